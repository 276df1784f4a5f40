"""A quick look at whether a nest of models, lists and dicts was touched."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel


class Untouched:
    """Whether a value still holds what it held when this was made: `Untouched(case).holds()`.

    It takes a small part of the time of a comparison with a copy, since what is the same object is
    not looked into twice.
    """

    def __init__(self, value: Any) -> None:
        self._holders = [(holder, _parts(holder).copy()) for holder in _holders(value)]

    def holds(self) -> bool:
        """Whether nothing has changed."""
        return all(_parts(holder) == kept for holder, kept in self._holders)  # `is` comes first


def _parts(holder: Any) -> Any:
    """What a holder holds; a model gets a new dict when a value is assigned."""
    return holder.__dict__ if isinstance(holder, BaseModel) else holder


def _holders(value: Any) -> Iterator[Any]:
    """All that can be changed in a value."""
    if isinstance(value, BaseModel | dict | list):
        yield value
    parts = _parts(value)
    if isinstance(parts, dict | list | tuple):
        for part in parts.values() if isinstance(parts, dict) else parts:
            yield from _holders(part)
