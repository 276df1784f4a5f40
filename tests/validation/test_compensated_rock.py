"""Rock whose every element is a block, as a continuum: E and nu of the whole are what the case says.

A cube of bonded tets is pulled or sheared by uniform tractions until it rests. Mean strain and
stress are those of its tets and faces, but for the outer layers.
"""

from __future__ import annotations

import numpy as np
import pytest
from scenes import case, irregular_tets

import cdem
from cdem.model.compensation import bonded_tets
from cdem.model.homogenize import STATES, means

YOUNG, NU = 1e10, 0.25
SIDES = pytest.mark.parametrize("side", [5, pytest.param(8, marks=pytest.mark.slow)])
STRONG = {"friction_angle": 30, "cohesion": 1e12, "tensile_strength": 1e12}


def compliance(model, group):
    """Strains by stresses of a cube, in the order of `STATES` [1/Pa], shape (6, 6)."""
    found = [pulled(dict(model), group, 1e5 * stress) for stress in STATES]
    strains, stresses = (np.concatenate(of, axis=1) for of in zip(*found, strict=True))
    return strains @ np.linalg.inv(stresses)


def pulled(model, group, stress):
    """Mean strain and stress of the inner tets of a cube under a uniform stress."""
    normals = [sign * np.eye(3)[axis] for axis in range(3) for sign in (1, -1)]
    tractions = [
        {"surface": {"group": group, "normal": n.tolist()}, "traction": (stress @ n).tolist()}
        for n in normals
        if (stress @ n).any()
    ]
    sim = cdem.Simulation(
        case(
            model.pop("blocks", []), {group: {}}, defaults=True, interfaces={"default": STRONG},
            rock={"young_modulus": YOUNG, "poisson_ratio": NU}, model=model,
            loads={"tractions": tractions, "gravity": [0, 0, 0]},
            stages=[{"name": "pull", "mode": "static", "relax": "adaptive", "tolerance": 1e-5}],
        ),
        threads=1,
    )  # fmt: skip
    assert sim.run() == "converged"
    t, made = sim.build.topology, sim.build.compensation[group]
    tets = bonded_tets(t, np.arange(len(t.pair_faces)), np.arange(len(t.element_nodes["tet4"])))
    u = sim.fields["displacement"][t.element_nodes["tet4"]].reshape(-1, 12, 1)
    return means(tets, u, made.stiffening * YOUNG, made.stiffening * NU, tets.inner(2))


def elastic():
    """What the case says [1/Pa]."""
    exact = -NU * np.ones((3, 3)) + (1 + NU) * np.eye(3)
    return (
        np.block([[exact, np.zeros((3, 3))], [np.zeros((3, 3)), 2 * (1 + NU) * np.eye(3)]]) / YOUNG
    )


@SIDES
def test_regular_tets(side):
    box = {"size": [side] * 3, "divisions": [side] * 3, "shape": "tet4"}
    found = compliance(
        {"blocks": [{"group": "rock", "box": box}], "split": {"rock": "elements"}}, "rock"
    )
    np.testing.assert_allclose(found, elastic(), atol=1e-6 / YOUNG)


@pytest.mark.slow
@pytest.mark.parametrize("side", [6, 8])
def test_irregular_tets(tmp_path, side):
    """The isotropic part: 3 sum C_nn + 2 sum C_cross + sum C_ss = 15 / E; sum over normals 1 / K."""
    mesh = irregular_tets(tmp_path / "m.vtk", [side] * 3, [side] * 3)
    c = compliance({**mesh, "split": {"default": "elements"}}, "default")
    normal, bulk = np.trace(c[:3, :3]), c[:3, :3].sum()
    young = 15 / (3 * normal + (bulk - normal) + np.trace(c[3:, 3:]))
    assert young == pytest.approx(YOUNG, rel=0.003)
    assert 1 / bulk == pytest.approx(YOUNG / (3 * (1 - 2 * NU)), rel=0.003)
    shear = 1 / (3 / young - bulk / 3)
    assert shear == pytest.approx(YOUNG / (2 * (1 + NU)), rel=0.003)


@pytest.mark.parametrize("mass", ["exact", "lumped-while-bonded"])
def test_the_ledger_closes_when_bonds_are_released_to_softer_contacts(mass):
    """A cube breaks on a bed: its bonds have about 7 E/h, its contacts 1 E/h."""
    cube = {"size": [1, 1, 1], "divisions": [4, 4, 4], "shape": "tet4"}
    bed = {"group": "bed", "box": {"size": [4, 4, 1]}, "translate": [-1, -1, -1]}
    sim = cdem.Simulation(
        case(
            [{"group": "body", "box": cube, "translate": [0, 0, 0.002]}, bed],
            {"body": {"velocity": [0.2, 0.1, -2]}, "bed": {"fix": ["x", "y", "z"]}}, defaults=True,
            interfaces={"default": STRONG | {"cohesion": 2e5, "tensile_strength": 1e5}},
            rock={"young_modulus": 1e8}, model={"split": {"body": "elements"}},
            loads={"gravity": [0, 0, -9.81]}, elements={"mass": mass},
            stages=[{"name": "fall", "mode": "dynamic", "duration": 0.02}],
        ),
        threads=1,
    )  # fmt: skip
    assert sim.run() == "finished"
    assert sum(sim.broken.values()) > 500
    assert abs(sim.energies["error"]) < 0.006
