"""Blocks that began flush have one surface for third ones, as long as they are flush."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import simulate

from cdem.verification.runner import Study, problems

BEDS = ["one mesh", "two blocks", "a wider floor", "blocks of tets"]


@pytest.mark.parametrize("angle", [40, pytest.param(20, marks=pytest.mark.slow), -10])
def test_a_kink_between_flush_blocks_is_that_of_one_mesh(angle, tmp_path):
    """Problem `kink`: speed past the kink as on one mesh, measured within 0.16 %."""
    (kink,) = problems(["kink"])
    study, kept = Study(kink.folder, threads=1), []
    for bed in BEDS:
        simulation = study.simulate(*kink.module.settings(bed, angle, tmp_path))
        kept.append(kink.module.pass_kink(simulation)[0])
        assert abs(simulation.energies["error"]) < 3e-3
    assert kept[1:] == pytest.approx(kept[:1] * 3, rel=5e-3)


def test_a_steep_kink_is_that_of_one_mesh(tmp_path):
    """A slab that strikes the foot of 80 degrees leaves it as on one mesh; measured 1.3e-4 of its
    speed. Edges of the seam took 6 % of it, or nothing held the corner."""
    (kink,) = problems(["kink"])
    study = Study(kink.folder, threads=1)
    left = [
        kink.module.strike(study.simulate(*kink.module.settings(bed, 80, tmp_path))) for bed in BEDS
    ]
    assert np.abs(np.array(left[1:]) - left[0]).max() < 1e-3


def test_a_face_that_its_neighbour_has_left_is_a_target_again():
    """Two boxes began flush; one is led away, and a cube meets the side that it covered.

    Exact: the cube stops at the side, at 1 m, but for the depth of its contacts: v sqrt(m / k).
    """
    bed = [
        {"group": "stays", "box": {"size": [1, 1, 1]}},
        {"group": "goes", "box": {"size": [1, 1, 1]}, "translate": [1, 0, 0]},
    ]
    cube = {"group": "cube", "box": {"size": [0.4, 0.4, 0.4]}, "translate": [1.5, 0.3, 1.7]}
    sim = simulate(
        [*bed, cube],
        {"stays": {"fix": ["x", "y", "z"]}, "goes": {}, "cube": {"velocity": [-2, 0, -4.8]}},
        loads={"gravity": [0, 0, 0], "velocities": [
            {"group": "goes", "components": ["x", "y", "z"], "velocity": [8, 0, 0]}]},
        rock={"young_modulus": "1 GPa"},
    )  # fmt: skip
    nearest = np.inf
    while sim.time < 0.4:
        sim.step(20)
        nearest = min(nearest, sim.fields["position"][sim.build.nodes_of("cube"), 0].min())
    depth = 2 * np.sqrt(2500 * 0.064 / (1e9 / 0.4 * 0.16))
    assert 1 - 3 * depth < nearest < 1
    assert sim.fields["velocity"][sim.build.nodes_of("cube"), 0].mean() > 1


def prism(group, section):
    """A block of 1 m along y with this outline in x and z [m]."""
    return {"group": group, "polyhedron": {"vertices": [[x, y, z] for x, z in section for y in (0, 1)]}}  # fmt: skip


def test_a_block_slides_on_over_the_joint_that_it_was_cut_by():
    """A slab of which the front and the bed are cut by one joint passes the seam without friction.

    Exact: it keeps its speed. It stood before the hidden side of the block in front as soon as the
    corners that began at one place had parted by a hundredth of its height.
    """
    front = [(0, 0), (0.75, -1)]
    sim = simulate(
        [
            prism("bed", [(-2, 0), *front, (-2, -1)]),
            prism("bed", [*front, (2, -1), (2, 0)]),
            prism("slab", [(-2, 0), (0, 0), (-0.75, 1), (-2, 1)]),
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "slab": {"velocity": [1, 0, 0]}},
        loads={"gravity": [0, 0, -9.81]},
        rock={"young_modulus": "1 GPa"},
    )
    while sim.time < 0.2:
        sim.step(20)
    assert sim.fields["velocity"][sim.build.nodes_of("slab"), 0].mean() == pytest.approx(
        1, abs=1e-3
    )
    assert abs(sim.energies["error"]) < 1e-3


def test_an_open_joint_gives_no_area_to_the_corner_beside_it():
    """A slab is drawn off the block behind; the face that has opened leans over the bed.

    Exact: the bed holds it by c A, here within 1.6e-4. The corner below the open face took the area
    that this face shares with the block behind, as long as both were near: 1.6 c A.
    """
    law = {"law": "residual", "friction_angle": 0, "cohesion": 5e3, "residual_cohesion": 5e3}
    sim = simulate(
        [
            {"group": "bed", "box": {"size": [6, 1, 1]}, "translate": [-3, 0, -1.0001]},
            prism("behind", [(-2, 0), (0, 0), (-0.75, 1), (-2, 1)]),
            prism("slab", [(0, 0), (2, 0), (1.25, 1), (-0.75, 1)]),
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "behind": {"fix": ["x", "y", "z"]}, "slab": {}},
        interfaces={"default": law},
        loads={
            "gravity": [0, 0, -9.81],
            "velocities": [{"group": "slab", "components": ["x"], "velocity": [0.02, 0, 0]}],
        },
        rock={"young_modulus": "1 GPa"},
        stages=[
            {
                "name": "run",
                "mode": "dynamic",
                "duration": 1,
                "damping": {"local": 0.7, "contact": 1},
            }
        ],
    )
    blocks = sim.build.topology.face_block
    held = []
    while sim.time < 0.15:
        sim.step(20)
        of = sim.contacts
        on_bed = (blocks[of["mother_face"]] == 0) | (blocks[of["target_face"]] == 0)
        if sim.time > 0.1:
            held.append(np.abs(of["force"][on_bed, 0]).sum())
    assert held == pytest.approx(np.full(len(held), 5e3 * 2), rel=1e-3)


def test_blocks_hide_each_other_after_their_bond_breaks():
    """A slab passes the seam of two bonded blocks that parts by 2 mm as it comes; no friction.

    Exact: it keeps its speed, here within 4e-4 of it. It stood before the hidden side of the block in
    front, and turned back.
    """
    front = [(0, 0), (0.75, -1)]
    sim = simulate(
        [
            prism("bed", [(-2, 0), *front, (-2, -1)]),
            prism("parts", [*front, (2, -1), (2, 0)]),
            prism("slab", [(-2.5, 0), (-0.5, 0), (-1.25, 1), (-2.5, 1)]),
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "parts": {}, "slab": {"velocity": [2, 0, 0]}},
        interfaces={
            "default": {"friction_angle": 0},
            "pairs": [{"between": ["bed", "parts"], "friction_angle": 0, "cohesion": "1 kPa",
                       "tensile_strength": "1 kPa"}],
        },
        loads={
            "gravity": [0, 0, -9.81],
            "velocities": [
                {"group": "parts", "components": ["x", "y", "z"], "velocity": [1e-2, 0, 0]}
            ],
        },
        rock={"young_modulus": "1 GPa"},
    )  # fmt: skip
    while sim.time < 0.4:
        sim.step(20)
    assert sim.broken["tension"] > 0
    assert sim.fields["velocity"][sim.build.nodes_of("slab"), 0].mean() == pytest.approx(
        2, rel=2e-3
    )
