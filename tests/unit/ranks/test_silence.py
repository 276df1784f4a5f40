import numpy as np
import pytest

from cdem.errors import BackendError
from cdem.ranks.silence import CALLS, silent_ones, time_limit


def test_the_limit_can_be_set(monkeypatch):
    monkeypatch.delenv("CDEM_MPI_TIMEOUT", raising=False)
    assert time_limit() == 600
    monkeypatch.setenv("CDEM_MPI_TIMEOUT", "2.5")
    assert time_limit() == 2.5


@pytest.mark.parametrize("text", ["", "long", "0", "-1", "nan"])
def test_a_limit_is_a_positive_number(monkeypatch, text):
    monkeypatch.setenv("CDEM_MPI_TIMEOUT", text)
    with pytest.raises(BackendError, match=r"CDEM_MPI_TIMEOUT=.*: must be a positive number"):
        time_limit()


def test_ranks_without_an_answer_or_at_work_are_named():
    waits = np.array([5, CALLS.index("swap"), 9])
    states = {1: waits, 2: None, 3: np.array([4, -1, 12])}
    assert silent_ones(states) == (
        "rank 2 does not answer; rank 3 computes since 12 s, after call 4"
    )


def test_if_all_wait_their_calls_are_told():
    states = {1: np.array([5, CALLS.index("swap"), 9]), 2: np.array([5, 0, 9])}
    assert silent_ones(states) == "rank 1 waits in swap (call 5); rank 2 waits in add_up (call 5)"


def test_not_all_of_many_are_told():
    assert silent_ones(dict.fromkeys(range(11))).endswith("rank 9 does not answer; and more")
    assert silent_ones(dict.fromkeys(range(10))).endswith("rank 9 does not answer")
