"""Summary of a run as text and as a page, from its folder alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cdem.output.page_facts import closing, departed, moving, rested
from cdem.output.reader import read_summary
from cdem.output.web_page import RunPage
from cdem.run.energy_terms import ENERGY_TERMS
from cdem.whole_files import write_text

BUDGET = 10_000_000
"""Largest size of report.html [bytes]."""


def info(folder: Path) -> str:
    """The summary as a page of text."""
    s = read_summary(folder)
    lines = [
        f"{s['title'] or 'untitled case'}: {s['status']}{rested(s)}{moving(s)}{departed(s)}",
        f"  {s['steps']:,} steps to t = {s['time']:.6g} s in {s['wall_time']:.1f} s "
        f"({s['steps'] / max(s['wall_time'], 1e-9):,.0f} steps/s), dt {s['time_step']:.4g} s, "
        f"{s['device']}, {s['threads']} threads, cdem {s['version']}",
        "  " + ", ".join(f"{v:,} {k.replace('_', ' ')}" for k, v in s["counts"].items()),
    ]
    for stage in s["stages"]:
        lines.append(
            f"  stage {stage['name']} ({stage['mode']}): {stage['status']} after "
            f"{stage['steps']:,} steps, {stage['time']:.6g} s, wall {stage['wall_time']:.1f} s"
        )
    e = s["energies"]
    if e:
        lines.append(f"  energy closing error {closing(e)}")
        lines.append(
            "  " + ", ".join(f"{t.name} {e[t.name]:.4g} J" for t in ENERGY_TERMS if t.name in e)
        )
    if s["unbalance_ratio"] is not None:
        lines.append(f"  unbalance ratio {s['unbalance_ratio']:.3g}")
    lines.append(
        f"  broken springs: {s['broken']['tension']:,} tension, {s['broken']['shear']:,} shear"
    )
    lines.append(
        f"  {'group':<18}{'mass [kg]':>13}{'moved [m]':>12}{'most [m]':>12}{'speed [m/s]':>13}"
    )
    for name, g in s["groups"].items():
        moved, speed = np.linalg.norm(g["displacement"]), np.linalg.norm(g["velocity"])
        lines.append(
            f"  {name:<18}{g['mass']:>13.5g}{moved:>12.5g}{g['max_displacement']:>12.5g}{speed:>13.5g}"
        )
    for name, count in s.get("yielded", {}).items():
        lines.append(
            f"  yielded: {count['ever']:,} elements of group {name}, {count['now']:,} of them "
            f"yield now"
        )
    for name, lost in s.get("taken_out", {}).items():
        share = lost["mass"] / s["groups"][name]["mass"]
        fate = "removed" if lost.get("dug_out") else "left the domain"
        lines.append(
            f"  {fate}: {lost['blocks']:,} blocks of group {name}, {lost['mass']:.5g} kg "
            f"({100 * share:.3g} % of its mass)"
        )
    warnings = [
        text
        for what in ("departures", "large_strains", "fast_weakening")
        for text in s.get(what, [])
    ]
    lines += [f"  warning: {text}" for text in warnings]
    return "\n".join(lines) + "\n"


def report(folder: Path, path: Path | None = None, *, budget: int = BUDGET) -> Path:
    """Write the page of a run: moving picture, histories, energies, warnings, in one file.

    Args:
        folder: Result folder.
        path: The file; None for report.html in the folder.
        budget: Largest size [bytes]; digits and frames are dropped to meet it.

    Raises:
        DiskError: It cannot be written.
    """
    page = RunPage(Path(folder)).whole(budget)
    path = path or Path(folder) / "report.html"
    write_text(path, page)
    return path
