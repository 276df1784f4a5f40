"""The table of a study: one row per run, with its parameters and collected results."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.formula import Formula, is_formula, unknown
from cdem.study.run import Run
from cdem.study.study import Study
from cdem.whole_files import replaced, write_text

OF_THE_MACHINE = {"title", "version", "device", "threads", "wall_time", "counts", "stages"}
"""Parts of a summary that enter the table only if the study names them."""


class Table:
    """All runs of a study with their parameters and results.

    Attributes:
        study: The study.
        runs: Its runs, in the order of the study.
    """

    def __init__(self, study: Study, runs: list[Run]) -> None:
        self.study = study
        self.runs = runs

    @property
    def rows(self) -> list[dict[str, Any]]:
        """One mapping per run: run, status, parameters, results, wall_time [s] and error."""
        found = [collect(self.study, run) for run in self.runs]
        names = list(self.study.results) or sorted({name for row in found for name in row})
        return [
            {
                "run": run.name,
                "status": run.status,
                **run.parameters,
                **{name: row.get(name) for name in names},
                "wall_time": (run.result or {}).get("wall_time"),
                "error": run.why,
            }
            for run, row in zip(self.runs, found, strict=True)
        ]

    def column(self, name: str) -> NDArray[np.float64]:
        """A parameter or result of all runs as numbers; NaN for missing ones."""
        return np.array([_number(row.get(name)) for row in self.rows])

    @property
    def failed(self) -> list[Run]:
        """Runs that failed."""
        return [run for run in self.runs if run.status == "failed"]

    @property
    def warnings(self) -> list[str]:
        """Each warning of the models of all runs, once."""
        told = [text for run in self.runs for text in (run.result or {}).get("warnings", [])]
        return list(dict.fromkeys(told))

    @property
    def waiting(self) -> int:
        """Number of runs without a result."""
        return sum(run.status == "waiting" for run in self.runs)

    def as_dict(self) -> dict[str, Any]:
        """All data, ready for JSON."""
        rows = [
            {k: None if isinstance(v, float) and math.isnan(v) else v for k, v in row.items()}
            for row in self.rows
        ]
        return {"runs": rows, "failed": len(self.failed), "waiting": self.waiting}

    def write(self, folder: Path) -> list[Path]:
        """Write table.csv, and table.parquet if pyarrow is installed; returns their paths."""
        units = {name: p.unit for name, p in self.study.parameters.items() if p.unit}
        units["wall_time"] = "s"
        rows = self.rows
        heads = [f"{n} [{units[n]}]" if n in units else n for n in rows[0]]
        paths = [folder / "table.csv"]
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows([_cell(value) for value in row.values()] for row in rows)
        write_text(paths[0], text.getvalue())
        columns = dict(zip(heads, zip(*(row.values() for row in rows), strict=True), strict=True))
        return paths + _write_parquet(folder / "table.parquet", columns)


def collect(study: Study, run: Run) -> dict[str, Any]:
    """The collected results of a run, by name; empty if it failed.

    Raises:
        ValueError: A path under ``results`` is not in the result.
    """
    if run.result is None or run.status == "failed":
        return {}
    there = available(run.result)
    if not study.results:
        return {n: v for n, v in there.items() if n.split(".")[0] not in OF_THE_MACHINE}
    found: dict[str, Any] = {}
    for name, text in study.results.items():
        if is_formula(text):
            formula = Formula(text)
            known = run.parameters | (there if study.critical else {}) | found
            empty = any(known.get(n, 0.0) is None for n in formula.names)
            found[name] = None if empty else formula.value(known)
        elif text in there:
            found[name] = there[text]
        else:
            raise ValueError(f"results.{name}: {unknown(text, there)}")
    return found


def check_results(study: Study, run: Run) -> None:
    """Stop at the first result if the study asks for a missing value.

    Raises:
        CaseError: A path under ``results`` is wrong.
    """
    try:
        collect(study, run)
    except ValueError as error:
        name, _, what = str(error).removeprefix("results.").partition(": ")
        raise study.error(("results", name), what) from None


def available(result: dict[str, Any]) -> dict[str, Any]:
    """Every number of a result by its dotted path."""
    if "critical" in result:
        found = dict(result["critical"])
        trials = found.pop("trials")
        numbers = {key: found[key] for key in ("value", "stable", "failed")}
        return numbers | {"trials": len(trials), "steps": sum(t["steps"] for t in trials)}
    numbers = dict(_flat(result["summary"], ""))
    for name, value in result["histories"].items():
        numbers[f"histories.{name.partition(' [')[0]}"] = value
    return numbers


def _flat(tree: Any, path: str) -> Any:
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield from _flat(value, f"{path}.{key}" if path else key)
    elif isinstance(tree, list):
        for i, value in enumerate(tree):
            name = value["name"] if isinstance(value, dict) else i  # stages have names
            yield from _flat(value, f"{path}.{name}")
    elif not isinstance(tree, str):
        yield path, tree


def _number(value: Any) -> float:
    return float(value) if isinstance(value, int | float) else math.nan


def _cell(value: Any) -> Any:
    """A number that reads back to the same bits; empty for a missing number."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value) if isinstance(value, list | dict) else value


def _write_parquet(path: Path, columns: dict[str, tuple[Any, ...]]) -> list[Path]:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        return []
    arrays = {}
    for name, values in columns.items():
        numbers = all(isinstance(v, int | float) or v is None for v in values)
        arrays[name] = (
            pyarrow.array([None if v is None else float(v) for v in values], pyarrow.float64())
            if numbers
            else pyarrow.array(["" if v is None else str(_cell(v)) for v in values])
        )
    with replaced(path) as file:
        parquet.write_table(pyarrow.table(arrays), file)
    return [path]
