"""The view that frames a model, and the strip below a picture."""

import numpy as np
import pytest

from cdem.output.scene import ROW, View, bar, color_map, labels

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


def columns_of_bar(strip):
    """Where the colour bar begins and ends [pixels]."""
    colored = np.flatnonzero(strip[ROW + 8].max(axis=1) < 255)
    return colored[colored > 400]


def test_a_bar_goes_from_nothing_to_the_largest_value():
    colors = color_map("viridis")
    strip = bar("water_pressure", "Pa", colors, 2.5e5, 0.05, 1000)
    assert strip.shape == (3 * ROW, 1000, 3)
    columns = columns_of_bar(strip)
    assert len(columns) == columns[-1] - columns[0] + 1
    for place, value in ((0, 0.0), (-1, 1.0), (len(columns) // 3, 1 / 3)):
        want = 255 * np.array(colors(value)[:3])
        assert strip[ROW + 8, columns[place]] == pytest.approx(want, abs=3)


@pytest.mark.parametrize("metres, pixels", [(0.05, 200), (0.04, 125), (1.0, 200), (3e-4, 167)])
def test_a_scale_has_a_round_length(metres, pixels):
    """At most a fifth of the picture: 10 m, 5 m, 200 m, 5 cm."""
    strip = bar("", "", color_map("viridis"), 1.0, metres, 1000)
    dark = np.flatnonzero(strip[ROW + 12, :400].max(axis=1) < 100)
    assert np.ptp(dark) == pytest.approx(pixels, abs=3)


def test_next_to_nothing_has_the_colour_of_rock():
    neutral, slight, first = (color_map("viridis")(x) for x in (0.0, 0.003, 0.01))
    assert neutral == slight != first


def test_every_label_has_a_row():
    image = labels([("a", "#ff0000"), ("b", "#00ff00")], 3, 200)
    assert image.shape == (3 * ROW + 10, 200, 3)
    for row, color in enumerate(([255, 0, 0], [0, 255, 0])):
        assert (image[10 + ROW * row + 10, 30] == color).all()
