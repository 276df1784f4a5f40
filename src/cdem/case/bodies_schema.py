"""The bodies of a case: boxes, polyhedra, files, and the joints that cut them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from cdem.case.types import (
    MOST_SEEDS,
    Angle,
    Direction3,
    Divisions3,
    Length3,
    Listed,
    Name,
    Part,
    Quantity,
    Size3,
    Three,
)


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
                raise ValueError(
                    f"face {face} names a vertex that is not in 0..{len(self.vertices) - 1}"
                )
        return self


class Block(Part):
    """A body made here instead of in a mesh file: turned first, then moved."""

    group: Name = Field(description="Group that the body belongs to")
    box: Box | None = Field(None, description="A box of elements")
    polyhedron: Polyhedron | None = Field(None, description="A convex polyhedron")
    file: Name | None = Field(
        None,
        description="Convex bodies from a file, relative to the case file: each closed surface of an "
        ".obj or .stl, each cell of a .vtu or .vtk, polyhedra too",
    )
    rotate: Rotate | None = Field(None, description="Rotation of the body")
    translate: Length3 | None = Field(None, description="Shift of the body after its rotation [m]")

    @model_validator(mode="after")
    def _one_shape(self) -> Block:
        exactly_one(self, ("box", "polyhedron", "file"))
        return self


class Scatter(Part):
    """How the planes of a set scatter about their mean direction."""

    fisher: Annotated[float, Quantity("1", above=0)] = Field(
        description="Concentration kappa [1]: 63 % of the normals lie within 81 deg / sqrt(kappa)"
    )


class Joint(Part):
    """A set of joints: planes that cut bodies into blocks. x is east, y north, z up."""

    name: Name = Field(
        description="Name, unique in the case; its faces form a surface of this name"
    )
    group: Name | None = Field(None, description="Group that it cuts; all when left out")
    dip: Annotated[float, Quantity("deg", at_least=0, at_most=90)] | None = Field(
        None, description="Steepest angle of the planes below the horizontal [deg]"
    )
    dip_direction: Annotated[float, Quantity("deg", at_least=0, at_most=360)] | None = Field(
        None, description="Where that steepest line points, clockwise from north [deg]"
    )
    normal: Direction3 | None = Field(
        None, description="Normal of the planes, instead of dip and dip_direction [1]"
    )
    spacing: Annotated[float, Quantity("m", above=0)] | None = Field(
        None, description="Distance between the planes [m]; one plane when left out"
    )
    origin: Length3 = Field([0.0, 0.0, 0.0], description="A point on one of the planes [m]")
    persistence: Annotated[float, Quantity("1", above=0, at_most=1)] = Field(
        1.0, description="Chance that a plane cuts a block that it meets [1]"
    )
    scatter: Scatter | None = Field(None, description="Scatter of the planes' directions")
    seed: int = Field(
        0, ge=0, le=MOST_SEEDS, description="Another number gives other scatter and persistence"
    )

    @model_validator(mode="after")
    def _one_direction(self) -> Joint:
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
    """A box along the axes; blocks that leave it are taken out of the computation."""

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
        description="What is one block, per group: one (the whole group), connected (each connected "
        "part; the default) or elements (each element)",
    )
    joints: list[Joint] = Field(
        [], description="Sets of joints that cut the bodies, in this order, once all are in place"
    )
    thinnest: Annotated[float, Quantity("m", at_least=0)] | None = Field(
        None,
        description="Joints cut off no part thinner than this [m]; default a hundredth of the "
        "smallest spacing",
    )
    rotate: Rotate | None = Field(None, description="Rotation of the whole model")
    translate: Length3 | None = Field(None, description="Shift of the whole model [m]")
    domain: Domain | None = Field(
        None,
        description="Blocks that leave this box, after rotate and translate, are taken out of the "
        "computation",
    )

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
