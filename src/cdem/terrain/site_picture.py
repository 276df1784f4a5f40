"""The picture of `cdem site`: hillshade, depth of the body, and a section along its slide."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import BackendError

Floats = NDArray[np.float64]
SUN = np.array([-1.0, 1.0, 1.4])  # direction of the light: from the north-west
STEPS = 400  # points of the section


def draw(found: Any, path: Path) -> Path:
    """Draw a site (`cdem.terrain.site.Site`).

    Raises:
        BackendError: The extra `viz` is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise BackendError(f"pictures need matplotlib: pip install 'cdem[viz]' ({error})") from None
    body = found.bed is not None
    figure = Figure(figsize=(11 if body else 6.5, 5.6), layout="constrained")
    axes = figure.subplots(1, 2 if body else 1, squeeze=False, width_ratios=[1.1, 1][: 1 + body])[0]
    _map(figure, axes[0], found)
    if body:
        _section(axes[0], axes[1], found)
    figure.savefig(path, dpi=130)
    return path


def _map(figure: Any, axes: Any, found: Any) -> None:
    from matplotlib.ticker import MaxNLocator

    grid = found.ground
    extent = [grid.low[0], grid.high[0], grid.low[1], grid.high[1]]
    south, east = np.gradient(grid.values, grid.step[1], grid.step[0])
    normal = np.stack([-east, -south, np.ones_like(east)])
    shade = np.tensordot(SUN, normal, 1) / np.linalg.norm(normal, axis=0) / np.linalg.norm(SUN)
    axes.imshow(shade, cmap="gray", origin="lower", extent=extent, vmin=-0.2, vmax=1.0)
    x = grid.west + grid.step[0] * np.arange(grid.values.shape[1])
    y = grid.south + grid.step[1] * np.arange(grid.values.shape[0])
    lines = axes.contour(x, y, grid.values, 10, colors="0.25", linewidths=0.5)
    axes.clabel(lines, fmt="%.0f", fontsize=7)
    if found.bed is not None:
        depth = np.where(np.isfinite(found.bed.values), grid.values - found.bed.values, np.nan)
        image = axes.imshow(
            depth, cmap="YlOrRd", origin="lower", extent=extent, alpha=0.75, vmin=0.0
        )
        figure.colorbar(image, ax=axes, label="depth [m]", shrink=0.7)
    ring = np.concatenate([found.ring, found.ring[:1]])
    axes.plot(*ring.T, color="#1f4e9c", linewidth=1.6)
    axes.set_aspect("equal")
    axes.ticklabel_format(style="plain", useOffset=False)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.tick_params(labelsize=8)
    axes.set_xlabel(f"x [m]  {found.facts['crs'] or ''}", fontsize=9)
    axes.set_ylabel("y [m]", fontsize=9)


def _section(plan_axes: Any, axes: Any, found: Any) -> None:
    """Ground and sliding surface along the slide, through the deepest point."""
    grid, bed = found.ground, found.bed
    depth = np.nan_to_num(grid.values - bed.values, nan=-1.0)
    row, column = np.unravel_index(int(depth.argmax()), depth.shape)
    middle = np.array([grid.west + grid.step[0] * column, grid.south + grid.step[1] * row])
    azimuth = np.radians(found.facts["direction"])
    along = np.array([np.sin(azimuth), np.cos(azimuth)])
    reach = (found.ring - middle) @ along
    s = np.linspace(1.4 * reach.min(), 1.4 * reach.max(), STEPS)
    xy = middle + s[:, None] * along
    inside = ((xy > grid.low) & (xy < grid.high)).all(axis=1)
    s, xy = s[inside], xy[inside]
    ground, lower = grid(xy), bed(xy)
    axes.fill_between(s, lower, ground, color="#e8a55a", label="body")
    axes.plot(s, ground, color="0.15", linewidth=1.6, label="ground")
    axes.plot(s, lower, color="#b02020", linewidth=1.6, label="sliding surface")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(
        f"along the slide, towards {found.facts['direction']:03.0f} deg [m]", fontsize=9
    )
    axes.set_ylabel("height [m]", fontsize=9)
    axes.set_title(
        f"{found.facts['volume'] / 1e6:.3g} Mm3, {found.facts['depth']:.3g} m deep", fontsize=10
    )
    axes.tick_params(labelsize=8)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False)
    plan_axes.plot(*xy[[0, -1]].T, color="#b02020", linewidth=1.0, linestyle="--")
