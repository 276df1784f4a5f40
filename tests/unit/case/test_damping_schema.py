"""Damping of rock by a ratio: refusals, each with its place in the file."""

import pytest

import cdem
from cdem.errors import CaseError

CASE = """\
model: {{blocks: [{{group: rock, box: {{size: [1, 1, 1]}}}}]}}
materials: {{stone: {{density: 2500, young_modulus: "10 GPa", poisson_ratio: 0.25}}}}
groups: {{rock: {{material: stone}}}}
{elements}
stages:
  - name: shake
    mode: {mode}
    {damping}
"""
DYNAMIC = "dynamic\n    duration: 1"


def load(folder, damping, mode=DYNAMIC, elements=""):
    path = folder / "a case.yaml"
    path.write_text(CASE.format(damping=f"damping: {damping}", mode=mode, elements=elements))
    return cdem.Case.load(path)


def refusal(*args):
    with pytest.raises(CaseError) as raised:
        load(*args)
    return str(raised.value)


RAYLEIGH, MAXWELL = "{ratio: 0.05, frequency: 3 Hz}", "{ratio: 0.02, band: [0.2 Hz, 20 Hz]}"


def test_damping_of_rock_is_read_with_units(tmp_path):
    """Frequencies may have a unit; part and reference have defaults."""
    rayleigh = load(tmp_path, f"{{rayleigh: {RAYLEIGH}}}").stages[0].damping.rayleigh
    assert (rayleigh.ratio, rayleigh.frequency, rayleigh.part) == (0.05, 3.0, "both")
    maxwell = load(tmp_path, f"{{maxwell: {MAXWELL}}}").stages[0].damping.maxwell
    assert (maxwell.band, maxwell.reference) == ([0.2, 20.0], "static")
    given = load(tmp_path, "{maxwell: {ratio: 2 %, band: [0.2, 20], reference: 3 Hz}}")
    assert given.stages[0].damping.maxwell.reference == 3.0
    again = cdem.Case.from_dict(given.model_dump(mode="json"))
    assert again.stages[0].damping == given.stages[0].damping


@pytest.mark.parametrize(
    ("damping", "place", "words"),
    [
        (f"{{rayleigh: {RAYLEIGH}, maxwell: {MAXWELL}}}", "9:5", "would add up: give one of them"),
        (f"{{mass: 2, stiffness: 0.1, rayleigh: {RAYLEIGH}}}", "9:5", "remove mass and stiffness"),
        ("{rayleigh: {ratio: 0.21, frequency: 3}}", "9:26", "must lie in (0, 0.2] [1], got 0.21"),
        ("{rayleigh: {ratio: 0, frequency: 3}}", "9:26", "must lie in (0, 0.2] [1], got 0"),
        ("{rayleigh: {ratio: 0.1, frequency: 0}}", "9:38", "must be above 0 [Hz], got 0"),
        ("{maxwell: {ratio: 0.5, band: [1, 2]}}", "9:25", "must lie in (0, 0.2] [1], got 0.5"),
        ("{maxwell: {ratio: 0.1, band: [2, 1]}}", "9:15", "write band: [1, 2]"),
        ("{maxwell: {ratio: 0.1, band: [2, 2]}}", "9:15", "write a lower and a higher frequency"),
        ("{maxwell: {ratio: 0.1, band: [0.01, 20]}}", "9:15", "over a factor of 1000 at most"),
        ("{maxwell: {ratio: 0.1, band: [1]}}", "9:37", "needs at least 2 entries"),
        ("{maxwell: {ratio: 0.1, band: [1, 2, 3]}}", "9:37", "needs at most 2 entries"),
        ("{maxwell: {ratio: 0.1, band: [0, 2]}}", "9:44", "must be above 0 [Hz], got 0"),
        ("{maxwell: {ratio: 0.1, band: 2 Hz}}", "9:37", "must be a list"),
        ("{maxwell: {ratio: 0.1, band: [1, 2], reference: 0}}", "9:51", "must be above 0 [Hz]"),
        ("{rayleigh: {ratio: 0.1}}", "9:15", "frequency: is missing"),
        ("{rayleigh: 0.1}", "9:15", "must be a mapping"),
        ("{rayleigh: {ratio: .nan, frequency: 3}}", "9:26", "must be a finite number"),
        ("{rayleigh: {ratio: 0.1, frequency: 3 km}}", "9:38", "wrong dimension; use one of: Hz"),
        ("{rayleigh: {ratio: 0.1, frequency: 3, part: all}}", "9:52", "must be both or mass"),
        ("{maxwell: {ratio: 0.1, band: [1, 2], reference: fast}}", "9:51", "must be a number"),
    ],
)
def test_wrong_damping_of_rock_is_refused_with_its_place(tmp_path, damping, place, words):
    """One line with file, line, column and a remedy."""
    text = refusal(tmp_path, damping)
    assert f"a case.yaml:{place}" in text
    assert words in text
    assert len(text.splitlines()) == 1


@pytest.mark.parametrize("kind", ["rayleigh", "maxwell"])
def test_damping_of_rock_needs_a_dynamic_stage(tmp_path, kind):
    """A static stage looks for rest with damping of its own."""
    own = RAYLEIGH if kind == "rayleigh" else MAXWELL
    text = refusal(tmp_path, f"{{{kind}: {own}}}", "static")
    assert f"damping.{kind} has no effect in a static stage; remove it" in text


def test_dashpots_and_branches_need_elements_that_have_them(tmp_path):
    """Only corotational elements do; Rayleigh's mass part needs none."""
    other = "elements: {formulation: incremental}"
    assert "part: mass" in refusal(tmp_path, f"{{rayleigh: {RAYLEIGH}}}", DYNAMIC, other)
    assert "corotational" in refusal(tmp_path, f"{{maxwell: {MAXWELL}}}", DYNAMIC, other)
    load(tmp_path, "{rayleigh: {ratio: 0.05, frequency: 3, part: mass}}", DYNAMIC, other)
