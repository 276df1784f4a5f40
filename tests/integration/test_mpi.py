"""Ranks that are processes: small scripts, and the program, started by mpiexec."""

from __future__ import annotations

from pathlib import Path

import pytest
from shared.mpi import needs_mpi, ranks

pytestmark = needs_mpi
END = 10.0  # all ranks end so long after one fails [s]
CALLS = """
import numpy as np
from mpi4py import MPI

def fail(*words):
    raise SystemError("pickled")

MPI.pickle.__init__(dumps=fail, loads=fail)
from cdem.ranks.exchange import Neighbour
from cdem.ranks.mpi import world

e = world()
me, count = e.rank, e.count
words = np.array([me + 1, -me, 2**60 if me == 0 else 5])
e.add_up(words)
assert words.tolist() == [
    sum(range(count + 1)), -sum(range(count)), 2**60 + 5 * (count - 1)], words

everything = np.zeros(2 * count, np.uint8)
e.gather(np.array([me, 100 + me], np.uint8), everything)
assert everything.tolist() == [n for r in range(count) for n in (r, 100 + r)], everything

rows = e.gather_rows(np.full((2 * me, 3), me, np.int16))
assert [(r.shape, r.dtype) for r in rows] == [((2 * r, 3), np.int16) for r in range(count)]
assert all((r == n).all() for n, r in enumerate(rows))
assert [len(r) for r in e.gather_rows(np.zeros((0, 3)))] == [0] * count
rows[0][...] = 1  # can be changed

for given in np.arange(6.0).reshape(2, 3), np.array(3), np.zeros((0, 2), bool):
    told = e.share(given if me == 0 else None)
    assert told.dtype == given.dtype and told.shape == given.shape and (told == given).all()
assert e.share_text("größer" if me == 0 else "not this") == "größer"
assert e.share_text("") == ""

left, right = (me - 1) % count, (me + 1) % count
if count > 2:
    links = [Neighbour(left, slice(0, 1), slice(1, 3)), Neighbour(right, slice(1, 3), slice(0, 1))]
else:
    links = [Neighbour(1 - me, slice(0, 1 + me), slice(0, 2 - me))]
for numbers in 1, 2:
    e.link(links)
    send, receive = 10.0 * me + np.arange(3.0 * numbers), np.full(4 * numbers, -1.0)
    for turn in range(3):
        send += turn
        if turn == 1:
            e.swap(send.reshape(3, numbers), receive.reshape(4, numbers))
        else:
            e.swap(send, receive, numbers)
        theirs = lambda r, a, b: 10.0 * r + np.arange(a * numbers, b * numbers) + [0, 1, 3][turn]
        if count > 2:
            expected = np.concatenate([theirs(right, 0, 1), theirs(left, 1, 3)])
        else:
            expected = theirs(1 - me, 0, 2 - me)
        assert (receive[: expected.size] == expected).all(), receive
        assert (receive[expected.size :] == -1).all(), receive
for size in range(1, 30):  # arrays that come and go
    e.link([Neighbour(1 - me, slice(0, size), slice(0, size))] if me < 2 else [])
    for _ in range(10):
        receive = np.zeros(size)
        e.swap(np.full(size, me + size / 2), receive)
        assert me > 1 or (receive == 1 - me + size / 2).all()
e.link([])
e.swap(np.zeros(1), np.zeros(1))
assert e.sent.messages["swap"] == 6 * len(links) + (290 if me < 2 else 0)
assert e.sent.bytes["add_up"] == 24
assert e.threads() >= 1
print("right")
"""

FAILURES = """
import os, signal, sys, time
import numpy as np
from cdem.errors import CaseError
from cdem.ranks.mpi import world

how = sys.argv[1]
if how == "mute":
    import mpi4py
    mpi4py.rc.thread_level = "serialized"
e = world()
last = e.rank == e.count - 1
if how == "one" and last:
    raise ValueError("bad luck")
if how == "all":
    raise CaseError("a wrong case")
if how == "differing":
    raise CaseError(f"a wrong case of {'the first' if e.rank == 0 else 'others'}")
if how == "killed" and last:
    os.kill(os.getpid(), signal.SIGKILL)
if how == "stopped" and last:
    os.kill(os.getpid(), signal.SIGSTOP)
if how in ("busy", "mute") and last:
    time.sleep(1000)
if how == "astray" and last:
    e.share_text("")
if how == "unlike":
    e.gather_rows(np.zeros((1, 1 + e.rank)))
if how == "unlinked":
    from cdem.ranks.exchange import Neighbour
    e.link([Neighbour(1, slice(0, 1), slice(0, 0))] if e.rank == 0 else [])
e.add_up(np.zeros(1, np.int64))
"""


def failing(tmp_path: Path, how: str, **more: str):
    script = tmp_path / "failing.py"
    script.write_text(FAILURES)
    return ranks(3, script, how, **more)


@pytest.mark.parametrize("count", [2, 3])
def test_every_call_between_processes(tmp_path, count):
    """The same calls as those of threads, in tests/unit/ranks; nothing is pickled."""
    script = tmp_path / "calls.py"
    script.write_text(CALLS)
    status, said, errors, _ = ranks(count, script)
    assert (status, said.count("right")) == (0, count), errors


def test_the_error_of_one_rank_ends_all(tmp_path):
    status, _, errors, took = failing(tmp_path, "one")
    assert status == 70
    assert "rank 2 of 3: Traceback" in errors
    assert errors.count("ValueError: bad luck") == 1
    assert took < END


def test_the_error_of_all_ranks_is_told_once(tmp_path):
    status, _, errors, took = failing(tmp_path, "all")
    assert status == 1
    assert errors.count("a wrong case") == 2  # the line of code and the words
    assert took < END


def test_different_errors_of_all_ranks_are_told(tmp_path):
    status, _, errors, _ = failing(tmp_path, "differing")
    assert status == 1
    assert errors.count("a wrong case of the first") == 1
    assert errors.count("rank 1 of 3: a wrong case of others") == 1
    assert "rank 2 of 3" not in errors


def test_a_rank_that_is_killed_ends_all(tmp_path):
    status, _, _, took = failing(tmp_path, "killed")
    assert status != 0
    assert took < END


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ("stopped", "in add_up (call 1): rank 2 does not answer"),
        ("busy", "in add_up (call 1): rank 2 computes since"),
        ("astray", "rank 2 waits in share_text (call 1)"),
    ],
)
def test_a_silent_rank_is_named_and_all_end(tmp_path, how, words):
    status, _, errors, took = failing(tmp_path, how, CDEM_MPI_TIMEOUT="2")
    assert status == 70
    assert "rank 0 of 3 has waited" in errors
    assert words in errors
    assert errors.count("(CDEM_MPI_TIMEOUT)") == 1
    assert took < 2 + END


def test_an_mpi_for_one_thread_ends_all_too(tmp_path):
    status, _, errors, took = failing(tmp_path, "mute", CDEM_MPI_TIMEOUT="2")
    assert status == 70
    assert "s for others, in add_up (call 1); this MPI cannot say for which" in errors
    assert took < 2 + END


def test_rows_of_different_shapes_are_refused_on_all_ranks(tmp_path):
    status, _, errors, _ = failing(tmp_path, "unlike")
    assert status == 1
    assert "ranks gather rows of different bytes: [8, 16, 24]" in errors


def test_links_that_do_not_fit_are_refused(tmp_path):
    status, _, errors, _ = failing(tmp_path, "unlinked")
    assert status == 70
    assert "rank 1 expects 0 rows of rank 0, which sends 1" in errors


@pytest.mark.parametrize(
    ("words", "status", "told"),
    [
        (["run", "missing.yaml"], 1, "missing.yaml: cannot read the case file"),
        (["check", "missing.yaml"], 1, "cdem check runs on one rank"),
        (["run", "missing.yaml", "--sped"], 2, "No such option"),
    ],
)
def test_the_program_tells_an_error_once(tmp_path, words, status, told):
    got, said, errors, took = ranks(2, "-m", "cdem", *words, cwd=tmp_path)
    assert (got, said) == (status, "")
    assert errors.count(told) == 1
    assert took < END


def test_the_program_tells_once_what_it_is(tmp_path):
    assert ranks(2, "-m", "cdem", "--version", cwd=tmp_path)[1].count("cdem") == 1
    assert ", 2 ranks\n" in ranks(2, "-m", "cdem", "doctor", cwd=tmp_path)[1]
