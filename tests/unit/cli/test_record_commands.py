"""The commands on records and layered ground."""

import numpy as np
import pytest
from shared.signals import at2, synthetic

PROFILE = """\
layers:
  - {thickness: 10 m, density: 1900, speed: 250 m/s}
  - {thickness: 20 m, density: 2000, speed: 500 m/s, damping: 0}
  - {thickness: 30 m, density: 2200, speed: 900 m/s}
  - {density: 2600, speed: 2 km/s}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a space in its name, the synthetic record, and a profile."""
    place = tmp_path / "a b"
    place.mkdir()
    monkeypatch.chdir(place)
    (place / "s.at2").write_text(at2(synthetic()[1], 0.005))
    (place / "p.yaml").write_text(PROFILE)
    return place


def test_a_record_is_shown_after_each_step(folder, run_cli):
    """With its keys from --set, and a picture."""
    words = ["--set", "band=[0.1 Hz, 15 Hz]", "--set", "baseline=cubic", "--picture", "s.png"]
    status, out, err = run_cli("record", "show", "s.at2", *words)
    assert status == 0 and not err
    lines = out.splitlines()
    assert lines[0].startswith("record s: 4,001 samples every 0.005 s, 20 s; 99 % of the energy")
    names = ["as read, scaled", "taper", "band-pass 0.1 to 15 Hz", "cubic baseline", "s.png"]
    assert [line[:30].strip() for line in lines[2:]] == names
    assert "0.3650     0.3293" in lines[2] and (folder / "s.png").is_file()


def test_a_wrong_file_or_key_is_one_line(folder, run_cli):
    """With the file in front."""
    for words, said in (
        (["nix.at2"], "nix.at2: cannot read the record"),
        (["s.at2", "--set", "unit=m"], "the file has the unit g, the case m; remove unit"),
        (["s.at2", "--set", "band=[9 Hz, 1 Hz]"], "the low frequency must be below the high one"),
        (["s.at2", "--set", "scales=2"], "did you mean scale?"),
    ):
        status, out, err = run_cli("record", "show", *words)
        assert status == 1 and said in err and len(err.splitlines()) == 1 and not out


def test_the_peaks_of_layered_ground_are_printed_and_written(folder, run_cli):
    """5.779 at 3.183 Hz and so on, as computed before."""
    status, out, _ = run_cli(
        "record", "response", "--profile", "p.yaml", "-o", "r.csv", "--f-max", "12"
    )
    assert status == 0
    peaks = [line.strip()[:12] for line in out.splitlines()[1:4]]
    assert peaks == ["5.779 at 3.1", "5.664 at 6.7", "4.219 at 9.9"]
    table = np.loadtxt(folder / "r.csv", delimiter=",", skiprows=1)
    assert table.shape == (5000, 3) and table[-1, 0] == 12
    assert table[:, 1].max() == pytest.approx(5.779, abs=1e-3)


def test_a_record_goes_down_and_is_a_record_again(folder, run_cli):
    """Its up-going wave is that of the response."""
    words = ["s.at2", "--profile", "p.yaml", "-o", "up.csv", "--f-max", "20"]
    status, out, _ = run_cli("record", "deconvolve", *words)
    assert status == 0 and "0.36495 g at the surface, 0.10803 g of the up-going wave" in out
    status, out, _ = run_cli("record", "show", "up.csv")
    assert status == 0 and "0.1080" in out


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("thickness: 10 m, ", "", "p.yaml: layer 0 needs a thickness; only the last one has none"),
        ("{density: 2600", "{thickness: 1, density: 2600", "the last layer is the half space"),
        ("damping: 0", "damping: 30 %", "p.yaml:3:54: layers.1.damping: must lie in [0, 0.2]"),
        ("speed: 2 km/s", "speed: 2 km", "p.yaml:5:21: layers.3.speed: '2 km' has the wrong"),
    ],
)
def test_a_wrong_profile_is_told_with_its_place(folder, run_cli, old, new, said):
    """One line."""
    (folder / "p.yaml").write_text(PROFILE.replace(old, new, 1))
    status, _, err = run_cli("record", "response", "--profile", "p.yaml")
    assert status == 1 and said in err and len(err.splitlines()) == 1


def test_an_empty_profile_is_told(folder, run_cli):
    (folder / "p.yaml").write_text("# nothing\n")
    status, _, err = run_cli("record", "response", "--profile", "p.yaml")
    assert status == 1 and err == "p.yaml: the file is empty; see docs/records.md\n"


def test_a_highest_frequency_out_of_range_is_refused(folder, run_cli):
    """Above half of the samples a second there is nothing."""
    words = ["s.at2", "--profile", "p.yaml", "-o", "up.csv", "--f-max", "101"]
    status, _, err = run_cli("record", "deconvolve", *words)
    assert status == 1 and "--f-max 101: must be above 0 and at most 100 Hz" in err
    assert not (folder / "up.csv").exists()
