"""Laws as the core declares them."""

import math
import re

import pytest

from cdem import Case, CaseError
from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS


def interface(**values):
    """The default interface of a case."""
    return Case(
        model={"blocks": [{"group": "rock", "box": {"size": [1, 1, 1]}}]},
        materials={"m": {"density": 2700, "young_modulus": 1e9, "poisson_ratio": 0.25}},
        groups={"rock": {"material": "m"}},
        interfaces={"default": values},
        stages=[{"name": "fall", "mode": "dynamic", "duration": 1}],
    ).interfaces.default


def test_the_core_has_the_laws_of_the_documents():
    assert list(INTERFACE_LAWS) == [
        "brittle", "residual", "slip-weakening", "softening", "velocity-weakening", "voellmy",
        "barton-bandis", "continuously-yielding",
    ]  # fmt: skip
    assert list(BLOCK_LAWS) == [
        "elastic",
        "mohr-coulomb",
        "ubiquitous-joint",
        "drucker-prager",
        "hoek-brown",
    ]
    assert [p.name for p in INTERFACE_LAWS["brittle"].parameters] == [
        "friction_angle", "cohesion", "tensile_strength", "dilation_angle", "dilation_slip"
    ]  # fmt: skip


def test_the_core_takes_tangents_of_angles():
    law = interface(friction_angle=30, cohesion="1 kPa")
    numbers = INTERFACE_LAWS["brittle"].numbers(law)
    assert numbers["friction_angle"] == math.tan(math.radians(30))
    assert numbers["cohesion"] == 1000 and numbers["tensile_strength"] == 0


@pytest.mark.parametrize(
    "law, message",
    [
        ({"law": "velocity-weakening", "dynamic_friction_angle": 20, "velocity": 0},
         "default: velocity must be above 0"),
        ({"law": "velocity-weakening", "dynamic_friction_angle": 31, "velocity": 1},
         "dynamic_friction_angle must not be larger than friction_angle, 30"),
        ({"law": "velocity-weakening", "dynamic_friction_angle": 20, "velocity": 1,
          "dilation_angle": 21, "dilation_slip": 1},
         "dilation_angle must not be larger than dynamic_friction_angle, 20"),
        ({"law": "voellmy", "turbulence": 0, "flow_density": 1}, "turbulence must be above 0"),
        ({"law": "voellmy", "turbulence": 500, "flow_density": 0}, "flow_density must be above 0"),
    ],
)  # fmt: skip
def test_laws_with_speed_say_what_does_not_fit(law, message):
    with pytest.raises(CaseError, match=message):
        interface(friction_angle=30, **law)


@pytest.mark.parametrize(
    "strengths, bonds",
    [({}, False), ({"cohesion": 1}, True), ({"tensile_strength": 1}, True)],
)
def test_faces_are_bonded_where_the_law_has_a_strength_that_bonds(strengths, bonds):
    law = interface(friction_angle=30, **strengths)
    assert INTERFACE_LAWS["brittle"].bonds(law) == bonds


def test_a_factor_of_safety_divides_strengths_and_the_tangent_of_friction():
    law = interface(friction_angle=45, cohesion=3e3, dilation_angle=10, dilation_slip=0.1)
    reduced = INTERFACE_LAWS["brittle"].reduced(law, 2)
    assert set(reduced) == {"friction_angle", "cohesion", "tensile_strength"}
    assert reduced["friction_angle"] == pytest.approx(math.degrees(math.atan(0.5)), rel=1e-15)
    assert reduced["cohesion"] == 1.5e3


def rock(**values):
    """The material of a case, Mohr-Coulomb unless told otherwise."""
    elastic = {"density": 2700, "young_modulus": 1e9, "poisson_ratio": 0.25}
    return Case(
        model={"blocks": [{"group": "rock", "box": {"size": [1, 1, 1]}}]},
        materials={"m": elastic | {"law": "mohr-coulomb"} | values},
        groups={"rock": {"material": "m"}},
        interfaces={"default": {"friction_angle": 30}},
        stages=[{"name": "fall", "mode": "dynamic", "duration": 1}],
    ).materials["m"]


def test_a_strength_that_is_left_out_has_no_limit_and_stays_so():
    law, material = BLOCK_LAWS["mohr-coulomb"], rock(cohesion="1 MPa", friction_angle=30)
    assert material.tensile_strength is None and material.dilation_angle == 0
    assert law.numbers(material)["tensile_strength"] == math.inf
    assert "tensile_strength" not in law.reduced(material, 2)
    material.tensile_strength = None  # as a resolved case says it
    given = rock(cohesion="1 MPa", friction_angle=30, tensile_strength="0.3 MPa")
    assert law.numbers(given)["tensile_strength"] == 3e5
    assert law.reduced(given, 2)["tensile_strength"] == 1.5e5


def test_a_factor_of_safety_keeps_dilation_below_friction():
    material = rock(cohesion=1e6, friction_angle=30, dilation_angle=30)
    reduced = BLOCK_LAWS["mohr-coulomb"].reduced(material, 1.7)
    assert reduced["dilation_angle"] == reduced["friction_angle"] < 30


@pytest.mark.parametrize(
    "values, told",
    [
        ({"cohesion": 1e6}, "friction_angle"),
        ({"cohesion": -1, "friction_angle": 30}, "cohesion"),
        ({"cohesion": 1, "friction_angle": 90}, r"friction_angle: must lie in \[0, 90\)"),
        (
            {"cohesion": 1, "friction_angle": 20, "dilation_angle": 21},
            "dilation_angle must not be larger than friction_angle, 20 deg",
        ),
        ({"cohesion": 0, "friction_angle": 0}, "must not both be 0"),
        ({"law": "elastic", "cohesion": 1}, "cohesion"),
    ],
)
def test_parameters_of_rock_that_cannot_be_are_refused(values, told):
    with pytest.raises(CaseError, match=told):
        rock(**values)


def test_strengths_in_words():
    law = interface(friction_angle=20, cohesion="2 MPa", tensile_strength="0.5 MPa")
    assert INTERFACE_LAWS["brittle"].summary(law) == "20 deg, bonded c 2e+06 T 5e+05 Pa"
    assert INTERFACE_LAWS["brittle"].summary(interface(friction_angle=30)) == "30 deg"


def test_a_factor_of_safety_multiplies_the_factor_of_rough_joints():
    of = interface(law="barton-bandis", jrc=8, jcs="50 MPa", residual_friction_angle=27)
    law = INTERFACE_LAWS["barton-bandis"]
    assert law.reduced(of, 1.5) == {"strength_factor": 1.5}
    assert law.numbers(of)["uniaxial_strength"] == 5e7
    assert law.curved and not law.bonds(of)
    assert law.summary(of) == "JRC 8, JCS 5e+07 Pa, phi_r 27 deg"


def test_an_unknown_law_is_refused():
    with pytest.raises(CaseError, match="law"):
        interface(law="britle", friction_angle=30)


def test_a_stage_cannot_change_the_law():
    with pytest.raises(CaseError, match="'law' of an interface is fixed at the start"):
        Case(
            model={"blocks": [{"group": "rock", "box": {"size": [1, 1, 1]}}]},
            materials={"m": {"density": 2700, "young_modulus": 1e9, "poisson_ratio": 0.25}},
            groups={"rock": {"material": "m"}},
            interfaces={"default": {"friction_angle": 30}},
            stages=[
                {
                    "name": "fall",
                    "mode": "dynamic",
                    "duration": 1,
                    "set": {"interfaces.default.law": "brittle"},
                }
            ],
        )


RESIDUAL = {"law": "residual", "friction_angle": 40, "cohesion": "2 MPa"}


def test_a_parameter_that_is_like_another_follows_it():
    law, of = INTERFACE_LAWS["residual"], interface(**RESIDUAL)
    assert of.residual_friction_angle is None
    assert law.numbers(of)["residual_friction_angle"] == math.tan(math.radians(40))
    assert "residual_friction_angle" not in law.reduced(of, 2)
    given = interface(**RESIDUAL, residual_friction_angle=30)
    assert law.values(given)["residual_friction_angle"] == 30
    assert law.summary(given) == "40 deg, phi_r 30 deg, c_r 0 Pa, bonded c 2e+06 T 0 Pa"


@pytest.mark.parametrize(
    "wrong, told",
    [
        ({"residual_friction_angle": 41}, "must not be larger than friction_angle, 40"),
        ({"dilation_angle": 35, "dilation_slip": 1, "residual_friction_angle": 30},
         "dilation_angle must not be larger than residual_friction_angle, 30"),
        ({"residual_cohesion": "3 MPa"}, "residual_cohesion must not be larger than cohesion, 2e+06"),
        ({"law": "brittle", "residual_cohesion": 0}, "unknown key; it belongs to law: residual or softening"),
    ],
)  # fmt: skip
def test_residual_values_that_do_not_fit(wrong, told):
    with pytest.raises(CaseError, match=re.escape(told)):
        interface(**RESIDUAL | wrong)


def test_a_pair_takes_from_the_default_what_its_own_law_has():
    case = Case.from_dict(
        {
            "model": {"blocks": [{"group": g, "box": {"size": [1, 1, 1]}} for g in ("a", "b")]},
            "materials": {"m": {"density": 2700, "young_modulus": 1e9, "poisson_ratio": 0.25}},
            "groups": {g: {"material": "m"} for g in ("a", "b")},
            "interfaces": {
                "default": RESIDUAL | {"residual_friction_angle": 25},
                "pairs": [
                    {"between": ["a", "a"], "law": "brittle", "friction_angle": 35},
                    {"between": ["b", "b"], "cohesion": 0},
                ],
            },
            "stages": [{"name": "fall", "mode": "dynamic", "duration": 1}],
        }
    )
    brittle, residual = case.interfaces.pairs
    assert (brittle.law, brittle.cohesion) == ("brittle", 2e6)
    assert not hasattr(brittle, "residual_friction_angle")
    assert (residual.law, residual.cohesion, residual.residual_friction_angle) == (
        "residual",
        0,
        25,
    )


def test_a_pair_may_leave_out_what_has_no_number_for_nothing():
    """The aperture of a rough joint follows from others, whatever the law of the default."""
    case = Case(
        model={"blocks": [{"group": "rock", "box": {"size": [1, 1, 1]}}]},
        materials={"m": {"density": 2700, "young_modulus": 1e9, "poisson_ratio": 0.25}},
        groups={"rock": {"material": "m"}},
        interfaces={
            "default": {"friction_angle": 30},
            "pairs": [
                {"between": ["rock", "rock"], "law": "barton-bandis", "jrc": 10, "jcs": "50 MPa",
                 "residual_friction_angle": 28}
            ],
        },
        stages=[{"name": "fall", "mode": "dynamic", "duration": 1}],
    )  # fmt: skip
    assert case.interfaces.pairs[0].aperture is None
