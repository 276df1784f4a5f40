"""The landslide file: terrain, with bodies or layers, checked like a case, for `cdem mesh`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import PrivateAttr

from cdem.case.document import Document
from cdem.case.map_system import look_up, unfit
from cdem.case.source import Keys
from cdem.errors import CaseError
from cdem.terrain import files, surfaces
from cdem.terrain.facet_files import read_facets
from cdem.terrain.features import read_features
from cdem.terrain.heights import Grid, Heights, Lines, Plane, Smooth, refuse_degrees
from cdem.terrain.projection import Projection, horizontal, name_of, short_name, utm_zone
from cdem.terrain.rasters import Box, read_raster
from cdem.terrain.resample import (
    Wanted,
    filled,
    label_of,
    metres_of_heights,
    read_heights,
)
from cdem.terrain.schema import (
    HeightsBy,
    LandslideParts,
    OutlineFile,
    PlaneBy,
    PlaneThrough,
    Shape,
)
from cdem.terrain.triangles import Triangles

Floats = NDArray[np.float64]


class Landslide(Document, LandslideParts):
    """The input of `cdem mesh`: terrain, sliding surface and bodies, or layers; sizes.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: problem.
    """

    kind = "landslide"

    _projection: Projection | None = PrivateAttr(None)

    def _contradictions(self) -> Iterator[tuple[Keys, str]]:
        parts: list[tuple[Keys, str]] = [
            (("bodies", i, "group"), body.group) for i, body in enumerate(self.bodies)
        ]
        parts += [(("layers", i, "group"), layer.group) for i, layer in enumerate(self.layers)]
        names = [self.bedrock]
        for keys, name in parts:
            if name in names:
                yield keys, f"the name '{name}' is used twice; choose another"
            names.append(name)

    @property
    def projection(self) -> Projection:
        """The common projection; its notes report transformations.

        Raises:
            CaseError: The terrain is in degrees or feet, and no other projection is given.
        """
        if self._projection is None:
            self._projection = Projection(self._target())
        return self._projection

    @property
    def system(self) -> str | None:
        """The projection as text for the case, e.g. ``EPSG:32632``; None if no file names one."""
        target = self.projection.target
        return None if target is None else name_of(target)

    def ground(self) -> Heights:
        """The ground, smoothed on request."""
        heights = self._heights("terrain", self.terrain)
        return Smooth(heights, self.terrain.smooth) if self.terrain.smooth else heights

    def sliding_surface(self) -> Heights | None:
        """The sliding surface of the bodies; None if it follows from ground and outlines."""
        by = self.surface
        return None if by is None or by.slbl is not None else self._shape("surface", by)

    def base_of(self, index: int) -> Heights:
        """The lower surface of a layer."""
        return self._shape(f"layers.{index}.base", self.layers[index].base)

    def _shape(self, key: str, by: Shape) -> Heights:
        if by.ellipsoid is not None:
            e = by.ellipsoid
            return surfaces.Ellipsoid(np.array(e.centre), np.array(e.axes), e.azimuth, e.tilt)
        if by.planes is not None:
            with self._source.blame(f"{key}.planes"):
                return surfaces.Highest([self._plane(plane) for plane in by.planes])
        if by.points is not None:
            with self._source.blame(f"{key}.points"):
                path = self._source.folder / by.points
                return surfaces.through_points(path, by.columns, self.bring(path, by.crs))
        return self._heights(key, by)

    def planes(self, planes: Iterable[PlaneBy]) -> list[Plane]:
        """Planes of given dips."""
        return [self._plane(plane) for plane in planes]

    def outline(self, index: int) -> Floats:
        """Corners [m] of a body's outline, shape (corners, 2)."""
        given = self.bodies[index].outline
        if isinstance(given, list):
            return np.array(given)
        by = given if isinstance(given, OutlineFile) else OutlineFile(file=given)
        with self._source.blame(f"bodies.{index}.outline"):
            path = self._source.folder / by.file
            bring = self.bring(path, by.crs)
            corners, notes = files.read_outline(path, by.layer, by.where, bring)
        self.projection.tell(*notes)
        return corners

    def bring(self, path: Path, told: str | None, unit: str | None = None) -> files.Bring:
        """Function that transforms points of a file, and their heights if any, to metres."""

        def bring(label: str | None, points: Floats) -> Floats:
            there = self.projection.bring(path, label, told, points)
            if there.shape[1] < 3:
                return there
            factor = metres_of_heights(path, told or label, "", unit, self.projection)
            return there * [1.0, 1.0, factor]

        return bring

    def _target(self) -> Any | None:
        """The common projection: as given, or from the terrain's file."""
        if self.crs is not None:
            with self._source.blame("crs"):
                system = look_up(self.crs)
            if why := unfit(system):
                raise self.error("crs", why)
            return system
        key = f"terrain.{self.terrain.source()}"
        with self._source.blame(key):
            label = self._label_of_terrain()
            system = None if label is None else look_up(label)
        if system is None:
            return None
        if not (why := unfit(system)):
            return horizontal(system)
        raise self.error(
            key, f"{why}; write the projection in metres as crs at the top{self._advice(system)}"
        )

    def _advice(self, system: Any) -> str:
        """The UTM zone of a terrain in degrees, for an error message."""
        if not horizontal(system).is_geographic or self.terrain.grid is None:
            return ""
        try:
            grid = read_raster(self._source.folder / self.terrain.grid).grid
            zone = utm_zone(*((grid.low + grid.high) / 2).tolist())
        except CaseError:
            return ""
        return f"; its UTM zone is {short_name(zone)}"

    def _label_of_terrain(self) -> str | None:
        by = self.terrain
        if by.crs is not None:
            return by.crs
        if by.grid is not None:
            return label_of(self._source.folder / by.grid)
        if by.contours is not None and not by.contours.lower().endswith((".csv", ".txt")):
            return read_features(self._source.folder / by.contours).label
        return None

    def _plane(self, by: PlaneBy | PlaneThrough) -> Plane:
        if isinstance(by, PlaneBy):
            return Plane(by.dip, by.dip_direction, tuple(by.through))  # type: ignore[arg-type]
        path = self._source.folder / by.through_lines
        lines = files.read_lines(path, None, self.bring(path, None))
        plane, notes = surfaces.fit_plane(np.concatenate(lines), path.name)
        self.projection.tell(*notes)
        return plane

    def _heights(self, key: str, given: HeightsBy) -> Heights:
        kind = given.source()
        with self._source.blame(f"{key}.{kind}"):
            if kind == "plane":
                return self._plane(given.plane)  # type: ignore[attr-defined]
            if given.grid is not None:
                return self._grid(key, given)
            if given.triangles is not None:
                return self._triangles(self._source.folder / given.triangles, given)
            if given.contours is not None:
                path = self._source.folder / given.contours
                bring = self.bring(path, given.crs, given.unit)
                lines = files.read_lines(path, given.elevation, bring)
            else:
                lines = [np.array(line) for line in given.lines or []]
            return Lines(lines, self.sizes.body / 4)

    def _triangles(self, path: Path, given: HeightsBy) -> Triangles:
        found = read_facets(path, given.layer)
        self.projection.tell(*found.notes)
        points = self.projection.bring(path, None, given.crs, found.points)
        points = points * [
            1.0, 1.0, metres_of_heights(path, given.crs, found.unit, given.unit, self.projection)
        ]  # fmt: skip
        refuse_degrees(path, points)
        try:
            surface = Triangles(points, found.triangles, found.rounding)
        except CaseError as error:
            raise CaseError(f"{path}: {error}") from None
        self.projection.tell(*(f"{path.name}: {note}" for note in surface.notes))
        return surface

    def _grid(self, key: str, given: HeightsBy) -> Grid:
        x, y = self.extent.x, self.extent.y
        margin = 4 * self.terrain.smooth if key == "terrain" else 0.0
        box = np.array([x[0], y[0]]) - margin, np.array([x[1], y[1]]) + margin
        return self.grid_within(given, box)

    def grid_within(self, given: HeightsBy, box: Box) -> Grid:
        """A grid of heights in the common projection.

        Args:
            given: The file and how to read it.
            box: South-west and north-east corner of the required part [m].

        Raises:
            CaseError: The file cannot be read or has no heights there.
        """
        path = self._source.folder / str(given.grid)
        wanted = Wanted(box, given.crs, given.cell, given.unit, given.nodata, given.classes)
        grid = read_heights(path, self.projection, wanted)
        if given.fill is None:
            return grid
        outlines = [self.outline(index) for index in range(len(self.bodies))]
        grid, notes = filled(path, grid, given.fill, outlines)
        self.projection.tell(*notes)
        return grid
