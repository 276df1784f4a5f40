"""Whether arrays from a checkpoint fit the model, checked before the core works with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.run.state import Attributes


def wrong_type(core: Any, arrays: Mapping[str, NDArray]) -> str:
    """Name and fault of an array whose kind of numbers is not that of the core's, or ""."""
    for name, own in core.fields().items():
        if arrays[name].dtype != own.dtype or arrays[name].ndim != 1:
            return f"{name} holds {arrays[name].dtype}, not a row of {own.dtype}"
    return ""


def wrong_stage(attributes: Attributes) -> str:
    """What is wrong with the stage that a run has come to, or ""."""
    index, stages = attributes.stage_index, attributes.case.get("stages", [])
    if index + (attributes.stage is not None) > len(stages):
        return "it is in a stage that the case does not have"
    begun = attributes.stage is not None or attributes.ended_stage is not None
    if begun != (index > 0 or attributes.stage is not None or attributes.core["step"] > 0):
        return "it is neither in a stage nor behind one"
    for place, kept in ((index, attributes.stage), (index - 1, attributes.ended_stage)):
        if kept is not None and (place < 0 or kept.name != stages[place]["name"]):
            return f"its stage {kept.name!r} is not that of the case"
    return ""


def wrong_array(core: Any) -> str:
    """Name and fault of a stored array with a wrong length or an index out of range, or ""."""
    infos, arrays = core.describe(), core.fields()
    kept = {info["rows"] for info in infos if info["origin"] != "rebuilt"}
    rebuilt = {info["rows"] for info in infos} - kept  # such rows are not there yet
    rows = core.describe_rows()
    counts = {kind["name"]: kind["count"] for kind in rows if kind["name"] not in rebuilt}
    for info in infos:
        if info["origin"] == "stored" and (fault := fault_of(info, arrays[info["name"]], counts)):
            return f"{info['name']} {fault}"
    return ""


def fault_of(info: Mapping[str, Any], array: NDArray, counts: Mapping[str, int]) -> str:
    """What is wrong with an array as its description has it, or "".

    Args:
        info: Its description, of `Core.describe`.
        array: Its numbers.
        counts: How many rows there are of each kind; references to other kinds are not looked at.
    """
    may_be_empty = info["optional"] or info["origin"] == "rebuilt"
    if len(array) == 0 and may_be_empty:
        return ""
    if info["rows"] and len(array) != (length := length_of(info, counts)):
        return f"holds {len(array)} numbers, not {length}"
    for kind, index in references(info, array, counts):
        if kind in counts and (fault := _fault_of_indices(info, kind, index, counts[kind])):
            return fault
    return ""


def _fault_of_indices(info: Mapping[str, Any], kind: str, index: NDArray, count: int) -> str:
    """What is wrong with indices of rows of a kind, or ""."""
    if info["layout"] == "starts":
        sound = index[0] == 0 and (np.diff(index) >= 0).all() and index[-1] == count
        return "" if sound else f"does not divide {count} {kind} into lists"
    if info["opposite"]:
        index = np.where(index < 0, ~index, index)
    least = 0 if info["opposite"] else -1
    if len(index) and (index.min() < least or index.max() >= count):
        return f"refers to {kind} that are not there"
    return ""


def length_of(info: Mapping[str, Any], counts: Mapping[str, int]) -> int:
    """Numbers that an array holds as its description has it."""
    count = counts[info["rows"]]
    if info["layout"] == "starts":
        return count + 1
    if info["layout"] == "columns":
        count = native.padded_stride(count)
    return count * info["numbers"]


def references(
    info: Mapping[str, Any], array: NDArray, counts: Mapping[str, int]
) -> Iterator[tuple[str, NDArray]]:
    """Kind of rows that each column of an array refers to, and its indices."""
    kinds = info["refers_to"]
    if not any(kinds):
        return
    numbers = info["numbers"] if info["rows"] else 1
    if info["layout"] == "columns":
        table = array.reshape(numbers, -1)[:, : counts[info["rows"]]].T
    else:
        table = array.reshape(-1, numbers)
    one_for_all = not any(kinds[1:])
    for column in range(numbers):
        if kind := kinds[0] if one_for_all else kinds[column]:
            yield kind, table[:, column]
