"""The parts of a case: every field with its type, unit, range, default and meaning."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Discriminator, Field, PrivateAttr, Tag, model_validator

from cdem.case.blasts_schema import BlastEntry, Waves
from cdem.case.bodies_schema import Model, exactly_one
from cdem.case.bolts_schema import Bolts, BoltType
from cdem.case.boundaries_schema import Boundary
from cdem.case.damping_schema import Maxwell, Rayleigh
from cdem.case.interface_schema import Interfaces
from cdem.case.laws import BLOCK_LAWS, choice, models
from cdem.case.loads_schema import Axes, Loads
from cdem.case.map_system import MapSystem
from cdem.case.output_fields import CHOICE, USUAL
from cdem.case.softening import Softening
from cdem.case.stress_schema import InitialStress
from cdem.case.surface_schema import SurfaceLoad
from cdem.case.types import (
    FileName,
    Length3,
    Line,
    Name,
    Part,
    Quantity,
    Spin3,
    Velocity3,
)
from cdem.case.water_schema import Water
from cdem.case.waves_schema import Record
from cdem.seismic.processing import Processed

Keys = tuple[str | int, ...]
"""Place of a value in a case."""
MOST_STEPS = 2_000_000_000
"""Largest number of steps that can be counted."""


class Material(Part):
    """Material of elements."""

    density: Annotated[float, Quantity("kg/m3", above=0)] = Field(description="Density [kg/m3]")
    young_modulus: Annotated[float, Quantity("Pa", above=0)] = Field(
        description="Young's modulus [Pa]"
    )
    poisson_ratio: Annotated[float, Quantity("1", at_least=0, below=0.5)] = Field(
        description="Poisson's ratio [1]"
    )
    biot: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        0.0,
        description="Biot's coefficient: fraction of the pore pressure that reduces the stress; "
        "0: water presses in joints and on faces only [1]",
    )
    saturated_density: Annotated[float, Quantity("kg/m3", above=0)] | None = Field(
        None, description="Density below the water table; default: density [kg/m3]"
    )
    softening: Softening | None = Field(
        None, description="Fall of strengths with slip, for a plastic law"
    )
    if TYPE_CHECKING:
        law: str


if TYPE_CHECKING:
    AnyMaterial = Material
else:
    AnyMaterial = choice(models(Material, BLOCK_LAWS), BLOCK_LAWS)


class Group(Part):
    """Settings for every element of a group."""

    material: Name = Field(description="A name under materials")
    fix: Axes = Field([], description="Fixed directions of all nodes")
    velocity: Velocity3 = Field([0.0, 0.0, 0.0], description="Initial velocity [m/s]")
    angular_velocity: Spin3 = Field(
        [0.0, 0.0, 0.0], description="Initial spin about the group's centroid [rad/s]"
    )
    gravity: bool = Field(True, description="Whether gravity acts on the group")


class Damping(Part):
    """Damping."""

    local: Annotated[float, Quantity("1", at_least=0, below=1)] | None = Field(
        None,
        description="Fraction of each node's unbalanced force that opposes its motion [1]; "
        "default 0.8 in a static stage with relax: local, else 0",
    )
    mass: Annotated[float, Quantity("1/s", at_least=0)] = Field(
        0.0, description="Rayleigh factor of the mass [1/s]; it also slows a free fall"
    )
    stiffness: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        0.0,
        description="Stiffness-proportional (Rayleigh), as a fraction of critical at the highest "
        "frequency that the time step resolves [1]",
    )
    contact: Annotated[float, Quantity("1", at_least=0)] | None = Field(
        None,
        description="Dashpot at each contact without restitution, as a fraction of critical of the two "
        "touching nodes [1]; the remaining speed after an impact then depends on mass, points and "
        "shape: "
        "for a given coefficient use restitution of the interface. Default 0.1 in a dynamic stage, 0 in "
        "a static one",
    )
    rayleigh: Rayleigh | None = Field(
        None, description="Dynamic only: Rayleigh damping of the rock, with a ratio at a frequency"
    )
    maxwell: Maxwell | None = Field(
        None, description="Dynamic only: damping of the rock with a ratio that is flat over a band"
    )

    @model_validator(mode="after")
    def _one_of_a_kind(self) -> Damping:
        if self.rayleigh and self.maxwell:
            raise ValueError("rayleigh and maxwell would add up: give one of them")
        others = [key for key in ("mass", "stiffness") if getattr(self, key) > 0]
        if self.rayleigh and others:
            raise ValueError(
                f"rayleigh gives the factors of mass and stiffness: remove {' and '.join(others)}"
            )
        return self


class Release(Part):
    """Release of the forces that removed groups carried."""

    parts: int = Field(
        1, ge=1, le=10_000, description="Static only: number of equal parts, each followed by rest"
    )
    over: Annotated[float, Quantity("s", above=0)] | None = Field(
        None, description="Dynamic only: duration of an even release; default at once [s]"
    )
    to: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        1.0, description="Fraction released by the end; a later stage may release the rest [1]"
    )


class Stage(Part):
    """A part of the run with its own settings."""

    name: Name = Field(description="Name, unique in the case")
    mode: Literal["static", "dynamic"] = Field(description="To rest, or over time")
    tolerance: Annotated[float, Quantity("1", above=0, below=1)] | None = Field(
        None, description="Static only: unbalance ratio that counts as rest [1]; default 1e-5"
    )
    duration: Annotated[float, Quantity("s", above=0)] | None = Field(
        None, description="Dynamic only: time to compute [s]"
    )
    until: Literal["rest"] | None = Field(
        None,
        description="Dynamic only: end the stage when every block is at rest; duration is then the "
        "longest time",
    )
    max_steps: int | None = Field(
        None, ge=1, le=MOST_STEPS, description="Stop the stage after so many steps"
    )
    reset_displacement: bool = Field(
        False, description="Zero the displacements when the stage begins"
    )
    damping: Damping = Field(Damping(), description="Damping")
    relax: Literal["local", "kinetic", "adaptive", "solve"] | None = Field(
        None,
        description="Static only: way to rest: solve (equilibrium of elements, bonds and contacts in touch "
        "first, then as adaptive; default), adaptive (critical damping and scaled masses), kinetic "
        "(stop at peaks of the kinetic energy), or local damping",
    )
    remove: list[Name] = Field([], description="Groups excavated at the beginning of the stage")
    add: list[Name] = Field(
        [],
        description="Groups added at the beginning of the stage, free of stress and at rest: "
        "backfill, or "
        "groups removed before",
    )
    release: Release | None = Field(
        None,
        description="Release of the forces of groups removed in this stage or before; default: at "
        "once in "
        "a stage with remove, nothing in others",
    )
    set: dict[str, Any] = Field(
        {}, description="Values to change at the beginning of the stage: {path in the case: value}"
    )

    @model_validator(mode="after")
    def _fits_its_mode(self) -> Stage:
        wrong = {"static": ("duration", "until"), "dynamic": ("tolerance", "relax")}[self.mode]
        for field in wrong:
            if getattr(self, field) is not None:
                raise ValueError(f"{field} has no effect in a {self.mode} stage; remove it")
        for field in ("rayleigh", "maxwell"):
            if self.mode == "static" and getattr(self.damping, field) is not None:
                raise ValueError(f"damping.{field} has no effect in a static stage; remove it")
        if self.release is not None and self.mode == "static" and self.release.over is not None:
            raise ValueError("release.over has no effect in a static stage; write parts")
        if self.release is not None and self.mode == "dynamic" and self.release.parts > 1:
            raise ValueError("release.parts has no effect in a dynamic stage; write over")
        if self.mode == "dynamic" and self.duration is None:
            raise ValueError("a dynamic stage needs a duration, e.g. duration: 2.0")
        return self

    @model_validator(mode="after")
    def _complete(self) -> Stage:
        # Not by assignment: that would start these checks again.
        if self.mode == "static":
            self.__dict__["tolerance"] = self.tolerance or 1e-5
            self.__dict__["relax"] = self.relax or "solve"
        if self.damping.local is None:
            self.damping.__dict__["local"] = 0.8 if self.relax == "local" else 0.0
        if self.damping.contact is None:
            self.damping.__dict__["contact"] = 0.1 if self.mode == "dynamic" else 0.0
        return self


class Contact(Part):
    """Search and place of contacts: Feng et al. (2014), Sections 3 and 4."""

    indentation: Annotated[float, Quantity("1", above=0, below=0.5)] = Field(
        0.01, description="Shift of a semi-spring from its vertex to the face's centre [1], Eq. 3"
    )
    tolerance: Annotated[float | Literal["auto"], Quantity("1", above=0, auto=True)] = Field(
        "auto",
        description="In-plane tolerance over the face's size [1]; auto: a tenth of the "
        "indentation, and must be smaller than it",
    )
    refresh: Annotated[
        Annotated[Literal["displacement"], Tag("word")]
        | Annotated[Annotated[int, Field(ge=1, le=MOST_STEPS)], Tag("steps")],
        Discriminator(lambda value: "word" if isinstance(value, str) else "steps"),
    ] = Field("displacement", description="Renew the search after a displacement, or every N steps")
    action: Literal["vertex", "indented"] = Field(
        "vertex",
        description="Point where a contact force acts: the vertex, or the point of the paper",
    )
    edges: bool = Field(True, description="Whether edges touch edges")
    bond_points: Literal["vertex", "quadrature"] = Field(
        "vertex", description="Place of the bonds of a conforming interface"
    )
    check: bool = Field(False, description="Compare every search with an all-pairs search (slow)")


class Elements(Part):
    """Forces and mass of elements."""

    formulation: Literal["corotational", "incremental", "paper-incremental", "paper-total"] = Field(
        "corotational", description="Kinematics of elements"
    )
    mass: Literal["auto", "exact", "lumped-while-bonded", "lumped"] = Field(
        "auto",
        description="Exact inertia of blocks of few elements; lumped mass of blocks that have bonds, "
        "exact inertia of others; or lumped mass everywhere. auto: lumped-while-bonded",
    )
    hexahedra: Literal["full", "one-point"] = Field(
        "full",
        description="Integration of hexahedra: 2 x 2 x 2 points, or one and hourglass springs",
    )
    tetrahedra: Literal["nodal-mean", "full"] = Field(
        "nodal-mean",
        description="Dilatation of tets in blocks of several tets with a plastic material: the "
        "mean at their "
        "nodes, or one value per tet, which locks. Other tets always have their own",
    )
    strain_limit: Annotated[float, Quantity("1", above=0, at_most=1)] = Field(
        0.2, description="Plastic strain above which a run warns; above 1 it ends [1]"
    )


class MassScaling(Part):
    """Mass added where small elements, bonds and contacts would force a smaller step."""

    step: Annotated[float, Quantity("s", above=0)] | None = Field(
        None, description="Target step, without damping [s]"
    )
    most: Annotated[float, Quantity("1", above=0, at_most=1)] | None = Field(
        None,
        description="Most mass to add, as a fraction of the mass of free nodes; without step, the "
        "longest step for it "
        "[1]",
    )

    @model_validator(mode="after")
    def _asks_for_something(self) -> MassScaling:
        if self.step is None and self.most is None:
            raise ValueError("give a step to reach, or the most mass to add, e.g. most: 0.001")
        return self


class Time(Part):
    """The time step."""

    step: Annotated[float | Literal["auto"], Quantity("s", above=0, auto=True)] = Field(
        "auto", description="Time step [s]; auto: safety times the stability limit"
    )
    safety: Annotated[float, Quantity("1", above=0, at_most=1)] = Field(
        0.8, description="Fraction of the stability limit for an automatic step [1]"
    )
    mass_scaling: MassScaling | None = Field(None, description="Mass scaling of the worst nodes")
    energy_error: Annotated[float, Quantity("1", above=0)] | Literal["any"] = Field(
        0.05,
        description="Closing error of the energy balance, as a fraction of its largest term, at "
        "which a "
        "run ends as failed; any: never [1]",
    )


if TYPE_CHECKING:
    FieldName = str
else:
    FieldName = Literal[tuple(CHOICE)]


class FlowMaps(Part):
    """Largest velocity, thickness, energy ... at each place, recorded during the run."""

    cell: Annotated[float, Quantity("m", above=0)] = Field(description="Side of a cell [m]")
    groups: Annotated[list[Name], Field(min_length=1)] | None = Field(
        None, description="Groups to follow; default: groups not fixed in all directions"
    )


class Output(Part):
    """Results written during the run."""

    every: Annotated[float, Quantity("s", above=0)] | None = Field(
        None, description="Time between frames [s]; by default a fiftieth of each dynamic stage"
    )
    fields: list[FieldName] = Field(
        USUAL,
        description="Fields of a frame; state variables of a law need the law in the case",
    )
    checkpoint_every: Annotated[float, Quantity("s", above=0)] = Field(
        300.0, description="Wall time between checkpoints [s]"
    )
    frames: bool = Field(True, description="Whether to write frames")
    maps: FlowMaps | None = Field(
        None, description="Record largest values at each place for the maps of cdem runout"
    )


WAVES = ("v_base", "v_up", "v_down")
"""Quantities of boundaries."""


class HistoryPoint(Part):
    """Quantities recorded over time, of a group, a node, a bolt or a boundary."""

    name: FileName = Field(
        description="Unique name; start of the column names, and name of a picture"
    )
    group: Name | None = Field(None, description="Follow this group")
    point: Length3 | None = Field(None, description="Follow the node nearest to this point [m]")
    bolt: Name | None = Field(None, description="Follow a bolt, or the largest value of a pattern")
    boundary: Name | None = Field(None, description="Follow the waves through a boundary")
    quantities: list[
        Literal[
            "centroid", "displacement", "velocity", "acceleration", "energy", "force", "water_force",
            "surface_force", "axial_force", "slip", "plate_force", "v_base", "v_up", "v_down",
        ]
    ] = Field(
        min_length=1,
        description="Quantities; axial_force, slip and plate_force are for bolts, v_base, v_up and v_down "
        "for boundaries: their motion, the wave that comes in, and the one that leaves",
    )  # fmt: skip
    every: Annotated[float, Quantity("s", above=0)] | None = Field(
        None,
        description="Most time between its rows in a dynamic stage; all histories are one table, "
        "whose rows come at the shortest of these times. By default the time between samples of a "
        "record that acts, and at most a tenth of the time between frames [s]",
    )

    @model_validator(mode="after")
    def _one_place(self) -> HistoryPoint:
        exactly_one(self, ("group", "point", "bolt", "boundary"))
        of = dict.fromkeys(("axial_force", "slip", "plate_force"), "bolt")
        of |= dict.fromkeys(WAVES, "boundary")
        here = next((key for key in ("bolt", "boundary") if getattr(self, key) is not None), None)
        for quantity in self.quantities:
            if (needed := of.get(quantity)) != here:
                place = f"a {needed}" if needed else "a group or a point"
                raise ValueError(f"{quantity} needs {place}")
        for quantity in ("centroid", "energy"):
            if self.point is not None and quantity in self.quantities:
                raise ValueError(f"{quantity} needs a group, not a point")
        for quantity in self.quantities:
            if self.quantities.count(quantity) > 1:
                raise ValueError(f"{quantity} is listed twice")
        return self


def absent_groups(changes: Sequence[tuple[list[str], list[str]]], begun: int) -> list[str]:
    """Groups absent once this many stages have begun, sorted.

    Args:
        changes: Groups that each stage removes and adds.
        begun: Number of stages.
    """
    first: dict[str, bool] = {}  # whether a stage adds the group before any removes it
    for removes, adds in changes:
        first |= {name: name in adds for name in [*removes, *adds] if name not in first}
    gone = {name for name, added in first.items() if added}
    for removes, adds in changes[:begun]:
        gone = (gone | set(removes)) - set(adds)
    return sorted(gone)


class CaseParts(Part):
    """All parts of a case."""

    cdem: Literal[2] = Field(2, description="Version of the case format; there is one")
    title: Line = Field("", description="One line for reports")
    units: Literal["SI"] = Field("SI", description="Unit system of plain numbers")
    crs: MapSystem | None = Field(
        None,
        description="Map projection of all coordinates, e.g. EPSG:32632; also of rasters and maps",
    )
    own_laws: list[str] = Field(
        [], description="Headers with laws of users, as given to cdem law build; needs --allow-code"
    )
    model: Model = Field(description="The bodies")
    materials: dict[Name, AnyMaterial] = Field(description="Materials by name")
    groups: dict[Name, Group] = Field(description="Groups by name; every body is in one")
    interfaces: Interfaces = Field(Interfaces(), description="Interfaces by pair of groups")
    loads: Loads = Field(Loads(), description="Actions from outside")
    boundaries: list[Boundary] = Field([], description="Quiet faces, and bases that are shaken")
    records: dict[FileName, Record] = Field({}, description="Motions of the ground by name")
    initial_stress: list[InitialStress] = Field([], description="Stress at the start")
    water: Water | None = Field(None, description="Water in joints, pores and the open")
    bolts: list[Bolts] = Field([], description="Bolts and cables")
    bolt_types: dict[Name, BoltType] = Field({}, description="Types of bolts by name")
    stages: list[Stage] = Field(min_length=1, description="Parts of the run, in order")
    contact: Contact = Field(Contact(), description="Contact search")
    elements: Elements = Field(Elements(), description="Element formulation")
    time: Time = Field(Time(), description="The time step")
    waves: Waves = Field(Waves(), description="Waves in the mesh")
    output: Output = Field(Output(), description="Results to write")
    histories: list[HistoryPoint] = Field([], description="Quantities recorded over time")

    _kept_records: dict[str, Processed] = PrivateAttr(default_factory=dict)
    """Processed records of the run that is continued, by name."""

    def processed(self, name: str) -> Processed:
        """A record ready for use, in SI; the same arrays at each call."""
        return self._kept_records.get(name) or self.records[name].steps()[-1][1]

    def keep_records(self, records: dict[str, Processed]) -> None:
        """Use these processed records from now on: those of the run that is continued."""
        self._kept_records = records

    @property
    def movable(self) -> list[str]:
        """Groups that are not fixed in all directions."""
        return [name for name, group in self.groups.items() if len(set(group.fix)) < 3]

    def stages_from(self, name: str | None) -> list[Stage]:
        """The stages from one on; all without a name, none where there is no such stage."""
        names = [stage.name for stage in self.stages]
        if name is None:
            return self.stages
        return self.stages[names.index(name) :] if name in names else []

    def begun_names(self, begun: int) -> set[str | None]:
        """Names of the first so many stages, and None, with which the run itself begins."""
        return {None, *(stage.name for stage in self.stages[:begun])}

    def absent(self, begun: int) -> list[str]:
        """Groups absent once this many stages have begun, in any order."""
        return absent_groups([(stage.remove, stage.add) for stage in self.stages], begun)

    @property
    def surface_entries(self) -> list[tuple[Keys, SurfaceLoad | BlastEntry]]:
        """All entries that act on faces by a law, each with its place in the case."""
        entries: list[tuple[Keys, SurfaceLoad | BlastEntry]] = [
            (("loads", "surfaces", i), item) for i, item in enumerate(self.loads.surfaces)
        ]
        for i, blast in enumerate(self.loads.blasts):
            entries += [(("loads", "blasts", i), ring) for ring in blast.entries]
        for i, boundary in enumerate(self.boundaries):
            if boundary.absorbs:
                entries.append((("boundaries", i), boundary.dashpots))
        return entries

    @property
    def acts_on_faces(self) -> bool:
        """Whether there are such entries."""
        absorbing = any(boundary.absorbs for boundary in self.boundaries)
        return bool(self.loads.surfaces or self.loads.blasts) or absorbing

    def surface_name(self, keys: Keys) -> str:
        """Name of an entry that acts on faces, for reports: its own, or its place in the case."""
        if keys[0] == "boundaries":
            return f"boundary {self.boundaries[int(keys[1])].name}"
        return ".".join(map(str, keys))

    @property
    def moved_masses(self) -> Literal["exact", "lumped-while-bonded", "lumped"]:
        """The value of `elements.mass`, with the meaning of `auto` put in."""
        return "lumped-while-bonded" if self.elements.mass == "auto" else self.elements.mass
