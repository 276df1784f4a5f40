"""Layers that make no sense are answered with what is wrong; parts of columns."""

import numpy as np
import pytest
from shared.facets import sheet, write

from cdem.errors import CaseError
from cdem.terrain import Landslide, make_mesh
from cdem.terrain.layers import graded

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")


def level(z):
    return {"plane": {"dip": 0, "dip_direction": 0, "through": [0, 0, z]}}


def layered(**changes):
    """Ground at 100 m, soil to 90 m, weathered rock to 75 m, bedrock to 0."""
    data = {
        "terrain": level(100),
        "extent": {"x": [0, 60], "y": [0, 40], "base": 0},
        "layers": [{"group": "soil", "base": level(90)}, {"group": "weathered", "base": level(75)}],
        "bedrock": "granite",
        "sizes": {"body": 20, "far": 40},
    }
    return data | changes


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"layers": [{"group": "a", "base": level(75)}, {"group": "b", "base": level(90)}]},
            r"layers\.1\.base: lies above the base of a everywhere, so the layer is absent; list layers",
        ),
        (
            {"layers": [{"group": "a", "base": level(175)}]},
            r"layers\.0\.base: lies above the ground everywhere",
        ),
        (
            {"layers": [{"group": "a", "base": level(99)}]},  # thinner than a tenth of an element
            r"layers\.0\.base: lies above the ground everywhere",
        ),
        (
            {"layers": [{"group": "a", "base": level(10)}]},
            r"extent\.base: must lie at least an element below the ground and the lowest layer",
        ),
        (
            {"layers": [{"group": "a", "base": level(90)}, {"group": "a", "base": level(75)}]},
            r"layers\.1\.group: the name 'a' is used twice",
        ),
        (
            {"layers": [{"group": "granite", "base": level(90)}]},
            r"layers\.0\.group: the name 'granite' is used twice",
        ),
        (
            {"layers": [{"group": "a", "base": {}}]},
            r"layers\.0\.base: needs exactly one of contours, grid, triangles, lines, plane, planes, "
            r"ellipsoid, points; got none",
        ),
        (
            {"layers": [{"group": "a", "base": {"slbl": {"depth": 5}}}]},
            r"layers\.0\.base\.slbl: unknown key",
        ),
        (
            {"layers": [{"group": "a", "base": level(90) | {"layer": "TOP"}}]},
            r"layers\.0\.base: layer goes with triangles; leave it out",
        ),
        (
            {"surface": level(90), "bodies": [{"group": "b", "outline": [[9, 9], [20, 9], [20, 20]]}]},
            r"layers do not go together with bodies and a sliding surface; leave out one of them",
        ),
        ({"sizes": {"body": 80, "far": 90}}, r"sizes\.far: is larger than the extent"),
        (
            {"layers": [{"group": "a", "base": {"triangles": "none.ts"}}]},
            r"layers\.0\.base\.triangles: none\.ts: cannot read the surface: there is no such file",
        ),
    ],
)  # fmt: skip
def test_mistakes_are_answered(changes, message):
    with pytest.raises(CaseError, match=message) as caught:
        make_mesh(Landslide(**layered(**changes)))
    assert "\n" not in str(caught.value)


def test_a_surface_that_ends_or_folds_inside_the_extent(tmp_path):
    points, triangles = sheet(
        lambda x, y: 90 + 0 * x, np.linspace(-5, 50, 5), np.linspace(-5, 45, 5)
    )
    write(tmp_path / "short.obj", points, triangles)
    data = layered(layers=[{"group": "a", "base": {"triangles": str(tmp_path / "short.obj")}}])
    with pytest.raises(CaseError, match=r"layers\.0\.base: has no data at \(60, 0\); it reaches from "
                       r"\(-5, -5\) to \(50, 45\); make the extent smaller, or give data"):  # fmt: skip
        make_mesh(Landslide(**data))
    points, triangles = sheet(
        lambda x, y: 90 + 0 * x, np.linspace(-5, 65, 8), np.linspace(-5, 45, 6)
    )
    hole = triangles[: len(triangles) // 2 - 5]
    write(tmp_path / "short.obj", points, np.concatenate([hole, triangles[len(hole) + 10 :]]))
    with pytest.raises(CaseError, match=r"layers\.0\.base: has no data at \(.*\); .* with gaps"):
        make_mesh(Landslide(**data))
    twice = np.concatenate([triangles, triangles + len(points)])
    write(tmp_path / "short.obj", np.concatenate([points, points - [0, 0, 9]]), twice)
    with pytest.raises(
        CaseError, match=r"layers\.0\.base\.triangles: .*short\.obj: has two heights at"
    ):
        make_mesh(Landslide(**data))


def test_parts_of_a_column_grow_downwards():
    """10, 15, 22.5 m with a growth of a half; equal parts where none may be larger than the first."""
    depth = lambda parts, height: -np.diff(np.array(parts[::-1])) * height  # noqa: E731
    assert depth(graded(47.5, 10, 100, 0.5), 47.5) == pytest.approx([10, 15, 22.5])
    assert depth(graded(90, 10, 20, 0.5), 90) == pytest.approx(
        np.array([10, 15, 20, 20, 20]) * 90 / 85
    )
    assert depth(graded(34, 10, 10, 0.3), 34) == pytest.approx([34 / 3] * 3)
    assert graded(3, 10, 10, 0.3) == [0, 1]
