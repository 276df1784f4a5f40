"""Checks of boundaries that need no mesh."""

from __future__ import annotations

from collections.abc import Iterator

from cdem.case.boundaries_schema import Boundary
from cdem.case.schema import CaseParts, Keys
from cdem.case.surface_schema import surface_groups

Problem = tuple[Keys, str]  # path, problem


def boundary_problems(case: CaseParts) -> Iterator[Problem]:
    """Contradictions between boundaries and the other parts of a case."""
    yield from _histories(case)
    yield from _moduli(case)
    names = [stage.name for stage in case.stages]
    for i, boundary in enumerate(case.boundaries):
        place = ("boundaries", i)
        yield from _stage(case, boundary, (*place, "stage"), names)
        for k, given in enumerate(boundary.inputs):
            if given.record not in case.records:
                at = (k,) if isinstance(boundary.input, list) else ()
                known = ", ".join(case.records) or "none"
                yield (
                    (*place, "input", *at, "record"),
                    f"no record '{given.record}'; the case has: {known}",
                )
        if boundary.free_field is not None:
            yield from _base(case, boundary, (*place, "free_field", "base"))


def _histories(case: CaseParts) -> Iterator[Problem]:
    """Histories of waves through boundaries."""
    names = {boundary.name: boundary for boundary in case.boundaries}
    for i, history in enumerate(case.histories):
        if history.boundary is None:
            continue
        boundary = names.get(history.boundary)
        if boundary is None:
            known = ", ".join(names) or "none"
            yield (
                ("histories", i, "boundary"),
                f"no boundary '{history.boundary}'; the case has: {known}",
            )
        elif not boundary.quiet and set(history.quantities) - {"v_base"}:
            yield (
                ("histories", i, "quantities"),
                f"v_up and v_down need a quiet boundary; {boundary.name} is none",
            )


def _moduli(case: CaseParts) -> Iterator[Problem]:
    """Columns keep the moduli that they begin with."""
    names = [stage.name for stage in case.stages]
    begin = [b.stage for b in case.boundaries if b.free_field is not None]
    first = min(
        (names.index(stage) if stage in names else 0 for stage in begin), default=len(names)
    )
    given = [
        (i, m if (m := stage.damping.maxwell) and m.reference != "static" else None)
        for i, stage in enumerate(case.stages)
        if i >= first and stage.mode == "dynamic"
    ]
    for i, branches in given[1:]:
        if branches != given[0][1]:
            yield (
                ("stages", i, "damping"),
                f"the moduli of the ground would change after {names[given[0][0]]} (maxwell.reference), "
                "and the columns of its free field do not; give both stages the same maxwell",
            )


def _stage(case: CaseParts, boundary: Boundary, place: Keys, names: list[str]) -> Iterator[Problem]:
    if boundary.stage is not None and boundary.stage not in names:
        yield place, f"no stage '{boundary.stage}'; the case has: {', '.join(names)}"
        return
    first = 0 if boundary.stage is None else names.index(boundary.stage)
    if case.stages[first].mode == "static":
        later = next((s.name for s in case.stages[first:] if s.mode == "dynamic"), "NAME")
        yield (
            place,
            f"{boundary.name} would begin with the static stage {names[first]}: waves need a dynamic "
            f"stage; write stage: {later}, and hold the faces with supports until then",
        )
    for group in set(surface_groups(boundary.surface)) & set(case.absent(first + 1)):
        yield place, f"{group} is not present in the stage {names[first]}"


def _base(case: CaseParts, side: Boundary, place: Keys) -> Iterator[Problem]:
    assert side.free_field is not None
    base = next((b for b in case.boundaries if b.name == side.free_field.base), None)
    if base is None or base is side:
        others = ", ".join(b.name for b in case.boundaries if b is not side) or "none"
        yield place, f"no boundary '{side.free_field.base}' beside this one; the case has: {others}"
    elif base.free_field is not None:
        yield place, f"{base.name} is a side itself; name the base below, quiet or rigid"
    elif base.stage != side.stage:
        yield place, f"{base.name} begins with another stage; give both the same stage"
