"""What the first rank does for all ranks."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from cdem.errors import CaseError, CdemError, DiskError
from cdem.ranks.exchange import Exchange

Value = TypeVar("Value")
ERRORS = {kind.__name__: kind for kind in (CaseError, CdemError, DiskError)}
"""Errors of the first rank that all ranks have then."""


def on_first(exchange: Exchange, act: Callable[[], Value]) -> Value | None:
    """Do something on the first rank; if it fails there, it fails on all.

    Args:
        exchange: The ranks.
        act: What to do.

    Returns:
        What it returned, on the first rank; None on the others.

    Raises:
        CdemError: It failed.
    """
    value, text = None, ""
    if exchange.rank == 0:
        try:
            value = act()
        except CdemError as error:
            text = f"{type(error).__name__} {error}"
    if text := exchange.share_text(text):
        kind, _, words = text.partition(" ")
        raise ERRORS.get(kind, CdemError)(words)
    return value
