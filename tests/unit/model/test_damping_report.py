"""The audit's lines about the damping of rock."""

import pytest

import cdem
from cdem.model.compliance import bonded_interfaces
from cdem.model.damping_report import rock_dampings

BOX = {"group": "a", "box": {"size": [20, 20, 20], "divisions": [4, 4, 4]}}


SINE = {"samples": [0, 1, 0, -1] * 20 + [0], "unit": "m/s", "step": 0.05, "scale": 0.1}


def told(damping, split="connected", **more):
    made = {
        "model": {"blocks": [BOX], "split": {"a": split}},
        "materials": {"r": {"density": 2650, "young_modulus": "30 GPa", "poisson_ratio": 0.25}},
        "groups": {"a": {"material": "r"}},
        "interfaces": {"default": {"friction_angle": 30, "cohesion": 1e9, "tensile_strength": 1e9}},
        "stages": [{"name": "shake", "mode": "dynamic", "duration": 1, "damping": damping}],
    } | more
    build = cdem.Simulation(cdem.Case.from_dict(made), threads=1).build
    return rock_dampings(build, bonded_interfaces(build))


def test_without_damping_of_rock_nothing_is_told():
    assert told({"mass": 1.0}) == []


def test_rayleigh_is_told_with_its_cost_and_what_maxwell_would_take():
    """Ratio at the frequency and five times above it; the step is seven times shorter."""
    (found,) = told({"rayleigh": {"ratio": 0.05, "frequency": 3}})
    assert found.ratios == pytest.approx({3.0: 0.05, 15.0: 0.13})
    assert found.step == pytest.approx(found.without / 7.15, rel=1e-3)
    assert found.instead == pytest.approx(found.without / 1.26, rel=1e-3)
    lines = "\n".join(found.lines())
    assert "damping of stage shake, rayleigh: 5 % at 3 Hz, 13 % at 15 Hz" in lines
    assert "maxwell: {ratio: 0.05, band: [0.3, 30]}" in lines


def test_rayleigh_is_told_at_the_middle_and_highest_frequency_of_the_record():
    """A sine of 5 Hz, whose spectrum is narrow."""
    load = {"group": "a", "velocity": [1, 0, 0], "components": ["x"], "record": "sine"}
    (found,) = told(
        {"rayleigh": {"ratio": 0.05, "frequency": 3}},
        records={"sine": SINE},
        loads={"gravity": [0, 0, 0], "velocities": [load]},
    )
    at, middle, highest = found.ratios
    assert (at, middle) == (3, pytest.approx(5, abs=0.1))
    assert middle < highest < 10
    assert found.ratios[middle] == pytest.approx(0.025 * (3 / middle + middle / 3))


def test_the_mass_part_alone_costs_nothing_and_is_told_below_its_frequency():
    (found,) = told({"rayleigh": {"ratio": 0.05, "frequency": 3, "part": "mass"}})
    assert found.ratios == pytest.approx({3.0: 0.025, 0.6: 0.125})
    assert found.step == pytest.approx(found.without, rel=1e-3)
    assert len(list(found.lines())) == 2


@pytest.mark.parametrize("reference", ["static", 3])
def test_maxwell_is_told_with_its_moduli_in_motion(reference):
    (found,) = told({"maxwell": {"ratio": 0.05, "band": [0.3, 30], "reference": reference}})
    assert sorted(found.ratios.values()) == pytest.approx([0.0486, 0.0514], abs=1e-4)
    low, high = found.stiffness
    assert high / low == pytest.approx(1.47 / 1.069, rel=1e-3)
    assert (low > 1) == (reference == "static")
    assert found.share == 1


def test_the_share_of_bonds_is_told():
    """Hexahedra compensate bonds by 1.2 times the modulus: 1 / (1 + 0.2 times 1.25 in motion)."""
    (found,) = told({"maxwell": {"ratio": 0.05, "band": [0.3, 30]}}, "elements")
    assert found.share == pytest.approx(1 / (1 + 0.2 * 1.25), rel=2e-3)
    assert any("bonds and joints are not damped by it" in line for line in found.lines())
