"""Elements at rest: patch test, deflection of a cantilever (Timoshenko); hourglass control."""

import meshio
import numpy as np
import pytest
from scenes import ROCK, simulate

import cdem
from cdem.mesh.primitives import box


@pytest.mark.parametrize("hexahedra", ["full", "one-point"])
@pytest.mark.parametrize("shape", ["hex8", "tet4"])
def test_patch_test_gives_uniform_stress(tmp_path, shape, hexahedra):
    """A distorted mesh under a traction of 0.1 MPa has that stress in every element.

    It is strained by sigma / E along it and -nu sigma / E across. Tolerances: the unbalance ratio of
    1e-9 at which the stage ends, 1e-4 Pa; the square of the strain of 1e-5.
    """
    young, poisson = 10e9, 0.3
    mesh = box("body", [1, 1, 1], [3, 3, 3], shape=shape)
    points = mesh.points.copy()
    inside = ((points > 1e-6) & (points < 1 - 1e-6)).all(axis=1)
    points[inside] += np.random.default_rng(1).uniform(-0.08, 0.08, (inside.sum(), 3))
    kind = {"hex8": "hexahedron", "tet4": "tetra"}[shape]
    cells = mesh.cells[shape]
    meshio.Mesh(
        points,
        [(kind, cells)],
        cell_data={"gmsh:physical": [np.ones(len(cells), int)], "gmsh:geometrical": [np.ones(len(cells), int)]},
        field_data={"body": np.array([1, 3])},
    ).write(tmp_path / "body.msh", file_format="gmsh22", binary=False)  # fmt: skip
    sides = [
        {"surface": {"group": "body", "normal": [-1.0 * (i == k) for i in range(3)]}, "fix": [axis]}
        for k, axis in enumerate("xyz")
    ]
    case = cdem.Case.from_dict(
        {
            "model": {"mesh": str(tmp_path / "body.msh")},
            "materials": {
                "rock": ROCK | {"young_modulus": young, "poisson_ratio": poisson},
            },
            "groups": {"body": {"material": "rock"}},
            "interfaces": {"default": {"friction_angle": 0}},
            "elements": {"hexahedra": hexahedra},
            "loads": {
                "supports": sides,
                "tractions": [
                    {"surface": {"group": "body", "normal": [0, 0, 1]}, "traction": [0, 0, 1e5]}
                ],
            },
            "stages": [{"name": "pull", "mode": "static", "relax": "adaptive", "tolerance": 1e-9}],
        }
    )
    sim = cdem.Simulation(case, threads=1)
    assert sim.run() == "converged"
    count = sim.build.assembly.counts[f"{shape}.count"]
    stress = sim.core.stress()[shape].reshape(6, -1)[:, :count]
    exact = np.zeros((6, count))
    exact[2] = 1e5
    np.testing.assert_allclose(stress, exact, rtol=0, atol=2e-4)  # [Pa]
    strain = 1e5 / young * np.array([-poisson, -poisson, 1])
    moved = sim.fields["displacement"]
    np.testing.assert_allclose(moved, strain * sim.build.start_position, rtol=0, atol=1e-10)


@pytest.mark.parametrize("hexahedra, cells, within", [("full", 4, 0.011), ("one-point", 1, 0.004)])
def test_deflection_of_a_cantilever(hexahedra, cells, within):
    """P L^3 / 3 E I + P L / (5/6 G A); one element of one point in the height is enough.

    Tolerance: the error of the mesh, 1.0 % and 0.35 %.
    """
    length, load, young = 10, 1e4, 10e9
    sim = simulate(
        [{"group": "beam", "box": {"size": [length, 1, 1], "divisions": [length * cells, cells, cells]}}],
        {"beam": {}},
        rock={"young_modulus": young, "poisson_ratio": 0},
        elements={"hexahedra": hexahedra},
        loads={
            "supports": [{"surface": {"group": "beam", "normal": [-1, 0, 0]}, "fix": ["x", "y", "z"]}],
            "tractions": [
                {"surface": {"group": "beam", "normal": [1, 0, 0]}, "traction": [0, 0, -load]}
            ],
        },
        stages=[{"name": "bend", "mode": "static", "relax": "adaptive", "tolerance": 1e-6}],
    )  # fmt: skip
    assert sim.run() == "converged"
    tip = sim.build.start_position[:, 0] > length - 1e-6
    exact = load * length**3 / (3 * young / 12) + load * length / (5 / 6 * young / 2)
    assert -sim.fields["displacement"][tip, 2].mean() == pytest.approx(exact, rel=within)


def test_hourglass_control_resists_and_conserves_energy():
    """A hexahedron of one point vibrates and spins: the energy ledger closes over 10 revolutions.

    Its edge keeps its length but for the vibration of 0.1 %.
    """
    sim = simulate(
        [{"group": "block", "box": {"size": [1, 0.8, 0.6]}}],
        {"block": {"angular_velocity": [1, 20, 3]}},
        rock={"young_modulus": "0.1 GPa"},
        elements={"hexahedra": "one-point"},
        time={"safety": 0.4},
    )
    sim.motion[:, 4:7] += np.random.default_rng(0).normal(size=(8, 3))
    edges = sim.fields["position"][1] - sim.fields["position"][0]
    turned = 2 * np.pi / np.linalg.norm([1, 20, 3])
    while sim.time < 10 * turned:
        sim.step(500)
        assert abs(sim.energies["error"]) < 5e-4
    now = sim.fields["position"][1] - sim.fields["position"][0]
    assert np.linalg.norm(now) == pytest.approx(np.linalg.norm(edges), rel=3e-3)
