"""What is said where a run ends that cannot go on: what, where, how to mend it."""

import numpy as np
import pytest
from shared.cases import FALL

import cdem
from cdem.case.case import Case
from cdem.case.reader import load_case_data
from cdem.run import failures


@pytest.fixture
def run(tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(FALL)
    return cdem.Simulation(Case.from_dict(load_case_data(path)[0]), threads=1)


@pytest.mark.parametrize(
    ("outcome", "value", "words"),
    [
        ("missed_contact", 3, ["found 3 contact(s)", "report this case"]),
        ("lost_contact", 0, ["a loaded contact of block 0 (group cube)", "contact_stiffness"]),
        (
            "not_finite",
            np.nan,
            ["node 5 of block 0 (group cube) no longer has a finite", "time.safety"],
        ),
        ("too_fast", 9e3, ["node 5 of block 0 (group cube) moves at 9e+03 m/s", "time.safety"]),
    ],
)
def test_an_outcome_says_where_and_how_to_mend_it(run, outcome, value, words):
    said = failures.of_outcome(run, outcome, 5, value)
    for word in words:
        assert word in said


def test_a_sound_run_has_no_failure(run):
    run.run()
    assert failures.of_energy(run) == failures.of_strain(run) == ""


def test_a_step_that_is_given_is_the_one_to_make_smaller(run):
    run.case.set("time.step", 1e-5)
    assert "Use a smaller time.step, or" in failures.of_outcome(run, "not_finite", 0, np.nan)
