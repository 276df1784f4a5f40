"""The landslide file: terrain, sliding surface and bodies, checked like a case, for `cdem mesh`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, ValidationError, model_validator

from cdem.case.explain import explain
from cdem.case.reader import load_case_data, plain
from cdem.case.source import Source
from cdem.case.types import Angle, Length3, Line, Listed, Name, Part, Quantity
from cdem.errors import CaseError
from cdem.terrain import files
from cdem.terrain.heights import Heights, Lines, Plane, Smooth

Length = Annotated[float, Quantity("m")]
Size = Annotated[float, Quantity("m", above=0)]
Point2 = Annotated[list[Length], Field(min_length=2, max_length=2), Listed]
Span = Annotated[list[Length], Field(min_length=2, max_length=2)]
SOURCES = ("contours", "grid", "lines", "plane")


class PlaneBy(Part):
    """A plane by its dip."""

    dip: Annotated[float, Quantity("deg", at_least=0, below=90)] = Field(
        description="Angle to the horizontal [deg]"
    )
    dip_direction: Angle = Field(description="Azimuth in which it falls, north (y) over east [deg]")
    through: Length3 = Field(description="A point on it [m]")


class HeightsBy(Part):
    """Heights from one of: contours, grid, lines, plane."""

    contours: Name | None = Field(None, description="Contour lines: .geojson or .csv [m]")
    grid: Name | None = Field(None, description="Grid: ESRI ASCII .asc or GeoTIFF .tif [m]")
    lines: list[Annotated[list[Length3], Field(min_length=2)]] | None = Field(
        None, min_length=1, description="Polylines of points [x, y, z] [m]"
    )
    plane: PlaneBy | None = Field(None, description="A plane")
    elevation: Name | None = Field(
        None, description="Property or column of the contours that holds the height"
    )

    @model_validator(mode="after")
    def _one_source(self) -> HeightsBy:
        given = [key for key in SOURCES if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError(
                f"needs exactly one of {', '.join(SOURCES)}; "
                + (f"got {' and '.join(given)}" if given else "got none")
            )
        return self


class Terrain(HeightsBy):
    """The ground."""

    smooth: Annotated[float, Quantity("m", at_least=0)] = Field(
        0.0,
        description="Standard deviation of a normal distribution in plan over which heights are "
        "averaged; half a body's element takes off what the mesh could not follow [m]",
    )


class Extent(Part):
    """The rectangle that is meshed."""

    x: Span = Field(description="From west to east [m]")
    y: Span = Field(description="From south to north [m]")
    base: Length = Field(description="Height of the flat base [m]")

    @model_validator(mode="after")
    def _has_an_area(self) -> Extent:
        for axis, (low, high) in (("x", self.x), ("y", self.y)):
            if low >= high:
                raise ValueError(f"{axis} must rise, got [{low:g}, {high:g}]")
        return self


class Body(Part):
    """A part of the rock above the sliding surface, seen in plan."""

    group: Name = Field(description="Group of its elements")
    outline: Annotated[list[Point2], Field(min_length=3), Listed] | Name = Field(
        description="Corners [x, y] in turn, or a GeoJSON file; may reach beyond the outcrop of the "
        "sliding surface, where the body ends [m]"
    )


class Sizes(Part):
    """Edge lengths of the elements."""

    body: Size = Field(description="In the bodies [m]")
    far: Size = Field(description="Largest, far from the bodies [m]")
    growth: Annotated[float, Quantity("1", above=0, at_most=1)] = Field(
        0.3, description="Growth of the edge length per distance from the bodies [1]"
    )

    @model_validator(mode="after")
    def _far_is_not_finer(self) -> Sizes:
        if self.far < self.body:
            raise ValueError(f"far must be at least body, got {self.far:g} < {self.body:g}")
        return self


class Landslide(Part):
    """What `cdem mesh` reads: terrain, sliding surface, bodies, sizes.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: what.
    """

    title: Line = Field("", description="One line for people")
    terrain: Terrain = Field(description="The ground")
    extent: Extent = Field(description="The rectangle that is meshed")
    surface: HeightsBy = Field(description="The sliding surface")
    bodies: list[Body] = Field(min_length=1, description="Where they overlap the first one counts")
    bedrock: Name = Field("bedrock", description="Group of everything below and around the bodies")
    sizes: Sizes = Field(description="Edge lengths of the elements")

    _source: Source = PrivateAttr(default_factory=Source)

    def __init__(self, _source: Source | None = None, **data: Any) -> None:
        source = _source or Source()
        try:
            super().__init__(**plain(data, source))
        except ValidationError as error:
            raise explain(error, source, Landslide) from None
        self._source = source
        names = [self.bedrock, *(body.group for body in self.bodies)]
        for index, body in enumerate(self.bodies):
            if body.group in names[: index + 1]:
                raise self.error(f"bodies.{index}.group", f"the name '{body.group}' is taken")

    @classmethod
    def load(cls, path: str | Path, overrides: Iterable[str] = ()) -> Landslide:
        """Read a landslide file.

        Args:
            path: A YAML file.
            overrides: Texts ``"sizes.body=30"`` that replace values.

        Raises:
            CaseError: The file cannot be read or is wrong; one line for each problem.
        """
        data, source = load_case_data(Path(path), overrides)
        return cls(_source=source, **data)

    def error(self, path: str, what: str) -> CaseError:
        """An error about a value, with its place in the file."""
        return CaseError(f"{self._source.where(path)}: {path}: {what}")

    def ground(self) -> Heights:
        """The ground, smoothed if that is asked for."""
        heights = self._heights("terrain", self.terrain)
        return Smooth(heights, self.terrain.smooth) if self.terrain.smooth else heights

    def sliding_surface(self) -> Heights:
        """The surface that the bodies slide on."""
        return self._heights("surface", self.surface)

    def outline(self, index: int) -> NDArray[np.float64]:
        """Corners [m] of a body's outline, shape (corners, 2)."""
        given = self.bodies[index].outline
        if not isinstance(given, str):
            return np.array(given)
        with self._source.blame(f"bodies.{index}.outline"):
            return files.read_outline(self._source.folder / given)

    def _heights(self, key: str, given: HeightsBy) -> Heights:
        if given.plane is not None:
            plane = given.plane
            return Plane(plane.dip, plane.dip_direction, tuple(plane.through))  # type: ignore[arg-type]
        kind = next(k for k in SOURCES if getattr(given, k) is not None)
        with self._source.blame(f"{key}.{kind}"):
            if given.grid is not None:
                return files.read_grid(self._source.folder / given.grid)
            if given.contours is not None:
                path = self._source.folder / given.contours
                lines = files.read_lines(path, given.elevation)
            else:
                lines = [np.array(line) for line in given.lines or []]
            return Lines(lines, self.sizes.body / 4)
