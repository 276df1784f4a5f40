"""Readers meet mutated files: they read them or refuse them, and never raise, hang or die."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).parents[3] / "tools/torture/fuzz.py"
ALL_WELL = "0 tracebacks, 0 hangs over 5 s, 0 aborts, 0 empty messages"


@pytest.mark.parametrize(("kind", "count"), [
    ("cases", 60), ("files", 30),
    pytest.param("cases", 150, marks=pytest.mark.slow), pytest.param("files", 60, marks=pytest.mark.slow),
])  # fmt: skip
def test_inputs_that_failed_once_and_mutated_ones_are_read_or_refused(tmp_path, kind, count):
    """`tests/corpus/README.md` says where the first are from."""
    if kind == "files":
        pytest.importorskip("pyvista", reason="needs the extra 'viz'")
        pytest.importorskip("rasterio", reason="needs the extra 'terrain'")
        pytest.importorskip("scipy", reason="needs the extra 'terrain'")
        pytest.importorskip("laspy", reason="needs the extra 'lidar'")
    corpus = Path(shutil.copytree(FUZZ.parents[2] / "tests/corpus" / kind, tmp_path / "corpus"))
    failed_once = len(list(corpus.glob("*-*")))
    command = [sys.executable, FUZZ, kind, str(count), "--seed", "7", "--out", tmp_path]
    command += ["--corpus", corpus]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert failed_once > 5 and f"{failed_once} {kind} of the corpus: all well" in done.stdout
    assert ALL_WELL in done.stdout and done.stdout.startswith(f"{count} {kind}, seed 7: ")
    read, refused = (int(done.stdout.split(": ")[1].split()[i]) for i in (0, 2))
    assert read + refused == count and read > 2 and refused > 2


def test_what_fails_is_counted_and_kept(tmp_path, monkeypatch):
    """A reader that raises, one that dies, and one that never ends."""
    monkeypatch.syspath_prepend(str(FUZZ.parent))
    import fuzz

    worker = tmp_path / "worker.py"
    worker.write_text(
        "import os, sys, time\n"
        f"sys.path.insert(0, {str(FUZZ.parent)!r})\n"
        "import fuzz\n"
        "acts = [lambda: None, lambda: 1 / 0, lambda: os.abort(), lambda: time.sleep(99)]\n"
        "calls = int(sys.argv[sys.argv.index('--first') + 1])\n"
        "def read(path):\n"
        "    global calls\n"
        "    calls += 1\n"
        "    acts[(calls - 1) % 4]()\n"
        "fuzz.read_case = read\n"
        "sys.exit(fuzz.main())\n"
    )
    monkeypatch.setattr(fuzz, "__file__", str(worker))
    monkeypatch.setattr(fuzz, "SILENT", 2.0)
    tally, _ = fuzz.fuzz("cases", 8, 1, tmp_path, tmp_path / "corpus")
    assert tally.counts == {"read": 2, "traceback": 2, "abort": 2, "hang": 2} and tally.failed
    names = [path.name for path in fuzz.kept(tmp_path / "corpus")]
    assert sorted(name.split("-")[1].split("_")[1] for name in names) == list("123567")
    (why,) = (tmp_path / "failed").glob("*-1_1-*.txt")
    assert "ZeroDivisionError" in why.read_text()
    tally, again = fuzz.fuzz("cases", 0, 1, tmp_path, tmp_path / "corpus")  # the same fail again
    assert again.done == 6 and again.counts["abort"] == 1 and again.failed and not tally.failed
    assert [path.name for path in fuzz.kept(tmp_path / "corpus")] == names
