"""Elements in a wave length, told by the audit."""

import numpy as np
import pytest
from scenes import case

from cdem import Simulation
from cdem.errors import CaseError
from cdem.model.build import build
from cdem.model.compliance import bonded_interfaces
from cdem.model.wave_mesh import (
    GOOD,
    NONE,
    highest_frequency,
    phase_error,
    shear_speed,
    wave_mesh,
)

SPEED = np.sqrt(4e9 / 2500)  # of S waves in the rock of scenes [m/s]
TOP = {"surface": {"group": "a", "normal": [0, 0, 1]}}


def blasted(rise, *, groups=None, shape="hex8", **more):
    """A box with edges up to 0.5 m, and a pressure on its top that rises in `rise` s."""
    box = {"size": [2, 1, 0.5], "divisions": [4, 4, 2], "shape": shape}
    pulse = {"peak": 1e6, "rise": rise, "fall": 2 * rise}
    stages = [{"name": "run", "mode": "dynamic", "duration": 1e-3}]
    return case([{"group": "a", "box": box}], groups or {"a": {}}, stages=stages,
                loads={"blasts": [TOP | {"pressure": pulse}]}, **more)  # fmt: skip


@pytest.mark.parametrize(
    ("count", "degrees"), [(20, 1.2), (12, 3.3), (10, 4.9), (8, 7.8), (5, 22.8)]
)
def test_phase_error_of_s_waves_with_the_step_of_p_waves(count, degrees):
    """Poisson's ratio 1/4, 0.8 of the limit of P: computed before by waves of a chain of cells."""
    assert phase_error(count, 0.8 / np.sqrt(3)) == pytest.approx(degrees, abs=0.05)
    assert phase_error(2, 0.8 / np.sqrt(3)) == NONE


@pytest.mark.parametrize(("shape", "edge"), [("hex8", 0.5), ("tet4", np.hypot(0.5, 0.354))])
def test_the_worst_element_of_each_group_is_told(shape, edge):
    rise = 2e-2
    sim = Simulation(blasted(rise, shape=shape), threads=1)
    (row,) = sim.audit.wave_mesh
    edge = 0.5 if shape == "hex8" else np.sqrt(0.5**2 + 0.25**2 + 0.25**2)
    assert row["edge"] == pytest.approx(edge)
    assert row["speed"] == pytest.approx(SPEED)
    assert row["elements"] == pytest.approx(np.pi * rise * SPEED / edge, rel=1e-4)
    assert row["bears"] == pytest.approx(SPEED / (GOOD * edge))
    assert "a: 159 elements in a wave length (of 0.5 m at" in sim.audit.text() or shape == "tet4"
    assert not [w for w in sim.audit.warnings if "the S wave of" in w]


def test_directions_in_which_a_group_is_fixed_do_not_count():
    (row,) = Simulation(blasted(1e-2, groups={"a": {"fix": ["x"]}}), threads=1).audit.wave_mesh
    assert row["edge"] == pytest.approx(0.25)


@pytest.mark.parametrize(("components", "told"), [("xyz", []), ("xy", ["a"])])
def test_a_table_whose_nodes_are_all_driven_has_no_waves(components, told):
    """It moves as a rigid body, however coarse it is."""
    driven = {"group": "a", "velocity": [1, 0, 0], "components": list(components)}
    blast = TOP | {"pressure": {"peak": 1e6, "rise": 2e-2, "fall": 4e-2}}
    box = {"size": [1, 1, 1], "divisions": [2, 2, 2]}
    stages = [{"name": "run", "mode": "dynamic", "duration": 1e-3}]
    shaken = case([{"group": "a", "box": box}], {"a": {}}, stages=stages,
                  loads={"blasts": [blast], "velocities": [driven]})  # fmt: skip
    assert [row["group"] for row in Simulation(shaken, threads=1).audit.wave_mesh] == told


def test_a_coarse_mesh_is_told_and_a_coarser_one_refused():
    per = np.pi * SPEED / 0.5  # elements a second of rise
    (told,) = [
        w for w in Simulation(blasted(8 / per), threads=1).audit.warnings if "the S wave of" in w
    ]
    assert "groups.a: the S wave of 503 Hz is 5 elements long" not in told
    assert "is 8 elements long, of 0.5 m at" in told
    assert "mesh the group with edges of 0.4 m" in told
    with pytest.raises(
        CaseError, match=r"groups\.a: the S wave of .* is 4 elements long.*allow_coarse"
    ):
        Simulation(blasted(4 / per), threads=1)
    allowed = Simulation(blasted(4 / per, waves={"allow_coarse": True}), threads=1)
    assert not [w for w in allowed.audit.warnings if "the S wave of" in w]


def test_bonds_slow_the_waves_of_their_group():
    """Layers of 0.25 m with k_s of G / 0.25 m between them: c_s / sqrt(1 + 3 / 4) of four layers."""
    box = {"size": [1, 1, 1], "divisions": [1, 1, 4]}
    stiff = f"{4e9 / 0.25} Pa/m"
    built = build(case(
        [{"group": "a", "box": box}], {"a": {}}, model={"split": {"a": "elements"}},
        interfaces={"default": {"friction_angle": 0, "cohesion": 1e9, "tensile_strength": 1e9,
                                "stiffness_n": stiff, "stiffness_s": stiff}},
    ))  # fmt: skip
    assert shear_speed(built, "a", bonded_interfaces(built)) == pytest.approx(SPEED / np.sqrt(1.75))


def test_without_blasts_there_is_nothing_to_tell():
    model = case([{"group": "a", "box": {"size": [1, 1, 1]}}], {"a": {}})
    assert highest_frequency(model) == 0
    built = build(model)
    assert wave_mesh(built, [], 0.0) == []
