"""The results of a fit: text, files and pictures."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.fit.find import Found
from cdem.fit.observed import Observed
from cdem.output.figures import pyplot
from cdem.whole_files import write_json, write_text

Floats = NDArray[np.float64]

BAND = (0.05, 0.5, 0.95)
"""Shares of the posterior in tables: the ends of the 90 % band, and the median."""
WRITTEN = 4000
"""Samples in posterior.csv."""
DRAWN = 400
"""Samples from which bands of observations are drawn."""


def facts(found: Found, title: str = "") -> dict[str, Any]:
    """All results except samples, ready for JSON."""
    bands = np.quantile(found.samples, BAND, axis=0).T
    best = found.values_of(found.posterior.best[None])[0]
    prior = np.array([one.value(np.array(BAND)) for one in found.runs.priors])
    correlation = np.atleast_2d(np.corrcoef(found.posterior.places.T))
    return {
        "title": title,
        "runs": len(found.runs.used),
        "components": found.emulators[0].basis.shape[0],
        "parameters": {
            one.name: {
                "low": float(bands[k, 0]),
                "median": float(bands[k, 1]),
                "high": float(bands[k, 2]),
                "best": float(best[k]),
                "before": {"low": float(prior[k, 0]), "high": float(prior[k, 2])},
                "correlations": {
                    other.name: float(correlation[k, j])
                    for j, other in enumerate(found.runs.priors)
                    if j != k
                },
            }
            for k, one in enumerate(found.runs.priors)
        },
        "observed": [
            {
                "name": one.name,
                "values": len(one.values),
                "deviation": one.deviation,
                "left_out_rms": part.left_out.rms,
                "left_out_in_90_band": part.left_out.inside,
                "misfit": misfit,
                "chance": chance,
            }
            for one, part, misfit, chance in zip(
                found.runs.observed, found.emulators, found.misfits, found.chances, strict=True
            )
        ],
        "notes": found.notes,
    }


def text(found: Found) -> str:
    """The results as text."""
    told = facts(found)
    lines = [f"note: {note}" for note in found.notes]
    lines.append(f"{told['runs']} runs")
    width = max(12, *(len(o["name"]) for o in told["observed"]))
    lines.append(
        f"  {'observed':<{width}}  values  deviation  runs left out: rms  in 90 % band  misfit/value"
    )
    for o in told["observed"]:
        lines.append(
            f"  {o['name']:<{width}}  {o['values']:6}  {o['deviation']:9.4g}  "
            f"{o['left_out_rms']:18.4g}  {100 * o['left_out_in_90_band']:10.0f} %  "
            f"{o['misfit'] / o['values']:12.3g}"
        )
    width = max(9, *(len(name) for name in told["parameters"]))
    lines.append(
        f"  {'parameter':<{width}}       5 %    median      95 %      best   before, 5 to 95 %"
    )
    for name, p in told["parameters"].items():
        before = f"{p['before']['low']:.4g} to {p['before']['high']:.4g}"
        lines.append(
            f"  {name:<{width}}  {p['low']:8.4g}  {p['median']:8.4g}  {p['high']:8.4g}  "
            f"{p['best']:8.4g}   {before}"
        )
    return "\n".join(lines)


def write(found: Found, folder: Path, title: str = "") -> list[Path]:
    """Write fit.json and posterior.csv into a folder; returns their paths."""
    paths = [folder / "fit.json", folder / "posterior.csv"]
    write_json(paths[0], facts(found, title))
    samples = found.samples
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([one.name for one in found.runs.priors])
    for row in samples[:: max(1, len(samples) // WRITTEN)]:
        writer.writerow([f"{value:.8g}" for value in row])
    write_text(paths[1], out.getvalue())
    return paths


def draw(found: Found, folder: Path, title: str = "") -> list[Path]:
    """Draw the parameters and the observations as PNG; returns their paths.

    Raises:
        CdemError: matplotlib is not installed.
    """
    plt = pyplot()
    paths = []
    for name, picture in (("parameters", _draw_parameters), ("observed", _draw_observed)):
        figure = picture(found, plt)
        figure.suptitle(title, fontsize=10)
        figure.tight_layout()
        figure.savefig(folder / f"{name}.png", dpi=110)
        plt.close(figure)
        paths.append(folder / f"{name}.png")
    return paths


def _draw_parameters(found: Found, plt: Any) -> Any:
    """Distributions of the parameters, and of all pairs."""
    count = len(found.runs.priors)
    size = max(4.5, 2.7 * count)
    figure, axes = plt.subplots(count, count, figsize=(size, size), squeeze=False)
    samples = found.samples
    for i, row in enumerate(found.runs.priors):
        for j, column in enumerate(found.runs.priors):
            panel = axes[i, j]
            if j > i:
                panel.set_axis_off()
                continue
            if i == j:
                _draw_one(panel, samples[:, i], row.value(np.linspace(0.001, 0.999, 4000)))
            else:
                panel.hist2d(samples[:, j], samples[:, i], bins=40, cmap="Blues")
                panel.plot(found.runs.used[:, j], found.runs.used[:, i], ".", color="gray", ms=3)
                if j == 0:
                    panel.set_ylabel(row.label, fontsize=8)
            if i == count - 1:
                panel.set_xlabel(column.label, fontsize=8)
            panel.tick_params(labelsize=7)
    return figure


def _draw_one(panel: Any, samples: Floats, before: Floats) -> None:
    """Histogram of a parameter with its 90 % band, over its distribution before."""
    panel.hist(before, bins=30, density=True, color="0.85", label="before")
    panel.hist(samples, bins=30, density=True, color="C0", alpha=0.8, label="fit")
    low, median, high = np.quantile(samples, BAND)
    panel.axvline(median, color="black", lw=1.2)
    for end in (low, high):
        panel.axvline(end, color="black", lw=0.8, ls="--")
    panel.set_yticks([])
    panel.set_title(f"{median:.4g} ({low:.4g} to {high:.4g})", fontsize=8)
    panel.legend(fontsize=7, frameon=False)


def _draw_observed(found: Found, plt: Any) -> Any:
    """Each observation beside the prediction of the fit."""
    places = found.posterior.places
    some = places[:: max(1, len(places) // DRAWN)]
    count = len(found.runs.observed)
    columns = min(3, count)
    rows = -(-count // columns)
    size = (4.6 * columns, 4.0 * rows)
    figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False)
    for panel in axes.ravel()[count:]:
        panel.set_axis_off()
    for panel, one, emulator in zip(
        axes.ravel(), found.runs.observed, found.emulators, strict=False
    ):
        predicted = emulator.at(some)
        if one.at is None:
            _draw_number(panel, one, predicted[:, 0])
        elif one.at.ndim == 1:
            _draw_times(panel, one, predicted)
        elif one.name.startswith("outline"):
            _draw_edge(panel, one, predicted.mean(axis=0))
        else:
            _draw_values(panel, one, predicted)
        panel.set_title(one.name, fontsize=9)
        panel.tick_params(labelsize=7)
    return figure


def _draw_number(panel: Any, one: Observed, predicted: Floats) -> None:
    panel.hist(predicted, bins=30, color="C0", alpha=0.8, label="fit", density=True)
    value, deviation = float(one.values[0]), one.deviation
    panel.axvspan(value - deviation, value + deviation, color="0.85", label="observed, 1 deviation")
    panel.axvline(value, color="black", lw=1.2)
    panel.set_yticks([])
    panel.legend(fontsize=7, frameon=False)


def _draw_times(panel: Any, one: Observed, predicted: Floats) -> None:
    low, median, high = np.quantile(predicted, BAND, axis=0)
    panel.fill_between(one.at, low, high, color="C0", alpha=0.3, lw=0, label="fit, 90 %")
    panel.plot(one.at, median, color="C0")
    style: dict[str, Any] = {"fmt": "o", "color": "black", "ms": 3, "lw": 0.8}
    panel.errorbar(one.at, one.values, yerr=one.deviation, label="observed", **style)
    panel.set(xlabel="time [s]", ylabel="distance from the crown [m]")
    panel.legend(fontsize=7, frameon=False)


def _draw_edge(panel: Any, one: Observed, beyond: Floats) -> None:
    """Points of the outline, coloured by the distance of the model's edge beyond them."""
    assert one.at is not None
    most = max(float(np.abs(beyond).max()), one.deviation)
    shown = panel.scatter(
        *one.at.T,
        c=beyond,
        cmap="RdBu_r",
        vmin=-most,
        vmax=most,
        s=16,
        edgecolors="0.5",
        linewidths=0.4,
    )
    bar = panel.figure.colorbar(shown, ax=panel, shrink=0.8)
    bar.set_label("model beyond the outline [m]", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    panel.set(xlabel="x, east [m]", ylabel="y, north [m]", aspect="equal")
    panel.ticklabel_format(style="plain", useOffset=False)


def _draw_values(panel: Any, one: Observed, predicted: Floats) -> None:
    low, median, high = np.quantile(predicted, BAND, axis=0)
    ends = np.array([median - low, high - median])
    style: dict[str, Any] = {"fmt": ".", "ms": 4, "lw": 0.5, "color": "C0"}
    panel.errorbar(one.values, median, yerr=ends, **style)
    most = max(float(one.values.max()), float(high.max()))
    panel.plot([0, most], [0, most], color="black", lw=0.8)
    panel.set(xlabel=f"observed [{one.unit}]", ylabel=f"fit, 90 % [{one.unit}]")
