"""The parts of a case but its bodies: every field with its type, unit, range, default and meaning."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from cdem.fields import (
    AUTO_STIFFNESS,
    Acceleration3,
    Direction3,
    Length3,
    Name,
    Part,
    Quantity,
    Spin3,
    Stiffness,
    Stress3,
    Velocity3,
)
from cdem.parts_model import exactly_one

Axis = Literal["x", "y", "z"]
Axes = list[Axis]
History = list[tuple[Annotated[float, Quantity("s")], Annotated[float, Quantity("1")]]]


class Material(Part):
    """What the elements are made of."""

    density: Annotated[float, Quantity("kg/m3", above=0)] = Field(description="Density [kg/m3]")
    young_modulus: Annotated[float, Quantity("Pa", above=0)] = Field(
        description="Young's modulus [Pa]"
    )
    poisson_ratio: Annotated[float, Quantity("1", at_least=0, below=0.5)] = Field(
        description="Poisson's ratio [1]"
    )
    law: Literal["elastic"] = Field("elastic", description="Stress-strain law")


class Group(Part):
    """What holds for every element of a group."""

    material: Name = Field(description="A name under materials")
    fix: Axes = Field([], description="Directions in which the nodes never move")
    velocity: Velocity3 = Field([0.0, 0.0, 0.0], description="Initial velocity [m/s]")
    angular_velocity: Spin3 = Field(
        [0.0, 0.0, 0.0], description="Initial spin about the group's centroid [rad/s]"
    )
    gravity: bool = Field(True, description="Whether gravity acts on the group")


class Interface(Part):
    """Coulomb friction with bonds that break in tension or shear: Feng et al. (2014), Eq. 14."""

    friction_angle: Annotated[float, Quantity("deg", at_least=0, below=90)] = Field(
        description="Friction angle [deg]"
    )
    cohesion: Annotated[float, Quantity("Pa", at_least=0)] = Field(
        0.0, description="Cohesion of the intact bond [Pa]"
    )
    tensile_strength: Annotated[float, Quantity("Pa", at_least=0)] = Field(
        0.0, description="Tensile strength of the intact bond [Pa]"
    )
    stiffness_n: Stiffness = Field(
        AUTO_STIFFNESS, description="Normal stiffness: auto (10 E/h), a number [Pa/m], or '5 E/h'"
    )
    stiffness_s: Stiffness = Field(
        AUTO_STIFFNESS, description="Shear stiffness: auto (10 E/h), a number [Pa/m], or '5 E/h'"
    )
    dilation_angle: Annotated[float, Quantity("deg", at_least=0, below=90)] = Field(
        0.0, description="Dilation angle [deg]: a sliding joint lifts by its tangent times the slip"
    )
    dilation_slip: Annotated[float, Quantity("m", at_least=0)] = Field(
        0.0, description="Slip after which a joint dilates no more [m]"
    )


class InterfacePair(Interface):
    """The interface between two groups, or in a set of joints; the rest is as in the default."""

    name: Name | None = Field(None, description="A name for use in paths, e.g. interfaces.bed")
    between: list[Name] | None = Field(
        None, min_length=2, max_length=2, description="Two groups, or one group twice"
    )
    joint: Name | None = Field(
        None, description="Set of joints instead of groups: where two of its faces touch"
    )
    friction_angle: Annotated[float, Quantity("deg", at_least=0, below=90)] = Field(
        None,  # type: ignore[assignment]  # until inherit() fills it in
        validate_default=False,
        description="Friction angle [deg]",
    )

    @model_validator(mode="after")
    def _one_place(self) -> InterfacePair:
        exactly_one(self, ("between", "joint"))
        return self


def _check_dilation(law: Interface, where: str) -> None:
    """A joint that lifts more than it slips against friction would make energy."""
    if law.dilation_angle > law.friction_angle:
        raise ValueError(
            f"{where}dilation_angle must not be larger than friction_angle, {law.friction_angle:g}"
        )
    if law.dilation_angle > 0 and not law.dilation_slip > 0:
        raise ValueError(
            f"{where}dilation_angle needs dilation_slip, the slip after which it dilates no more"
        )


class Interfaces(Part):
    """Interfaces by pair of groups, or by set of joints."""

    default: Interface | None = Field(None, description="For pairs of groups not listed in pairs")
    pairs: list[InterfacePair] = Field([], description="For the pairs of groups named")

    @model_validator(mode="after")
    def _complete_and_single(self) -> Interfaces:
        seen = set()
        for number, pair in enumerate(self.pairs):
            key = frozenset(pair.between) if pair.between else pair.joint
            if key in seen:
                what = f"{' and '.join(pair.between)} are" if pair.between else f"{pair.joint} is"
                raise ValueError(f"pairs.{number}: {what} listed twice")
            seen.add(key)
            if self.default is None and "friction_angle" not in pair.model_fields_set:
                raise ValueError(
                    f"pairs.{number}: friction_angle is missing, and so is interfaces.default"
                )
        self.inherit()
        if self.default is not None:
            _check_dilation(self.default, "default: ")
        for number, pair in enumerate(self.pairs):
            _check_dilation(pair, f"pairs.{number}: ")
        return self

    def inherit(self) -> None:
        """Give each pair the default's value for every field that the case left out."""
        for pair in self.pairs if self.default else []:
            for field in Interface.model_fields.keys() - pair.model_fields_set:
                # Not by assignment: the field must keep counting as left out.
                pair.__dict__[field] = getattr(self.default, field)

    def between(self, group_a: str, group_b: str) -> Interface | None:
        """Return the interface of two groups, or None when the case says nothing about them."""
        for pair in self.pairs:
            if pair.between and set(pair.between) == {group_a, group_b}:
                return pair
        return self.default


class FacesOfGroup(Part):
    """The outer faces of a group that look in one direction."""

    group: Name = Field(description="Group")
    normal: Direction3 = Field(description="Outward normal of the faces [1]")

    @model_validator(mode="after")
    def _normal_has_a_direction(self) -> FacesOfGroup:
        if not any(self.normal):
            raise ValueError("normal must not be [0, 0, 0]")
        return self


def _surface_kind(value: object) -> str:
    return "faces" if isinstance(value, dict | FacesOfGroup) else "name"


Surface = Annotated[
    Annotated[Name, Tag("name")] | Annotated[FacesOfGroup, Tag("faces")],
    Discriminator(_surface_kind),
]


class Region(Part):
    """All nodes inside a box along the axes."""

    min: Length3 = Field(description="Lowest corner [m]")
    max: Length3 = Field(description="Highest corner [m]")

    @model_validator(mode="after")
    def _ordered(self) -> Region:
        if any(low > high for low, high in zip(self.min, self.max, strict=True)):
            raise ValueError("min must not be above max")
        return self


class _Timed(Part):
    history: History | None = Field(
        None,
        min_length=1,
        description="Factor over time, linear between: [[time [s], factor [1]], ...]",
    )

    @model_validator(mode="after")
    def _times_increase(self) -> _Timed:
        times = [time for time, _ in self.history or []]
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise ValueError("history: times must increase")
        return self


class Traction(_Timed):
    """A stress on faces, per area of the undeformed face."""

    surface: Surface = Field(description="Surface of the mesh, or {group, normal}")
    traction: Stress3 = Field(description="Force per area [Pa]")


class PrescribedVelocity(_Timed):
    """Nodes that are driven."""

    group: Name | None = Field(None, description="All nodes of this group")
    surface: Surface | None = Field(None, description="Surface of the mesh, or {group, normal}")
    point: Length3 | None = Field(None, description="The node nearest to this point [m]")
    box: Region | None = Field(None, description="All nodes in this box")
    components: Axes = Field(["x", "y", "z"], description="Directions that are driven")
    velocity: Velocity3 = Field(description="Velocity [m/s]")

    @model_validator(mode="after")
    def _one_selection(self) -> PrescribedVelocity:
        exactly_one(self, ("group", "surface", "point", "box"))
        return self


class Support(Part):
    """Nodes that are held."""

    surface: Surface | None = Field(None, description="Surface of the mesh, or {group, normal}")
    point: Length3 | None = Field(None, description="The node nearest to this point [m]")
    box: Region | None = Field(None, description="All nodes in this box")
    group: Name | None = Field(None, description="With point or box: only nodes of this group")
    fix: Axes = Field(min_length=1, description="Directions in which the nodes never move")

    @model_validator(mode="after")
    def _one_selection(self) -> Support:
        exactly_one(self, ("surface", "point", "box"))
        if self.group is not None and self.surface is not None:
            raise ValueError("group goes with point or box; write surface: {group, normal}")
        return self


class Loads(Part):
    """What acts on the bodies from outside."""

    gravity: Acceleration3 = Field([0.0, 0.0, 0.0], description="Acceleration of gravity [m/s2]")
    tractions: list[Traction] = Field([], description="Stresses on faces")
    velocities: list[PrescribedVelocity] = Field([], description="Driven nodes")
    supports: list[Support] = Field([], description="Held nodes")


class Damping(Part):
    """What takes energy out; all are zero unless given, but local in a static stage."""

    local: Annotated[float, Quantity("1", at_least=0, below=1)] | None = Field(
        None,
        description="Share of each node's unbalanced force that opposes its motion [1]; "
        "default 0.8 in a static stage with relax: local, else 0",
    )
    mass: Annotated[float, Quantity("1/s", at_least=0)] = Field(
        0.0, description="Rayleigh factor of the mass [1/s]; it also brakes a free fall"
    )
    stiffness: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        0.0,
        description="Stiffness-proportional (Rayleigh), as a fraction of critical at the highest "
        "frequency that the time step resolves [1]",
    )
    contact: Annotated[float, Quantity("1", at_least=0)] = Field(
        0.0, description="Dashpot at each contact, as a fraction of critical [1]"
    )


class Stage(Part):
    """A part of the run with its own rules."""

    name: Name = Field(description="Name, unique in the case")
    mode: Literal["static", "dynamic"] = Field(description="To rest, or over time")
    tolerance: Annotated[float, Quantity("1", above=0, below=1)] | None = Field(
        None, description="Static only: unbalance ratio that counts as rest [1]; default 1e-5"
    )
    duration: Annotated[float, Quantity("s", above=0)] | None = Field(
        None, description="Dynamic only: time to compute [s]"
    )
    max_steps: int | None = Field(None, ge=1, description="Stop the stage after so many steps")
    reset_displacement: bool = Field(
        False, description="Zero the displacements when the stage begins"
    )
    damping: Damping = Field(Damping(), description="Damping")
    relax: Literal["local", "kinetic", "adaptive"] | None = Field(
        None,
        description="Static only: the way to rest: local damping (default), kinetic (stop at peaks of "
        "the kinetic energy), or adaptive (critical damping and scaled masses: the fewest steps)",
    )
    set: dict[str, Any] = Field(
        {}, description="Values that change when the stage begins: {path in the case: value}"
    )

    @model_validator(mode="after")
    def _fits_its_mode(self) -> Stage:
        wrong = {"static": ("duration",), "dynamic": ("tolerance", "relax")}[self.mode]
        for field in wrong:
            if getattr(self, field) is not None:
                raise ValueError(f"{field} has no meaning in a {self.mode} stage; remove it")
        if self.mode == "dynamic" and self.duration is None:
            raise ValueError("a dynamic stage needs a duration, e.g. duration: 2.0")
        # Not by assignment: that would start this check again.
        if self.mode == "static":
            self.__dict__["tolerance"] = self.tolerance or 1e-5
            self.__dict__["relax"] = self.relax or "local"
        if self.damping.local is None:
            self.damping.__dict__["local"] = 0.8 if self.relax == "local" else 0.0
        return self


class Contact(Part):
    """How contacts are found and where they act: Feng et al. (2014), Sections 3 and 4."""

    indentation: Annotated[float, Quantity("1", above=0, below=0.5)] = Field(
        0.01, description="Shift of a semi-spring from its vertex to the face's centre [1], Eq. 3"
    )
    tolerance: Annotated[float | Literal["auto"], Quantity("1", above=0, auto=True)] = Field(
        "auto",
        description="In-plane tolerance over the face's size [1]; auto: a tenth of the "
        "indentation, below which it must stay",
    )
    refresh: Annotated[
        Annotated[Literal["displacement"], Tag("word")]
        | Annotated[Annotated[int, Field(ge=1)], Tag("steps")],
        Discriminator(lambda value: "word" if isinstance(value, str) else "steps"),
    ] = Field("displacement", description="Renew the search by displacement, or every N steps")
    action: Literal["vertex", "indented"] = Field(
        "vertex", description="Where the force of a contact acts: the vertex, or as the paper does"
    )
    edges: bool = Field(True, description="Whether edges touch edges")
    bond_points: Literal["vertex", "quadrature"] = Field(
        "vertex", description="Where the bonds of a conforming interface sit"
    )
    check: bool = Field(False, description="Compare every search with an all-pairs search (slow)")


class Elements(Part):
    """How elements give forces and carry mass."""

    formulation: Literal["corotational", "incremental", "paper-incremental", "paper-total"] = Field(
        "corotational", description="How the forces of an element follow from its motion"
    )
    mass: Literal["exact", "lumped"] = Field(
        "exact", description="Exact inertia of blocks of one element, or lumped mass everywhere"
    )
    hexahedra: Literal["full", "one-point"] = Field(
        "full",
        description="Integration of hexahedra: 2 x 2 x 2 points, or one and hourglass springs",
    )


class MassScaling(Part):
    """Mass added to the elements that would force a smaller step."""

    step: Annotated[float, Quantity("s", above=0)] = Field(description="Step to reach [s]")


class Time(Part):
    """The time step."""

    step: Annotated[float | Literal["auto"], Quantity("s", above=0, auto=True)] = Field(
        "auto", description="Time step [s]; auto: safety times the stability limit"
    )
    safety: Annotated[float, Quantity("1", above=0, at_most=1)] = Field(
        0.8, description="Share of the stability limit that an automatic step uses [1]"
    )
    mass_scaling: MassScaling | None = Field(None, description="Mass scaling of the worst elements")


OutputField = Literal["displacement", "velocity", "stress", "damage", "piece"]


class Output(Part):
    """What is written while the case runs."""

    every: Annotated[float, Quantity("s", above=0)] | None = Field(
        None, description="Time between frames [s]; by default a fiftieth of each dynamic stage"
    )
    fields: list[OutputField] = Field(
        ["displacement", "velocity", "stress", "damage", "piece"], description="Fields of a frame"
    )
    checkpoint_every: Annotated[float, Quantity("s", above=0)] = Field(
        300.0, description="Wall time between checkpoints [s]"
    )
    frames: bool = Field(True, description="Whether frames are written at all")


class HistoryPoint(Part):
    """Quantities followed over time, for a group or at a node."""

    name: Name = Field(description="Name, unique in the case; begins the columns")
    group: Name | None = Field(None, description="Follow this group")
    point: Length3 | None = Field(None, description="Follow the node nearest to this point [m]")
    quantities: list[Literal["centroid", "displacement", "velocity", "energy", "force"]] = Field(
        min_length=1, description="What to follow"
    )

    @model_validator(mode="after")
    def _one_place(self) -> HistoryPoint:
        exactly_one(self, ("group", "point"))
        for quantity in ("centroid", "energy"):
            if self.point is not None and quantity in self.quantities:
                raise ValueError(f"{quantity} needs a group, not a point")
        for quantity in self.quantities:
            if self.quantities.count(quantity) > 1:
                raise ValueError(f"{quantity} is listed twice")
        return self
