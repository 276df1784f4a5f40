"""Warnings of damping that does not fit the waves of a case."""

import re

import pytest

import cdem
from cdem.model.damping_doubts import damping_doubts

CASE = """\
model: {{blocks: [{{group: rock, box: {{size: [1, 1, 4], divisions: [1, 1, 4]}}}}]}}
materials: {{stone: {{density: 2500, young_modulus: "10 GPa", poisson_ratio: 0.25}}}}
groups: {{rock: {{material: stone}}}}
loads: {{gravity: [0, 0, 0]}}
records:
  wave: {{samples: [0, 1, 0, -1, 0, 1, 0, -1, 0, 1, 0], unit: m/s, step: "0.1 s"}}
boundaries:
  - {{name: base, surface: {{group: rock, normal: [0, 0, -1]}}, {base}}}
stages:
  - {{name: before, mode: dynamic, duration: 1, damping: {{mass: 10}}}}
  - {{name: shake, mode: dynamic, duration: 1,
     damping: {damping}}}
"""
INPUT = "stage: shake, input: {record: wave, direction: [1, 0, 0]"
QUIET, RIGID = f"quiet: true, {INPUT}}}", f"{INPUT}, kind: rigid}}"


def told(folder, damping, base=QUIET, more=""):
    path = folder / "a case.yaml"
    path.write_text(CASE.format(damping=damping, base=base) + more)
    return list(damping_doubts(cdem.Case.load(path)))


@pytest.mark.parametrize(
    ("damping", "words"),
    [
        ("{mass: 10}", "10 1/s damps waves of 2.5 Hz, the middle of the record, by 31.8 %"),
        ("{maxwell: {ratio: 0.01, band: [1, 20], reference: 30}}",
         "reference: 30 Hz is outside the band, 1 to 20 Hz"),
        ("{maxwell: {ratio: 0.01, band: [5, 20]}}", "band: 2.5 Hz, the middle of the record, is outside"),
    ],
)  # fmt: skip
def test_damping_that_does_not_fit_the_waves_is_told(tmp_path, damping, words):
    """One line with its place, and a remedy; the record has not begun in the stage before."""
    (line,) = told(tmp_path, damping)
    assert re.match(r".*a case\.yaml:12:16: stages\.1\.damping\.m", line), line
    assert words in line


@pytest.mark.parametrize(
    ("damping", "base"),
    [
        ("{mass: 1.5}", QUIET),  # 0.095 of 2 pi 2.5 Hz
        ("{rayleigh: {ratio: 0.05, frequency: 3}}", QUIET),
        ("{maxwell: {ratio: 0.05, band: [1, 20], reference: 4.47}}", QUIET),
        ("{maxwell: {ratio: 0.05, band: [1, 20]}}", QUIET),
    ],
)
def test_damping_that_fits_is_not_told(tmp_path, damping, base):
    assert not told(tmp_path, damping, base)


@pytest.mark.parametrize(
    ("first", "later"),
    [("{maxwell: {ratio: 0.05, band: [1, 20]}}", "{}"),
     ("{mass: 0.1}", "{maxwell: {ratio: 0.05, band: [1, 20]}}")],
)  # fmt: skip
def test_other_branches_in_a_later_stage_are_told_where_a_surface_is_quiet(tmp_path, first, later):
    """By its coefficient of reflection: the storage modulus is 1.21."""
    more = f"  - {{name: later, mode: dynamic, duration: 1, damping: {later}}}\n"
    (line,) = told(tmp_path, first, more=more)
    assert "stages.2.damping: waves in the rock are" in line
    assert "4.8 % of a wave comes back" in line
    assert not told(tmp_path, first, RIGID, more)


@pytest.mark.parametrize("base", [QUIET, RIGID])
def test_local_damping_of_waves_is_told_with_a_quiet_base_and_a_rigid_one(tmp_path, base):
    """It brakes every node by its force."""
    path = tmp_path / "a case.yaml"
    path.write_text(CASE.format(damping="{local: 0.1}", base=base))
    warnings = cdem.Case.load(path).warnings
    assert any("stages.1.damping.local: 0.1 distorts the waves" in line for line in warnings)
