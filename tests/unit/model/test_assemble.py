"""Arrays of the core: all of every joint is bonded."""

import pytest
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
