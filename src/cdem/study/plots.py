"""Pictures of a study's table: lines, maps and tornadoes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.output.figures import pyplot
from cdem.output.scene import color
from cdem.study.results_table import Table
from cdem.study.schema import Plot
from cdem.study.study import Study
from cdem.whole_files import refuse_link

MOST_BARS = 20  # of a tornado; more cannot be read


def draw_all(table: Table, folder: Path) -> list[Path]:
    """Draw all plots of a study as PNG; returns their paths.

    Raises:
        CaseError: A plot needs numbers that the table lacks.
        CdemError: matplotlib is not installed.
    """
    if not table.study.plots:
        return []
    refuse_link(folder)
    folder.mkdir(exist_ok=True)
    plt = pyplot()
    paths = []
    for i, plot in enumerate(table.study.plots):
        figure, axes = plt.subplots(figsize=(6.0, 4.6))
        try:
            {"lines": _lines, "map": _map, "tornado": _tornado}[plot.kind](table, plot, axes)
        except ValueError as error:
            raise table.study.error(("plots", i), str(error)) from None
        axes.set_title(plot.title, fontsize=10)
        figure.tight_layout()
        paths.append(folder / f"{i + 1}-{plot.kind}-{_file_name(plot)}.png")
        figure.savefig(paths[-1])
        plt.close(figure)
    return paths


def _file_name(plot: Plot) -> str:
    names = [plot.result, *(n for n in (plot.x, plot.y) if n)]
    return "-".join("".join(c if c.isalnum() or c in "._" else "_" for c in n) for n in names)


def label_of(study: Study, name: str) -> str:
    """Label of a parameter on an axis."""
    parameter = study.parameters[name]
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    return parameter.label or f"{name}{unit}"


def _numbers(table: Table, name: str) -> NDArray[np.float64]:
    column = table.column(name)
    if not np.isfinite(column).any():
        raise ValueError(f"{name} has no numbers to draw")
    return column


def _lines(table: Table, plot: Plot, axes: Any) -> None:
    assert plot.x is not None
    x, z = _numbers(table, plot.x), _numbers(table, plot.result)
    beside = _numbers(table, plot.beside) if plot.beside else None
    keys = [str(row.get(plot.by)) for row in table.rows] if plot.by else [""] * len(x)
    groups = np.array(keys)
    for number, key in enumerate(dict.fromkeys(keys)):
        here = np.flatnonzero((groups == key) & np.isfinite(x) & np.isfinite(z))
        here = here[np.argsort(x[here], kind="stable")]
        shade = color(number)
        single = len(np.unique(x[here])) == len(here)  # one value of y for each x: a line
        name = key.removesuffix(".0") if plot.by else None
        if beside is not None:
            axes.plot(x[here], beside[here], "-" if single else "x", color=shade, lw=0.9, alpha=0.7)
        style = "o" if beside is not None or not single else "o-"
        axes.plot(x[here], z[here], style, color=shade, ms=4, lw=1.4, label=name)
    if beside is not None:
        axes.plot([], [], "-", color="gray", lw=0.9, label=plot.beside)
    axes.set(xlabel=label_of(table.study, plot.x), ylabel=plot.label or plot.result)
    if plot.by or plot.beside:
        heading = label_of(table.study, plot.by) if plot.by else None
        below = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.16), "ncols": 5}
        axes.legend(frameon=False, fontsize=8, title=heading, title_fontsize=8, **below)


def _map(table: Table, plot: Plot, axes: Any) -> None:
    assert plot.x is not None and plot.y is not None
    x, y, z = (_numbers(table, n) for n in (plot.x, plot.y, plot.result))
    there = np.isfinite(x) & np.isfinite(y) & np.isfinite(z)
    x, y, z = x[there], y[there], z[there]
    columns, rows = np.unique(x), np.unique(y)
    if len(x) == len(columns) * len(rows) and min(len(columns), len(rows)) > 1:
        grid = np.full((len(rows), len(columns)), np.nan)
        grid[np.searchsorted(rows, y), np.searchsorted(columns, x)] = z
        shown = axes.contourf(columns, rows, grid, levels=12, cmap="viridis")
        contours = axes.contour(columns, rows, grid, levels=12, colors="white", linewidths=0.5)
        axes.clabel(contours, fontsize=7)
        axes.plot(x, y, ".", color="black", ms=3)
    else:  # random values
        shown = axes.scatter(x, y, c=z, cmap="viridis", s=18)
    axes.figure.colorbar(shown, ax=axes, label=plot.label or plot.result)
    study = table.study
    axes.set(xlabel=label_of(study, plot.x), ylabel=label_of(study, plot.y))


def _tornado(table: Table, plot: Plot, axes: Any) -> None:
    bars = effects(table, plot.result)
    if not bars:
        raise ValueError("no parameter with numbers varies")
    name = plot.label or plot.result
    draw_bars(axes, {label_of(table.study, key): ends for key, ends in bars.items()})
    if table.study.sampling:
        mark_correlations(axes, name)
        return
    axes.use_sticky_edges = False  # or the longest bar would touch the frame
    axes.autoscale_view()
    axes.set(xlabel=name)
    for number, word in enumerate(("grows", "falls")):
        axes.bar(0, 0, color=color(number), label=f"{word} with the parameter")
    axes.legend(frameon=False, fontsize=8, loc="lower right")


def draw_bars(axes: Any, bars: dict[str, tuple[float, float]]) -> None:
    """Draw a tornado: bars by their label, each with its ends, the longest on top."""
    ranked = sorted(bars.items(), key=lambda bar: abs(bar[1][1] - bar[1][0]))[-MOST_BARS:]
    for place, (_, (low, high)) in enumerate(ranked):
        axes.barh(place, high - low, left=low, height=0.6, color=color(int(high <= low)))
    axes.set_yticks(range(len(ranked)), [label for label, _ in ranked])


def mark_correlations(axes: Any, name: str) -> None:
    """Label a tornado of rank correlations with a result."""
    axes.axvline(0, color="black", lw=0.8)
    axes.set(xlabel=f"rank correlation with {name}", xlim=(-1, 1))


def effects(table: Table, result: str) -> dict[str, tuple[float, float]]:
    """Effect of each parameter on a result.

    For random parameters (0, rank correlation of Spearman); for lists and grids the mean result at
    the parameter's smallest and largest value, over the runs in which it varies.
    """
    study, z = table.study, table.column(result)
    columns = {name: table.column(name) for name in study.parameters}
    found = {}
    for name, x in columns.items():
        here = np.isfinite(x) & np.isfinite(z)
        if study.combine == "one-at-a-time":
            others = [c for n, c in columns.items() if n != name]
            here &= np.all([(c == c[0]) | ~np.isfinite(c) for c in others] or [here], axis=0)
        values = x[here]
        if len(np.unique(values)) < 2:
            continue
        if study.sampling:
            found[name] = (0.0, rank_correlation(values, z[here]))
        else:
            ends = [z[here][values == end].mean() for end in (values.min(), values.max())]
            found[name] = (float(ends[0]), float(ends[1]))
    return found


def rank_correlation(x: NDArray[np.float64], z: NDArray[np.float64]) -> float:
    """Rank correlation of Spearman of two lists of numbers [1]; nan if one of them is constant."""
    if len(x) < 2 or min(np.ptp(x), np.ptp(z)) == 0:
        return float("nan")
    return float(np.corrcoef(_ranks(x), _ranks(z))[0, 1])


def _ranks(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rank of each value; equal values share their mean rank."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    return (last - 0.5 * (counts - 1))[inverse]
