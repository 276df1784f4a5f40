"""The results of a comparison as files and a picture."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.fit.agreement import WORDS, Agreement
from cdem.fit.monitored import COMPONENTS
from cdem.output.figures import pyplot
from cdem.whole_files import write_json, write_text

Floats = NDArray[np.float64]

MOST_LINES = 12
"""Points whose motion over time is drawn."""


def write(found: Agreement, folder: Path) -> list[Path]:
    """Write the table of residuals and the scores; returns their paths."""
    stem = found.monitored.path.stem
    paths = [folder / f"{stem}.csv", folder / f"{stem}.json"]
    shown = [k for k in range(4) if np.isfinite(found.monitored.moved[:, k]).any()]
    head = ["name", "x [m]", "y [m]", "z [m]", "time [s]"]
    for kind in ("monitored", "computed", "residual"):
        head += [f"{kind}_{COMPONENTS[k]} [m]" for k in shown]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(head)
    seen = found.monitored
    parts = (seen.moved, found.computed, found.residual)
    for row, name in enumerate(seen.names):
        numbers = [*seen.at[row], seen.time[row]]
        numbers += [part[row, k] for part in parts for k in shown]
        writer.writerow([name, *("" if np.isnan(v) else f"{v:.8g}" for v in numbers)])
    write_text(paths[0], out.getvalue())
    write_json(paths[1], found.as_dict())
    return paths


def draw(found: Agreement, path: Path) -> Path:
    """Draw monitored and computed displacements: as a map, against each other, and over time.

    Raises:
        CdemError: matplotlib is not installed.
    """
    plt = pyplot()
    timed = np.isfinite(found.monitored.time).any()
    figure, axes = plt.subplots(1, 3 if timed else 2, figsize=(15 if timed else 10.5, 4.8))
    _draw_map(found, axes[0])
    _draw_pairs(found, axes[1])
    if timed:
        _draw_times(found, axes[2])
    figure.suptitle(found.monitored.path.name, fontsize=10)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return path


def _draw_map(found: Agreement, panel: Any) -> None:
    """Arrows in plan, or the residual along the line of sight or upwards in colours."""
    seen = found.monitored
    last = _last(seen.names)
    at, moved, computed = seen.at[last], seen.moved[last], found.computed[last]
    if np.isfinite(moved[:, :2]).all(axis=1).any():
        both = np.concatenate([moved[:, :2], computed[:, :2]])
        longest = float(np.nanmax(np.linalg.norm(both, axis=1)))
        size = float(np.ptp(at[:, :2], axis=0).max()) or 1.0
        style: dict[str, Any] = {"angles": "xy", "scale_units": "xy"}
        scale = longest / (0.15 * size) or 1.0
        both_kinds = (("monitored", moved, "black", 0.012), ("computed", computed, "C1", 0.005))
        for number, (label, values, color, width) in enumerate(both_kinds):
            arrows = panel.quiver(
                *at[:, :2].T, *values[:, :2].T, color=color, scale=scale, width=width, **style
            )
            panel.quiverkey(
                arrows, 0.2 + 0.5 * number, 1.03, longest, f"{label}, {longest:.2g} m",
                labelpos="N", fontproperties={"size": 7},
            )  # fmt: skip
        middle = 0.5 * (at[:, :2].min(axis=0) + at[:, :2].max(axis=0))
        for axis, center in zip("xy", middle, strict=True):
            getattr(panel, f"set_{axis}lim")(center - 0.7 * size, center + 0.7 * size)
    else:
        k = 3 if np.isfinite(moved[:, 3]).any() else 2
        apart = computed[:, k] - moved[:, k]
        most = float(np.nanmax(np.abs(apart))) or 1.0
        size_of = 20 if len(at) < 500 else 4
        shown = panel.scatter(
            *at[:, :2].T, c=apart, cmap="RdBu_r", vmin=-most, vmax=most, s=size_of
        )
        bar = panel.figure.colorbar(shown, ax=panel, shrink=0.8)
        bar.set_label(f"computed less monitored, {WORDS[COMPONENTS[k]]} [m]", fontsize=8)
    panel.set(xlabel="x, east [m]", ylabel="y, north [m]", aspect="equal")
    panel.ticklabel_format(style="plain", useOffset=False)
    panel.tick_params(labelsize=7)


def _draw_pairs(found: Agreement, panel: Any) -> None:
    """Computed over monitored, a colour for each component."""
    low, high = 0.0, 0.0
    for k, key in enumerate(COMPONENTS):
        seen, computed = found.monitored.moved[:, k], found.computed[:, k]
        if not np.isfinite(seen).any():
            continue
        spread = found.monitored.deviation[:, k]
        panel.errorbar(
            seen, computed, xerr=np.where(np.isfinite(spread), spread, 0), fmt=".", ms=4, lw=0.6,
            label=WORDS[key],
        )  # fmt: skip
        low = min(low, float(np.nanmin(seen)), float(np.nanmin(computed)))
        high = max(high, float(np.nanmax(seen)), float(np.nanmax(computed)))
    panel.plot([low, high], [low, high], color="black", lw=0.8)
    panel.set(xlabel="monitored [m]", ylabel="computed [m]")
    panel.tick_params(labelsize=7)
    panel.legend(fontsize=7, frameon=False)


def _draw_times(found: Agreement, panel: Any) -> None:
    """Length of the displacement over time at the points that move most."""
    seen = found.monitored
    lengths = [np.sqrt(np.nansum(v**2, axis=1)) for v in (seen.moved, _where(found))]
    names = np.array(seen.names)
    unique = list(dict.fromkeys(seen.names))
    most = sorted(unique, key=lambda n: -float(lengths[0][names == n].max()))[:MOST_LINES]
    for number, name in enumerate(most):
        own = np.flatnonzero(names == name)
        own = own[np.argsort(seen.time[own], kind="stable")]
        color = f"C{number % 10}"
        panel.plot(seen.time[own], lengths[0][own], "o", ms=3, color=color, label=name)
        panel.plot(seen.time[own], lengths[1][own], "-", lw=1, color=color)
    panel.set(xlabel="time [s]", ylabel="displacement [m]: points monitored, lines computed")
    panel.tick_params(labelsize=7)
    panel.legend(fontsize=7, frameon=False)


def _where(found: Agreement) -> Floats:
    """Computed displacements of the components that are monitored."""
    return np.where(np.isfinite(found.monitored.moved), found.computed, np.nan)


def _last(names: list[str]) -> list[int]:
    """The last row of each point."""
    return list({name: row for row, name in enumerate(names)}.values())
