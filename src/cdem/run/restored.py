"""Whether a checkpoint is of the model, and its arrays fit, before the core works with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem._native import digests
from cdem._version import __version__
from cdem.errors import CdemError
from cdem.run.flow_recorder import PREFIX
from cdem.run.history_file import SUM_DIGITS
from cdem.run.state import Attributes, RunState, StageState

if TYPE_CHECKING:
    from cdem._core import Core


def check_model(
    run: RunState, path: Path, arrays: dict[str, NDArray], attributes: Attributes, *, force: bool
) -> None:
    """Make sure that a checkpoint is of this model and this program.

    Args:
        run: The run that is to go on.
        path: Of the checkpoint.
        arrays: What it holds, by name.
        attributes: What it keeps besides arrays.
        force: Whether the program may be of another version.

    Raises:
        CdemError: It is of another model or program; says what to do.
    """
    if attributes.nodes != run.build.fingerprint:
        raise CdemError(
            f"{path}: belongs to another model, with other elements or groups, or whose nodes "
            "begin at other places or are numbered otherwise; resume with the case and the mesh "
            "that were run"
        )
    if attributes.own_laws != digests:
        names = ", ".join(attributes.own_laws) or "none"
        raise CdemError(
            f"{path}: was written with another text of own laws ({names}); go on with the "
            "headers that were run, or run the case again in another folder (-o)"
        )
    output = run.given_case.model_dump(mode="json")["output"]
    if attributes.case.get("output", {}).get("maps") != output["maps"]:
        raise CdemError(
            f"{path}: was written with another output.maps, whose values are half there; go on with "
            "that of the run"
        )
    own = {"simulation.reference", "simulation.born"}  # see RunState.kept
    own |= {name for name in arrays if name.startswith(PREFIX)}
    other = set(arrays) - own | set(attributes.core)
    other ^= set(run.core.fields()) | set(run.core.scalars())
    # a case without a module goes on from what a cdem without it wrote
    other -= set(run.core.absent_fields()) - set(arrays)
    if other or (attributes.version != __version__ and not force):
        fields = f" and holds other fields ({', '.join(sorted(other)[:3])}, ...)" if other else ""
        raise CdemError(
            f"{path}: was written by another version of cdem ({attributes.version}; this is "
            f"{__version__}){fields}. Go on with the cdem that wrote it"
            f"{'' if other else ', with --force'}, or run the case again in another folder (-o)"
        )


def wrong_type(core: Core, arrays: Mapping[str, NDArray]) -> str:
    """Name and fault of an array whose kind of numbers is not that of the core's, or ""."""
    for name, own in core.fields().items():
        if name in arrays and (arrays[name].dtype != own.dtype or arrays[name].ndim != 1):
            return f"{name} holds {arrays[name].dtype}, not a row of {own.dtype}"
    return ""


def wrong_kept(arrays: Mapping[str, NDArray], own: Mapping[str, NDArray]) -> str:
    """Name and fault of an array that a run keeps besides those of the core, or ""."""
    for name, like in own.items():
        if name not in arrays:
            return f"{name} is not there"
        array = arrays[name]
        if array.dtype != like.dtype or array.shape != like.shape:
            return f"{name} has another shape or kind of numbers"
        if not np.isfinite(array).all():
            return f"{name} holds numbers that are not finite"
    return ""


def wrong_stage(attributes: Attributes) -> str:
    """What is wrong with the stage that a run has come to, or ""."""
    index, stages = attributes.stage_index, attributes.case.get("stages", [])
    if not isinstance(stages, list) or not all(isinstance(s, dict) and "name" in s for s in stages):
        return "its case has no stages"
    if index + (attributes.stage is not None) > len(stages):
        return "it is in a stage that the case does not have"
    begun = attributes.stage is not None or attributes.ended_stage is not None
    if begun != (index > 0 or attributes.stage is not None or attributes.core["step"] > 0):
        return "it is neither in a stage nor behind one"
    for place, kept in ((index, attributes.stage), (index - 1, attributes.ended_stage)):
        if kept is not None and (place < 0 or kept.name != stages[place]["name"]):
            return f"its stage {kept.name!r} is not that of the case"
    return ""


MOST_STEPS = 2**53
"""More steps than any run does."""
RANGES = {"node.out": 1, "bolts.phase": 3, "triangles.status": 2, "quads.status": 2,
          "overlaps.status": 2, "surface.begun": 1}  # fmt: skip
"""Highest number of arrays that tell states apart; the lowest is 0."""


def wrong_numbers(run: RunState, attributes: Attributes) -> str:
    """What is wrong with the numbers that a checkpoint keeps besides arrays, or ""."""
    core, own = attributes.core, run.core.scalars()
    for name, number in core.items():
        whole = isinstance(own[name], int)
        if whole != isinstance(number, int) or not np.isfinite(float(number)):
            return f"{name} is {number}"
        if whole and not -1 <= number <= MOST_STEPS:
            return f"{name} is {number}"
    if not (core["dt"] > 0 and core["time"] >= 0 and core["step"] >= max(core["built_step"], 0)):
        return "its time, step or number of steps cannot be"
    begun = attributes.stage_index + (attributes.stage is not None)
    if len(attributes.row_sums) != SUM_DIGITS * attributes.rows:
        return "its rows and their checksums are not as many"
    if max(attributes.rows, attributes.frames) > core["step"] + 2 * begun + 1:
        return f"it counts {attributes.rows} rows and {attributes.frames} frames"
    if len(attributes.finished_stages) != attributes.stage_index:
        return "it does not tell of the stages that have ended"
    found = (_wrong_time(attributes, s) for s in _stages(attributes))
    return _wrong_begin(attributes) or next(filter(None, found), "")


def begins(attributes: Attributes) -> dict[str, float]:
    """When the stages began that have begun, by name [s]; `wrong_numbers` has found nothing."""
    names = [stage["name"] for stage in attributes.case["stages"]]
    ended = [row["begin"] for row in attributes.finished_stages]
    return dict(zip(names, ended, strict=False)) | {
        stage.name: stage.start_time for stage in _stages(attributes)
    }


def _wrong_begin(attributes: Attributes) -> str:
    """What cannot be of the times at which stages began that have ended, or ""."""
    for row in attributes.finished_stages:
        time = row.get("begin")
        if not isinstance(time, float) or not 0 <= time <= attributes.core["time"]:
            return f"one of its stages began at {time}"
    return ""


def _stages(attributes: Attributes) -> list[StageState]:
    return [s for s in (attributes.stage, attributes.ended_stage) if s is not None]


def _wrong_time(attributes: Attributes, stage: StageState) -> str:
    """What cannot be of a stage that has begun, or ""."""
    core, end = attributes.core, stage.end_time
    times = [stage.start_time, stage.row_every, stage.held, 0.0 if end is None else end]
    sound = np.isfinite(times).all() and stage.row_every > 0
    sound = sound and 0 <= stage.start_step <= core["step"] and stage.start_time <= core["time"]
    sound = sound and 0 <= stage.rows <= MOST_STEPS and 0 <= stage.parts <= MOST_STEPS
    sound = sound and (end is None) == (stage.mode == "static")
    return "" if sound else f"its stage {stage.name!r} has times or counts that cannot be"


def wrong_state(arrays: Mapping[str, NDArray]) -> str:
    """Name and fault of an array of which a value cannot be, or ""."""
    for name, most in RANGES.items():
        values = arrays.get(name, np.zeros(0))
        if len(values) and (values.min() < 0 or values.max() > most):
            return f"{name} holds other numbers than 0 to {most}"
    for name in ("node.motion", "node.force", "corner.force"):
        if not np.isfinite(arrays[name]).all():
            return f"{name} holds numbers that are not finite"
    return ""


def wrong_array(core: Core) -> str:
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
