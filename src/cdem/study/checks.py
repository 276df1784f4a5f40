"""Contradictions within a study: checks between its parts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from cdem.case.formula import Formula, is_formula, unknown
from cdem.case.source import Keys
from cdem.study.schema import (
    COLUMNS,
    CRITICAL_RESULTS,
    MOST_RUNS,
    CriticalSearch,
    Parameter,
    StudyParts,
    run_count,
)


def formulas(study: StudyParts) -> Iterator[tuple[Keys, str]]:
    """Every formula needed before a run starts, and its place."""
    yield from _inside(study.set, ("set",))
    if study.critical:
        yield from _inside(study.critical.between, ("critical", "between"))


def _inside(value: Any, keys: Keys) -> Iterator[tuple[Keys, str]]:
    if is_formula(value):
        yield keys, value
    elif isinstance(value, dict | list):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _inside(item, (*keys, key))


def contradictions(study: StudyParts) -> Iterator[tuple[Keys, str]]:
    """Every mismatch between parts of a study, and its place."""
    used: set[str] = set()  # names in formulas
    for keys, text in formulas(study):
        yield from _formula(keys, text, study.parameters, used)
    yield from _results(study, used)
    for field, names in (("parameters", study.parameters), ("results", study.results)):
        for name in set(names) & set(COLUMNS):
            yield (field, name), "is the name of a column of every table; choose another"
    for name, parameter in study.parameters.items():
        yield from _parameter(study, name, parameter, used)
    yield from _sampling(study)
    yield from _plots(study)
    if study.critical:
        yield from _critical(study, study.critical)


def _results(study: StudyParts, used: set[str]) -> Iterator[tuple[Keys, str]]:
    known = [*study.parameters, *(CRITICAL_RESULTS if study.critical else ())]
    for name, text in study.results.items():
        if is_formula(text):
            yield from _formula(("results", name), text, known, used)
        elif study.critical and text not in CRITICAL_RESULTS:
            yield ("results", name), unknown(text, CRITICAL_RESULTS)
        if name in study.parameters:
            yield ("results", name), "is also the name of a parameter; choose another"
        known.append(name)


def _critical(study: StudyParts, search: CriticalSearch) -> Iterator[tuple[Keys, str]]:
    for i, value in enumerate(search.between):
        if not is_formula(value) and not isinstance(value, int | float):
            yield ("critical", "between", i), f"must be a number or a formula, got '{value}'"
    sought = search.parameter
    for field, names in (("parameters", study.parameters), ("set", study.set)):
        if sought in names:
            yield ("critical", "parameter"), f"'{sought}' is also given by {field}; vary it once"


def _formula(
    keys: Keys, text: str, known: Iterable[str], used: set[str]
) -> Iterator[tuple[Keys, str]]:
    try:
        names = Formula(text).names
    except ValueError as error:
        yield keys, str(error)
        return
    used |= names
    for name in sorted(names - set(known)):
        yield keys, f"'{text.strip()}': {unknown(name, known)}"


def _parameter(
    study: StudyParts, name: str, parameter: Parameter, used: set[str]
) -> Iterator[tuple[Keys, str]]:
    keys: Keys = ("parameters", name)
    if "." not in name and name not in used:
        yield keys, "is neither used by a formula nor a path in the case (a path has a dot)"
    if parameter.is_drawn and study.sampling is None:
        yield keys, "has a distribution, so the study needs sampling: {count: 100}"
    if parameter.is_drawn and study.combine == "one-at-a-time":
        yield keys, "has a distribution, which one-at-a-time does not allow; give values or a grid"
    if name in study.set:
        yield ("set", name), "is also a parameter; give it once"


def _sampling(study: StudyParts) -> Iterator[tuple[Keys, str]]:
    lengths = {n: p.count for n, p in study.parameters.items() if not p.is_drawn}
    if study.combine == "together" and len(set(lengths.values())) > 1:
        counts = ", ".join(f"{name} {count}" for name, count in lengths.items())
        yield (
            ("combine",),
            (f"together needs the same number of values for each parameter; got {counts}"),
        )
    if run_count(study) > MOST_RUNS:
        yield (
            ("combine",),
            f"{run_count(study):,} runs are too many; the limit is {MOST_RUNS:,}",
        )
    if study.sampling and len(lengths) == len(study.parameters):
        yield ("sampling",), "no parameter has a distribution; remove sampling"


def _plots(study: StudyParts) -> Iterator[tuple[Keys, str]]:
    for i, plot in enumerate(study.plots):
        for field in ("x", "y", "by"):
            name = getattr(plot, field)
            if name is not None and name not in study.parameters:
                yield ("plots", i, field), f"parameter {unknown(name, study.parameters)}"
        for field in (plot.kind, "beside"):
            name = getattr(plot, field)
            if name is not None and study.results and name not in study.results:
                yield ("plots", i, field), f"result {unknown(name, study.results)}"
