import threading
import time

import numpy as np
import pytest

from cdem.ranks.exchange import Neighbour, Threads, run_ranks

COUNTS = pytest.mark.parametrize("count", [1, 2, 3, 7])


@COUNTS
def test_words_are_added_up_in_place(count):
    def act(exchange):
        words = np.array([exchange.rank + 1, -exchange.rank, 2**60 if exchange.rank == 0 else 5])
        exchange.add_up(words)
        return words

    for words in run_ranks(count, act):
        ranks = np.arange(count)
        assert words.tolist() == [(ranks + 1).sum(), -ranks.sum(), 2**60 + 5 * (count - 1)]


@COUNTS
def test_bytes_come_rank_after_rank(count):
    def act(exchange):
        own = np.array([exchange.rank, 100 + exchange.rank], np.uint8)
        everything = np.zeros(2 * exchange.count, np.uint8)
        exchange.gather(own, everything)
        return everything

    expected = [number for rank in range(count) for number in (rank, 100 + rank)]
    assert all(result.tolist() == expected for result in run_ranks(count, act))


@COUNTS
def test_rows_of_any_length_are_gathered(count):
    def act(exchange):
        return exchange.gather_rows(np.full((exchange.rank, 3), exchange.rank, np.int32))

    for result in run_ranks(count, act):
        assert [rows.shape for rows in result] == [(rank, 3) for rank in range(count)]
        assert [rows.dtype for rows in result] == [np.int32] * count
        assert all((rows == rank).all() for rank, rows in enumerate(result))


@COUNTS
def test_the_array_and_text_of_rank_0_are_shared(count):
    def act(exchange):
        array = np.arange(6.0).reshape(2, 3) if exchange.rank == 0 else None
        return exchange.share(array), exchange.share_text(f"says {exchange.rank}")

    for array, text in run_ranks(count, act):
        assert array.tolist() == [[0, 1, 2], [3, 4, 5]]
        assert text == "says 0"


def test_a_rank_may_change_what_it_got_and_what_it_gave():
    def act(exchange):
        own = np.array([float(exchange.rank)])
        got = exchange.gather_rows(own)
        shared = exchange.share(own if exchange.rank == 0 else None)
        own += 10
        for array in [*got, shared]:
            array += 100 * (exchange.rank + 1)
        exchange.add_up(np.zeros(1, np.int64))  # all have changed theirs
        return [*got, shared]

    first, second = run_ranks(2, act)
    assert [array[0] for array in first] == [100, 101, 100]
    assert [array[0] for array in second] == [200, 201, 200]


@COUNTS
@pytest.mark.parametrize("flat", [False, True])
def test_rows_go_round_a_ring(count, flat):
    """Each rank gives one row to the rank before, two to the one after."""

    def act(exchange):
        left, right = (exchange.rank - 1) % count, (exchange.rank + 1) % count
        neighbours = [
            Neighbour(left, send=slice(0, 1), receive=slice(1, 3)),
            Neighbour(right, send=slice(1, 3), receive=slice(0, 1)),
        ]
        exchange.link(neighbours if count > 2 else [])
        send = 10.0 * exchange.rank + np.arange(6.0).reshape(3, 2)
        receive = np.full((4, 2), -1.0)
        if flat:
            exchange.swap(send.ravel(), receive.ravel(), 2)
        else:
            exchange.swap(send, receive)
        return receive

    for rank, receive in enumerate(run_ranks(count, act)):
        left, right = 10.0 * ((rank - 1) % count), 10.0 * ((rank + 1) % count)
        expected = np.full((4, 2), -1.0)
        if count > 2:
            expected[0] = right + np.arange(2.0)
            expected[1:3] = left + np.arange(2.0, 6.0).reshape(2, 2)
        assert (receive == expected).all()


def test_links_can_be_changed():
    def act(exchange):
        other = 1 - exchange.rank
        send, receive = np.array([1.0, 2.0]) + 10 * exchange.rank, np.zeros(2)
        exchange.link([Neighbour(other, slice(0, 1), slice(1, 2))])
        exchange.swap(send, receive)
        exchange.link([Neighbour(other, slice(0, 2), slice(0, 2))])
        before = receive.copy()
        exchange.swap(send, receive)
        return before.tolist(), receive.tolist()

    assert run_ranks(2, act) == [([0, 11], [11, 12]), ([0, 1], [1, 2])]


def test_links_that_do_not_fit_are_refused():
    def act(exchange):
        exchange.link([Neighbour(1 - exchange.rank, slice(0, 1 + exchange.rank), slice(0, 1))])

    with pytest.raises(RuntimeError, match="rank 0 expects 1 rows of rank 1, which sends 2"):
        run_ranks(2, act)


def test_a_link_of_one_side_only_is_refused():
    def act(exchange):
        exchange.link([Neighbour(1, slice(0, 1), slice(0, 0))] if exchange.rank == 0 else [])

    with pytest.raises(RuntimeError, match="rank 1 expects 0 rows of rank 0, which sends 1"):
        run_ranks(2, act)


def test_a_part_with_steps_is_refused():
    with pytest.raises(ValueError, match="not a range of rows"):
        run_ranks(1, lambda exchange: exchange.link([Neighbour(0, slice(0, 4, 2), slice(0, 2))]))


def test_a_neighbour_named_twice_is_refused():
    part = Neighbour(0, slice(0, 1), slice(0, 1))
    with pytest.raises(ValueError, match="a rank is a neighbour twice"):
        run_ranks(1, lambda exchange: exchange.link([part, part]))


def test_messages_and_bytes_are_counted_by_call():
    def act(exchange):
        other = 1 - exchange.rank
        exchange.link([Neighbour(other, slice(0, 2), slice(0, 2))])
        for _ in range(3):
            exchange.swap(np.zeros((2, 6)), np.zeros((2, 6)))
        exchange.add_up(np.zeros(5, np.int64))
        exchange.gather(np.zeros(7, np.uint8), np.zeros(14, np.uint8))
        exchange.gather_rows(np.zeros((exchange.rank, 2)))
        exchange.share(np.zeros(4) if exchange.rank == 0 else None)
        exchange.share_text("abc")
        return exchange.sent

    first, second = run_ranks(2, act)
    messages = {"swap": 3} | dict.fromkeys(
        ["add_up", "gather", "gather_rows", "share", "share_text"], 1
    )
    assert first.messages == second.messages == messages
    assert dict(first.bytes) == {
        "swap": 3 * 2 * 48, "add_up": 40, "gather": 7, "gather_rows": 0, "share": 32, "share_text": 3
    }  # fmt: skip
    assert dict(second.bytes) == dict(first.bytes) | {
        "gather_rows": 16,
        "share": 0,
        "share_text": 0,
    }


def test_the_error_of_a_rank_ends_all_and_is_told():
    ended = []

    def act(exchange):
        if exchange.rank == 1:
            time.sleep(0.05)  # the others wait by now
            raise ValueError("of rank 1")
        try:
            exchange.add_up(np.zeros(1, np.int64))
        except threading.BrokenBarrierError:
            ended.append(exchange.rank)
            raise

    with pytest.raises(ValueError, match="of rank 1"):
        run_ranks(3, act)
    assert sorted(ended) == [0, 2]


def test_ranks_in_different_calls_are_told():
    def act(exchange):
        if exchange.rank:
            exchange.share_text("")
        else:
            exchange.add_up(np.zeros(1, np.int64))

    with pytest.raises(RuntimeError, match="different calls: rank 0 add_up, rank 1 share_text"):
        run_ranks(2, act)


def test_a_rank_that_ends_early_is_told():
    def act(exchange):
        if exchange.rank:
            exchange.share_text("")

    with pytest.raises(RuntimeError, match="different calls: rank 0 its end, rank 1 share_text"):
        run_ranks(2, act)


def test_a_long_wait_ends():
    def act(exchange):
        if exchange.rank:
            time.sleep(0.3)
        exchange.share_text("")

    with pytest.raises(RuntimeError, match=r"longer than 0\.05 s"):
        run_ranks(2, act, timeout=0.05)


def test_a_group_has_its_ranks():
    group = Threads.group(3)
    assert [(one.rank, one.count) for one in group] == [(0, 3), (1, 3), (2, 3)]
