"""Simulations that are shared out to ranks: threads of the test, a rank each."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest

import cdem
from cdem.ranks.exchange import Threads, run_ranks

_here = threading.local()


def on_ranks(count: int, act: Callable[[Threads], Any], timeout: float = 120) -> list[Any]:
    """What a function returns on each rank; the simulations that it makes are shared out.

    Args:
        count: Number of ranks.
        act: Gets the exchange of its rank.
        timeout: Longest wait of a rank for others [s].
    """
    begin = cdem.Simulation.__init__

    def begin_shared(self, *words, **named):
        named.setdefault("exchange", getattr(_here, "exchange", None))
        begin(self, *words, **named)

    def be_rank(exchange):
        _here.exchange = exchange
        return act(exchange)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cdem.Simulation, "__init__", begin_shared)
        return run_ranks(count, be_rank, timeout)
