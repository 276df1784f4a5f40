"""What the version of the case format fills in: the table of docs/defaults.md."""

from __future__ import annotations

import pytest

from cdem import Case

CASE = {
    "model": {"blocks": [{"group": "a", "box": {"size": [1, 1, 1]}}]},
    "materials": {"rock": {"density": 2500, "young_modulus": 1e10, "poisson_ratio": 0.2}},
    "groups": {"a": {"material": "rock"}},
    "stages": [
        {"name": "rest", "mode": "static"},
        {"name": "fall", "mode": "dynamic", "duration": 1},
        {"name": "own", "mode": "static", "relax": "kinetic", "damping": {"contact": 0.3}},
    ],
}


@pytest.mark.parametrize(
    ("version", "relax", "local", "contact", "masses"),
    [
        ({"cdem": 1}, "local", 0.8, 0.0, "exact"),
        ({"cdem": 2}, "adaptive", 0.0, 0.1, "lumped-while-bonded"),
        ({}, "adaptive", 0.0, 0.1, "lumped-while-bonded"),
    ],
)
def test_what_a_case_leaves_out_is_as_its_version_has_it(version, relax, local, contact, masses):
    case = Case.from_dict(CASE | version)
    rest, fall, own = case.stages
    assert (rest.relax, rest.damping.local, rest.damping.contact) == (relax, local, 0.0)
    assert (fall.relax, fall.damping.local, fall.damping.contact) == (None, 0.0, contact)
    assert (own.relax, own.damping.local, own.damping.contact) == ("kinetic", 0.0, 0.3)
    assert case.moved_masses == masses
