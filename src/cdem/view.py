"""Looking at results: text, plots, pictures, ParaView files and a report, from the folder alone."""

from __future__ import annotations

import base64
import html
from pathlib import Path

import numpy as np

from cdem.errors import CdemError
from cdem.scene import can_draw, picture, render, snapshot
from cdem.series import SurfaceSeries, export, read_histories, read_summary

__all__ = [
    "SurfaceSeries",
    "can_draw",
    "export",
    "info",
    "picture",
    "plot",
    "pyplot",
    "read_histories",
    "read_summary",
    "render",
    "report",
    "snapshot",
]

ENERGY_COLUMNS = ("kinetic", "strain", "contact", "friction", "damping", "fracture", "external")


# ---------------------------------------------------------------------- text


def info(folder: Path) -> str:
    """The summary as a page of text."""
    s = read_summary(folder)
    lines = [
        f"{s['title'] or 'untitled case'}: {s['status']}",
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
        lines.append("  " + ", ".join(f"{k} {e[k]:.4g} J" for k in ENERGY_COLUMNS))
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
    return "\n".join(lines) + "\n"


# ---------------------------------------------------------------------- plots


def pyplot():
    """matplotlib's pyplot, ready to draw into files.

    Raises:
        CdemError: matplotlib is not installed.
    """
    try:
        import matplotlib
    except ImportError:
        raise CdemError("plots need matplotlib; pip install 'cdem[viz]'") from None
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"axes.spines.top": False, "axes.spines.right": False, "figure.dpi": 130})
    return plt


def plot(folder: Path) -> list[Path]:
    """Draw energies, unbalance and all histories; returns the PNG files."""
    plt = pyplot()
    folder = Path(folder)
    columns = read_histories(folder)
    time = columns.pop("time [s]")
    paths = [_plot_energies(plt, folder, time, columns)]
    if (columns["unbalance ratio"] > 0).any():
        figure, axes = plt.subplots(figsize=(6.4, 3.2))
        axes.semilogy(columns["step"], np.maximum(columns["unbalance ratio"], 1e-16))
        axes.set(xlabel="step", ylabel="unbalance ratio")
        paths.append(_save(plt, figure, folder / "unbalance.png"))
    names: dict[str, list[str]] = {}
    for column in columns:
        if "." in column:
            names.setdefault(column.split(".")[0], []).append(column)
    for name, members in names.items():
        paths.append(_plot_history(plt, folder, name, members, time, columns))
    return paths


def _save(plt, figure, path: Path) -> Path:
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)
    return path


def _plot_energies(plt, folder: Path, time, columns) -> Path:
    figure, (upper, lower) = plt.subplots(
        2, 1, figsize=(6.4, 5.2), sharex=True, height_ratios=[3, 1]
    )
    for name in ENERGY_COLUMNS:
        key = f"{name} energy [J]" if f"{name} energy [J]" in columns else f"{name} work [J]"
        if np.abs(columns[key]).max() > 0:
            upper.plot(time, columns[key], label=name, lw=1.4)
    upper.set(ylabel="energy [J]")
    upper.legend(frameon=False, fontsize=8, ncols=2)
    lower.plot(time, 100 * columns["energy error"], color="k", lw=1)
    lower.set(xlabel="time [s]", ylabel="closing error [%]")
    return _save(plt, figure, folder / "energies.png")


def _plot_history(plt, folder: Path, name: str, members: list[str], time, columns) -> Path:
    quantities: dict[str, list[str]] = {}
    for column in members:
        label = column.split(".", 1)[1]
        quantity = label.split(" [")[0]
        quantity = quantity[:-2] if quantity.endswith(("_x", "_y", "_z")) else quantity
        quantities.setdefault(quantity, []).append(column)
    figure, rows = plt.subplots(
        len(quantities), 1, figsize=(6.4, 2.4 * len(quantities) + 0.6), sharex=True, squeeze=False
    )
    for axes, (quantity, some) in zip(rows[:, 0], quantities.items(), strict=True):
        for column in some:
            part = column.split(".", 1)[1].split(" [")[0]
            axes.plot(time, columns[column], label=part[-1] if len(some) == 3 else None, lw=1.4)
        unit = some[0].rsplit("[", 1)[1].rstrip("]")
        axes.set(ylabel=f"{quantity.replace('_', ' ')} [{unit}]")
        if len(some) == 3:
            axes.legend(frameon=False, fontsize=8)
    rows[-1, 0].set(xlabel="time [s]")
    rows[0, 0].set_title(name)
    return _save(plt, figure, folder / f"history-{name}.png")


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
    rows = "".join(f"<tr><td>{k}</td><td>{e[k]:.6g} J</td></tr>" for k in ENERGY_COLUMNS if e)
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
