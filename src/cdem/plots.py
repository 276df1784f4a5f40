"""Histories as figures: energies, unbalance, broken springs, and what the case asked to follow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.load import load_histories, load_summary

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Columns = Mapping[str, NDArray[np.float64]]

ENERGIES = {
    "kinetic energy [J]": ("#0072b2", "-"),
    "strain energy [J]": ("#009e73", "-"),
    "contact energy [J]": ("#56b4e9", "-"),
    "friction work [J]": ("#d55e00", "-"),
    "damping work [J]": ("#e69f00", "-"),
    "fracture work [J]": ("#cc79a7", "-"),
    "external work [J]": ("black", "--"),
}
"""Columns of the ledger: colour (the Okabe-Ito set, told apart by everybody) and line."""
AXIS_COLORS = {"x": "#0072b2", "y": "#009e73", "z": "#d55e00"}
PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"))
STYLE: Any = {
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": True,
    "axes.grid": True,
    "axes.labelsize": 9,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 9,
    "figure.constrained_layout.use": True,
    "font.size": 9,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "savefig.dpi": 200,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
}
WIDTH = 6.3  # of a figure [inch]


def plot(folder: Path | str) -> list[Path]:
    """Draw histories.csv.

    Args:
        folder: Result folder.

    Returns:
        PNG files in the folder: energies, unbalance (static stages only), broken springs (if any
        broke), and one for each history of the case.

    Raises:
        CdemError: There are no histories, or matplotlib is missing.
    """
    folder = Path(folder)
    columns = load_histories(folder)
    try:
        import matplotlib
    except ImportError:
        raise CdemError("plots need matplotlib; pip install 'cdem[viz]'") from None
    stages = _stages(folder)
    with matplotlib.rc_context(STYLE):
        paths = [_plot_energies(folder, columns, stages)]
        static = _static_rows(columns, stages)
        if (columns["unbalance ratio"][static] > 0).any():
            paths.append(_plot_unbalance(folder, columns, static))
        if columns["broken tension"].any() or columns["broken shear"].any():
            paths.append(_plot_broken(folder, columns, stages))
        for name, members in _histories(columns).items():
            paths.append(_plot_history(folder, name, members, columns, stages))
    return paths


def _figure(height: float, rows: int = 1, **settings: Any) -> tuple[Figure, Sequence[Axes]]:
    # not through pyplot, which would change the backend of a notebook
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height))
    return figure, figure.subplots(rows, 1, squeeze=False, **settings)[:, 0]


def _save(figure: Figure, path: Path) -> Path:
    figure.savefig(path)
    return path


# ---------------------------------------------------------------------- stages


def _stages(folder: Path) -> list[dict[str, Any]]:
    """Stages of the summary with "end", the time at which each ended [s]; none while it runs."""
    try:
        stages = load_summary(folder)["stages"]
    except CdemError:
        return []
    ends = np.cumsum([stage["time"] for stage in stages])
    return [stage | {"end": end} for stage, end in zip(stages, ends, strict=True)]


def _static_rows(columns: Columns, stages: list[dict[str, Any]]) -> NDArray[np.bool_]:
    """Rows within static stages; all of them while the stages are not known."""
    if not stages:
        return np.ones(len(columns["step"]), bool)
    ends = np.cumsum([stage["steps"] for stage in stages])
    static = np.array([stage["mode"] == "static" for stage in stages] + [False])
    return static[np.searchsorted(ends, columns["step"])]


def _mark_stages(axes: Sequence[Axes], columns: Columns, stages: list[dict[str, Any]]) -> None:
    """A line where a stage ends, and the names of the stages above the first of the axes."""
    if len(stages) < 2:
        return
    last = float(columns["time [s]"].max())
    start = 0.0
    for stage in stages:
        end = min(stage["end"], last)
        if start > 0:
            for some in axes:
                some.axvline(start, color="#999999", lw=0.8, ls=":")
        if end - start > 0.08 * last:  # else there is no room for the name
            axes[0].text(
                (start + end) / 2 / last,
                1.02,
                stage["name"],
                transform=axes[0].transAxes,
                ha="center",
                fontsize=8,
                color="#666666",
            )
        start = end
    for some in axes:
        some.set_xlim(0, last)


# ---------------------------------------------------------------------- figures


def scaled(largest: float, unit: str) -> tuple[float, str]:
    """Divisor and unit with a prefix that make a value readable: 2.5e6 J is 2.5 MJ."""
    for size, prefix in PREFIXES:
        if largest >= size:
            return size, prefix + unit
    return 1.0, unit


def _plot_energies(folder: Path, columns: Columns, stages: list[dict[str, Any]]) -> Path:
    figure, (upper, lower) = _figure(4.6, 2, sharex=True, height_ratios=[3, 1])
    time = columns["time [s]"]
    drawn = {n: s for n, s in ENERGIES.items() if np.nanmax(np.abs(columns[n])) > 0}
    largest = max((np.nanmax(np.abs(columns[n])) for n in drawn), default=1.0)
    size, unit = scaled(largest, "J")
    for name, (color, line) in drawn.items():
        upper.plot(time, columns[name] / size, color=color, ls=line, label=name.rsplit(" ", 1)[0])
    upper.set_ylabel(f"energy [{unit}]")
    upper.legend(ncols=2)
    lower.plot(time, 100 * columns["energy error"], color="black", lw=1)
    lower.axhline(0, color="#999999", lw=0.6)
    lower.set_ylabel("closing error [%]")
    lower.set_xlabel("time [s]")
    _mark_stages((upper, lower), columns, stages)
    figure.align_ylabels()
    return _save(figure, folder / "energies.png")


def _plot_unbalance(folder: Path, columns: Columns, rows: NDArray[np.bool_]) -> Path:
    figure, (axes,) = _figure(2.8)
    ratio = np.where(rows, columns["unbalance ratio"], np.nan)  # gaps where a stage is dynamic
    axes.semilogy(columns["step"][rows], ratio[rows], color="#0072b2")
    axes.set_xlabel("step")
    axes.set_ylabel("unbalance ratio [1]")
    return _save(figure, folder / "unbalance.png")


def _plot_broken(folder: Path, columns: Columns, stages: list[dict[str, Any]]) -> Path:
    figure, (axes,) = _figure(2.8)
    for kind, color in (("tension", "#0072b2"), ("shear", "#d55e00")):
        axes.plot(columns["time [s]"], columns[f"broken {kind}"], color=color, label=f"in {kind}")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("broken springs")
    axes.legend()
    _mark_stages((axes,), columns, stages)
    return _save(figure, folder / "broken.png")


def _histories(columns: Columns) -> dict[str, dict[str, list[str]]]:
    """Columns such as "block.velocity_x [m/s]" by history and by quantity with unit."""
    found: dict[str, dict[str, list[str]]] = {}
    for column in columns:
        label, _, unit = column.partition(" [")
        name, dot, quantity = label.rpartition(".")
        if not dot:
            continue
        if quantity.endswith(("_x", "_y", "_z")):
            quantity = quantity[:-2]
        title = f"{quantity.replace('_', ' ')} [{unit}"
        found.setdefault(name, {}).setdefault(title, []).append(column)
    return found


def _plot_history(
    folder: Path,
    name: str,
    members: dict[str, list[str]],
    columns: Columns,
    stages: list[dict[str, Any]],
) -> Path:
    figure, rows = _figure(1.9 * len(members) + 0.7, len(members), sharex=True)
    for axes, (title, some) in zip(rows, members.items(), strict=True):
        size, unit = 1.0, None
        if title.endswith("[J]") or title.endswith("[N]"):
            largest = max(np.nanmax(np.abs(columns[column])) for column in some)
            size, unit = scaled(largest, title[-2])
        for column in some:
            axis = column.partition(" [")[0][-1] if len(some) > 1 else None
            color = AXIS_COLORS.get(axis or "", "black")
            axes.plot(columns["time [s]"], columns[column] / size, color=color, label=axis)
        axes.set_ylabel(title if unit is None else f"{title[: title.rindex('[')]}[{unit}]")
        if len(some) > 1:
            axes.legend(ncols=3)
    rows[-1].set_xlabel("time [s]")
    figure.suptitle(name, fontsize=9, fontweight="bold")
    _mark_stages(rows, columns, stages)
    figure.align_ylabels()
    return _save(figure, folder / f"history-{_safe(name)}.png")


def _safe(name: str) -> str:
    """The name of a history as part of a file name."""
    return "".join(c if c.isalnum() or c in "-_." else "_" for c in name)
