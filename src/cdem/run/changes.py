"""Differences between the case of a run and the case with which it is resumed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any

from cdem.case.case import Case
from cdem.case.schema import absent_groups
from cdem.errors import CaseError

FILES = (
    "own_laws.*",
    "model.joints.*.discs.file",
    "model.mesh",
    "model.blocks.*.file",
    "records.*.file",
    "water.fields.*.surface",
    "water.fields.*.table",
)
"""Values that may differ because the files themselves are compared."""
FREE = ("title", "crs", "output.every", "output.checkpoint_every", "time.energy_error")
"""Values that a resumed run may change."""
ENDS = ("duration", "until", "tolerance", "max_steps")
"""Values of the last stage begun that a resumed run may change."""
CURVES = ("loads.*.*.stage", "water.fields.*.stage", "water.reservoir.stage")
"""Stages where curves start: naming the first stage means the same as naming none."""

SHOWN = 300
"""Most characters shown of a value."""
Difference = tuple[str, Any, Any]  # path, old value, new value; None for a missing value


@dataclass
class Changes:
    """Differences between two cases, by whether a resumed run allows them.

    Attributes:
        allowed: Differences that take effect.
        refused: Differences that would make it another run.
        longer: Whether the last stage begun is to be prolonged.
    """

    allowed: list[Difference] = field(default_factory=list)
    refused: list[Difference] = field(default_factory=list)
    longer: bool = False

    def check(self, case: Case, *, force: bool) -> list[str]:
        """Report the changes, one line for each value.

        Raises:
            CaseError: A change is not allowed, and it is not forced; or a record changes.
        """
        if records := [one for one in self.refused if one[0].startswith("records.")]:
            raise CaseError("\n".join(_of_record(case, *one) for one in records))
        if self.refused and not force:
            raise CaseError(
                "\n".join(
                    f"{case.where(path)}: {path}: is {_short(now)}, but the run was begun with "
                    f"{_short(then)}"
                    for path, then, now in self.refused
                )
                + "\nA resumed run may change durations, tolerances, stages that have not begun, and "
                "output.every. Set other values back, continue with --force, or run the case "
                "again in another folder (-o)"
            )
        lines = [f"{path} changes from {then} to {now}" for path, then, now in self.allowed]
        return lines + [
            f"{path} changes from {then} to {now} in the middle of the run (--force)"
            for path, then, now in self.refused
        ]


def compare(then: dict[str, Any], now: dict[str, Any], begun: int) -> Changes:
    """Compare two cases by meaning: after units, defaults and inheritance.

    then: The case at the start of the run, as given by `Case.model_dump`.
        then: The case that the run was begun with, as `Case.model_dump` gives it.
        now: The case for resuming.
        begun: Stages that have begun.
    """
    found = Changes(refused=list(_other_start(then, now)))
    last = f"stages.{begun - 1}."
    first = {None, now["stages"][0]["name"]}
    for path, a, b in differences(then, now):
        later = path.startswith("stages.") and int(path.split(".")[1]) >= begun
        end = path.removeprefix(last) if path.startswith(last) else ""
        if _is_of(path, FILES) or (_is_of(path, CURVES) and {a, b} <= first):
            continue
        if end in ENDS:
            found.longer |= b is None or (
                a is not None and (a > b if end == "tolerance" else b > a)
            )
        allowed = later or path in FREE or end in ENDS
        (found.allowed if allowed else found.refused).append((path, a, b))
    return found


def _of_record(case: Case, path: str, then: Any, now: Any) -> str:
    """Why a resumed run cannot change a record; samples are too long to show."""
    what = f"is {now}, but the run was begun with {then}"
    if path.endswith(".samples"):
        what = "are not those that the run was begun with"
    return (
        f"{case.where(path)}: {path}: {what}; a resumed run goes on with the processed record of its "
        "begin, so --force does not help: set it back, or run the case again in another folder (-o)"
    )


def _short(value: Any) -> str:
    """A value as text, without the end of a long one."""
    text = str(value)
    return text if len(text) <= SHOWN else text[:SHOWN] + "..."


def _is_of(path: str, patterns: tuple[str, ...]) -> bool:
    return any(fnmatchcase(path, pattern) for pattern in patterns)


def _other_start(then: dict[str, Any], now: dict[str, Any]) -> Iterator[Difference]:
    """Changes of later stages that alter the start: groups that are absent there, and pairs of faces."""
    cases = [[(stage.get("remove", []), stage.get("add", [])) for stage in case.get("stages", [])]
             for case in (then, now)]  # fmt: skip
    was, new = (set(absent_groups(changes, 0)) for changes in cases)
    words = ("present from the start", "absent at the start")
    for name in sorted(was ^ new):
        yield f"groups.{name}", words[name in was], words[name in new]
    added, adds = (any(come for _, come in changes) for changes in cases)
    words = ("no stage with add", "a stage with add")  # joints without strength are pairs then
    if added != adds:
        yield "stages", words[added], words[adds]


def differences(then: Any, now: Any, path: str = "") -> Iterator[Difference]:
    """Places where two nests of dicts and lists differ, in order.

    A key that `then` did not know yet is no difference if its list is empty now.
    """
    if isinstance(then, dict) and isinstance(now, dict):
        now = {key: value for key, value in now.items() if key in then or value not in ([], {})}
    if isinstance(then, list) and isinstance(now, list):
        then, now = dict(enumerate(then)), dict(enumerate(now))
    if isinstance(then, dict) and isinstance(now, dict):
        for key in [*then, *(key for key in now if key not in then)]:
            inside = f"{path}.{key}" if path else str(key)
            yield from differences(then.get(key), now.get(key), inside)
    elif then != now:
        yield path, then, now
