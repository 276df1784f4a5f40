"""FracMan files: polygons become discs of their centre, plane and area."""

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.joints.directions import pole
from cdem.joints.discs import read_discs

HEAD = """BEGIN FORMAT
    Format = Ascii
    Length_Unit = {unit}
    XAxis = East
    Scale = 100
    No_Fractures = 2
    No_TessFractures = 0
END FORMAT

BEGIN SETS
    Set1 = "bedding"
END SETS

BEGIN FRACTURE
"""


def regular(center, dip, direction, corner_radius, corners, turn):
    """Corners of a regular polygon in a plane."""
    normal = pole(dip, direction)
    across = np.linalg.svd(normal[None])[2][1:]
    angle = turn * 2 * np.pi * np.arange(corners) / corners
    return np.array(center) + corner_radius * np.stack([np.cos(angle), np.sin(angle)], -1) @ across


def fab(path, polygons, unit="M", end="END FRACTURE\n"):
    text = HEAD.format(unit=unit)
    for k, x in enumerate(polygons, 1):
        text += f"  {k} {len(x)} 1 1e-6\n"
        text += "".join(f"    {i} {a:.9f} {b:.9f} {c:.9f}\n" for i, (a, b, c) in enumerate(x, 1))
        text += "    0 -1 -1 -1\n"  # a constant, as some writers put there
    path.write_text(text + end)
    return path


def test_polygons_become_discs(tmp_path):
    made = [((4, 5, 6), 30, 120, 2.0, 4), ((-100, 2e3, 50), 85, 10, 3.0, 9)]
    polygons = [regular(*row, turn) for row, turn in zip(made, (1, -1), strict=True)]
    found = read_discs(fab(tmp_path / "network.fab", polygons))
    for disc, (center, dip, direction, radius, corners) in zip(found, made, strict=True):
        area = corners / 2 * radius**2 * np.sin(2 * np.pi / corners)
        assert disc.center == pytest.approx(center) and disc.radius**2 * np.pi == pytest.approx(
            area
        )
        assert disc.normal == pytest.approx(pole(dip, direction), abs=1e-8)


def test_an_uneven_polygon(tmp_path):
    x = np.array([[0, 0, 0], [6, 0, 0], [6, 2, 0], [2, 2, 0], [2, 6, 0], [0, 6, 0]], float)  # an L
    disc = read_discs(fab(tmp_path / "l.fab", [x]))[0]
    assert disc.center == pytest.approx([2.2, 2.2, 0]) and disc.radius**2 * np.pi == pytest.approx(
        20
    )


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda t: t.replace("Ascii", "Binary"), "f.fab:2: format = binary: save it as ASCII"),
        (lambda t: t.replace("= M", "= Feet"), "f.fab:3: length_unit = feet: export it in metres"),
        (lambda t: t.replace("East", "North"), "f.fab:4: xaxis = north"),
        (lambda t: t.replace("TessFractures = 0", "TessFractures = 3"), "export polygons"),
        (lambda t: t.replace("BEGIN FRACTURE", ""), "no line BEGIN FRACTURE"),
        (lambda t: t.replace("1 4 1", "1 x 1"), "f.fab:15: a fracture is a row"),
        (lambda t: t.replace("1 4 1", "1 9 1"), "f.fab:15: a fracture is a row"),
        (lambda t: t.replace("END FRACTURE", ""), "is truncated"),
        (lambda t: t[: t.index("  1 4")] + "END FRACTURE", "contains no fractures"),
    ],
)
def test_what_is_refused(tmp_path, change, what):
    path = fab(tmp_path / "f.fab", [regular((0, 0, 0), 30, 90, 1.0, 4, 1)])
    path.write_text(change(path.read_text()))
    with pytest.raises(CaseError) as error:
        read_discs(path)
    assert what in str(error.value)


def test_a_fracture_without_area_is_refused(tmp_path):
    with pytest.raises(CaseError, match="fracture 1 has no area"):
        read_discs(fab(tmp_path / "f.fab", [np.array([[0, 0, 0], [1, 1, 1], [2, 2, 2.0]])]))
