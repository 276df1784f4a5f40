"""The files that a case names: they must exist, and they are part of its identity."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from cdem.case.history_file import is_file_of_history

OF_WATER = ("surface", "table")
SET_OF_WATER = re.compile(rf"water\.fields\.[^.]+\.(?:{'|'.join(OF_WATER)})")

Places = list[tuple[Any, str | int]]


def files_of(data: dict[str, Any]) -> Places:
    """Places where the data of a case name a file: the mapping and its key, or the list and its
    index.

    Args:
        data: Plain data of a case; malformed parts are skipped.
    """
    laws, model, water = data.get("own_laws"), data.get("model"), data.get("water")
    places: Places = [(laws, k) for k in range(len(laws))] if isinstance(laws, list) else []
    if isinstance(model, dict):
        discs = [joint.get("discs") for joint in _mappings(model.get("joints"))]
        places.append((model, "mesh"))
        places += [(one, "file") for one in [*_mappings(model.get("blocks")), *_mappings(discs)]]
    if isinstance(water, dict):
        places += [(one, key) for one in _mappings(water.get("fields")) for key in OF_WATER]
    places += [*_records(data.get("records")), *_histories(data)]
    for changes in _mappings([stage.get("set") for stage in _mappings(data.get("stages"))]):
        places += [(changes, path) for path in changes if SET_OF_WATER.fullmatch(str(path))]
    return [(holder, key) for holder, key in places if _names_one(holder, key)]


def _histories(value: Any) -> Iterator[tuple[Any, str | int]]:
    """Histories that name a file, anywhere in the data, also in the `set` of a stage."""
    if isinstance(value, dict):
        for key, one in value.items():
            if is_file_of_history(str(key), one):
                yield one, "file"
            else:
                yield from _histories(one)
    elif isinstance(value, list):
        for one in value:
            yield from _histories(one)


def _names_one(holder: Any, key: str | int) -> bool:
    value = holder.get(key) if isinstance(holder, dict) else holder[key]
    return isinstance(value, str)


def _records(value: Any) -> Places:
    """Records that name a file."""
    records = list(value.values()) if isinstance(value, dict) else []
    return [(one, "file") for one in _mappings(records)]


def _mappings(value: Any) -> list[dict[str, Any]]:
    """The mappings in a list; none for any other value."""
    return [one for one in value if isinstance(one, dict)] if isinstance(value, list) else []
