"""What a run did, as text and as a page, from its folder alone."""

from __future__ import annotations

import base64
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment

from cdem.errors import CdemError
from cdem.output.figures import plot
from cdem.output.reader import read_summary
from cdem.output.render import render
from cdem.run.energy_terms import ENERGY_TERMS
from cdem.run.rest import REST_SPEED, SLOW_SPEED
from cdem.whole_files import write_text

DOUBTFUL = 0.01
"""Closing error of the energy balance that is flagged, as a share of its largest term."""


def info(folder: Path) -> str:
    """The summary as a page of text."""
    s = read_summary(folder)
    lines = [
        f"{s['title'] or 'untitled case'}: {s['status']}{moving(s)}",
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
        lines.append("  " + ", ".join(f"{t.name} {e[t.name]:.4g} J" for t in ENERGY_TERMS))
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
            f"  yielded: {count['ever']:,} elements of group {name}, {count['now']:,} of them flow now"
        )
    for name, lost in s.get("taken_out", {}).items():
        share = lost["mass"] / s["groups"][name]["mass"]
        what = "dug out" if lost.get("dug_out") else "left the domain"
        lines.append(
            f"  {what}: {lost['blocks']:,} blocks of group {name}, {lost['mass']:.5g} kg "
            f"({100 * share:.3g} % of its mass)"
        )
    warnings = [
        text
        for what in ("departures", "large_strains", "fast_weakening")
        for text in s.get(what, [])
    ]
    lines += [f"  warning: {text}" for text in warnings]
    return "\n".join(lines) + "\n"


def closing(energies: dict[str, float]) -> str:
    """How well the energy balance closes, with a word if that is not well enough."""
    error = energies["error"]
    doubt = (
        "" if abs(error) <= DOUBTFUL else f": above {100 * DOUBTFUL:g} %, look before you trust it"
    )
    return f"{100 * error:.3g} %{doubt}"


def moving(summary: dict[str, Any]) -> str:
    """Say how fast the fastest block moved at the end of a run; nothing if all rest, or not known."""
    # of a run that failed, numbers that are not finite are null
    speeds = {name: g.get("fastest_block") or 0.0 for name, g in summary["groups"].items()}
    name = max(speeds, key=speeds.__getitem__)
    if speeds[name] < (SLOW_SPEED if summary["status"] == "at rest" else REST_SPEED):
        return ""
    return f", still moving at {speeds[name]:.3g} m/s (a block of group {name})"


def report(folder: Path) -> Path:
    """Write report.html: summary, energy balance, pictures, all in one file."""
    folder = Path(folder)
    s = read_summary(folder)
    pictures = plot(folder)
    try:
        pictures = render(folder)[-1:] + pictures
        missing = ""
    except CdemError as error:
        missing = str(error)
    e = s["energies"]
    # case files come from strangers: whatever they name is escaped
    page = Environment(autoescape=True).from_string(
        (resources.files("cdem.output") / "report_page.html").read_text(encoding="utf-8")
    )
    text = page.render(
        title=s["title"] or "cdem run",
        closing=closing(e) if e else "not sampled",
        info=info(folder),
        missing=missing,
        images=[(p.stem, base64.b64encode(p.read_bytes()).decode()) for p in pictures],
        energies=[(t.name, f"{e[t.name]:.6g}") for t in ENERGY_TERMS if e],
    )
    path = folder / "report.html"
    write_text(path, text)
    return path
