"""The bodies of a case: boxes, polyhedra, files, and the joints that cut them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from cdem.case.types import (
    MOST_SEEDS,
    Angle,
    Direction3,
    Divisions3,
    Length3,
    Line,
    Listed,
    Name,
    Part,
    Quantity,
    Size3,
    Three,
)

MOST_DISCS = 100_000
"""More discs than this in one set are taken for a mistake."""


class Rotate(Part):
    """A rotation about an axis through a point."""

    axis: Direction3 = Field(description="Direction of the axis; right-handed [1]")
    angle: Angle = Field(description="Angle [deg]")
    origin: Length3 = Field([0.0, 0.0, 0.0], description="A point on the axis [m]")

    @model_validator(mode="after")
    def _axis_has_a_direction(self) -> Rotate:
        if not any(self.axis):
            raise ValueError("axis must not be [0, 0, 0]")
        return self


class Box(Part):
    """A box of elements with one corner at the origin of the body."""

    size: Size3 = Field(description="Lengths along x, y and z [m]")
    divisions: Divisions3 = Field([1, 1, 1], description="Cells along x, y and z")
    shape: Literal["hex8", "wedge6", "pyramid5", "tet4"] = Field(
        "hex8", description="Elements: a cell is 1 hex8, 2 wedge6, 6 pyramid5 or 6 tet4"
    )
    cells: Literal["mirrored", "alike"] | None = Field(
        None,
        description="For tet4: neighbouring cells are mirror images, so the mesh has no preferred "
        "direction (default), or all are divided along the same diagonal",
    )

    @model_validator(mode="after")
    def _cells_are_of_tets(self) -> Box:
        if self.cells is not None and self.shape != "tet4":
            raise ValueError("cells is of shape: tet4; other shapes have one division")
        return self


class Polyhedron(Part):
    """A convex polyhedron: one block of tetrahedra."""

    vertices: list[Length3] = Field(min_length=4, description="Corner points [m]")
    faces: list[Annotated[list[int], Field(min_length=3)]] | None = Field(
        None, description="Corner numbers of each face, from 0; by default the convex hull"
    )

    @model_validator(mode="after")
    def _faces_name_vertices(self) -> Polyhedron:
        for face in self.faces or []:
            if any(not 0 <= vertex < len(self.vertices) for vertex in face):
                raise ValueError(f"face {face} names a vertex outside 0..{len(self.vertices) - 1}")
        return self


class Block(Part):
    """A body made here instead of in a mesh file: turned first, then moved."""

    group: Name = Field(description="Group that the body belongs to")
    box: Box | None = Field(None, description="A box of elements")
    polyhedron: Polyhedron | None = Field(None, description="A convex polyhedron")
    file: Name | None = Field(
        None,
        description="Convex bodies from a file, relative to the case file: each closed surface of an "
        ".obj, .stl or .ply, or each cell (also a polyhedron) of a .vtu or .vtk",
    )
    size: Annotated[float, Quantity("m", above=0)] | None = Field(
        None,
        description="For a file: fill closed surfaces, convex or not, with tets up to this edge "
        "length "
        "(extra terrain); each is a block of several elements [m]",
    )
    scale: Annotated[float, Quantity("1", above=0)] | None = Field(
        None, description="For a file: metres per unit of the file, 0.001 for millimetres [1]"
    )
    rotate: Rotate | None = Field(None, description="Rotation of the body")
    translate: Length3 | None = Field(None, description="Shift of the body after its rotation [m]")

    @model_validator(mode="after")
    def _one_shape(self) -> Block:
        exactly_one(self, ("box", "polyhedron", "file"))
        if self.size is not None and self.file is None:
            raise ValueError("size goes with a file; a box has divisions")
        if self.scale is not None and self.file is None:
            raise ValueError("scale goes with a file; other bodies are given in metres")
        return self


class Scatter(Part):
    """Scatter of the planes of a set about their mean direction."""

    fisher: Annotated[float, Quantity("1", above=0)] = Field(
        description="Concentration kappa [1]: 63 % of the normals lie within 81 deg / sqrt(kappa)"
    )


Radius = Annotated[float, Quantity("m", above=0)]


class Between(Part):
    """Radii spread evenly between two limits."""

    min: Radius = Field(description="Smallest [m]")
    max: Radius = Field(description="Largest [m]")

    @model_validator(mode="after")
    def _in_order(self) -> Between:
        if not self.min < self.max:
            raise ValueError("min must be below max")
        return self


class Power(Between):
    """Radii between two limits with a density proportional to r^-exponent."""

    exponent: Annotated[float, Quantity("1", above=1)] = Field(
        description="Exponent a of the density r^-a, e.g. 3 to 4.5 [1]"
    )


class Lognormal(Part):
    """Radii with a normal logarithm; radii above the largest are drawn again."""

    mean: Radius = Field(description="Mean of the radii, before the cut-off at max [m]")
    deviation: Radius = Field(description="Standard deviation of the radii, before the cut-off [m]")
    max: Radius = Field(description="Largest [m]")

    @model_validator(mode="after")
    def _is_likely(self) -> Lognormal:
        if not self.mean < self.max:
            raise ValueError("mean must be below max")
        return self


class Radii(Part):
    """Distribution of the radii of discs."""

    uniform: Between | None = Field(None, description="Uniform between two limits")
    power: Power | None = Field(None, description="Power law between two limits")
    lognormal: Lognormal | None = Field(None, description="Lognormal up to a limit")

    @model_validator(mode="after")
    def _one_kind(self) -> Radii:
        exactly_one(self, ("uniform", "power", "lognormal"))
        return self


class Discs(Part):
    """Joints of finite size: discs from a file, or random ones."""

    file: Line | None = Field(
        None,
        description="File, relative to the case file: CSV with columns x, y, z [m] of the centre, dip, "
        "dip direction [deg] and radius [m]; or FracMan .fab, whose polygons become discs of equal "
        "area",
    )
    density: Annotated[float, Quantity("1/m3", above=0)] | None = Field(
        None, description="Centres per volume, also outside the bodies within reach of discs [1/m3]"
    )
    count: int | None = Field(
        None,
        ge=1,
        le=MOST_DISCS,
        description="Number of discs, with centres in the box round the bodies",
    )
    radius: (
        Annotated[
            Annotated[Radius, Tag("same")] | Annotated[Radii, Tag("spread")],
            Discriminator(lambda v: "spread" if isinstance(v, dict | Radii) else "same"),
        ]
        | None
    ) = Field(None, description="Radius of random discs [m], or their distribution")

    @model_validator(mode="after")
    def _one_source(self) -> Discs:
        exactly_one(self, ("file", "density", "count"))
        if (self.file is None) == (self.radius is None):
            raise ValueError("random discs need a radius; a file has its own")
        return self


class Joint(Part):
    """A set of joints: planes that cut bodies into blocks. x is east, y north, z up."""

    name: Name = Field(description="Unique name; also the name of the surface that its faces form")
    group: Name | None = Field(None, description="Group to cut; default all")
    dip: Annotated[float, Quantity("deg", at_least=0, at_most=90)] | None = Field(
        None, description="Steepest angle of the planes below the horizontal [deg]"
    )
    dip_direction: Annotated[float, Quantity("deg", at_least=0, at_most=360)] | None = Field(
        None, description="Azimuth of that steepest line, clockwise from north [deg]"
    )
    normal: Direction3 | None = Field(
        None, description="Normal of the planes, instead of dip and dip_direction [1]"
    )
    spacing: Annotated[float, Quantity("m", above=0)] | None = Field(
        None, description="Distance between the planes [m]; default: a single plane"
    )
    origin: Length3 = Field([0.0, 0.0, 0.0], description="A point on one of the planes [m]")
    persistence: Annotated[float, Quantity("1", above=0, at_most=1)] = Field(
        1.0, description="Persistence: probability that a plane cuts a block that it meets [1]"
    )
    scatter: Scatter | None = Field(None, description="Scatter of the planes' directions")
    seed: int = Field(
        0, ge=0, le=MOST_SEEDS, description="Seed of the random scatter and persistence"
    )
    discs: Discs | None = Field(
        None, description="Discs instead of planes; cut faces outside the rim are rock bridges"
    )
    bridge: Name | None = Field(
        None,
        description="Name of the surface of rock bridges beside discs; pairs of interfaces may "
        "name it "
        "as joint; default NAME.bridge",
    )

    @property
    def bridges(self) -> str | None:
        """Name of the surface of the set's rock bridges; None without discs."""
        return None if self.discs is None else self.bridge or f"{self.name}.bridge"

    @model_validator(mode="after")
    def _discs_or_planes(self) -> Joint:
        if self.discs is None:
            if self.bridge is not None:
                raise ValueError("bridge goes with discs only; remove it")
            return self
        planes = {"spacing", "origin", "persistence"}
        if self.discs.file is not None:
            planes |= {"dip", "dip_direction", "normal", "scatter", "seed"}
        fields = type(self).model_fields
        if idle := sorted(f for f in planes if getattr(self, f) != fields[f].default):
            kind = "random discs" if self.discs.file is None else "discs of a file"
            raise ValueError(f"{idle[0]} has no effect with {kind}; remove it")
        return self

    @model_validator(mode="after")
    def _one_direction(self) -> Joint:
        if self.discs is not None and self.discs.file is not None:
            return self
        given = [self.dip is not None, self.dip_direction is not None]
        if self.normal is not None:
            if any(given):
                raise ValueError("give dip and dip_direction, or normal, not both")
            if not any(self.normal):
                raise ValueError("normal must not be [0, 0, 0]")
        elif not all(given):
            raise ValueError("give dip and dip_direction, or normal")
        return self


OpenCorner = Annotated[list[Annotated[float, Quantity("m")] | None], Three, Listed]


class Domain(Part):
    """A box along the axes; blocks that leave it are removed from the computation."""

    min: OpenCorner = Field([None] * 3, description="Lowest corner [m]; null: open on that side")
    max: OpenCorner = Field([None] * 3, description="Highest corner [m]; null: open on that side")

    @model_validator(mode="after")
    def _holds_something(self) -> Domain:
        if not any(side is not None for side in self.min + self.max):
            raise ValueError("is open on all sides; give min, max or both")
        for axis, low, high in zip("xyz", self.min, self.max, strict=True):
            if low is not None and high is not None and low >= high:
                raise ValueError(f"min must be below max, but along {axis} they are {low}, {high}")
        return self


class Model(Part):
    """The bodies: a mesh file, bodies made here, or both."""

    mesh: Name | None = Field(
        None, description="Mesh file, relative to the case file; physical groups become groups"
    )
    blocks: list[Block] = Field([], description="Bodies made here")
    split: dict[Name, Literal["one", "connected", "elements"]] = Field(
        {},
        description="Blocks of a group: one (the whole group), connected (each connected part; the "
        "default) or elements (each element)",
    )
    joints: list[Joint] = Field(
        [], description="Sets of joints; they cut the placed bodies in this order"
    )
    thinnest: Annotated[float, Quantity("m", at_least=0)] | None = Field(
        None,
        description="Thinnest part that joints may cut off [m]; default a hundredth of the "
        "smallest spacing",
    )
    rotate: Rotate | None = Field(None, description="Rotation of the whole model")
    translate: Length3 | None = Field(None, description="Shift of the whole model [m]")
    domain: Domain | None = Field(
        None,
        description="Blocks that leave this box (set after rotate and translate) are removed from "
        "the "
        "computation",
    )

    @property
    def joint_surfaces(self) -> list[str]:
        """Names of surfaces of joints: the sets in order, then rock bridges of sets with discs."""
        bridges = [joint.bridges for joint in self.joints]
        return [joint.name for joint in self.joints] + [name for name in bridges if name]

    @model_validator(mode="after")
    def _has_bodies(self) -> Model:
        if self.mesh is None and not self.blocks:
            raise ValueError("has no bodies; give mesh, blocks or both")
        return self


def exactly_one(part: Part, fields: tuple[str, ...]) -> None:
    given = [field for field in fields if getattr(part, field) is not None]
    if len(given) != 1:
        got = " and ".join(given) or "none of them"
        raise ValueError(f"give exactly one of {', '.join(fields)}; got {got}")
