"""The runs of a study beside the observations: parameters and the same values of each run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.reader import load_case_data
from cdem.errors import CaseError, CdemError
from cdem.fit.fitting import Fit
from cdem.fit.observed import Observed, observed
from cdem.fit.priors import Prior
from cdem.fit.schema import OfResult
from cdem.output.runout import measure
from cdem.output.runout_result import RunOut
from cdem.study.plan import plan
from cdem.study.plots import label_of
from cdem.study.results_table import Table
from cdem.study.run import Run
from cdem.study.study import Study
from cdem.study.worker import RESULT_FOLDER, finished

Floats = NDArray[np.float64]
Report = Callable[[str, float], None]

USUAL = 10
"""Usual number of runs for each parameter (Loeppky, Sacks & Welch 2009)."""
LEAST = 4
"""Fewest runs, beside one for each parameter."""


@dataclass
class Runs:
    """The runs of a study that can be compared with observations.

    Attributes:
        priors: The parameters.
        used: Parameters of the runs, shape (runs, parameters).
        observed: The observations.
        results: For each observation the same values of every run, shape (runs, size).
        notes: Messages for the user.
    """

    priors: list[Prior]
    used: Floats
    observed: list[Observed]
    results: list[Floats]
    notes: list[str]

    @property
    def places(self) -> Floats:
        """Parameters of the runs in units of their priors, shape (runs, parameters)."""
        columns = [p.share(self.used[:, k]) for k, p in enumerate(self.priors)]
        return np.column_stack(columns)


def runs_of(fit: Fit, report: Report | None = None) -> Runs:
    """Read the results of the study, and measure each run as the deposit was measured.

    Args:
        fit: The study and the observations.
        report: Called with a text and the share done.

    Raises:
        CaseError: The fit, the study, or a file of an observation is wrong.
        CdemError: Too few runs have results, or no result folders.
    """
    study = fit.load_study()
    case, _ = load_case_data(study.case_file)
    wanted = observed(fit, case.get("crs"))
    notes = [note for one in wanted for note in one.notes]
    table = _table(fit, study, notes)
    _check_columns(fit, table)
    names = _varied(fit, table)
    used, results = _results(fit, table, names, wanted, notes, report)
    _check_count(fit, used, names, notes)
    priors = [
        Prior.of(n, label_of(study, n), study.parameters[n], used[:, k])
        for k, n in enumerate(names)
    ]
    return Runs(priors, used, wanted, results, notes)


def _table(fit: Fit, study: Study, notes: list[str]) -> Table:
    """The table of the study, with the results that its sweep has."""
    folder = fit.folder
    if not (folder / "study.json").is_file():
        raise CdemError(
            f"{folder}: holds no sweep; run cdem sweep {fit.path_of(fit.study)} -o {folder}, or "
            "name its folder by sweep"
        )
    table = Table(study, plan(study, folder))
    for run in table.runs:
        run.result = finished(run.task)
    if table.waiting:
        notes.append(f"{table.waiting} of {len(table.runs)} runs have no result yet")
    if table.failed:
        notes.append(f"{len(table.failed)} runs failed and are left out")
    return table


def _check_columns(fit: Fit, table: Table) -> None:
    """Every observed result must be a column of the table."""
    rows = table.rows
    known = sorted({name for row in rows for name, value in row.items() if value is not None})
    for number, part in enumerate(fit.observed):
        if isinstance(part, OfResult) and part.result not in known and known:
            raise fit.error(
                ("observed", number, "result"),
                f"no column {part.result} in the table of the study; it has: {', '.join(known)}",
            )


def _varied(fit: Fit, table: Table) -> list[str]:
    """Names of the parameters that have different numbers."""
    names = []
    for name in table.study.parameters:
        values = table.column(name)
        if not np.isfinite(values).all():
            raise fit.error(("study",), f"{name} has values that are not numbers; a fit needs them")
        if np.ptp(values) > 0:
            names.append(name)
    if not names:
        raise fit.error(("study",), "no parameter of the study varies")
    return names


def _results(
    fit: Fit,
    table: Table,
    names: Sequence[str],
    wanted: Sequence[Observed],
    notes: list[str],
    report: Report | None,
) -> tuple[Floats, list[Floats]]:
    """Parameters of the runs, and for each observation the same values of every run."""
    used, results = [], []
    known: set[str] = set()
    left_out: dict[str, int] = {}
    for number, (run, row) in enumerate(zip(table.runs, table.rows, strict=True)):
        if report:
            report("runs", number / len(table.runs))
        if run.status in ("waiting", "failed") or run.identity in known:
            continue
        known.add(run.identity)
        try:
            vectors = _vectors(fit, run, row, wanted)
        except CaseError:
            raise
        except CdemError as error:
            reason = str(error).split(": ", 1)[-1]
            left_out[reason] = left_out.get(reason, 0) + 1
            continue
        used.append([float(row[name]) for name in names])
        results.append(vectors)
    notes += [f"{count} runs are left out: {reason}" for reason, count in left_out.items()]
    return np.array(used).reshape(-1, len(names)), [
        np.array(one) for one in zip(*results, strict=True)
    ]


def _vectors(fit: Fit, run: Run, row: dict[str, Any], wanted: Sequence[Observed]) -> list[Floats]:
    """The values of the observations in a run.

    Raises:
        CdemError: They cannot be measured; gives the reason.
    """
    found = None
    if any(one.needs_folder for one in wanted):
        found = _run_out(fit, fit.folder / "runs" / run.name / RESULT_FOLDER)
    vectors = [one.of_run(row, found) for one in wanted]
    for one, vector in zip(wanted, vectors, strict=True):
        if not np.isfinite(vector).all():
            raise CdemError(f"{run.name}: {one.name} has no number")
    return vectors


def _run_out(fit: Fit, folder: Path) -> RunOut:
    if not (folder / "frames").is_dir():
        raise CaseError(
            f"{folder}: has no frames, which outline, thickness, front and runout need; write "
            f"keep: true in {fit.study}, and run cdem sweep again"
        )
    return measure(folder)


def _check_count(fit: Fit, used: Floats, names: Sequence[str], notes: list[str]) -> None:
    runs, least = len(used), len(names) + LEAST
    if runs < least:
        why = f": {notes[-1]}" if notes else ""
        raise CdemError(
            f"{fit.folder}: {runs} runs can be used; {len(names)} parameters need at least {least}, "
            f"better {USUAL * len(names)}{why}"
        )
    if runs < USUAL * len(names):
        notes.append(f"{runs} runs for {len(names)} parameters; {USUAL * len(names)} are usual")
