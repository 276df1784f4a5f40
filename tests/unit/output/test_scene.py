"""The view that frames a model, and the strip below a picture."""

import matplotlib
import numpy as np
import pytest

from cdem.output.scene import ROW, SIZE, View, bar, color_map, foot, labels

CUBE = np.array([[x, y, z] for x in (0, 2) for y in (0, 3) for z in (0, 5)], float)


@pytest.mark.parametrize("back", [[0.6, -0.8, 0.75], [0, -1, 0.01], [3, 1, -2]])
@pytest.mark.parametrize("size", [(1100, 760), (300, 900)])
def test_all_points_are_in_the_picture_and_fill_it(back, size):
    points = CUBE @ np.diag([1, 40, 2]) + [5e5, 3e6, 100]
    view = View.framing(points, np.array(back, float), size)
    right = np.cross([0, 0, 1], view.back)
    right /= np.linalg.norm(right)
    up = np.cross(view.back, right)
    away = points - view.focus
    across, along = np.abs(away @ right).max(), np.abs(away @ up).max()
    half = np.array([size[0] / size[1], 1]) * view.height / 2
    share = np.array([across, along]) / half
    assert share.max() == pytest.approx(1 / 1.06)
    assert (away @ view.back).max() < view.far  # nothing is behind the camera


def test_a_low_model_has_a_low_picture():
    low = View.fitting(CUBE @ np.diag([40, 1, 1]), np.array([0, -1.0, 0]))
    assert low.size == (1100, 300)
    high = View.fitting(CUBE, np.array([0, -1.0, 0]))
    assert high.size == (1100, 760)
    assert high.metres == pytest.approx(5 * 1.06 / 760)


def test_a_plan_has_x_to_the_right():
    view = View.framing(CUBE, np.array([0, 0, 1.0]))
    assert view.right == pytest.approx([1, 0, 0])
    assert view.up == pytest.approx([0, 1, 0])


def columns_of_bar(strip):
    """Where the colour bar begins and ends [pixels]."""
    return np.flatnonzero(strip[ROW + 8].max(axis=1) < 255)


def test_a_bar_goes_from_one_end_to_the_other():
    colors = color_map("viridis")
    strip = bar("water_pressure", "Pa", colors, (0, 2.5e5), 500)
    assert strip.shape == (3 * ROW, 500, 3)
    columns = columns_of_bar(strip)
    assert len(columns) == columns[-1] - columns[0] + 1
    for place, value in ((0, 0.0), (-1, 1.0), (len(columns) // 3, 1 / 3)):
        want = 255 * np.array(colors(value)[:3])
        assert strip[ROW + 8, columns[place]] == pytest.approx(want, abs=3)


def foot_of(metres, *, north=False, back=(0, -1.0, 0)):
    view = View(np.zeros(3), np.array(back, float), metres * 760, 1.0, SIZE)
    return foot(labels([], 1, 10), view, 1000, north=north)


@pytest.mark.parametrize("metres, pixels", [(0.05, 200), (0.04, 125), (1.0, 200), (3e-4, 167)])
def test_a_scale_has_a_round_length(metres, pixels):
    """At most a fifth of the picture: 10 m, 5 m, 200 m, 5 cm."""
    dark = np.flatnonzero(foot_of(metres)[ROW + 12, :300].max(axis=1) < 100)
    assert np.ptp(dark) == pytest.approx(pixels, abs=3)


def test_an_arrow_shows_north_as_it_lies_in_the_picture():
    """To the right seen from the east, upwards in a plan; the axes if north is not known."""

    def reach(image):
        rows, columns = np.nonzero(image[:, 300:450].max(axis=2) < 100)
        return np.ptp(columns), np.ptp(rows)

    east = reach(foot_of(0.05, north=True, back=(1, 0, 0)))
    plan = reach(foot_of(0.05, north=True, back=(0, 0, 1)))
    assert east[0] > 40 > 20 > east[1]
    assert plan[1] > 40 > 20 > plan[0]
    axes = reach(foot_of(0.05))  # x and z
    assert min(axes) > 30


def test_little_has_nearly_the_colour_of_rock():
    """Nothing has it; from there the colours go over into those of the map without a jump."""
    colors = color_map("viridis")
    row = np.array([colors(x)[:3] for x in np.linspace(0, 1, 500)])
    assert (row[0] == row[1]).all()
    assert np.abs(np.diff(row, axis=0)).max() < 0.04
    assert row[60:] == pytest.approx(
        matplotlib.colormaps["viridis"](np.linspace(0, 1, 500))[60:, :3]
    )


def test_every_label_has_a_row():
    image = labels([("a", "#ff0000"), ("b", "#00ff00")], 3, 200)
    assert image.shape == (3 * ROW + 10, 200, 3)
    for row, color in enumerate(([255, 0, 0], [0, 255, 0])):
        assert (image[10 + ROW * row + 10, 30] == color).all()
