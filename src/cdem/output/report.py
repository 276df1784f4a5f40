"""What a run did, as text and as a page, from its folder alone."""

from __future__ import annotations

import base64
import html
from pathlib import Path
from typing import Any

import numpy as np

from cdem.errors import CdemError
from cdem.output.figures import plot
from cdem.output.reader import read_summary
from cdem.output.render import render
from cdem.run.energy_terms import ENERGY_TERMS
from cdem.run.rest import REST_SPEED, SLOW_SPEED


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
        lines.append(f"  energy closing error {100 * e['error']:.3g} %")
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
    lines += [f"  warning: {text}" for text in s.get("departures", [])]
    return "\n".join(lines) + "\n"


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
        missing = f"<p>No pictures: {html.escape(str(error))}</p>"
    e = s["energies"]
    rows = "".join(
        f"<tr><td>{t.name}</td><td>{e[t.name]:.6g} J</td></tr>" for t in ENERGY_TERMS if e
    )
    images = "".join(
        f'<img alt="{p.stem}" src="data:image/png;base64,'
        f'{base64.b64encode(p.read_bytes()).decode()}">'
        for p in pictures
    )
    closing = f"{100 * e['error']:.3g} %" if e else "not sampled"
    page = f"""<!doctype html>
<html lang="en"><meta charset="utf-8"><title>{html.escape(s["title"] or "cdem run")}</title>
<style>body{{font:16px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em}}
img{{max-width:100%;display:block;margin:1em 0}}td{{padding:.1em 1.5em .1em 0}}
pre{{background:#f4f4f4;padding:1em;overflow:auto}}</style>
<h1>{html.escape(s["title"] or "cdem run")}</h1>
<p>Energy balance closes to <b>{closing}</b>.</p>
<pre>{html.escape(info(folder))}</pre>{missing}{images}
<h2>Energies at the end</h2><table>{rows}</table>
<p>Files beside this page: case.yaml, summary.json, histories.csv, frames.vtkhdf, surface.vtkhdf,
checkpoint.h5, run.log.</p></html>
"""
    path = folder / "report.html"
    path.write_text(page)
    return path
