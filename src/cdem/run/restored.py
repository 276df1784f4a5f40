"""Checks of a checkpoint before the core uses it: the right model, and arrays that fit."""

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
from cdem.run.stage_state import StageState
from cdem.run.state import Attributes, RunState

if TYPE_CHECKING:
    from cdem._core import Core


def check_model(
    run: RunState, path: Path, arrays: dict[str, NDArray], attributes: Attributes, *, force: bool
) -> None:
    """Make sure that a checkpoint belongs to this model and this program.

    Args:
        run: The run to continue.
        path: File of the checkpoint.
        arrays: Its arrays by name.
        attributes: Its other data.
        force: Whether another version of the program is allowed.

    Raises:
        CdemError: It belongs to another model or program; with advice.
    """
    if attributes.nodes != run.build.fingerprint:
        raise CdemError(
            f"{path}: belongs to another model, with other elements or groups, other initial "
            "positions of nodes, or another numbering; resume with the case and the mesh "
            "of the run"
        )
    if attributes.own_laws != digests:
        names = ", ".join(attributes.own_laws) or "none"
        raise CdemError(
            f"{path}: was written with other headers of own laws ({names}); continue with the "
            "headers of the run, or run the case again in another folder (-o)"
        )
    output = run.given_case.model_dump(mode="json")["output"]
    if attributes.case.get("output", {}).get("maps") != output["maps"]:
        raise CdemError(
            f"{path}: was written with another output.maps, whose values are incomplete; continue "
            f"with "
            "output.maps of the run"
        )
    own = set(run.kept) | {"simulation.watched", "simulation.born"}
    own |= {name for name in arrays if name.startswith(PREFIX)}
    other = set(arrays) - own | set(attributes.core)
    other ^= set(run.core.fields()) | set(run.core.scalars())
    # a case without a module can continue a checkpoint of a cdem without it
    other -= set(run.core.absent_fields()) - set(arrays)
    if other or (attributes.version != __version__ and not force):
        fields = f" and holds other fields ({', '.join(sorted(other)[:3])}, ...)" if other else ""
        raise CdemError(
            f"{path}: was written by another version of cdem ({attributes.version}; this is "
            f"{__version__}){fields}. Continue with the cdem that wrote it"
            f"{'' if other else ', with --force'}, or run the case again in another folder (-o)"
        )


def wrong_type(core: Core, arrays: Mapping[str, NDArray]) -> str:
    """Name and fault of an array with a wrong number type, or ""."""
    for name, own in core.fields().items():
        if name in arrays and (arrays[name].dtype != own.dtype or arrays[name].ndim != 1):
            return f"{name} holds {arrays[name].dtype}, not a row of {own.dtype}"
    return ""


def wrong_kept(arrays: Mapping[str, NDArray], own: Mapping[str, NDArray]) -> str:
    """Name and fault of an array of the run itself, not of the core, or ""."""
    for name, like in own.items():
        if name not in arrays:
            return f"{name} is missing"
        array = arrays[name]
        if array.dtype != like.dtype or array.shape != like.shape:
            return f"{name} has a wrong shape or number type"
        if not np.isfinite(array).all():
            return f"{name} holds numbers that are not finite"
    return ""


def wrong_looks(attributes: Attributes) -> str:
    """Fault of the looks at a static stage, or ""."""
    for stage in (attributes.stage, attributes.ended_stage):
        if stage is not None and len(stage.ways) != len(stage.ratios):
            return "its looks at a stage are not whole"
    return ""


def wrong_stage(attributes: Attributes) -> str:
    """Fault of the present stage, or ""."""
    index, stages = attributes.stage_index, attributes.case.get("stages", [])
    if not isinstance(stages, list) or not all(isinstance(s, dict) and "name" in s for s in stages):
        return "its case has no stages"
    if index + (attributes.stage is not None) > len(stages):
        return "its stage does not exist in the case"
    begun = attributes.stage is not None or attributes.ended_stage is not None
    if begun != (index > 0 or attributes.stage is not None or attributes.core["step"] > 0):
        return "it is neither in a stage nor after one"
    for place, kept in ((index, attributes.stage), (index - 1, attributes.ended_stage)):
        if kept is not None and (place < 0 or kept.name != stages[place]["name"]):
            return f"its stage {kept.name!r} has another name in the case"
    return ""


MOST_STEPS = 2**53
"""More steps than in any run."""
RANGES = {"node.out": 1, "bolts.phase": 3, "triangles.status": 2, "quads.status": 2,
          "overlaps.status": 2, "surface.begun": 1}  # fmt: skip
"""Highest value of arrays with numbered states; the lowest is 0."""


def wrong_numbers(run: RunState, attributes: Attributes) -> str:
    """Fault of the numbers that a checkpoint holds besides arrays, or ""."""
    core, own = attributes.core, run.core.scalars()
    for name, number in core.items():
        whole = isinstance(own[name], int)
        if whole != isinstance(number, int) or not np.isfinite(float(number)):
            return f"{name} is {number}"
        if whole and not -1 <= number <= MOST_STEPS:
            return f"{name} is {number}"
    if not (core["dt"] > 0 and core["time"] >= 0 and core["step"] >= max(core["built_step"], 0)):
        return "its time, step or number of steps is impossible"
    begun = attributes.stage_index + (attributes.stage is not None)
    if len(attributes.row_sums) != SUM_DIGITS * attributes.rows:
        return "the numbers of its rows and of their checksums differ"
    if max(attributes.rows, attributes.frames) > core["step"] + 2 * begun + 1:
        return f"it counts {attributes.rows} rows and {attributes.frames} frames"
    if len(attributes.finished_stages) != attributes.stage_index:
        return "it lacks finished stages"
    found = (_wrong_time(attributes, s) for s in _stages(attributes))
    return _wrong_begin(attributes) or next(filter(None, found), "")


def begins(attributes: Attributes) -> dict[str, float]:
    """Start times of the stages begun, by name [s]; `wrong_numbers` has found no fault."""
    names = [stage["name"] for stage in attributes.case["stages"]]
    ended = [row["begin"] for row in attributes.finished_stages]
    return dict(zip(names, ended, strict=False)) | {
        stage.name: stage.start_time for stage in _stages(attributes)
    }


def _wrong_begin(attributes: Attributes) -> str:
    """Impossible start times of finished stages, or ""."""
    for row in attributes.finished_stages:
        time = row.get("begin")
        if not isinstance(time, float) or not 0 <= time <= attributes.core["time"]:
            return f"one of its stages began at {time}"
    return ""


def _stages(attributes: Attributes) -> list[StageState]:
    return [s for s in (attributes.stage, attributes.ended_stage) if s is not None]


def _wrong_time(attributes: Attributes, stage: StageState) -> str:
    """Impossible values of the present stage, or ""."""
    core, end = attributes.core, stage.end_time
    times = [stage.start_time, stage.row_every, stage.frame_every, stage.held, end or 0.0]
    sound = np.isfinite(times).all() and stage.row_every > 0 and stage.frame_every >= 0
    sound = sound and 0 <= stage.start_step <= core["step"] and stage.start_time <= core["time"]
    sound = sound and 0 <= stage.rows <= MOST_STEPS and 0 <= stage.parts <= MOST_STEPS
    sound = sound and (end is None) == (stage.mode == "static")
    return "" if sound else f"its stage {stage.name!r} has impossible times or counts"


def wrong_state(arrays: Mapping[str, NDArray]) -> str:
    """Name and fault of an array with an impossible value, or ""."""
    for name, most in RANGES.items():
        values = arrays.get(name, np.zeros(0))
        if len(values) and (values.min() < 0 or values.max() > most):
            return f"{name} holds numbers outside 0 to {most}"
    for name in ("node.motion", "node.force", "corner.force"):
        if not np.isfinite(arrays[name]).all():
            return f"{name} holds numbers that are not finite"
    return ""


def wrong_array(core: Core) -> str:
    """Name and fault of a stored array with a wrong length or an index out of range, or ""."""
    infos, arrays = core.describe(), core.fields()
    kept = {info["rows"] for info in infos if info["origin"] != "rebuilt"}
    rebuilt = {info["rows"] for info in infos} - kept  # these rows do not exist yet
    rows = core.describe_rows()
    counts = {kind["name"]: kind["count"] for kind in rows if kind["name"] not in rebuilt}
    for info in infos:
        if info["origin"] == "stored" and (fault := fault_of(info, arrays[info["name"]], counts)):
            return f"{info['name']} {fault}"
    return ""


def fault_of(info: Mapping[str, Any], array: NDArray, counts: Mapping[str, int]) -> str:
    """Fault of an array compared with its description, or "".

    Args:
        info: Its description from `Core.describe`.
        array: Its numbers.
        counts: Number of rows of each kind; references to other kinds are not checked.
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
    """Fault of indices of rows of a kind, or ""."""
    if info["layout"] == "starts":
        sound = index[0] == 0 and (np.diff(index) >= 0).all() and index[-1] == count
        return "" if sound else f"does not divide {count} {kind} into lists"
    if info["opposite"]:
        index = np.where(index < 0, ~index, index)
    least = 0 if info["opposite"] else -1
    if len(index) and (index.min() < least or index.max() >= count):
        return f"refers to missing {kind}"
    return ""


def length_of(info: Mapping[str, Any], counts: Mapping[str, int]) -> int:
    """Number of values of an array according to its description."""
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
