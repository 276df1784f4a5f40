"""Pictures of a rockfall: tracks over the ground, reach, and the distributions at barriers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.output.figures import pyplot
from cdem.output.map_layers import colors_of, limits_of
from cdem.output.map_picture import SHADED, ground_grid, label_axes, scale_and_north, shade
from cdem.rockfall.maps import LAYERS
from cdem.rockfall.result import AtBarrier, Result
from cdem.rockfall.rockfall import file_name
from cdem.rockfall.statistics import LEVELS, quantile_of
from cdem.terrain.rasters import Raster

Floats = NDArray[np.float64]
Edges = tuple[float, float, float, float]
MARGIN = 0.06
"""Ground around the tracks, relative to the larger side."""
BINS = 20
MOST_TRACKS = 300
"""Tracks in a picture; more hide one another."""


def draw_all(result: Result, rasters: Mapping[str, Raster], folder: Path) -> list[Path]:
    """Draw rockfall.png and a picture of each barrier that blocks have passed.

    Raises:
        CdemError: matplotlib is not installed.
    """
    if not result.rows:
        return []
    plt = pyplot()
    paths = [_draw_map(result, rasters, folder / "rockfall.png", plt)]
    for b in result.barriers:
        if b.reached:
            path = folder / f"barrier_{file_name(b.barrier.name)}.png"
            paths.append(_draw_barrier(b, path, plt))
    return paths


def _edges(result: Result) -> Edges:
    """West, east, south and north of the tracks and lines with some ground around [m]."""
    ground = result.runs.ground
    places = [track.places[:, :2] for track in result.tracks]
    places += [np.array(b.barrier.line) for b in result.barriers]
    xy = np.concatenate(places)
    low, high = xy.min(axis=0), xy.max(axis=0)
    more = MARGIN * float((high - low).max())
    low, high = np.maximum(low - more, ground.low), np.minimum(high + more, ground.high)
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])


def _draw_map(result: Result, rasters: Mapping[str, Raster], path: Path, plt: Any) -> Path:
    edges = _edges(result)
    wide, high = edges[1] - edges[0], edges[3] - edges[2]
    beside = high > wide  # upright maps are placed side by side
    size = 5.0 if beside else 7.0
    each = float(np.clip(0.85 * size * high / wide, 0.3 * size, 1.9 * size))
    shape = (1, 2) if beside else (2, 1)
    figure, (left, right) = plt.subplots(
        *shape, figsize=(size * 1.15 * shape[1], (each + 0.5) * shape[0]), layout="constrained"
    )
    _ground(left, result, edges)
    _tracks(left, figure, result)
    _ground(right, result, edges)
    _raster(right, figure, rasters["reach_probability"])
    for axes, title in ((left, "tracks, by kinetic energy"), (right, "runs that reach a cell")):
        _lines(axes, result)
        axes.set_title(title, fontsize=9, loc="left")
        axes.set(xlim=edges[:2], ylim=edges[2:], aspect="equal")
        label_axes(axes)
        scale_and_north(axes, edges)
    figure.savefig(path, bbox_inches="tight")
    plt.close(figure)
    return path


def _ground(axes: Any, result: Result, edges: Edges) -> None:
    x, y = ground_grid(edges)
    step = float(x[1] - x[0])
    z = result.runs.ground.height(np.stack(np.meshgrid(x, y), axis=-1))
    shade(axes, Raster(x[0] - step / 2, y[0] - step / 2, step, z))


def _tracks(axes: Any, figure: Any, result: Result) -> None:
    """Tracks coloured by the energy, and stops."""
    from matplotlib.collections import LineCollection

    step = max(1, len(result.tracks) // MOST_TRACKS)
    pieces, energy = [], []
    for track in result.tracks[::step]:
        every = max(1, len(track.samples) // SHADED)
        xy, e = track.places[::every, :2], track.energy[::every]
        pieces.append(np.stack([xy[:-1], xy[1:]], axis=1))
        energy.append(0.5 * (e[1:] + e[:-1]) / 1e3)
    some = np.concatenate(energy)
    found = LineCollection(
        list(np.concatenate(pieces)), array=some, cmap="plasma", linewidths=0.7, alpha=0.8, zorder=2
    )
    found.set_clim(0.0, max(float(np.quantile(some, 0.99)), 1e-3))
    axes.add_collection(found)
    bar = figure.colorbar(found, ax=axes, shrink=0.7, pad=0.02, extend="max")
    bar.set_label("kinetic energy [kJ]", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    stops = np.array([track.places[-1] for track in result.tracks])
    axes.plot(*stops[:, :2].T, "o", ms=3, mfc="w", mec="k", mew=0.6, zorder=3, label="stops")


def _raster(axes: Any, figure: Any, raster: Raster) -> None:
    from matplotlib.colors import BoundaryNorm, ListedColormap

    layer, limits = LAYERS["reach_probability"], limits_of("reach_probability", raster.values)
    colors = ListedColormap(colors_of(layer, len(limits) - 1))
    image = axes.imshow(
        raster.values, origin="lower", extent=raster.extent, cmap=colors, alpha=0.85,
        norm=BoundaryNorm(limits, colors.N, clip=True), interpolation="nearest", zorder=1,
    )  # fmt: skip
    bar = figure.colorbar(image, ax=axes, shrink=0.7, pad=0.02, ticks=limits)
    bar.set_label("share of all runs [%]", fontsize=8)
    bar.ax.tick_params(labelsize=7)


def _lines(axes: Any, result: Result) -> None:
    halo = {"boxstyle": "round,pad=0.15", "fc": "w", "ec": "none", "alpha": 0.8}
    for b in result.barriers:
        line = np.array(b.barrier.line)
        axes.plot(*line.T, "-", color="C2", lw=2.0, zorder=4)
        axes.annotate(
            b.barrier.name, line[-1], (4, -10), textcoords="offset points", color="C2",
            fontsize=8, bbox=halo, zorder=6,
        )  # fmt: skip


def _draw_barrier(b: AtBarrier, path: Path, plt: Any) -> Path:
    """Histograms and cumulative curves of height and energy."""
    figure, all_axes = plt.subplots(2, 2, figsize=(9, 5.6), layout="constrained")
    measures = (
        ("top", "height of the top of the block above the ground [m]", 1.0, b.barrier.height),
        ("energy", "kinetic energy [kJ]", 1e-3, b.barrier.energy),
    )
    for (above, below), (name, title, scale, limit) in zip(all_axes.T, measures, strict=True):
        values = np.sort(b.first[name]) * scale
        above.hist(values, bins=min(BINS, max(5, len(values) // 4)), color="C0", alpha=0.7)
        above.set_ylabel("runs", fontsize=8)
        below.step(
            np.concatenate([values[:1], values]), np.linspace(0, 100, len(values) + 1), "C0-",
            where="post",
        )  # fmt: skip
        for level, color in zip(LEVELS, ("C1", "C3", "k"), strict=True):
            q = quantile_of(values, level)
            below.plot(q.value, 100 * level, "o", color=color, ms=4)
            label = f"{100 * level:g} %: {q.text()}"
            below.plot([q.low or q.value, q.high or q.value], [100 * level] * 2, color=color, lw=2, label=label)  # fmt: skip
        for axes in (above, below):
            if limit is not None:
                axes.axvline(limit * scale, color="C2", ls="--", lw=1.2)
            axes.set_xlim(left=min(0.0, float(values[0])))
            axes.tick_params(labelsize=7)
        below.set_xlabel(title, fontsize=8)
        below.set_ylabel("passages below [%]", fontsize=8)
        below.legend(fontsize=7, frameon=False, loc="lower right")
    dashed = ""
    if b.barrier.height is not None or b.barrier.energy is not None:
        dashed = "; dashed: height and capacity of the barrier"
    figure.suptitle(
        f"{b.barrier.name}: first passages of {b.reached} of {b.runs} runs{dashed}", fontsize=9
    )
    figure.savefig(path)
    plt.close(figure)
    return path
