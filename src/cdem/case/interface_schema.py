"""Interfaces of a case: friction, bonds and stiffness, by pair of groups or set of joints."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from cdem.case.bodies_schema import exactly_one
from cdem.case.types import (
    AUTO_STIFFNESS,
    Name,
    Part,
    Quantity,
    Stiffness,
)


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
