"""The automatic time step: below the stability limit, and close to it."""

import numpy as np
import pytest
from scenes import irregular_tets, simulate

from cdem.errors import UnstableError
from cdem.mesh.element_shapes import mass_matrices, reference_gradients

TET = [[0, 0, 0], [1, 0, 0], [0.2, 1.1, 0], [0.1, 0.2, 0.9]]
SCENES = {
    "a tet": ([{"group": "a", "polyhedron": {"vertices": TET}}], {}),
    "a hexahedron": ([{"group": "a", "box": {"size": [1, 1, 1]}}], {}),
    "a plate": ([{"group": "a", "box": {"size": [4, 1, 4], "divisions": [4, 1, 4]}}], {}),
    "a plate of wedges": (
        [{"group": "a", "box": {"size": [2, 1, 2], "divisions": [2, 1, 2], "shape": "wedge6"}}],
        {},
    ),
    "a meshed cube": ([{"group": "a", "box": {"size": [1, 1, 1], "divisions": [8, 8, 8]}}], {}),
    "27 bonded hexahedra": (
        [{"group": "a", "box": {"size": [3, 3, 3], "divisions": [3, 3, 3]}}],
        {"split": {"a": "elements"}},
    ),
    "48 bonded tets": (
        [{"group": "a", "box": {"size": [2, 2, 2], "divisions": [2, 2, 2], "shape": "tet4"}}],
        {"split": {"a": "elements"}},
    ),
}
BOND = {"friction_angle": 30, "cohesion": "100 GPa", "tensile_strength": "100 GPa"}


def build(name, stiffness, **time):
    blocks, model = SCENES[name]
    return simulate(
        blocks,
        {"a": {}},
        interfaces={"default": {**BOND, "stiffness_n": stiffness, "stiffness_s": stiffness}},
        model=model,
        time=time,
    )


def is_stable(name, stiffness, dt, steps=1500):
    """Whether random velocities of 1e-9 m/s stay below 1e-6 m/s."""
    sim = build(name, stiffness, step=dt)
    velocity = sim.motion[:, 4:7]
    velocity += np.random.default_rng(1).normal(size=velocity.shape) * 1e-9
    try:
        sim.step(steps)
    except UnstableError:
        return False
    return np.abs(sim.fields["velocity"]).max() < 1e-6


@pytest.mark.parametrize(
    "name, stiffness, least",
    [
        ("a tet", "1 E/h", 0.98),
        ("a hexahedron", "1 E/h", 0.98),
        ("a plate", "1 E/h", 0.85),
        ("a plate of wedges", "1 E/h", 0.92),
        ("a meshed cube", "1 E/h", 0.73),
        ("27 bonded hexahedra", "1 E/h", 0.87),
        ("27 bonded hexahedra", "10 E/h", 0.87),
        ("48 bonded tets", "1 E/h", 0.87),
        ("48 bonded tets", "10 E/h", 0.91),
    ],
)
def test_automatic_step_is_below_and_close_to_the_stability_limit(name, stiffness, least):
    """0.98 of the estimate is stable; 1.05 of the limit found by trial is not.

    The estimate is at least `least` of the limit. It is exact for a single element and bounds the
    stiffness of a node by that of its elements and bonds otherwise.
    """
    estimate = build(name, stiffness).core.step_limit()[0]
    assert is_stable(name, stiffness, 0.98 * estimate)
    low, high = 0.98, 1.05 / least
    assert not is_stable(name, stiffness, high * estimate)
    while high - low > 0.02:
        middle = 0.5 * (low + high)
        low, high = (
            (middle, high) if is_stable(name, stiffness, middle * estimate) else (low, middle)
        )
    assert not is_stable(name, stiffness, 1.05 * high * estimate)


@pytest.mark.parametrize("mass", ["lumped", "exact"])
def test_step_of_an_irregular_mesh_is_bounded_by_its_nodes(tmp_path, mass):
    """2 / sqrt(max eig M^-1 S), S the sum_e w_e^2 m_e of each node, is below the exact limit
    2 / sqrt(max eig M^-1 K) and above half of it; the worst element alone gives less than a third.

    M is diagonal, or the full mass matrix of a block of 125 nodes.
    """
    mesh = irregular_tets(tmp_path / "a.vtk", [4, 4, 4], [4, 4, 4])
    sim = simulate([], {"default": {}}, model=mesh, elements={"mass": mass})
    t, count = sim.build.topology, len(sim.fields["mass"])
    corners = t.node_position[t.element_nodes["tet4"]]
    gradient, volume = reference_gradients("tet4", corners)
    matrices = mass_matrices("tet4", corners, np.full(len(corners), 2500.0))
    stiffness, inertia = np.zeros((count, 3, count, 3)), np.zeros((count, count))
    lame = shear = 10e9 / 2 / 1.25  # nu = 0.25
    for e, nodes in enumerate(t.element_nodes["tet4"]):
        g = gradient[e, 0]
        block = lame * np.einsum("ia,jb->iajb", g, g) + shear * np.einsum("ib,ja->iajb", g, g)
        block += shear * np.einsum("ix,jx,ab->iajb", g, g, np.eye(3))
        stiffness[nodes[:, None], :, nodes[None, :], :] += volume[e] * block.transpose(0, 2, 1, 3)
        inertia[np.ix_(nodes, nodes)] += matrices[e]
    if mass == "lumped":
        inertia = np.diag(inertia.sum(axis=1))
    root = np.kron(np.linalg.inv(np.linalg.cholesky(inertia)), np.eye(3))
    full = root @ stiffness.reshape(3 * count, 3 * count) @ root.T
    exact = 2 / np.sqrt(np.linalg.eigvalsh(full)[-1])
    worst_element = 2 / sim.build.assembly.element_frequency["tet4"].max()
    assert (sim.build.arrays["node.mass_row_first"] >= 0).all() == (mass == "exact")
    assert worst_element < exact / 3
    assert exact / 2 < sim.core.step_limit()[0] < exact


def test_step_of_a_body_without_contact_is_that_of_its_elements():
    """A cube far from the bed that it has hit has half the step of a cube alone, however the run is split.

    Half: with all of it the next impact would change the energy of its vibrations by up to 67 %.
    """

    def fly(*runs):
        sim = simulate(
            [
                {"group": "body", "box": {"size": [1, 1, 1]}, "translate": [0, 0, 0.01]},
                {"group": "bed", "box": {"size": [4, 4, 1]}, "translate": [-1, -1, -1]},
            ],
            {"body": {"velocity": [0, 0, -10]}, "bed": {"fix": ["x", "y", "z"]}},
        )
        for steps in runs:
            sim.step(steps)
        assert sim.fields["position"][sim.build.nodes_of("body"), 2].min() > 0.5
        return sim.core.scalars()

    alone = simulate([{"group": "a", "box": {"size": [1, 1, 1]}}], {"a": {}}).core.scalars()["dt"]
    at_once = fly(2000)
    assert at_once["dt"] == pytest.approx(alone / 2, rel=1e-12)
    assert at_once == fly(*[100] * 20)


@pytest.mark.parametrize("model", ["shaken", "jointed"])
def test_step_of_scaled_masses_is_stable(tmp_path, model):
    """0.98 of the stable step with 1 % of mass added, of bonded tets and of blocks of a few tets."""
    joints = [{"name": "j", "dip": 30, "dip_direction": 70, "spacing": 0.4}]
    parts = {
        "shaken": (
            [],
            {"default": {}},
            {**irregular_tets(tmp_path / "a.vtk", [3, 3, 3], [3, 3, 3]),
             "split": {"default": "elements"}},
        ),
        "jointed": (
            [{"group": "a", "box": {"size": [1, 1, 2]}}], {"a": {}}, {"joints": joints},
        ),
    }  # fmt: skip
    blocks, groups, model = parts[model]

    def simulation(**time):
        scaling = {"mass_scaling": {"most": 0.01}}
        return simulate(
            blocks,
            groups,
            interfaces={"default": BOND},
            model=model,
            defaults=True,
            time=scaling | time,
        )

    free = simulate(blocks, groups, interfaces={"default": BOND}, model=model, defaults=True)
    limit = simulation().core.step_limit()[0]
    assert limit > 1.1 * free.core.step_limit()[0]
    sim = simulation(step=0.98 * limit)
    velocity = sim.motion[:, 4:7]
    velocity += np.random.default_rng(1).normal(size=velocity.shape) * 1e-9
    sim.step(1500)
    assert np.abs(sim.fields["velocity"]).max() < 1e-6
