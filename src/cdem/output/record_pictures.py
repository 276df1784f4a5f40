"""Pictures of records, of amplification, and of the motions of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.output.figures import pyplot
from cdem.seismic.processing import GRAVITY, Processed

Floats = NDArray[np.float64]


def draw_record(path: Path, name: str, before: Processed, after: Processed) -> Path:
    """Draw acceleration, velocity and displacement of a record, as read and processed."""
    plt = pyplot()
    figure, rows = plt.subplots(3, 1, figsize=(6.4, 6.0), sharex=True)
    quantities = (("acceleration", "g", GRAVITY), ("velocity", "m/s", 1), ("displacement", "m", 1))
    for axes, (quantity, unit, factor) in zip(rows, quantities, strict=True):
        for record, label, colour in ((before, "as read", "0.65"), (after, "processed", "C0")):
            values = getattr(record, quantity) / factor
            axes.plot(record.times, values, color=colour, lw=0.9, label=label)
        axes.set(ylabel=f"{quantity} [{unit}]")
    rows[0].legend(frameon=False, fontsize=8)
    rows[0].set_title(name)
    rows[-1].set(xlabel="time [s]")
    return _save(plt, figure, path)


def draw_amplification(path: Path, frequency: Floats, ratios: Mapping[str, Floats]) -> Path:
    """Draw ratios over frequency."""
    plt = pyplot()
    figure, axes = plt.subplots(figsize=(6.4, 3.6))
    for name, ratio in ratios.items():
        axes.plot(frequency, ratio, lw=1.2, label=name)
    axes.set(xlabel="frequency [Hz]", ylabel="amplification [1]")
    axes.set_ylim(0, None)
    axes.legend(frameon=False, fontsize=8)
    return _save(plt, figure, path)


def draw_motion(path: Path, name: str, panels: Sequence[dict[str, Any]]) -> Path:
    """Draw panels of curves.

    Args:
        path: The PNG file.
        name: Title.
        panels: Each has the labels "x" and "y", whether it is "log", and curves (x, y) by name.
    """
    plt = pyplot()
    figure, rows = plt.subplots(len(panels), 1, figsize=(6.4, 2.5 * len(panels)), squeeze=False)
    for axes, panel in zip(rows[:, 0], panels, strict=True):
        for label, (x, y) in panel["curves"].items():
            axes.plot(x, y, lw=1.1, label=label)
        if panel["log"]:
            axes.set_xscale("log")
            axes.xaxis.set_major_formatter("{x:g}")
        axes.set(xlabel=panel["x"], ylabel=panel["y"])
        axes.legend(frameon=False, fontsize=8, ncols=2)
    rows[0, 0].set_title(name)
    return _save(plt, figure, path)


def _save(plt: Any, figure: Any, path: Path) -> Path:
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)
    return path
