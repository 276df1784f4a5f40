"""The runs of a study: the case of each, and its hash."""

from __future__ import annotations

import hashlib
import json
from copy import deepcopy
from functools import lru_cache
from pathlib import Path
from typing import Any

from cdem._version import __version__
from cdem.case.case import Case
from cdem.case.formula import Formula, is_formula
from cdem.case.input_file import is_file
from cdem.case.named_files import files_of
from cdem.case.reader import load_case_data, put
from cdem.case.source import Source
from cdem.errors import CaseError
from cdem.study import sampling
from cdem.study.run import Run
from cdem.study.samples import samples
from cdem.study.study import Study


def plan(study: Study, folder: Path) -> list[Run]:
    """Make the case of every run.

    Random values may be invalid (a cohesion below zero): such a run has an error. Invalid values
    in the study file are the user's mistake.

    Raises:
        CaseError: The case is wrong, or all runs are.
        CdemError: The folder contains a sweep with unknown values.
        BackendError: The study needs an extra.
    """
    data, source = load_case_data(study.case_file)
    drawn = study.sampling is not None
    runs, first_error = [], None
    for row in sampling.rows(study, samples(study, folder)):
        try:
            runs.append(_make(study, data, source, row, folder))
        except CaseError as error:
            if not drawn:
                raise
            first_error = first_error or error
            runs.append(Run("", "", row, {}, error=str(error)))
    if first_error and all(run.error for run in runs):
        raise first_error
    return runs


def _make(
    study: Study, data: dict[str, Any], source: Source, row: dict[str, Any], folder: Path
) -> Run:
    """The run with one value of each parameter."""
    data, own = deepcopy(data), Source(source.file, source.places)
    for name, value in row.items():
        if "." not in name:
            continue
        where = study._source.where(("parameters", name))
        unit = study.parameters[name].unit
        written = f"{value!r} {unit}" if unit and isinstance(value, int | float) else value
        put(data, name, written, own, f"{where}: {name} = {written}")
    for path, value in study.set.items():
        where = study._source.where(("set", path))
        put(data, path, _computed(study, ("set", path), value, row), own, f"{where}: {path}")
    for holder, key in files_of(data):  # workers start in other folders
        holder[key] = str((source.folder / holder[key]).resolve())
    case = Case(_source=own, **deepcopy(data))
    search = None
    if study.critical:
        search = study.critical.model_dump()
        search["between"] = _computed(study, ("critical", "between"), study.critical.between, row)
        _check_search(study, case, search)
    identity = _identity(case, search)
    task = {
        "name": identity[:16],
        "identity": identity,
        "version": __version__,
        "folder": str(folder.resolve()),
        "case": data,
        "source": own.as_dict(),
        "critical": search,
        "keep": study.keep,
        "parameters": row,
    }
    return Run(identity[:16], identity, row, task)


def _check_search(study: Study, case: Case, search: dict[str, Any]) -> None:
    from cdem.study.critical import check_last_stage, parameter

    if search["parameter"]:  # else the study seeks the factor of safety
        where = study._source.where(("critical", "parameter"))
        try:
            parameter(search["parameter"])(case.model_copy(deep=True), search["between"][0])
        except CaseError as error:
            raise CaseError(f"{where}: {error}") from None
    check_last_stage(case)


def _computed(study: Study, keys: tuple[str | int, ...], value: Any, row: dict[str, Any]) -> Any:
    """A value of the study with computed formulas."""
    if isinstance(value, dict):
        return {k: _computed(study, (*keys, k), v, row) for k, v in value.items()}
    if isinstance(value, list):
        return [_computed(study, (*keys, i), v, row) for i, v in enumerate(value)]
    if not is_formula(value):
        return value
    try:
        return Formula(value).value(row)
    except ValueError as error:
        raise study.error(keys, str(error)) from None


def _identity(case: Case, search: dict[str, Any] | None) -> str:
    """Hash of all data that a result depends on, including the contents of files."""
    data = case.model_dump(mode="json")
    for holder, key in files_of(data):
        path = case.path_of(holder[key])
        holder[key] = _digest(path, path.stat().st_mtime_ns) if is_file(path) else holder[key]
    whole = {"case": data, "critical": search, "version": __version__}
    return hashlib.sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()


@lru_cache(maxsize=64)
def _digest(path: Path, changed: int) -> str:
    """Hash of a file; read once, not for every run."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
