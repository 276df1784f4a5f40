"""The texts of a run's page: state, warnings, tables, reproduction. All are plain text."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np

from cdem._version import __version__
from cdem.case.yaml_text import parse
from cdem.errors import CdemError
from cdem.output.reader import read_histories, read_summary
from cdem.run.energy_terms import ENERGY_TERMS
from cdem.run.rest import REST_SPEED, SLOW_SPEED

DOUBTFUL = 0.01
"""Closing error of the energy balance above which it is flagged, relative to its largest term."""
MOST_LOG = 200_000
"""Most characters of run.log on a page, counted from its end."""
BROKEN = "springs broken in tension / shear"
WARNING = "warning: "
PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"))


def closing(energies: dict[str, float]) -> str:
    """Closing error of the energy balance, with a remark if it is large."""
    error = energies["error"]
    doubt = (
        ""
        if abs(error) <= DOUBTFUL
        else f": above {100 * DOUBTFUL:g} %, check the run before you trust it"
    )
    return f"{100 * error:.3g} %{doubt}"


def moving(summary: dict[str, Any]) -> str:
    """Speed of the fastest block at the end of a run; empty if all rest, or if unknown."""
    # a failed run has null for non-finite numbers
    speeds = {name: g.get("fastest_block") or 0.0 for name, g in summary["groups"].items()}
    name = max(speeds, key=speeds.__getitem__)
    if speeds[name] < (SLOW_SPEED if summary["status"] == "at rest" else REST_SPEED):
        return ""
    return f", still moving at {speeds[name]:.3g} m/s (a block of group {name})"


def rested(summary: dict[str, Any]) -> str:
    """Displacement of a run that came to rest; empty for other ends."""
    if summary["status"] != "converged":
        return ""
    ways = {name: g.get("max_displacement") or 0.0 for name, g in summary["groups"].items()}
    name = max(ways, key=ways.__getitem__)
    return f", moved by up to {ways[name]:.3g} m (group {name})"


def unrested(summary: dict[str, Any]) -> list[str]:
    """A line for each static stage that found no rest."""
    stages = summary.get("stages", [])
    return [f"stage {row['name']} {row['no_rest']}" for row in stages if row.get("no_rest")]


def departed(summary: dict[str, Any]) -> str:
    """Blocks that have left the domain, while all others rest; empty for other ends."""
    if summary["status"] != "at rest":
        return ""
    gone = [
        f"{lost['blocks']:,} block{'s' * (lost['blocks'] > 1)} of group {name}"
        for name, lost in summary.get("taken_out", {}).items()
        if not lost.get("dug_out")
    ]
    return f", but for {' and '.join(gone)} that left the domain" if gone else ""


def case_facts(folder: Path) -> dict[str, Any]:
    """What the picture of a run takes from its case.

    Args:
        folder: Result folder.

    Returns:
        `fixed`: groups that can never move; `north`: whether y points north, as in a case with a
        map projection.
    """
    path = folder / "case.yaml"
    try:
        case = parse(_part(_text(path), ("crs", "groups", "loads")), str(path))
    except CdemError:
        case = None
    if not isinstance(case, dict):
        return {"fixed": [], "north": False}
    try:
        driven = [entry.get("group") for entry in case["loads"]["velocities"]]
        fixed = [name for name, group in case["groups"].items() if len(set(group["fix"])) == 3]
    except (AttributeError, KeyError, TypeError):  # not as cdem writes it
        driven = fixed = []
    north = case.get("crs") is not None
    return {"fixed": [name for name in fixed if name not in driven], "north": north}


def _part(case: str, keys: tuple[str, ...]) -> str:
    """The text of some entries of a case; those of its blocks take ten times as long to parse."""
    entries = re.split(r"^(?=\S)", case, flags=re.MULTILINE)
    return "".join(entry for entry in entries if entry.partition(":")[0] in keys)


def page_facts(folder: Path) -> dict[str, Any]:
    """The texts and tables of a run's page.

    Args:
        folder: Result folder; the run may be in progress.
    """
    log, case = _text(folder / "run.log"), _text(folder / "case.yaml")
    try:
        columns = read_histories(folder)
    except CdemError:
        columns = {}
    try:
        summary = read_summary(folder)
    except CdemError:
        summary = None
    if not is_over(folder):
        summary = None
    facts = {
        "title": _title(summary, case) or folder.resolve().name,
        "over": summary is not None,
        "warnings": _warnings(log),
        "repeat": _repeat(folder, summary),
        "case": case,
        "log": log[-MOST_LOG:],
        "leftOut": [],
        "missing": "",
    }
    return facts | (_ended(summary) if summary else _going_on(columns))


def is_over(folder: Path) -> bool:
    """Whether the summary belongs to the last row of the histories: an active run is past it."""
    try:
        steps = json.loads((folder / "summary.json").read_text())["steps"]
        last = (folder / "histories.csv").read_text().rstrip().rpartition("\n")[2]
        return int(last.split(",")[1]) <= steps
    except (OSError, KeyError, IndexError, ValueError):
        return (folder / "summary.json").is_file()


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def _title(summary: dict[str, Any] | None, case: str) -> str:
    if summary:
        return summary["title"]
    lines = [
        line.removeprefix("title: ") for line in case.splitlines() if line.startswith("title: ")
    ]
    return lines[0] if lines and lines[0] != "''" else ""


def _warnings(log: str) -> list[str]:
    """Each warning of the log, once."""
    found = [line.partition(WARNING)[2] for line in log.splitlines() if WARNING in line]
    return list(dict.fromkeys(found))


def _repeat(folder: Path, summary: dict[str, Any] | None) -> str:
    version = summary["version"] if summary else __version__
    words = ["cdem", "run", str(folder / "case.yaml"), "-o", f"{folder}.again"]
    words += ["--allow-code"] * bool(summary and summary["own_laws"])
    return (
        f"{shlex.join(words)}\n\n"
        f"With cdem {version} this gives the same bits on any number of threads. The case below names\n"
        "the files that it reads (mesh, tables): keep them with it."
    )


def _ended(s: dict[str, Any]) -> dict[str, Any]:
    """The part from the summary."""
    energies = s["energies"]
    error = energies.get("error") if energies else None
    broken = s["broken"]
    tiles = [
        ["time simulated", _quantity(s["time"], "s"), ""],
        ["steps", f"{s['steps']:,}", ""],
        ["elements", f"{s['counts']['elements']:,}", ""],
        ["blocks", f"{s['counts']['blocks']:,}", ""],
        _closing_tile(error),
        [BROKEN, f"{broken['tension']:,} / {broken['shear']:,}", ""],
        ["wall time", _quantity(s["wall_time"], "s"), ""],
    ]
    threads = f"{s['threads']} thread{'s' * (s['threads'] > 1)}"
    return {
        "status": s["status"],
        "tone": {"failed": "bad", "stopped": "doubt"}.get(s["status"], "good"),
        "subtitle": f"cdem {s['version']} · {s['device']} · {threads}{rested(s)}{moving(s)}{departed(s)}",
        "tiles": tiles,
        "tables": [_groups(s), *_stages(s), *_energies(energies)],
    }


def _going_on(columns: dict[str, Any]) -> dict[str, Any]:
    """The part from the histories."""
    tiles = []
    if columns:
        last = {name: float(values[-1]) for name, values in columns.items()}
        tiles = [
            ["time simulated", _quantity(last["time [s]"], "s"), ""],
            ["steps", f"{last['step']:,.0f}", ""],
            _closing_tile(last["energy error"]),
            [BROKEN, f"{last['broken tension']:,.0f} / {last['broken shear']:,.0f}", ""],
        ]
    return {
        "status": "not at its end",
        "tone": "live",
        "subtitle": f"cdem {__version__} · the run is in progress, or was interrupted",
        "tiles": tiles,
        "tables": [],
    }


def _closing_tile(error: float | None) -> list[str]:
    if error is None:
        return ["energy balance", "not sampled", ""]
    good = abs(error) <= DOUBTFUL
    label = "energy balance closes to" if good else "energy balance: check before use"
    return [label, f"{100 * abs(error):.2g} %", "good" if good else "doubt"]


def _groups(s: dict[str, Any]) -> dict[str, Any]:
    rows = [
        [
            name,
            _number(g["mass"]),
            _norm(g["displacement"]),
            _number(g["max_displacement"]),
            _norm(g["velocity"]),
        ]
        for name, g in s["groups"].items()
    ]
    head = ["group", "mass [kg]", "moved [m]", "most [m]", "speed [m/s]"]
    return {"title": "Groups at the end", "head": head, "rows": rows}


def _stages(s: dict[str, Any]) -> list[dict[str, Any]]:
    rows = [
        [t["name"], t["mode"], t["status"], f"{t['steps']:,}", _number(t["time"]), _number(t["wall_time"])]
        for t in s["stages"]
    ]  # fmt: skip
    head = ["stage", "mode", "ended", "steps", "time [s]", "wall [s]"]
    return [{"title": "Stages", "head": head, "rows": rows}] if rows else []


def _energies(energies: dict[str, Any]) -> list[dict[str, Any]]:
    rows = [
        [term.name.replace("_", " "), term.kind, _quantity(energies[term.name], "J")]
        for term in ENERGY_TERMS
        if energies and energies.get(term.name)
    ]
    return [{"title": "Energies at the end", "head": [], "rows": rows}] if rows else []


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"


def _norm(vector: list[float | None]) -> str:
    """Length of a vector; None for non-finite numbers of a failed run."""
    return "–" if None in vector else _number(float(np.linalg.norm(np.array(vector, float))))


def _quantity(value: float, unit: str) -> str:
    """A number with its unit, and a prefix if that is shorter."""
    if unit == "s" and abs(value) >= 1:
        return f"{value:.4g} s" if value < 3600 else f"{value / 3600:.3g} h"
    factor, prefix = next((p for p in PREFIXES if abs(value) >= p[0]), (1.0, ""))
    return f"{value / factor:.4g} {prefix}{unit}"
