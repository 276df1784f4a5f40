"""The rockfall file: terrain, starts, blocks, ground and barriers, checked like a case."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import PrivateAttr

from cdem.case.document import Document
from cdem.case.source import Keys
from cdem.errors import CaseError
from cdem.model.slips import DEEP
from cdem.rockfall.blocks import Wish
from cdem.rockfall.fall import GRAVITY, Physics
from cdem.rockfall.ground import Ground
from cdem.rockfall.schema import Drawn, OutlineFile, RockfallParts, check_drawn
from cdem.rockfall.starts import Starts, triangles_of
from cdem.study.sampling import quantile
from cdem.terrain.clouds import KINDS
from cdem.terrain.features import read_features
from cdem.terrain.files import read_outline
from cdem.terrain.heights import Grid, Smooth, extra
from cdem.terrain.landslide import Landslide
from cdem.terrain.rasters import Box, read_raster
from cdem.units import coordinates, to_number

Floats = NDArray[np.float64]
LEAST = 1e-12
"""Probability below which a drawn value is not checked."""
SAMPLES = 4.0
"""Samples while the fastest possible block crosses a cell of the maps."""
LONGEST_SAMPLE = 0.02
"""Longest time between two samples [s]."""
KINDS_OF_STARTS = ("Point", "LineString", "Polygon")
FARTHEST = 1e9
"""Extent of a terrain that is used whole [m]."""


class Rockfall(Document, RockfallParts):
    """The input of `cdem rockfall`.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: problem.
    """

    kind = "rockfall"

    _site: Landslide | None = PrivateAttr(None)

    def _contradictions(self) -> Iterator[tuple[Keys, str]]:
        yield from _problems(self)

    @property
    def site(self) -> Landslide:
        """The terrain as `cdem mesh` reads it, with its projection and notes."""
        if self._site is None:
            extent = self.extent
            x, y = (extent.x, extent.y) if extent else ([-FARTHEST, FARTHEST],) * 2
            data = {
                "crs": self.crs,
                "terrain": self.terrain.model_dump(exclude_unset=True),
                "extent": {"x": list(x), "y": list(y), "base": -FARTHEST},
                "sizes": {"body": 1.0, "far": 1.0},
            }
            self._site = Landslide.of(data, self._source)
        return self._site

    @property
    def system(self) -> str | None:
        """Projection of all places, or None."""
        return self.site.system

    def make_ground(self) -> Ground:
        """The ground with its zones.

        Raises:
            CaseError: The terrain cannot be read, or a zone does not meet it.
        """
        grid = self._grid()
        rows, columns = grid.values.shape
        if min(rows, columns) < 3:
            raise self.error("terrain", f"has {columns} x {rows} points here; at least 3 x 3")
        zone = np.zeros((rows - 1, columns - 1), np.int16)
        x = grid.west + grid.step[0] * (np.arange(columns - 1) + 0.5)
        y = grid.south + grid.step[1] * (np.arange(rows - 1) + 0.5)
        middles = np.meshgrid(x, y)
        for number in range(len(self.ground.zones), 0, -1):  # the first counts
            shapely = extra("shapely", "a zone of the ground")
            inside = shapely.contains_xy(shapely.Polygon(self._ring(number - 1)), *middles)
            if not inside.any():
                raise self.error(
                    f"ground.zones.{number - 1}.area", "holds the middle of no cell of the terrain"
                )
            zone[inside] = number
        return Ground(grid.west, grid.south, np.array(grid.step), grid.values, zone)

    def _grid(self) -> Grid:
        _ = self.site.projection  # its own errors name their place
        whole = self._box()
        with self._source.blame("terrain.grid"):
            grid = self.site.grid_within(self.terrain, whole)
        rows, columns = grid.values.shape
        x = grid.west + grid.step[0] * np.arange(columns)
        y = grid.south + grid.step[1] * np.arange(rows)
        if self.terrain.smooth:
            xy = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
            grid.values = Smooth(grid, self.terrain.smooth)(xy).reshape(rows, columns)
        if self.extent is None:
            return grid
        j = np.flatnonzero((x >= whole[0][0]) & (x <= whole[1][0]))
        i = np.flatnonzero((y >= whole[0][1]) & (y <= whole[1][1]))
        if not len(i) or not len(j):
            raise self.error(
                "extent",
                f"holds no point of the terrain, which reaches from ({coordinates(grid.low)}) to "
                f"({coordinates(grid.high)})",
            )
        values = grid.values[i[0] : i[-1] + 1, j[0] : j[-1] + 1]
        return Grid(float(x[j[0]]), float(y[i[0]]), grid.step, values)

    def _box(self) -> Box:
        """The part of the terrain to read: the extent, or all of the file [m]."""
        if self.extent is not None:
            x, y = self.extent.x, self.extent.y
            return np.array([x[0], y[0]]), np.array([x[1], y[1]])
        path = self._source.folder / str(self.terrain.grid)
        if path.suffix.lower() in KINDS:
            raise self.error("terrain.grid", "a point cloud needs extent: {x: [...], y: [...]}")
        if self.terrain.cell is None and self.crs is None and self.terrain.crs is None:
            return np.full(2, -np.inf), np.full(2, np.inf)
        with self._source.blame("terrain.grid"):
            found = read_raster(path)
            low, high = found.grid.low, found.grid.high
            corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
            corners = self.site.bring(path, self.terrain.crs)(found.label, corners)
        return corners.min(axis=0), corners.max(axis=0)

    def _ring(self, number: int) -> Floats:
        """Corners of a zone [m]."""
        given = self.ground.zones[number].area
        if isinstance(given, list):
            return np.array(given)
        by = given if isinstance(given, OutlineFile) else OutlineFile(file=given)
        with self._source.blame(f"ground.zones.{number}.area"):
            path = self._source.folder / by.file
            corners, notes = read_outline(path, by.layer, by.where, self.site.bring(path, by.crs))
        self.site.projection.tell(*notes)
        return corners

    def make_starts(self, ground: Ground) -> Starts:
        """Where blocks start, all on the ground.

        Raises:
            CaseError: A file cannot be read, or a start lies outside the terrain.
        """
        starts, none = self.starts, np.zeros((0, 2))
        if starts.line is not None:
            found, key = Starts([np.array(starts.line)], np.zeros((0, 3, 2)), none), "line"
        elif starts.area is not None:
            with self._source.blame("starts.area"):
                found = Starts([], triangles_of(np.array(starts.area)), none)
            key = "area"
        else:
            with self._source.blame("starts.file"):
                found = self._starts_of_file(self._source.folder / str(starts.file))
            key = "file"
        at = found.corners
        away = np.flatnonzero(~np.isfinite(ground.height(at)))
        if len(away):
            raise self.error(
                f"starts.{key}",
                f"({coordinates(at[away[0]])}) is not on the terrain, which reaches from "
                f"({coordinates(ground.low)}) to ({coordinates(ground.high)}), gaps excluded",
            )
        if found.lines and not sum(np.abs(np.diff(line, axis=0)).sum() for line in found.lines):
            raise self.error(f"starts.{key}", "has no length")
        return found

    def _starts_of_file(self, path: Path) -> Starts:
        starts = self.starts
        features = read_features(path, starts.layer, starts.where)
        bring = self.site.bring(path, starts.crs)
        parts: dict[str, list[Floats]] = {kind: [] for kind in KINDS_OF_STARTS}
        for geometry, _ in features.items:
            for kind, points in _points_of(path, geometry):
                parts[kind].append(bring(features.label, points))
        given = [kind for kind, found in parts.items() if found]
        if len(given) != 1:
            raise CaseError(
                f"{path}: must hold points, lines or areas, one kind; has: "
                f"{', '.join(given) or 'none of them'}"
            )
        rings = [triangles_of(r[:-1] if (r[0] == r[-1]).all() else r) for r in parts["Polygon"]]
        return Starts(
            [line for line in parts["LineString"] if len(line) > 1],
            np.concatenate(rings) if rings else np.zeros((0, 3, 2)),
            np.concatenate(parts["Point"]) if parts["Point"] else np.zeros((0, 2)),
        )

    def wish(self, starts: Starts) -> Wish:
        """What is drawn for each run."""
        blocks, by = self.blocks, self.starts
        return Wish(self.seed, blocks.shapes, blocks.volume, by.height, by.velocity, starts)

    def physics(self, ground: Ground, starts: Starts) -> Physics:
        """Properties of all runs; the stiffness of contacts follows from the highest fall."""
        speed = self.fastest(ground, starts)
        blocks = self.blocks
        modulus = blocks.contact_modulus
        if not isinstance(modulus, float):
            modulus = blocks.density * (speed / DEEP) ** 2
        zones = [self.ground.default, *self.ground.zones]
        sample = self.cell(ground) / SAMPLES / speed
        return Physics(
            density=blocks.density,
            modulus=float(f"{modulus:.3g}"),
            contacts=[zone.contact() for zone in zones],
            sample=min(LONGEST_SAMPLE, float(f"{sample:.2g}")),
            duration=self.duration,
        )

    def fastest(self, ground: Ground, starts: Starts) -> float:
        """Speed after a fall without any loss from the highest start to the lowest ground [m/s]."""
        height = _most(self.starts.height, "m")
        drop = float(np.nanmax(ground.height(starts.corners)) - np.nanmin(ground.heights)) + height
        return float(
            np.sqrt(2 * GRAVITY * max(drop, 1.0) + _most(self.starts.velocity, "m/s") ** 2)
        )

    def cell(self, ground: Ground) -> float:
        """Side of a cell of the maps [m]."""
        return self.maps.cell or float(ground.step.max())

    def needs(self) -> dict[str, Any]:
        """All that a run depends on besides the ground, for its identity."""
        keys = ("starts", "seed", "blocks", "ground", "duration")
        return {key: json.loads(self.model_dump_json())[key] for key in keys}


def _points_of(path: Path, geometry: dict[str, Any]) -> Iterator[tuple[str, Floats]]:
    """Kind and points of the parts of a geometry; of areas the outer rings."""
    kind, data = str(geometry.get("type")), geometry.get("coordinates", [])
    single = kind.removeprefix("Multi")
    if single not in KINDS_OF_STARTS:
        return
    for part in data if kind.startswith("Multi") else [data]:
        ring = part[0] if single == "Polygon" and part else part
        try:
            points = np.array([ring] if single == "Point" else ring, float)[:, :2]
        except (TypeError, ValueError, IndexError):
            points = np.zeros((0, 0))
        if points.shape[1] != 2 or not np.isfinite(points).all():
            raise CaseError(f"{path}: its {kind} is not made of points [x, y]")
        yield single, points


def _problems(given: Rockfall) -> Iterator[tuple[Keys, str]]:
    """Contradictions between keys."""
    if given.terrain.grid is None:
        yield ("terrain",), "a rockfall needs a grid of heights: terrain: {grid: dem.tif}"
    yield from _wrong_values(given)
    barriers = [barrier.name for barrier in given.barriers]
    zones = [zone.name for zone in given.ground.zones]
    for place, names in ((("barriers",), barriers), (("ground", "zones"), zones)):
        for number, name in enumerate(names):
            if file_name(name) in map(file_name, names[:number]):
                yield (*place, number, "name"), f"the name '{name}' is used twice; choose another"
    for number, barrier in enumerate(given.barriers):
        if np.ptp(np.array(barrier.line), axis=0).max() == 0:
            yield ("barriers", number, "line"), "has no length"
    if isinstance(given.blocks.contact_modulus, str) and given.blocks.contact_modulus != "auto":
        yield ("blocks", "contact_modulus"), "must be auto or a number [Pa]"


def _wrong_values(given: Rockfall) -> Iterator[tuple[Keys, str]]:
    """Units and ranges of what is drawn."""
    drawn: dict[Keys, tuple[Drawn, str, float]] = {
        ("blocks", "volume"): (given.blocks.volume, "m3", 0.0),
        ("starts", "height"): (given.starts.height, "m", -1e-300),
        ("starts", "velocity"): (given.starts.velocity, "m/s", -1e-300),
    }
    for keys, (value, unit, limit) in drawn.items():
        try:
            check_drawn(value, unit)
        except ValueError as error:
            yield keys, str(error)
            continue
        if _least(value, unit) <= limit:
            word = "above 0" if limit == 0 else "at least 0"
            yield keys, f"must be {word}; give low: a limit of the distribution"


def file_name(name: str) -> str:
    """A name as part of a file name."""
    return "".join(c if c.isalnum() or c in "-_" else "_" for c in name.lower())


def _of(drawn: Drawn, value: float, unit: str) -> float:
    return value if drawn.unit is None else to_number(f"{value!r} {drawn.unit}", unit)


def _values(drawn: Drawn, unit: str) -> list[float]:
    ends = "" if drawn.unit is None else f" {drawn.unit}"
    return [to_number(f"{v}{ends}" if ends else v, unit) for v in drawn.values or []]


def _least(drawn: Drawn, unit: str) -> float:
    if drawn.values is not None:
        return min(_values(drawn, unit))
    if drawn.normal is not None and drawn.normal.low is None:
        return -np.inf
    if drawn.lognormal is not None:
        return np.inf
    return _of(drawn, quantile(drawn, 0.0), unit)


def _most(drawn: Drawn, unit: str) -> float:
    """Greatest value, or a quantile that is practically never exceeded."""
    if drawn.values is not None:
        return max(_values(drawn, unit))
    return _of(drawn, quantile(drawn, 1 - LEAST), unit)
