"""How much softer bonds make a body, and beams too coarse to bend."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import plain

from cdem import Case, Simulation

STRONG = {"friction_angle": 30, "cohesion": 1e12, "tensile_strength": 1e12}
YOUNG = 1e9


def beam(length, cells, split, shape="hex8", load=(0.0, 0.0, 0.0), poisson=0.0) -> Simulation:
    """A bar of 1 m x 1 m along x, clamped at x = 0, with a traction at its end."""
    case = Case.from_dict(plain({  # nothing makes up for the bonds
        "model": {
            "blocks": [
                {"group": "bar", "box": {"size": [length, 1, 1], "divisions": cells, "shape": shape}}
            ],
            "split": {"bar": split},
        },
        "materials": {"m": {"density": 2500, "young_modulus": YOUNG, "poisson_ratio": poisson}},
        "groups": {"bar": {"material": "m"}},
        "interfaces": {"default": STRONG},
        "loads": {
            "gravity": [0, 0, 0],
            "tractions": [{"surface": {"group": "bar", "normal": [1, 0, 0]}, "traction": list(load)}],
            "supports": [{"box": {"min": [-1e-6] * 3, "max": [1e-6, 2, 2]}, "fix": ["x", "y", "z"]}],
        },
        "stages": [
            {"name": "load", "mode": "static", "relax": "adaptive", "tolerance": 1e-5,
             "max_steps": 4000},
        ],
    }))  # fmt: skip
    return Simulation(case, threads=1)


def moved(sim: Simulation, axis: int) -> float:
    sim.run()
    end = sim.build.start_position[:, 0] > sim.build.start_position[:, 0].max() - 1e-9
    return float(sim.fields["displacement"][end, axis].mean())


def test_layers_in_tension_and_shear_are_exact():
    """Planes across the bar, k = 10 E / h: each adds h / 10 of rock in tension, h E / (10 G) / h."""
    sim = beam(4, [8, 1, 1], "elements", poisson=0.25)
    (row,) = sim.audit.interfaces
    assert row["compliance_along_xyz"] == pytest.approx([100 * 7 * 0.05 / 4, 0, 0])
    ratio = 1 / 2.5  # G / E
    expected = 100 * 7 * 0.05 / 4 * ratio
    assert row["shear_compliance_in_xy_yz_zx"] == pytest.approx([expected, 0, expected])


@pytest.mark.parametrize(
    ("load", "axis", "length", "measured_over_stated"),
    [((1e3, 0, 0), 0, 4, (0.95, 1.0)), ((0, 0, -1e3), 2, 6, (0.65, 1.05))],
    ids=["tension", "bending"],
)
@pytest.mark.parametrize("shape", ["hex8", "wedge6", "tet4"])
def test_the_stated_compliance_is_met_in_tension_and_holds_in_bending(
    shape, load, axis, length, measured_over_stated
):
    """Beams of 2 x 2 cells, bonded against whole: hardly less is announced than is measured."""
    cells = [2 * length, 2, 2]
    whole = moved(beam(length, cells, "connected", shape, load), axis)
    bonded = beam(length, cells, "elements", shape, load)
    added = 100 * (moved(bonded, axis) / whole - 1)
    (row,) = bonded.audit.interfaces
    low, high = measured_over_stated
    assert low * row["compliance_percent"] < added < (high + 0.05) * row["compliance_percent"]


@pytest.mark.parametrize("split", ["connected", "elements"])
def test_beams_of_tets_less_than_three_deep_are_told(split):
    def told(*args, **more) -> list[str]:
        return [w for w in beam(*args, split, **more).audit.warnings if "a beam of tets" in w]

    (warning,) = told(6, [12, 2, 2], shape="tet4")
    assert warning.startswith("group bar: a beam of tets 2.0 deep bends too little")
    assert told(6, [18, 3, 3], shape="tet4") == []
    assert told(6, [12, 2, 2], shape="hex8") == []
    assert told(3, [6, 2, 2], shape="tet4") == []  # a stocky body hardly bends


def test_the_softest_direction_is_warned_of():
    soft = dict(STRONG, stiffness_n=f"{2 * YOUNG} Pa/m", stiffness_s=f"{2 * YOUNG} Pa/m")
    sim = beam(4, [8, 1, 1], "elements")
    assert not any("compliance" in w for w in sim.audit.warnings)
    data = sim.case.model_dump(mode="json", exclude_none=True)
    data["interfaces"]["default"] = soft
    warnings = Simulation(Case(**data), threads=1).audit.warnings
    assert any("bar - bar adds 88 % compliance in tension and bending" in w for w in warnings)
    assert np.isclose(100 * 7 / 4 / 2, 87.5)
