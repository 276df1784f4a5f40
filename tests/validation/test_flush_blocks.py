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
