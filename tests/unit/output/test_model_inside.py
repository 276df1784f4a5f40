"""Bolts and water in the picture of a model: their parts, and what the stages do to tables."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import cdem
from cdem import Case
from cdem.model.bolt_places import Polyline
from cdem.output.model_inside import _kind, _over_stages, _part

TEMPLATES = Path(cdem.__file__).parent / "templates"
BENT = Polyline("b", 0, np.array([[0, 0, 0], [4, 0, 0], [4, 0, -4]], float))


def test_parts_of_a_bolt_keep_its_bends():
    np.testing.assert_array_equal(_part(BENT, 0, 3), [[0, 0, 0], [3, 0, 0]])
    np.testing.assert_array_equal(_part(BENT, 3, np.inf), [[3, 0, 0], [4, 0, 0], [4, 0, -4]])
    assert _part(BENT, 8, np.inf) is None
    assert _part(BENT, 0, 0) is None


def test_a_table_is_seen_in_each_stage_that_moves_it():
    case = Case.load(TEMPLATES / "bedded_slope.yaml")
    seen = [(stage, _kind(state.water.fields[0])) for stage, state in _over_stages(case)]
    assert seen == [("", "plane, lifted by -20 m"), (", stage rain", "plane, lifted by 6 m")]
    assert case.water.fields[0].lift == -20


def test_a_level_over_time_is_seen_at_its_highest():
    case = Case.load(TEMPLATES / "dam.yaml")
    (state,) = [state for _, state in _over_stages(case)]
    assert state.water.reservoir.level == [(0.0, 50.0)]
    assert case.water.reservoir.level[0] == (0.0, 0.0)


def test_a_dry_case_has_no_tables():
    assert list(_over_stages(Case.load(TEMPLATES / "safety.yaml"))) == []
