"""Interfaces of a case: law and stiffness, by pair of groups or set of joints."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Discriminator, Field, Tag, model_validator

from cdem.case.bodies_schema import exactly_one
from cdem.case.laws import INTERFACE_LAWS, choice, interface_contradiction, models
from cdem.case.types import AUTO, Name, Part, Quantity, Stiffness


class Overlap(Part):
    """Allowed overlap of blocks in contact; the stiffness of contacts follows from it."""

    overlap: Annotated[float, Quantity("1", above=0, below=0.05)] = Field(
        description="Overlap under the weight of the rock above, over the height of the element [1]"
    )
    impact: Annotated[float, Quantity("1", above=0, below=0.05)] = Field(
        0.01, description="Overlap in an impact, over the height of the element [1]"
    )
    speed: Annotated[float, Quantity("m/s", at_least=0)] | None = Field(
        None,
        description="Largest speed of impact [m/s]; by default the largest speed at which a group "
        "starts or is driven",
    )


Coefficient = Annotated[float, Quantity("1", above=0.05, at_most=1)]
"""Lowest coefficient of restitution. Contacts unload 1 / e^2 times as stiff as they load, so at
this
limit their stable step is a twentieth; an impact that keeps 0.25 % of its energy is practically
plastic."""


class Restitution(Part):
    """Coefficients of restitution of contacts."""

    normal: Coefficient = Field(
        1.0, description="Normal coefficient of restitution e_n: speed after over speed before [1]"
    )
    tangential: Coefficient = Field(
        1.0,
        description="Tangential coefficient e_t: contacts return e_t^2 of the work that loaded "
        "their shear springs [1]",
    )


class Heterogeneity(Part):
    """Variation of bond strength from one pair of faces to the next."""

    weibull: Annotated[float, Quantity("1", at_least=1)] = Field(
        description="Shape m of Weibull's distribution with mean 1: cohesion and tensile strength "
        "of "
        "each pair are multiplied by a random value, fracture energies by its square [1]"
    )
    seed: Annotated[int, Field(ge=0, lt=2**63)] = Field(
        0, description="Seed: a random value depends only on the seed and the two faces"
    )

    @property
    def mean(self) -> float:
        """Mean of the distribution with scale 1."""
        return math.gamma(1 + 1 / self.weibull)


class Interface(Part):
    """Keys that every interface has; each law adds its parameters."""

    if TYPE_CHECKING:
        law: str
    stiffness_n: Stiffness = Field(
        AUTO,
        description="Normal stiffness of bonds: auto (10 E/h; between elements that are blocks a "
        "stiffness that their modulus compensates), a number [Pa/m], or '5 E/h'",
    )
    stiffness_s: Stiffness = Field(
        AUTO, description="Shear stiffness of bonds: auto, a number [Pa/m], or '5 E/h'"
    )
    contact_stiffness: Annotated[
        Annotated[Stiffness, Tag("value")] | Annotated[Overlap, Tag("overlap")],
        Discriminator(lambda v: "overlap" if isinstance(v, dict | Overlap) else "value"),
    ] = Field(
        AUTO,
        description="Normal and shear stiffness of contacts: auto (the bond stiffness if given, "
        "else 1 E/h, in soft rock up to 10 so that blocks overlap by at most 1 % under weight and 2 % "
        "at their initial speeds), a number [Pa/m], '0.3 E/h', or an allowed overlap",
    )
    restitution: Annotated[
        Annotated[Coefficient, Tag("value")] | Annotated[Restitution, Tag("each")],
        Discriminator(lambda v: "each" if isinstance(v, dict | Restitution) else "value"),
    ] = Field(
        1.0,
        description="Coefficient of restitution of contacts [1], whatever the masses: normal, or "
        "{normal: 0.5, tangential: 0.8}; 1 returns all energy. Contacts unload more stiffly than "
        "they load",
    )

    rolling_resistance: Annotated[float, Quantity("1", at_least=0, below=1)] = Field(
        0.0,
        description="Rolling resistance mu_r: contacts of vertices with faces resist with couples "
        "up to "
        "mu_r R F_n, R the radius of a sphere of the block's volume [1]",
    )

    heterogeneity: Heterogeneity | None = Field(
        None,
        description="Random strength of bonds, pair by pair: {weibull: 5, seed: 1}",
    )

    def idle_heterogeneity(self) -> str:
        """Why the given heterogeneity would have no effect; None if it has one."""
        given = self.heterogeneity if "heterogeneity" in self.model_fields_set else None
        if given is None or INTERFACE_LAWS[self.law].bonds(self):
            return ""
        return "heterogeneity varies bonds; it needs cohesion or tensile_strength above 0"

    def curve_conflict(self) -> str:
        """Why a restitution does not suit the law; None if it does."""
        if not INTERFACE_LAWS[self.law].curved or min(self.coefficients()) == 1:
            return ""
        return f"restitution must be 1 with law {self.law}, whose joints have a closure curve"

    def coefficients(self) -> tuple[float, float]:
        """Normal and tangential coefficient of restitution [1]."""
        given = self.restitution
        if isinstance(given, Restitution):
            return given.normal, given.tangential
        return given, 1.0


class InterfacePair(Interface):
    """The interface between two groups or in a set of joints; omitted keys are as in the default."""

    name: Name | None = Field(None, description="A name for use in paths, e.g. interfaces.bed")
    between: list[Name] | None = Field(
        None, min_length=2, max_length=2, description="Two groups, or one group twice"
    )
    joint: Name | None = Field(
        None, description="Set of joints instead of groups: contacts of two of its faces"
    )

    @model_validator(mode="after")
    def _one_place(self) -> InterfacePair:
        exactly_one(self, ("between", "joint"))
        return self

    def inherited(self) -> set[str]:
        """Fields taken from the default: common fields that the case left out."""
        own = {p.name for p in INTERFACE_LAWS[self.law].parameters} | Interface.model_fields.keys()
        return own - self.model_fields_set


if TYPE_CHECKING:
    AnyInterface = Interface
    AnyPair = InterfacePair
else:
    AnyInterface = choice(models(Interface, INTERFACE_LAWS), INTERFACE_LAWS)
    AnyPair = choice(models(InterfacePair, INTERFACE_LAWS, required=False), INTERFACE_LAWS)


class Interfaces(Part):
    """Interfaces by pair of groups, or by set of joints."""

    default: AnyInterface | None = Field(
        None, description="For pairs of groups not listed in pairs"
    )
    pairs: list[AnyPair] = Field([], description="For the pairs of groups named")

    @model_validator(mode="before")
    @classmethod
    def _pairs_have_the_law_of_the_default(cls, data: Any) -> Any:
        default = data.get("default") if isinstance(data, dict) else None
        law = default.get("law") if isinstance(default, dict) else getattr(default, "law", None)
        pairs = data.get("pairs") if law is not None else None
        if not isinstance(pairs, list):
            return data
        same = [{"law": law} | p if isinstance(p, dict) else p for p in pairs]
        return data | {"pairs": same}

    @model_validator(mode="after")
    def _complete_and_single(self) -> Interfaces:
        seen = set()
        for number, pair in enumerate(self.pairs):
            key = frozenset(pair.between) if pair.between else pair.joint
            if key in seen:
                listed = f"{' and '.join(pair.between)} are" if pair.between else f"{pair.joint} is"
                raise ValueError(f"pairs.{number}: {listed} listed twice; keep one")
            seen.add(key)
        self.inherit()
        for number, pair in enumerate(self.pairs):
            for parameter in INTERFACE_LAWS[pair.law].parameters:
                if getattr(pair, parameter.name) is None and parameter.is_required:
                    raise ValueError(
                        f"pairs.{number}: {parameter.name} is missing here and in "
                        f"interfaces.default"
                    )
        named = {} if self.default is None else {"default": self.default}
        for place, law in (named | {f"pairs.{i}": p for i, p in enumerate(self.pairs)}).items():
            why = interface_contradiction(law) or law.idle_heterogeneity() or law.curve_conflict()
            if why:
                raise ValueError(f"{place}: {why}")
        return self

    def inherit(self) -> None:
        """Give each pair the default's value for every field that the case left out."""
        for pair in self.pairs if self.default else []:
            for field in pair.inherited():
                if hasattr(self.default, field):  # another law may lack the parameter
                    # Not by assignment: the field must still count as left out.
                    pair.__dict__[field] = getattr(self.default, field)

    def fixed(self) -> dict[str, list[Any]]:
        """Values fixed at the start, of all interfaces; the default's come last."""
        laws = [*self.pairs, *([] if self.default is None else [self.default])]
        return {
            "restitution": [law.coefficients() for law in laws],
            "heterogeneity": [law.heterogeneity for law in laws],
        }

    def between(self, group_a: str, group_b: str) -> Interface | None:
        """Return the interface of two groups, or None if the case gives none."""
        for pair in self.pairs:
            if pair.between and set(pair.between) == {group_a, group_b}:
                return pair
        return self.default
