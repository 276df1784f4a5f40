"""Maps of a run-out as pictures: a layer over the hillshade of the ground, with scale and north."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.output.map_layers import LAYERS, Maps, colors_of
from cdem.terrain.rasters import Raster

Floats = NDArray[np.float64]

MARGIN = 0.08
"""Ground shown around the rock, relative to the larger side of the affected area."""
SHADED = 300
"""Points of the hillshade along the larger side."""
SUN = (315.0, 45.0)
"""Azimuth and height of the light, as usual on maps [deg]."""
DARKEST = 0.45
"""Grey of ground without light."""
CONTOURS = 9
"""Approximate number of contour lines of the ground."""
FLAT = 1e-3
"""Ground with height differences below this fraction of its width gets no contours."""
SHEET = ("thickness_max", "velocity_mean_max", "energy_area_max", "arrival")
"""Layers of maps.png."""
TICKS = 5
UNDER = 0.55
"""Top of the legend under a map [in]."""


@dataclass
class View:
    """Background and overlays of every map of one run-out.

    Attributes:
        west, east, south, north: Edges of the picture [m].
        ground: Heights of the ground in it [m], nan for missing ground.
        source: The thickness at the start.
        centre: Places of the centre of mass [m], shape (frames, 3).
        crown: Position of the crown [m].
        front: Position of the front [m].
        sections: x0, y0, x1, y1 of each [m].
        outline: Lines mapped in the field [m], each of shape (points, 2).
    """

    west: float
    east: float
    south: float
    north: float
    ground: Raster
    source: Raster
    centre: Floats
    crown: Floats
    front: Floats
    sections: Sequence[tuple[float, ...]]
    outline: Sequence[Floats] = ()

    @property
    def is_upright(self) -> bool:
        """Whether the picture is higher than wide."""
        return self.north - self.south > self.east - self.west


def frame_of(raster: Raster) -> tuple[float, float, float, float]:
    """West, east, south and north of a picture with a raster and some ground around it [m]."""
    west, east, south, north = raster.extent
    more = MARGIN * max(east - west, north - south)
    return west - more, east + more, south - more, north + more


def ground_grid(edges: tuple[float, float, float, float]) -> tuple[Floats, Floats]:
    """x and y of the points where the ground is shaded [m]."""
    west, east, south, north = edges
    step = max(east - west, north - south) / SHADED
    return np.arange(west + step / 2, east, step), np.arange(south + step / 2, north, step)


def draw_deposit(path: Path, maps: Maps, view: View, title: str, plt: Any) -> Path:
    """Draw the thickness at the end."""
    figure, axes = plt.subplots(figsize=_size(view, 7.5))
    bar = _draw(axes, figure, maps, "thickness_end", view)
    bar.set_label("thickness of solid rock [m]", fontsize=8)
    axes.set_title(title, fontsize=9, loc="left")
    axes.plot(*view.crown[:2], "k^", ms=5, label="crown")
    axes.plot(*view.front[:2], "C3v", ms=5, label="front")
    below = UNDER / (axes.get_position().height * figure.get_figheight())
    axes.legend(
        fontsize=7, frameon=False, ncols=3 if view.is_upright else 5, loc="upper left",
        bbox_to_anchor=(0, -below), borderaxespad=0,
    )  # fmt: skip
    return _save(figure, plt, path)


def draw_sheet(path: Path, maps: Maps, view: View, plt: Any) -> Path:
    """Draw largest thickness, velocity and energy, and arrival, on one sheet."""
    names = [name for name in SHEET if name in maps.rasters]
    wide, high = _size(view, 4.0 if view.is_upright else 6.0)
    columns = len(names) if view.is_upright else 2  # upright maps are placed side by side
    rows = -(-len(names) // columns)
    figure, all_axes = plt.subplots(
        rows, columns, figsize=(columns * wide, rows * high), squeeze=False
    )
    for axes, name in zip(all_axes.flat, names, strict=False):
        bar = _draw(axes, figure, maps, name, view)
        bar.set_label(f"[{LAYERS[name].unit}]", fontsize=8)
        axes.set_title(LAYERS[name].title, fontsize=9, loc="left")
    for axes in all_axes.flat[len(names) :]:
        axes.set_axis_off()
    figure.tight_layout()
    return _save(figure, plt, path)


def _save(figure: Any, plt: Any, path: Path) -> Path:
    figure.savefig(path, bbox_inches="tight")
    plt.close(figure)
    return path


def _size(view: View, wide: float) -> tuple[float, float]:
    """Width and height of a picture [in], with room for the scale beside the map."""
    ratio = (view.north - view.south) / (view.east - view.west)
    return wide, float(np.clip(0.75 * wide * ratio + 1.0, 0.4 * wide, 1.8 * wide))


def _draw(axes: Any, figure: Any, maps: Maps, name: str, view: View) -> Any:
    """One map and its colour bar: hillshade, layer in its classes, source, path, sections, outline, scale, north."""
    from matplotlib.colors import BoundaryNorm, ListedColormap

    shade(axes, view.ground)
    raster, limits = maps.rasters[name], maps.classes[name]
    colors = ListedColormap(colors_of(LAYERS[name], len(limits) - 1))
    image = axes.imshow(
        raster.values, origin="lower", extent=raster.extent, cmap=colors, alpha=0.85,
        norm=BoundaryNorm(limits, colors.N, clip=True), interpolation="nearest", zorder=1,
    )  # fmt: skip
    bar = figure.colorbar(image, ax=axes, shrink=0.7, pad=0.02, ticks=limits)
    bar.ax.tick_params(labelsize=7)
    axes.add_collection(_outline_of(view.source))
    axes.plot(*view.centre[:, :2].T, "C0-", lw=1.2, label="centre of mass")
    axes.plot([], [], "k:", lw=1.0, label="source")
    for number, (x0, y0, x1, y1) in enumerate(view.sections, start=1):
        axes.plot([x0, x1], [y0, y1], "C2-", lw=1.5)
        axes.annotate(str(number), (x1, y1), color="C2", fontsize=8)
    for k, line in enumerate(view.outline):
        axes.plot(*line.T, "-", color="m", lw=1.3, label=None if k else "mapped")
    axes.set(xlim=(view.west, view.east), ylim=(view.south, view.north), aspect="equal")
    label_axes(axes)
    scale_and_north(axes, (view.west, view.east, view.south, view.north))
    return bar


def _outline_of(raster: Raster) -> Any:
    """The edges between cells with a value and cells without."""
    from matplotlib.collections import LineCollection

    has = np.pad(np.isfinite(raster.values), 1).astype(int)
    row, column = np.nonzero(np.diff(has, axis=0)[:, 1:-1])
    along = np.stack([np.column_stack([column + k, row]) for k in (0, 1)], axis=1)
    row, column = np.nonzero(np.diff(has, axis=1)[1:-1])
    up = np.stack([np.column_stack([column, row + k]) for k in (0, 1)], axis=1)
    edges = np.array([raster.x, raster.y]) + raster.cell * np.concatenate([along, up])
    return LineCollection(list(edges), colors="k", linewidths=1.0, linestyles=":")


def shade(axes: Any, ground: Raster) -> None:
    """Draw hillshade and contour lines of the ground; white for missing ground."""
    z = ground.values
    if min(z.shape) < 2 or not np.isfinite(z).any():
        return
    axes.imshow(
        DARKEST + (1 - DARKEST) * hillshade(z, ground.cell), origin="lower", extent=ground.extent,
        cmap="gray", vmin=0, vmax=1, interpolation="bilinear",
    )  # fmt: skip
    if np.nanmax(z) - np.nanmin(z) > FLAT * ground.cell * max(z.shape):
        contours = axes.contour(
            *ground.middles(), z, CONTOURS, colors="0.35", linewidths=0.4, zorder=0.5
        )
        axes.clabel(contours, fontsize=6, fmt="%.10g")


def hillshade(z: Floats, cell: float) -> Floats:
    """Light on a surface from `SUN`, 0 to 1; nan for missing surface.

    Args:
        z: Heights [m], shape (rows, columns), from south to north.
        cell: Distance of neighbours [m].
    """
    to_north, to_east = np.gradient(z, cell)
    azimuth, height = np.radians(SUN)
    light = np.cos(height) * (-to_east * np.sin(azimuth) - to_north * np.cos(azimuth))
    light += np.sin(height)
    return np.clip(light / np.sqrt(1 + to_east**2 + to_north**2), 0.0, 1.0)


def label_axes(axes: Any) -> None:
    """Coordinates in full, on both sides of a map upright or not."""
    from matplotlib.ticker import MaxNLocator, StrMethodFormatter

    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(TICKS, steps=[1, 2, 5, 10]))
        axis.set_major_formatter(StrMethodFormatter("{x:.10g}"))
    axes.tick_params(labelsize=7)
    axes.set_xlabel("x, east [m]", fontsize=8)
    axes.set_ylabel("y, north [m]", fontsize=8)
    axes.spines[["top", "right"]].set_visible(True)


def scale_and_north(axes: Any, edges: tuple[float, float, float, float]) -> None:
    """A bar of a round length in the lower left corner, an arrow to the north in the upper left.

    Args:
        axes: A map.
        edges: Its west, east, south and north [m].
    """
    west, east, south, north = edges
    wide, high = east - west, north - south
    power = 10.0 ** np.floor(np.log10(wide / 4))
    length = float(max(f for f in (1, 2, 5) if f * power <= wide / 4) * power)
    x, y = west + 0.04 * wide, south + 0.05 * high
    halo = {"boxstyle": "round,pad=0.15", "fc": "w", "ec": "none", "alpha": 0.7}
    axes.plot([x, x + length], [y, y], "k-", lw=3, solid_capstyle="butt", zorder=5)
    axes.annotate(
        f"{length:g} m", (x + length / 2, y), (0, 5), textcoords="offset points", ha="center",
        fontsize=8, bbox=halo, zorder=6,
    )  # fmt: skip
    axes.annotate(
        "N", xy=(0.05, 0.97), xytext=(0.05, 0.85), xycoords="axes fraction", ha="center",
        fontsize=9, bbox=halo, zorder=6, arrowprops={"arrowstyle": "-|>", "color": "k", "lw": 1.5},
    )  # fmt: skip
