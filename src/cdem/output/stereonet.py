"""The picture of a survey of joints: equal-area nets of the lower hemisphere (Schmidt)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.joints.directions import dips, line
from cdem.joints.kinematics import MOST_FOR_PAIRS, Slope, intersections
from cdem.joints.sets import axis_density
from cdem.joints.survey import Survey, plane_text
from cdem.output.figures import pyplot

Floats = NDArray[np.float64]

LEVELS = (2.0, 4.0, 8.0, 16.0, 32.0)
"""Contours of density, as multiples of a uniform density."""
CELLS = 301
MOST_POINTS = 5000
"""Most points to draw; of more, evenly chosen ones are drawn."""
ZONE = "#d62728"


def project(vectors: Floats) -> tuple[Floats, Floats]:
    """Positions of lines on the net, in a circle of radius 1; north is up.

    Lambert's equal-area projection of the lower hemisphere: a line of plunge p lies
    sqrt(2) sin((90 deg - p) / 2) from the centre.

    Args:
        vectors: Unit vectors, up or down, shape (lines, 3).
    """
    down = vectors * np.where(vectors[:, 2:] > 0, -1.0, 1.0)
    scale = 1 / np.sqrt(np.maximum(1 - down[:, 2], 1.0))
    return down[:, 0] * scale, down[:, 1] * scale


def net() -> tuple[Floats, Floats]:
    """Coordinates along both axes [1], and the downward unit vector at each point of that grid.

    Outside the net the vectors are nan; shape (cells, cells, 3).
    """
    axis = np.linspace(-1, 1, CELLS)
    x, y = np.meshgrid(axis, axis)
    square = x**2 + y**2
    with np.errstate(invalid="ignore"):
        across = np.sqrt(2 - square)
    vectors = np.stack([x * across, y * across, square - 1], axis=-1)
    vectors[square > 1] = np.nan
    return axis, vectors


def density(vectors: Floats, axes: Floats) -> Floats:
    """Density of axes, as a multiple of the uniform density.

    The kernel is Fisher's distribution with kappa = 2 (1 + N / 9), at most 400: exponential Kamb
    contours (Vollmer 1995).

    Args:
        vectors: Directions to evaluate, unit vectors, shape (places, 3).
        axes: Unit vectors, shape (axes, 3).
    """
    kappa = np.array(min(2 * (1 + len(axes) / 9), 400.0))
    out = np.zeros(len(vectors))
    for part in np.array_split(axes, max(1, len(axes) // 200)):
        out += axis_density(np.abs(vectors @ part.T), kappa).sum(axis=1)
    return 2 * np.pi * out / len(axes)


def draw(survey: Survey, path: Path) -> Path:
    """Draw the joints and, for a slope, its failure zones; returns the path.

    Raises:
        CdemError: matplotlib is not installed.
    """
    plt = pyplot()
    if survey.slope is None:
        figure, axes = plt.subplots(figsize=(5.6, 6.0))
        _draw_sets(survey, axes)
    else:
        figure, four = plt.subplots(2, 2, figsize=(9.6, 10.4))
        _draw_sets(survey, four[0, 0])
        _draw_zones(survey, survey.slope, four.ravel()[1:])
    figure.tight_layout()
    figure.savefig(path, dpi=100)
    plt.close(figure)
    return path


def _frame(axes: Any, title: str) -> None:
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set(xlim=(-1.18, 1.18), ylim=(-1.12, 1.16))
    turn = np.radians(np.arange(0, 361, 2))
    axes.plot(np.sin(turn), np.cos(turn), color="black", lw=1.2)
    for azimuth in range(0, 360, 10):
        inner = 0.95 if azimuth % 90 == 0 else 0.98
        x, y = np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))
        axes.plot([inner * x, x], [inner * y, y], color="black", lw=0.7)
    for letter, x, y in (("N", 0, 1.06), ("E", 1.08, 0), ("S", 0, -1.07), ("W", -1.08, 0)):
        axes.text(x, y, letter, ha="center", va="center", fontsize=9)
    axes.plot(0, 0, "+", color="black", ms=6, mew=0.7)
    axes.set_title(title, fontsize=10)


def _great_circle(axes: Any, dip: float, direction: float, **style: Any) -> None:
    """Draw all lines that lie in a plane."""
    along = line(np.array(direction - 90.0), np.array(0.0))
    down = line(np.array(direction), np.array(dip))
    turn = np.radians(np.linspace(0, 180, 91))
    x, y = project(np.cos(turn)[:, None] * along + np.sin(turn)[:, None] * down)
    axes.plot(x, y, **style)


def _some(items: Floats) -> Floats:
    """At most `MOST_POINTS` rows, evenly chosen."""
    if len(items) <= MOST_POINTS:
        return items
    return items[np.linspace(0, len(items) - 1, MOST_POINTS).astype(int)]


def _draw_sets(survey: Survey, axes: Any) -> None:
    sets, normals = survey.fit.sets, survey.measured.normals
    _frame(axes, f"{survey.source}: {len(normals)} poles")
    axis, vectors = net()
    inside = np.isfinite(vectors[..., 0])
    values = np.full(inside.shape, np.nan)
    values[inside] = density(vectors[inside], _some(normals))
    levels = [0.0, *LEVELS, 1e9]
    shown = axes.contourf(
        axis, axis, values, levels=levels, cmap="Greys", alpha=0.45, norm=_steps()
    )
    shown.set_edgecolor("face")
    member = survey.fit.membership.argmax(axis=1)
    for k, s in enumerate(sets):
        x, y = project(_some(normals[member == k]))
        label = f"{s.name}  {plane_text(s.dip, s.dip_direction)}"
        axes.plot(x, y, "o", color=f"C{k}", ms=2.6, mew=0, label=label)
        _great_circle(axes, s.dip, s.dip_direction, color=f"C{k}", lw=1.6)
    x, y = project(_some(normals[member == len(sets)]))
    axes.plot(x, y, "x", color="0.35", ms=3.5, mew=0.8, label="no set" if len(x) else None)
    if survey.slope:
        slope = survey.slope
        label = f"slope  {plane_text(slope.dip, slope.dip_direction)}"
        style = {"color": "black", "lw": 2.0, "label": label}
        _great_circle(axes, slope.dip, slope.dip_direction, **style)
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, 0.03), ncols=2)
    axes.text(
        -1.12,
        1.08,
        f"density: {', '.join(f'{v:g}' for v in LEVELS)}\ntimes the uniform density",
        fontsize=7,
        va="top",
    )


def _steps() -> Any:
    """Equal steps of grey between the levels."""
    from matplotlib.colors import BoundaryNorm

    return BoundaryNorm([0.0, *LEVELS, 1e9], 256)


def _draw_zones(survey: Survey, slope: Slope, panels: Any) -> None:
    assert survey.shares is not None
    normals, fail = survey.measured.normals, survey.shares
    x, y = project(normals)
    for axes, name, test, share in (
        (panels[0], "planar sliding", slope.planar, fail.planar),
        (panels[1], "toppling", slope.toppling, fail.toppling),
    ):
        _frame(axes, f"{name}: {100 * share:.0f} % of poles")
        _zone(axes, lambda v, test=test: test(*dips(v)))  # type: ignore[misc]
        _points(axes, x, y, test(*dips(normals)), 3.0)
        _great_circle(axes, slope.dip, slope.dip_direction, color="black", lw=2.0)
    plunge, trend = intersections(normals)
    pairs = f"{len(plunge):,} intersections"
    pairs += f" of {MOST_FOR_PAIRS} poles" if len(normals) > MOST_FOR_PAIRS else ""
    _frame(panels[2], f"wedges: {100 * fail.wedge:.0f} % of {pairs}")
    _zone(panels[2], lambda v: slope.wedge(*_lines(v)))
    lines = _some(np.column_stack([plunge, trend]))
    x, y = project(line(lines[:, 1], lines[:, 0]))
    _points(panels[2], x, y, slope.wedge(lines[:, 0], lines[:, 1]), 1.2)
    _great_circle(panels[2], slope.dip, slope.dip_direction, color="black", lw=2.0)
    for k, s in enumerate(survey.fit.sets):
        _great_circle(panels[2], s.dip, s.dip_direction, color=f"C{k}", lw=1.6)


def _lines(vectors: Floats) -> tuple[Floats, Floats]:
    """Plunge and trend [deg] of downward unit vectors."""
    plunge = np.degrees(np.arcsin(np.clip(-vectors[:, 2], -1, 1)))
    return plunge, np.degrees(np.arctan2(vectors[:, 0], vectors[:, 1])) % 360


def _zone(axes: Any, test: Callable[[Floats], NDArray[np.bool_]]) -> None:
    """Shade the zone where a test holds for a downward vector."""
    axis, vectors = net()
    inside = np.isfinite(vectors[..., 0])
    held = np.zeros(inside.shape)
    held[inside] = test(vectors[inside])
    axes.contourf(axis, axis, held, levels=[0.5, 2], colors=[ZONE], alpha=0.18)
    axes.contour(axis, axis, held, levels=[0.5], colors=[ZONE], linewidths=1.0)


def _points(axes: Any, x: Floats, y: Floats, hit: NDArray[np.bool_], size: float) -> None:
    axes.plot(x[~hit], y[~hit], "o", color="0.6", ms=size, mew=0)
    axes.plot(x[hit], y[hit], "o", color=ZONE, ms=size, mew=0)
