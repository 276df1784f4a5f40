"""Records of a case: their files become samples, and wrong ones are refused."""

import numpy as np
import pytest
from shared.signals import G, at2, synthetic

from cdem import Case, CaseError

CASE = """\
model: {blocks: [{group: rock, box: {size: [1, 1, 1]}}]}
materials: {m: {density: 2600, young_modulus: 1 GPa, poisson_ratio: 0.2}}
groups: {rock: {material: m}}
interfaces: {default: {friction_angle: 30}}
loads:
  velocities:
    - {group: rock, velocity: [1, 0, 0], record: kobe, stage: shake}
records:
  kobe: {file: kobe.at2}
stages:
  - {name: rest, mode: static}
  - {name: shake, mode: dynamic, duration: 20 s}
"""


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Load the case with one text in place of another, beside a file of the synthetic record."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "kobe.at2").write_text(at2(synthetic()[1], 0.005))

    def load(old="kobe.at2", new="kobe.at2"):
        assert old in CASE
        (tmp_path / "case.yaml").write_text(CASE.replace(old, new, 1))
        return Case.load("case.yaml")

    return load


@pytest.fixture
def said(load):
    """What is said about the case with one text in place of another."""

    def said(old, new):
        with pytest.raises(CaseError) as caught:
            load(old, new)
        return str(caught.value)

    return said


def test_samples_of_a_file_become_part_of_the_case(load, tmp_path):
    """The case that a run writes needs no file, and means the same to the bit."""
    case = load()
    record = case.records["kobe"]
    assert (record.file, record.unit, record.step, record.quantity) == (
        "kobe.at2", "g", 0.005, "acceleration")  # fmt: skip
    (tmp_path / "kobe.at2").unlink()
    (tmp_path / "again.yaml").write_text(case.dump())
    again = Case.load("again.yaml")
    assert again.records["kobe"].samples == record.samples
    assert again.processed("kobe") is case.processed("kobe")


def test_a_record_is_processed_once_and_then_the_same_arrays(load):
    """Also by copies of the case."""
    case = load()
    first = case.processed("kobe")
    assert first is case.processed("kobe") is case.model_copy(deep=True).processed("kobe")
    assert np.abs(first.acceleration).max() / G == pytest.approx(0.36495, abs=1e-5)


def test_samples_may_stand_in_a_case_made_in_python(load):
    """As an array; the scale counts."""
    samples = np.sin(np.arange(400) * 0.1)
    data = load().model_dump(mode="json")
    data["records"]["kobe"] = {
        "file": "none",
        "samples": samples,
        "unit": "cm/s",
        "step": 0.01,
        "scale": 2,
    }
    record = Case.from_dict(data).processed("kobe")
    np.testing.assert_allclose(record.velocity[10:390], 0.02 * samples[10:390], rtol=1e-15)


@pytest.mark.parametrize(
    ("new", "words"),
    [
        ("none.at2", "case.yaml:9:10: records.kobe.file: none.at2: cannot read the record"),
        ("kobe.dat", "has the ending .dat; a record is a PEER file (.at2)"),
        ("kobe.at2, unit: m/s2", "the file has the unit g, the case m/s2; remove unit"),
        ("kobe.at2, step: 1 ms", "the file has the step 0.005, the case 1 ms; remove step"),
        ("kobe.at2, kind: velocity", "the unit g is that of acceleration, not of velocity"),
        ("kobe.at2, scale: 0", "scale must not be 0"),
        ("kobe.at2, scale: 14", "case.yaml:9:3: records.kobe: its acceleration reaches 5.11 g"),
        ("kobe.at2, band: [5 Hz, 1 Hz]", "9:26: records.kobe.band: the low frequency must be below"),
        ("kobe.at2, band: [1 Hz, 101 Hz]", "101 Hz is above 100 Hz, the highest frequency"),
        ("kobe.at2, band: [0.04 Hz, 9 Hz]", "0.04 Hz is below 0.05 Hz, one period in the 20 s"),
        ("kobe.at2, band: [1 Hz]", "records.kobe.band"),
        ("kobe.at2, band: [1 m, 2 Hz]", "'1 m' has the wrong dimension; use one of: Hz, kHz"),
        ("kobe.at2, baseline: linear", "must be none or cubic, got 'linear'"),
        ("kobe.at2, samples: [1, 2]", "9:26: records.kobe.samples: has 2 samples; a record has 10"),
        ("kobe.at2, samples: 1 2 x", "records.kobe.samples: could not convert string to float"),
        ("kobe.at2, colour: red", "unknown key"),
    ],
)  # fmt: skip
def test_a_wrong_record_is_refused_with_its_place(said, new, words):
    """One line with file, line and column of the case."""
    found = said("kobe.at2", new)
    assert words in found and len(found.splitlines()) == 1 and found.startswith("case.yaml:9:")


def test_a_velocity_too_high_for_a_record_is_refused_or_told(said, load, tmp_path):
    """A slow sine, whose acceleration is low."""
    rows = "".join(f"{0.05 * i!r}, {float(np.sin(0.0125 * i))!r}\n" for i in range(1000))
    (tmp_path / "slow.csv").write_text("time [s], v [m/s]\n" + rows)
    assert "records.kobe: its velocity reaches 11 m/s, above 10 m/s; look at its unit" in said(
        "kobe.at2", "slow.csv, scale: 11"
    )
    told = load("kobe.at2", "slow.csv, scale: 4").warnings
    assert any("its velocity reaches 4 m/s, above 3 m/s, which is rare" in line for line in told)


@pytest.mark.parametrize(
    ("value", "words"),
    [("nan", "sample 5 is nan; a record has numbers only"), ("x", "f.csv:6: '0.04, x' is not a row"),
     ("1\n0.05, 2\n0.06, 3\n0.077, 9", "its times are not evenly spaced (row")],
)  # fmt: skip
def test_a_wrong_sample_is_told_with_the_places_in_case_and_file(said, tmp_path, value, words):
    """The case says which file, the file which row."""
    rows = "".join(f"{0.01 * i:.2f}, {i + 1}\n" for i in range(4)) + f"0.04, {value}\n"
    tail = "" if "\n" in value else "".join(f"{0.01 * i:.2f}, {i}\n" for i in range(5, 20))
    head, more = "time [s], a [m/s2]\n", "0.08, 1\n0.09, 1\n0.10, 1\n"
    (tmp_path / "f.csv").write_text(head + rows + (tail or more))
    found = said("kobe.at2", "f.csv")
    assert found.startswith("case.yaml:9:10: records.kobe.file: f.csv") and words in found
    assert len(found.splitlines()) == 1


def test_a_file_without_a_unit_is_refused_with_the_list_of_units(said, tmp_path):
    """There is no default."""
    rows = "".join(f"{0.01 * i:.2f} {i % 7 - 3}\n" for i in range(100))
    (tmp_path / "plain.txt").write_text(rows)
    found = said("kobe.at2", "plain.txt")
    assert "the unit is missing, in file and case: g, m/s2, cm/s2, m/s, cm/s, m, cm" in found


def test_a_file_without_times_needs_a_step(said, load, tmp_path):
    """One column, or an array."""
    np.save(tmp_path / "a.npy", synthetic()[1])
    assert "write the time between samples, e.g. step: 5 ms" in said(
        "kobe.at2", "a.npy, unit: m/s2"
    )
    found = load("kobe.at2", "a.npy, unit: m/s2, step: 5 ms").processed("kobe")
    np.testing.assert_allclose(found.acceleration[50:-50], synthetic()[1][50:-50], rtol=1e-12)


@pytest.mark.parametrize(
    ("raw", "words"),
    [(b"\x93NUMPY junk", "cannot be read"), (b"", "cannot be read"),
     (b"\x00\xff" * 90, "cannot be read")],
)  # fmt: skip
def test_a_broken_array_is_one_error(said, tmp_path, raw, words):
    """No traceback, no pickle."""
    (tmp_path / "a.npy").write_bytes(raw)
    found = said("kobe.at2", "a.npy")
    assert words in found and len(found.splitlines()) == 1


def test_an_array_of_objects_is_not_loaded(said, tmp_path):
    """It could run code."""
    np.save(tmp_path / "a.npy", np.array([{}, 1], object), allow_pickle=True)
    assert "cannot be read" in said("kobe.at2", "a.npy")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("record: kobe", "record: kobi", "loads.velocities.0.record: no record 'kobi'; did you mean kobe?"),
        (", stage: shake", "", "would start in the static stage rest, whose time means nothing; write stage: shake"),
        ("stage: shake", "stage: rest", "7:56: loads.velocities.0.stage: would start in the static"),
        ("stage: shake", "stage: shock", "no stage 'shock'"),
        ("record: kobe", "record: kobe, history: [[0, 1]]", "give a history or a record, not both"),
        ("velocity: [1, 0, 0]", "velocity: [0, 0, 0]", "case.yaml:7:7: loads.velocities.0: velocity [0, 0, 0] takes nothing"),
    ],
)  # fmt: skip
def test_a_wrong_use_of_a_record_is_refused_with_its_place(said, old, new, words):
    """Names, stages, and a history beside it."""
    assert words in said(old, new)


@pytest.mark.parametrize(
    ("setting", "words"),
    [("records.kobe.scale: 2", "a stage can change interfaces.*, loads.*,"),
     ("loads.velocities.0: {group: rock, velocity: [1, 0, 0]}", "records and their stages cannot")],
)  # fmt: skip
def test_a_stage_cannot_change_a_record(said, setting, words):
    """Its curve has begun, or is stored."""
    found = said("duration: 20 s", f"duration: 20 s, set: {{{setting}}}")
    assert found.startswith("case.yaml:12:5") and "stages.1.set" in found and words in found


BASE = """\
boundaries:
  - {name: base, surface: {group: rock, normal: [0, 0, -1]}, quiet: true, stage: shake,
     input: {record: kobe, direction: [1, 0, 0]}}
loads: {gravity: [0, 0, 0]}
"""
DRIVEN = """\
loads:
  velocities:
    - {group: rock, velocity: [1, 0, 0], record: kobe, stage: shake}
"""


def test_the_record_of_a_base_must_fit_its_stage_like_others(load, tmp_path):
    """A cut is told at the input; so is an end before the last dynamic stage begins."""
    wave = {"duration: 20 s": "duration: 5 s", DRIVEN: BASE}
    text = CASE
    for old, new in wave.items():
        text = text.replace(old, new)
    (tmp_path / "base.yaml").write_text(text)
    told = Case.load("base.yaml").warnings
    assert any("base.yaml:7:6: boundaries.0.input: its record lasts 20 s" in line for line in told)
    (tmp_path / "base.yaml").write_text(
        text.replace(", stage: shake", "").replace("mode: static", "mode: dynamic, duration: 30 s")
    )
    with pytest.raises(CaseError, match=r"base.yaml:7:14: boundaries.0.input.record: is over at"):
        Case.load("base.yaml")


def test_a_record_that_nothing_uses_is_told(load):
    """Its place would be forgotten in silence."""
    told = load(DRIVEN, "loads: {gravity: [0, 0, 0]}\n").warnings
    assert any("records.kobe: nothing uses it; write record: kobe where" in line for line in told)


def test_warnings_name_a_motion_that_is_left_a_high_peak_and_a_cut(load):
    """Each with its place and a remedy."""
    (left,) = load().warnings
    assert (
        "case.yaml:9:3: records.kobe: leaves a velocity of -0.01 m/s (3.1 % of PGV) and a" in left
    )
    assert "baseline: cubic reduces it" in left
    high = load("kobe.at2", "kobe.at2, scale: 6").warnings
    assert any("reaches 2.19 g, above 2 g, which is rare" in line for line in high)
    cut = load("duration: 20 s", "duration: 5 s").warnings
    assert any("of its Arias intensity is cut off; give them a longer" in line for line in cut)
