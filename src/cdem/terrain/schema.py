"""The parts of a landslide file: every field with its unit, range, default and meaning."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from cdem.case.map_system import MapSystem
from cdem.case.types import Angle, Length3, Line, Listed, Name, Part, Quantity, Size3

Length = Annotated[float, Quantity("m")]
Size = Annotated[float, Quantity("m", above=0)]
Point2 = Annotated[list[Length], Field(min_length=2, max_length=2), Listed]
Span = Annotated[list[Length], Field(min_length=2, max_length=2)]
Dip = Annotated[float, Quantity("deg", at_least=0, below=90)]
GROUND = ("contours", "grid", "triangles", "lines", "plane")
SHAPE = (*GROUND, "planes", "ellipsoid", "points")
SURFACE = (*SHAPE, "slbl")


class PlaneBy(Part):
    """A plane by its dip."""

    dip: Dip = Field(description="Angle to the horizontal [deg]")
    dip_direction: Angle = Field(description="Azimuth of its dip, clockwise from north (y) [deg]")
    through: Length3 = Field(description="A point on it [m]")


class PlaneThrough(Part):
    """The plane that fits lines best, e.g. a crown line and a toe line."""

    through_lines: Name = Field(description="GIS or CSV file of lines with heights")


class EllipsoidBy(Part):
    """The lower half of an ellipsoid."""

    centre: Length3 = Field(description="Its centre [m]")
    axes: Size3 = Field(
        description="Half axes: in the direction of azimuth, across it, normal to both [m]"
    )
    azimuth: Angle = Field(description="Azimuth of the first axis, clockwise from north [deg]")
    tilt: Annotated[float, Quantity("deg", above=-90, below=90)] = Field(
        0.0, description="Plunge of the first axis below the horizontal [deg]"
    )


class SlblBy(Part):
    """The sloping local base level: a surface of constant curvature below the ground in the outlines."""

    depth: Size | None = Field(None, description="Greatest depth below the ground [m]")
    volume: Annotated[float, Quantity("m3", above=0)] | None = Field(
        None, description="Volume of the bodies [m3]"
    )
    curvature: Annotated[float, Quantity("1/m")] | None = Field(
        None, description="Laplacian of the surface; positive for a concave surface [1/m]"
    )
    deepest: Size | None = Field(
        None, description="Largest depth below the ground, for any volume [m]"
    )
    above: list[PlaneBy] = Field([], description="Planes below the surface everywhere")

    @model_validator(mode="after")
    def _one_measure(self) -> SlblBy:
        given = [k for k in ("depth", "volume", "curvature") if getattr(self, k) is not None]
        if len(given) != 1:
            raise ValueError(
                "needs exactly one of depth, volume, curvature; got "
                + (" and ".join(given) if given else "none")
            )
        if self.depth is not None and self.deepest is not None:
            raise ValueError("depth and deepest are the same; write depth alone")
        return self


class HeightsBy(Part):
    """Heights from one of: contours, grid, triangles, lines, plane."""

    contours: Name | None = Field(
        None, description="Contour lines: .geojson, .shp, .gpkg, .kml, .dxf or .csv"
    )
    grid: Name | None = Field(
        None,
        description="Grid: GeoTIFF, VRT, ESRI ASCII, Surfer; or a point cloud (.las, .laz) and cell",
    )
    triangles: Name | None = Field(
        None, description="Surface of triangles: .obj, .stl, .ply, .ts (GOCAD) or .dxf (3DFACE)"
    )
    layer: Name | None = Field(
        None, description="Layer of a DXF file of triangles; needed if several have faces"
    )
    lines: list[Annotated[list[Length3], Field(min_length=2)]] | None = Field(
        None, min_length=1, description="Polylines of points [x, y, z] [m]"
    )
    elevation: Name | None = Field(
        None, description="Property or column of the contours with the height"
    )
    crs: MapSystem | None = Field(None, description="Projection of the file; overrides its own")
    cell: Size | None = Field(
        None, description="Resample a grid to this cell size; required for a point cloud [m]"
    )
    fill: (
        Annotated[
            Annotated[Literal["all"], Tag("all")] | Annotated[Size, Tag("size")],
            Discriminator(lambda value: "all" if value == "all" else "size"),
        ]
        | None
    ) = Field(
        None,
        description="Fill gaps of a grid up to this distance [m]; all: any gap, also inside "
        "outlines",
    )
    unit: Literal["m", "ft", "us-ft", "cm", "dm"] | None = Field(
        None,
        description="Unit of the heights of a grid, contours or triangles; default: as in the "
        "file, else metres",
    )
    nodata: list[float] = Field([], description="Further values of a grid for missing data")
    classes: Literal["ground", "all"] = Field(
        "ground", description="Points of a cloud to use: class 2 (ground), or all"
    )

    def source(self) -> str:
        """Name of the given source."""
        return next(key for key in SURFACE if getattr(self, key, None) is not None)


def _one_source(part: HeightsBy, sources: tuple[str, ...]) -> None:
    given = [key for key in sources if getattr(part, key) is not None]
    if len(given) != 1:
        raise ValueError(
            f"needs exactly one of {', '.join(sources)}; "
            + (f"got {' and '.join(given)}" if given else "got none")
        )
    if part.layer is not None and part.triangles is None:
        raise ValueError("layer goes with triangles; leave it out")


class Terrain(HeightsBy):
    """The ground."""

    plane: PlaneBy | None = Field(None, description="A plane")
    smooth: Annotated[float, Quantity("m", at_least=0)] = Field(
        0.0,
        description="Standard deviation of a normal distribution in plan for smoothing heights; "
        "half a body's element size removes details finer than the mesh [m]",
    )

    @model_validator(mode="after")
    def _has_a_source(self) -> Terrain:
        _one_source(self, GROUND)
        return self


AnyPlane = Annotated[
    Annotated[PlaneThrough, Tag("lines")] | Annotated[PlaneBy, Tag("dip")],
    Discriminator(lambda v: "lines" if isinstance(v, dict) and "through_lines" in v else "dip"),
]


class Shape(HeightsBy):
    """A surface in the rock."""

    plane: AnyPlane | None = Field(None, description="A plane, by its dip or through lines")
    planes: list[AnyPlane] | None = Field(
        None, min_length=2, description="Planes; the rock above all of them slides (wedge)"
    )
    ellipsoid: EllipsoidBy | None = Field(None, description="The lower half of an ellipsoid")
    points: Name | None = Field(
        None,
        description="CSV or GIS file of points: a smooth surface through them; with dip and dip "
        "direction, the planes through them",
    )
    columns: dict[Name, Name] = Field(
        {}, description="Names of columns of the points, e.g. {dip: inclination}"
    )


class Surface(Shape):
    """The sliding surface."""

    slbl: SlblBy | None = Field(None, description="Sloping local base level")

    @model_validator(mode="after")
    def _has_a_source(self) -> Surface:
        _one_source(self, SURFACE)
        return self


class LayerBase(Shape):
    """The lower surface of a layer."""

    @model_validator(mode="after")
    def _has_a_source(self) -> LayerBase:
        _one_source(self, SHAPE)
        return self


class Layer(Part):
    """Rock between a surface and the one above it."""

    group: Name = Field(description="Group of its elements")
    base: LayerBase = Field(
        description="Its lower surface; where it lies above the ground or the base of the layer "
        "above, the layer is absent"
    )


class Extent(Part):
    """The rectangle to mesh."""

    x: Span = Field(description="From west to east [m]")
    y: Span = Field(description="From south to north [m]")
    base: Length = Field(description="Height of the flat base [m]")

    @model_validator(mode="after")
    def _has_an_area(self) -> Extent:
        for axis, (low, high) in (("x", self.x), ("y", self.y)):
            if low >= high:
                raise ValueError(f"{axis} must rise, got [{low:g}, {high:g}]")
        return self


class OutlineFile(Part):
    """An outline in a GIS file."""

    file: Name = Field(description="GeoJSON, GeoPackage, Shapefile, KML, FlatGeobuf or DXF")
    layer: Name | None = Field(None, description="Layer, if there are several")
    where: dict[Name, Any] = Field({}, description="Use only features with these properties")
    crs: MapSystem | None = Field(None, description="Projection of the file; overrides its own")


def _kind_of_outline(value: Any) -> str:
    if isinstance(value, str):
        return "name"
    return "file" if isinstance(value, dict | OutlineFile) else "corners"


class Body(Part):
    """A part of the rock above the sliding surface, outlined in plan."""

    group: Name = Field(description="Group of its elements")
    outline: Annotated[
        Annotated[Annotated[list[Point2], Field(min_length=3), Listed], Tag("corners")]
        | Annotated[Name, Tag("name")]
        | Annotated[OutlineFile, Tag("file")],
        Discriminator(_kind_of_outline),
    ] = Field(
        description="Corners [x, y] in order, or a GIS file; may reach beyond the outcrop of the "
        "sliding surface, which limits the body [m]"
    )


class Sizes(Part):
    """Edge lengths of the elements."""

    body: Size = Field(description="In the bodies and layers; for bare ground at its surface [m]")
    far: Size = Field(description="Largest, far from the bodies; height of those below layers [m]")
    growth: Annotated[float, Quantity("1", above=0, at_most=1)] = Field(
        0.3, description="Growth of the edge length per distance from the bodies [1]"
    )

    @model_validator(mode="after")
    def _far_is_not_finer(self) -> Sizes:
        if self.far < self.body:
            raise ValueError(f"far must be at least body, got {self.far:g} < {self.body:g}")
        return self


class LandslideParts(Part):
    """All parts of a landslide file."""

    title: Line = Field("", description="One line for reports")
    crs: MapSystem | None = Field(
        None,
        description="Projection in metres of everything here; default: as in the terrain's file",
    )
    terrain: Terrain = Field(description="The ground")
    extent: Extent = Field(description="The rectangle to mesh")
    surface: Surface | None = Field(None, description="The sliding surface; needed by bodies")
    bodies: list[Body] = Field(
        [], description="Bodies; the first one counts where they overlap; none for bare ground"
    )
    layers: list[Layer] = Field(
        [], description="Layers from the ground downwards, above the bedrock; in place of bodies"
    )
    bedrock: Name = Field(
        "bedrock", description="Group of everything below and around the bodies or layers"
    )
    sizes: Sizes = Field(description="Edge lengths of the elements")

    @model_validator(mode="after")
    def _bodies_have_a_surface(self) -> LandslideParts:
        if self.layers and (self.bodies or self.surface is not None):
            raise ValueError(
                "layers do not go together with bodies and a sliding surface; leave out one of them"
            )
        if bool(self.bodies) != (self.surface is not None):
            raise ValueError(
                "bodies need a sliding surface; give surface"
                if self.bodies
                else "a surface without bodies has no effect; list bodies, or leave it out"
            )
        return self
