"""Forces on bodies apart from strength: weight, shaking, and water on their planes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.terrain.heights import Grid
from cdem.terrain.rasters import read_grid
from cdem.units import describe, to_number

Floats = NDArray[np.float64]

UNIT_WATER = 9810.0
"""Unit weight of water [N/m3]."""
GRIDS = (".asc", ".grd", ".tif", ".tiff", ".vrt")


@dataclass(frozen=True)
class Loads:
    """Shaking, and water in joints; at rest and dry by default.

    Attributes:
        kh: Horizontal acceleration of the ground in the direction in which a body slides [g].
        kv: Vertical acceleration that makes bodies lighter [g].
        share: Share of the height between plane and ground that is filled with water, or 1 with
            `level` [1].
        level: Heights of a water table in the cells of the map, nan where dry [m].
        crack: Depth of a tension crack behind the crest of profiles [m]; 0 for none.
    """

    kh: float = 0.0
    kv: float = 0.0
    share: float = 0.0
    level: Floats | None = None
    crack: float = 0.0

    @property
    def is_wet(self) -> bool:
        """Whether there is any water."""
        return self.share > 0

    @property
    def is_shaken(self) -> bool:
        """Whether the ground accelerates."""
        return self.kh != 0 or self.kv != 0

    def heads(self, at: Any, bed: Floats, thickness: Floats) -> Floats:
        """Height of the water table above the bed, at most the ground; for a share of 1 [m].

        Args:
            at: Index of cells of the map.
            bed: Height of the bed at these cells [m].
            thickness: Height of the ground above the bed [m].
        """
        if self.level is None:
            return thickness
        return np.nan_to_num(np.clip(self.level[at] - bed, 0.0, thickness))

    def heads_at(self, ground: Grid, xy: Floats, bed: Floats, thickness: Floats) -> Floats:
        """The same at points of the plan, linear between cells, shape (points,).

        Args:
            ground: The grid of the map.
            xy: Points [m], shape (points, 2).
            bed: Height of the bed [m].
            thickness: Height of the ground above the bed [m]; negative where it lies below.
        """
        if self.level is None:
            return thickness
        water = replace(ground, values=self.level)(xy) - bed
        return np.nan_to_num(np.clip(water, 0.0, np.maximum(thickness, 0.0)))

    def text(self) -> str:
        """Water and shaking in words."""
        words = ["dry"]
        if self.is_wet and self.level is not None:
            words = ["with a water table"]
        elif self.is_wet:
            words = [f"water table at {self.share:g} of the height between plane and ground"]
        if self.crack:
            words.append(f"tension crack of {self.crack:g} m in profiles")
        if self.is_shaken:
            words.append(f"shaken by {self.kh:g} g in the direction of sliding, {self.kv:g} g up")
        return ", ".join(words)


def force_on(
    weight: Floats,
    heading: Floats,
    kh: Any = 0.0,
    kv: Any = 0.0,
    push: Any = 0.0,
    lift: Any = 0.0,
    normals: Floats | None = None,
) -> Floats:
    """Sum of the forces on bodies but those of the rock below [N], shape (..., 3).

    Args:
        weight: Weight of each body [N], shape (...).
        heading: Horizontal unit vector of shaking, shape (2,).
        kh, kv: Accelerations of `Loads` [g], shape (...).
        push: Force of the water in a tension crack along the heading [N], shape (...).
        lift: Force of the water on each plane [N], shape (..., planes).
        normals: Unit normals of these planes, that point into the bodies, shape (planes, 3).
    """
    weight = np.asarray(weight, float)
    across = kh * weight + push
    up = (kv - 1.0) * weight
    force = np.stack(np.broadcast_arrays(across * heading[0], across * heading[1], up), axis=-1)
    return force if normals is None else force + lift @ normals


def read_water(text: str | None, ground: Grid) -> tuple[float, Floats | None, list[str]]:
    """Read the water of an option: a share, a height with its unit, or a grid of heights.

    Returns:
        Share and level of `Loads`, and messages for the user.

    Raises:
        CaseError: It is none of them; names the option.
    """
    if text is None:
        return 0.0, None, []
    if Path(text).suffix.lower() in GRIDS:
        return _from_grid(Path(text), ground)
    try:
        share = float(text)
    except ValueError:
        share = np.nan
    if 0 <= share <= 1:
        return share, None, []
    try:
        if not np.isnan(share):
            raise ValueError("a number must lie in 0 to 1")
        height = to_number(text, "m")
    except ValueError as error:
        raise CaseError(
            f"--water {text[:60]}: {error}; give the filled share of the height between plane and "
            "ground (0 to 1), a height with its unit ('1200 m'), or a grid of heights (.tif, .asc)"
        ) from None
    level = np.full(ground.values.shape, height)
    return 1.0, level, _notes(f"--water {text}", level, ground)


def _from_grid(path: Path, ground: Grid) -> tuple[float, Floats | None, list[str]]:
    grid = read_grid(path)
    rows, columns = ground.values.shape
    x = ground.west + ground.step[0] * np.arange(columns)
    y = ground.south + ground.step[1] * np.arange(rows)
    xy = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    inside = ((xy >= grid.low) & (xy <= grid.high)).all(axis=1)
    # beside a cell without a height, the cell itself counts
    cell = np.rint((xy - [grid.west, grid.south]) / grid.step).astype(int)
    j, i = np.clip(cell, 0, np.array(grid.values.shape[::-1]) - 1).T
    between = grid(xy)
    level = np.where(np.isnan(between), grid.values[i, j], between)
    level = np.where(inside, level, np.nan).reshape(rows, columns)
    if not np.isfinite(level).any():
        raise CaseError(
            f"{path}: has no height of the water table on the map; are both in one projection?"
        )
    return 1.0, level, _notes(str(path), level, ground)


def _notes(name: str, level: Floats, ground: Grid) -> list[str]:
    """Messages on a water table: dry cells, cells above the ground, none of use."""
    notes = []
    missing = float(np.isnan(level).mean())
    if missing:
        notes.append(f"{name}: no water table in {100 * missing:.1f} % of the map: dry there")
    with np.errstate(invalid="ignore"):
        above = float((level > ground.values).mean())
    if above:
        notes.append(
            f"{name}: above the ground in {100 * above:.1f} % of the map; the ground counts there"
        )
    return notes


def number_of(option: str, text: object, low: float, high: float) -> float:
    """A number of an option within limits.

    Raises:
        CaseError: It lies outside.
    """
    try:
        value = to_number(text, "1")
    except ValueError as error:
        raise CaseError(f"{option}: {error}") from None
    if not low <= value <= high:
        raise CaseError(f"{option} must lie in {low:g} to {high:g}, got {describe(text)}")
    return value
