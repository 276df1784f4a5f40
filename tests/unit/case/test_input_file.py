"""The boundary around readers: whatever a library does becomes one error, in time."""

import contextlib
import ctypes
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from cdem.case.input_file import _time_limited, _TooLong, read_text, reading, too_long
from cdem.errors import CaseError, MeshError


def fail(error):
    raise error


@pytest.mark.parametrize(
    ("act", "message"),
    [
        (lambda: fail(ValueError("bad\n  thing")), "a.msh: cannot be read (bad thing); mend it"),
        (lambda: fail(KeyError("x")), "cannot be read (x is missing); mend it"),
        (lambda: sys.exit(1), "cannot be read (its reader stopped); mend it"),
        (lambda: fail(MemoryError()), "needs more memory than a sound file"),
        (lambda: fail(RecursionError()), "is nested more deeply than a sound file"),
        (lambda: fail(ValueError("x" * 5000)), "xxx ...); mend it"),
        (lambda: Path("none.msh").read_text(), "cannot be read (No such file or directory)"),
    ],
)
def test_what_a_library_raises_is_one_error(tmp_path, act, message):
    path = tmp_path / "a.msh"
    path.write_text("")
    with pytest.raises(MeshError) as caught, reading(path, MeshError, "mend it"):
        act()
    assert message in str(caught.value) and len(str(caught.value)) < 500


@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited on Linux only")
def test_a_small_file_does_not_take_gigabytes(tmp_path):
    path = tmp_path / "a.msh"
    path.write_text("")
    import resource

    before = resource.getrlimit(resource.RLIMIT_AS)
    with pytest.raises(MeshError, match="needs more memory"), reading(path, MeshError, "mend"):
        np.ones(2_000_000_000, np.int8)
    assert resource.getrlimit(resource.RLIMIT_AS) == before


def test_errors_of_ours_pass(tmp_path):
    with pytest.raises(CaseError, match="ours"), reading(tmp_path, MeshError, "mend it"):
        raise CaseError("ours")


def test_a_reader_that_never_ends_is_ended():
    began = time.perf_counter()
    with pytest.raises(_TooLong), _time_limited(0.1):
        while True:
            with contextlib.suppress(Exception):  # as libraries do
                Path("none").read_text()
    assert time.perf_counter() - began < 5


def test_processor_time_counts_not_that_of_a_clock_on_the_wall(tmp_path):
    """On a busy machine a sound file takes long."""
    with _time_limited(0.2):
        time.sleep(0.6)
    assert too_long(0).startswith("reading it takes more than 3 s of processor time")


def test_a_read_leaves_nothing_behind_that_slows_python_down(monkeypatch):
    """Where the limit was not reached nothing is raised in the thread, not even nothing."""
    raised = []
    monkeypatch.setattr(ctypes.pythonapi, "PyThreadState_SetAsyncExc", lambda *a: raised.append(a))
    with _time_limited(10):
        pass
    assert raised == []


def test_a_read_under_the_profiler_ends(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("x")
    script = tmp_path / "read.py"
    script.write_text(
        "from pathlib import Path\nfrom cdem.errors import CaseError\n"
        "from cdem.case.input_file import reading\n"
        f"path = Path({str(path)!r})\n"
        "for _ in range(5):\n"
        "    with reading(path, CaseError, 'mend'):\n        path.read_text()\n"
        "print(sum(range(1000)))\n"
    )
    command = [sys.executable, "-m", "cProfile", str(script)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.startswith("499500")


def test_nothing_is_raised_after_the_end():
    for _ in range(200):
        with contextlib.suppress(_TooLong), _time_limited(1e-4):
            pass
    time.sleep(0.05)


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (
            "a: höhe\nb: Fläche\n".encode("latin-1"),
            r"a.txt:1: not in UTF-8 at 'hö'; is it in Latin-1",
        ),
        ("a: 1\n".encode("utf-16"), "is text in UTF-16; save the case file as UTF-8"),
        (b"\x89HDF\xff\xfe", "not a text file; a case file is text in UTF-8"),
    ],
)
def test_texts_in_other_encodings(tmp_path, raw, message):
    path = tmp_path / "a.txt"
    path.write_bytes(raw)
    with pytest.raises(CaseError, match=message):
        read_text(path, "case file")


def test_a_mark_of_byte_order_and_line_ends_do_not_matter(tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes(b"\xef\xbb\xbfa\r\nb\rc\n")
    assert read_text(path, "case file") == "a\nb\nc\n"
