"""Surfaces of a case, and laws that act on them from outside."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, get_args

from pydantic import Discriminator, Field, Tag, model_validator

from cdem.case.laws import SURFACE_LAWS, choice, models, surface_contradiction
from cdem.case.timed_schema import Factored
from cdem.case.types import Direction3, Name, Part

QUIET = "quiet"
"""The surface law of boundaries."""


class FacesOfGroup(Part):
    """The outer faces of a group, or of several, with one outward direction."""

    group: Annotated[
        Annotated[Name, Tag("one")]
        | Annotated[Annotated[list[Name], Field(min_length=1)], Tag("some")],
        Discriminator(lambda value: "some" if isinstance(value, list) else "one"),
    ] = Field(description="Group, or a list of groups")
    normal: Direction3 = Field(description="Outward normal of the faces [1]")

    @property
    def groups(self) -> list[str]:
        """All groups."""
        return self.group if isinstance(self.group, list) else [self.group]

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


def surface_groups(surface: object) -> list[str]:
    """Groups that a surface names."""
    return surface.groups if isinstance(surface, FacesOfGroup) else []


class SurfaceLoad(Factored):
    """A law on faces in their present position; each law adds its parameters."""

    acts_from_stage: ClassVar[bool] = True
    ring: ClassVar[None] = None
    """It acts on all its faces, not on a ring of them."""
    if TYPE_CHECKING:
        law: str
    surface: Surface = Field(description="Surface of the mesh, or {group, normal}")
    stage: Name | None = Field(
        None,
        description="Stage in which it starts to act; times of its history and displacements of "
        "its faces "
        "count from there; by default from the start of the run",
    )

    @model_validator(mode="before")
    @classmethod
    def _is_no_boundary(cls, data: Any) -> Any:
        laws = get_args(cls.model_fields["law"].annotation)
        if isinstance(data, dict) and data.get("law") == QUIET and QUIET not in laws:
            raise ValueError(
                "quiet faces are boundaries; write boundaries: [{name: NAME, surface: SURFACE, "
                "quiet: true}]"
            )
        return data

    @model_validator(mode="after")
    def _parameters_fit(self) -> SurfaceLoad:
        if why := surface_contradiction(self):
            raise ValueError(why)
        return self


OF_ENTRIES = {name: law for name, law in SURFACE_LAWS.items() if name != QUIET}
"""Laws that an entry may have; quiet faces are boundaries."""
if TYPE_CHECKING:
    AnySurfaceLoad = SurfaceLoad
else:
    AnySurfaceLoad = choice(models(SurfaceLoad, OF_ENTRIES), OF_ENTRIES)
