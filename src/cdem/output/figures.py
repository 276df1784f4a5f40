"""Histories and energies of a run drawn as PNG."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.output.reader import read_histories
from cdem.run.energy_terms import ENERGY_TERMS


def pyplot() -> Any:
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
    plt.rcParams["text.parse_math"] = False  # a name may contain dollar signs
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


def _save(plt: Any, figure: Any, path: Path) -> Path:
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)
    return path


def _plot_energies(plt: Any, folder: Path, time: NDArray, columns: dict[str, NDArray]) -> Path:
    figure, (upper, lower) = plt.subplots(
        2, 1, figsize=(6.4, 5.2), sharex=True, height_ratios=[3, 1]
    )
    for term in ENERGY_TERMS:
        values = columns.get(term.column, np.zeros(1))
        if np.abs(values).max() > 0:
            upper.plot(time, values, label=term.name, lw=1.4)
    upper.set(ylabel="energy [J]")
    upper.legend(frameon=False, fontsize=8, ncols=2)
    lower.plot(time, 100 * columns["energy error"], color="k", lw=1)
    lower.set(xlabel="time [s]", ylabel="closing error [%]")
    return _save(plt, figure, folder / "energies.png")


def _plot_history(
    plt: Any,
    folder: Path,
    name: str,
    members: list[str],
    time: NDArray,
    columns: dict[str, NDArray],
) -> Path:
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
