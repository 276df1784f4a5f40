"""Slices, columns and blocks of bonded elements, pulled along each axis: E is what the case says.

Exact: 1/E of bricks of height h in a row, each behind a bond of a E'/h, is (1 + 1/a) / E'. The free
ends of the row have no bonds, and those beside them stand for both. Along an axis without bonds the
elements are alone, e = E'/E times as stiff: `cdem check` says so, to the per cent.
"""

from __future__ import annotations

import numpy as np
import pytest
from scenes import case, irregular_tets, turn

import cdem

YOUNG, NU, STRESS = 1e10, 0.25, 1e5
STRONG = {"friction_angle": 30, "cohesion": 1e12, "tensile_strength": 1e12}
TOLERANCE = 0.002


def pulled(blocks, axis, turned=None, group="rock", model=None):
    """E of a whole body that is pulled along an axis, over that of the case; what makes up for bonds."""
    (found,), made = each_pulled(blocks, axis, turned, group, model, [(-np.inf, np.inf)])
    return found, made


def each_pulled(blocks, axis, turned, group, model, parts):
    """The same of several bodies, each in its part of x."""
    way = np.eye(3)[axis] if turned is None else np.asarray(turned)[:, axis]
    tractions = [
        {"surface": {"group": group, "normal": (s * way).tolist()}, "traction": (s * STRESS * way).tolist()}
        for s in (1, -1)
    ]  # fmt: skip
    sim = cdem.Simulation(
        case(
            blocks, {group: {}}, defaults=True, interfaces={"default": STRONG},
            rock={"young_modulus": YOUNG, "poisson_ratio": NU},
            model={"split": {group: "elements"}, **(model or {})},
            loads={"tractions": tractions, "gravity": [0, 0, 0]},
            stages=[{"name": "pull", "mode": "static", "relax": "adaptive", "tolerance": 1e-5}],
        ),
        threads=1,
    )  # fmt: skip
    assert sim.run() == "converged"
    along, u = sim.build.born @ way, sim.fields["displacement"] @ way
    found = []
    for part in parts:
        nodes = [face[face >= 0] for face in sim.build.topology.face_nodes]
        nodes = [n for n in nodes if part[0] <= sim.build.born[n, 0].mean() <= part[1]]
        low, high = (_mean(u, [n for n in nodes if np.allclose(along[n], end, atol=1e-9)], sim)
                     for end in (along.min(), along.max()))  # fmt: skip
        found.append(STRESS * np.ptp(along) / (high - low) / YOUNG)
    return found, sim.build.compensation[group]


def _mean(u, faces, sim):
    """Mean over faces by their area: all points of a triangle or a square count alike."""
    x = sim.build.born
    area = [np.linalg.norm(np.cross(x[f[2]] - x[f[0]], x[f[-1]] - x[f[1]])) for f in faces]
    return np.average([u[f].mean() for f in faces], weights=area)


def box(divisions, shape, size=None):
    return [{"group": "rock", "box": {"size": size or divisions, "divisions": divisions, "shape": shape}}]  # fmt: skip


BRICKS = [
    ([1, 1, 10], None), ([8, 1, 8], None), ([4, 2, 6], None), ([3, 3, 3], None), ([5, 5, 5], None),
    ([1, 2, 1], None), ([4, 2, 3], [4, 1, 6]), ([2, 4, 5], [8, 2, 1]),
]  # fmt: skip


@pytest.mark.parametrize(("divisions", "size"), BRICKS)
def test_bricks_are_exact_along_axes_with_bonds(divisions, size):
    for axis, cells in enumerate(divisions):
        found, made = pulled(box(divisions, "hex8", size), axis)
        exact = 1.0 if cells > 1 else 1.2
        assert found == pytest.approx(exact, rel=TOLERANCE)
        assert 1 + made.along_xyz[axis] == pytest.approx(exact, rel=1e-6)


TETS = [([1, 1, 10], [2]), ([8, 1, 8], [0, 2]), ([2, 2, 8], [2]), ([4, 2, 6], []), ([4, 4, 4], []),
        ([2, 2, 2], [0, 1, 2])]  # fmt: skip


@pytest.mark.parametrize(("divisions", "right"), TETS)
def test_tets_are_exact_along_what_is_long_or_as_told(divisions, right):
    for axis in range(3):
        found, made = pulled(box(divisions, "tet4"), axis)
        assert found == pytest.approx(1 + made.along_xyz[axis], rel=0.005)
        if axis in right:
            assert found == pytest.approx(1, rel=0.005)


@pytest.mark.parametrize("shape", ["wedge6", "pyramid5"])
@pytest.mark.parametrize("divisions", [[1, 1, 6], [4, 1, 4], [3, 3, 3]])
def test_other_shapes_are_as_told(shape, divisions):
    for axis in range(3):
        found, made = pulled(box(divisions, shape), axis)
        assert found == pytest.approx(1 + made.along_xyz[axis], rel=0.01)
        if divisions[axis] == 6:
            assert found == pytest.approx(1, rel=0.02)


@pytest.mark.parametrize("shape", ["hex8", "tet4"])
def test_a_column_may_lean(shape):
    """A turned column: no axis of space is its own."""
    column = box([1, 1, 8], shape)[0] | {"rotate": {"axis": [1, 2, 3], "angle": 40}}
    found, _ = pulled([column], 2, turn([1, 2, 3], 40))
    assert found == pytest.approx(1, rel=0.005)


def test_fine_and_coarse_tets_of_one_group_are_right_each():
    """Two cubes of 4 m, of cells of 1 and of 0.4 m. Tolerance: surfaces, which are counted."""
    cubes = [
        box([n] * 3, "tet4", [4] * 3)[0] | {"translate": [x, 0, 0]} for n, x in ((4, 0), (10, 9))
    ]
    found, _ = each_pulled(cubes, 2, None, "rock", None, [(0, 4), (9, 13)])
    assert found == pytest.approx([1, 1], rel=0.01)


def test_walls_that_meet_are_right_each():
    """Slices along x and along y, one group: neither has bonds across itself, which counts for none."""
    walls = [box([8, 1, 4], "hex8")[0], box([1, 8, 4], "hex8")[0] | {"translate": [-1, 0, 0]}]
    found, made = pulled(walls, 2)
    assert made.stiffening == pytest.approx(1.2, rel=1e-6)
    assert found == pytest.approx(1, rel=TOLERANCE)


def test_bricks_in_running_bond_are_counted():
    """Every other course is shifted by half a brick: beds do not conform, but are bonds, too."""
    courses = [
        box([4, 1, 1], "hex8", [8, 1, 1])[0] | {"translate": [k % 2, 0, k]} for k in range(6)
    ]
    made = cdem.Simulation(
        case(courses, {"rock": {}}, defaults=True, interfaces={"default": STRONG},
             model={"split": {"rock": "elements"}}),
    ).build.compensation["rock"]  # fmt: skip
    assert made.stiffening == pytest.approx(1.2, rel=1e-6)
    x, y, z = made.along_xyz
    assert x == pytest.approx(0, abs=1e-3) and y == pytest.approx(0.2, abs=1e-3)
    assert 0 < z < 0.02


def test_shaken_tets_are_as_told(tmp_path):
    mesh = irregular_tets(tmp_path / "m.vtk", [2, 2, 8], [2, 2, 8])
    for axis in range(3):
        found, made = pulled([], axis, group="default", model=mesh)
        assert found == pytest.approx(1 + made.along_xyz[axis], rel=0.005)
    assert found == pytest.approx(1, rel=0.02)
