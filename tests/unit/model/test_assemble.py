"""Arrays of the core: all of every joint is bonded."""

import numpy as np
import pytest
from scenes import simulate
from shared.joints import SETS, jointed_case

import cdem


@pytest.mark.parametrize("persistence, fisher", [(1.0, 200.0), (0.6, 200.0)])
def test_all_of_every_joint_is_bonded(persistence, fisher):
    """Where neighbours were cut differently, the true overlaps of their faces add up."""
    more = {"persistence": persistence, "scatter": {"fisher": fisher}}
    b = cdem.Simulation(
        jointed_case(
            {
                "model.joints": [s | more for s in SETS],
                "interfaces.default": {"friction_angle": 30, "cohesion": 1e6},
            }
        ),
        threads=1,
    ).build
    a = b.assembly
    made = b.arrays["face.area"][b.topology.face_kind > 0].sum() / 2
    kinds = ("triangles", "overlaps")
    bonded = [b.arrays[f"{k}.area"][: a.counts[f"{k}.count"]].sum() for k in kinds]
    assert sum(bonded) == pytest.approx(made, rel=1e-9)
    assert bonded[1] > 0.1 * made or persistence == 1


def test_faces_know_the_sphere_of_their_blocks_volume():
    blocks = [
        {"group": "a", "box": {"size": [1, 2, 3], "divisions": [1, 2, 1]}},
        {"group": "b", "box": {"size": [1, 1, 1], "shape": "tet4"}, "translate": [5, 0, 0]},
        {"group": "c", "box": {"size": [1, 1, 1]}, "translate": [9, 0, 0]},
    ]
    build = simulate(blocks, {"a": {}, "b": {}, "c": {"fix": ["x", "y", "z"]}}).build
    radius, group = build.arrays["face.radius"], build.topology.face_group
    for name, volume in (("a", 6.0), ("b", 1.0)):
        own = radius[group == build.group_names.index(name)]
        assert own == pytest.approx(np.full(len(own), (0.75 * volume / np.pi) ** (1 / 3)), rel=1e-8)
    assert (radius[group == build.group_names.index("c")] == 1e300).all()
