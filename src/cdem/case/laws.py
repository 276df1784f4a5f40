"""Laws as the compiled core declares them: their part of a case, their checks, their numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Union

from pydantic import Discriminator, Field, Tag, create_model

from cdem._native import core as native
from cdem.case.types import Part, Quantity


@dataclass(frozen=True)
class Parameter:
    """A parameter of a law.

    Attributes:
        name: Its key in a case.
        symbol: In formulas.
        unit: Unit in a case.
        meaning: What it is.
        at_least: Lowest value allowed [unit], or None.
        below: Limit that it must stay below [unit], or None.
        at_most: Highest value allowed [unit], or None.
        default: Value where the case is silent, infinity for a strength without a limit, or None.
        like: Parameter whose value it has where the case is silent, or None.
        is_tangent: Whether it is an angle whose tangent the core takes.
        is_half_tangent: Whether it is an angle of which the core takes the tangent of the half.
        is_strength: Whether a factor of safety divides it (of an angle, the tangent).
        is_factor: Whether a factor of safety multiplies it.
        choices: Words that it may be, the core takes the place of the word; empty for a number.
        bonds: Whether a value above zero bonds faces that touch at the start.
    """

    name: str
    symbol: str
    unit: str
    meaning: str
    at_least: float | None
    below: float | None
    at_most: float | None
    default: float | None
    like: str | None
    is_tangent: bool
    is_half_tangent: bool
    is_strength: bool
    is_factor: bool
    choices: str
    bonds: bool

    @property
    def annotation(self) -> Any:
        """Its type in a case."""
        if self.choices:
            return Literal[tuple(self.choices.split())]
        limits = Quantity(self.unit, at_least=self.at_least, below=self.below, at_most=self.at_most)
        return Annotated[float, limits]

    @property
    def is_required(self) -> bool:
        """Whether the case must give it, for a pair or by the default."""
        return self.default is None and self.like is None

    def field(self, required: bool) -> tuple[Any, Any]:
        """Type and field of a pydantic model; not required: it may be left out and is then None."""
        if self.choices:
            return self.annotation, Field(self.choices.split()[0], description=self.meaning)
        text = f"{self.meaning} [{self.unit}]"
        if self.default == math.inf:  # no number of a case
            return self.annotation | None, Field(None, description=text)
        if self.default is not None:
            return self.annotation, Field(self.default, description=text)
        if required and self.like is None:
            return self.annotation, Field(description=text)
        return self.annotation, Field(None, validate_default=False, description=text)


@dataclass(frozen=True)
class StateVariable:
    """A number that a law remembers, which is an output field of the same name."""

    name: str
    unit: str
    meaning: str


@dataclass(frozen=True)
class Law:
    """What a law says of itself.

    Attributes:
        name: Its value of the key `law` in a case.
        meaning: One sentence.
        flows: Of a block law: whether it ever gives inelastic strain.
        curved: Of an interface law: whether its joints close by a curve.
        absorbs: Of a surface law: whether it has dashpots to the ground.
        parameters: In the order of the core.
        state: In the order of the core.
        softening: Of a block law: the names of the strengths that may fall.
    """

    name: str
    meaning: str
    flows: bool
    curved: bool
    absorbs: bool
    parameters: tuple[Parameter, ...]
    state: tuple[StateVariable, ...]
    softening: tuple[str, ...] = ()

    def values(self, part: Part) -> dict[str, float]:
        """Parameters of a part of a case, those that it leaves out included."""
        given = {p.name: getattr(part, p.name) for p in self.parameters}
        of_like = {p.name: given[p.like] for p in self.parameters if p.like}
        values = {name: of_like.get(name) if v is None else v for name, v in given.items()}
        for p in self.parameters:
            if p.choices:
                values[p.name] = p.choices.split().index(getattr(part, p.name))
        return {name: math.inf if v is None else float(v) for name, v in values.items()}

    def numbers(self, part: Part) -> dict[str, float]:
        """The same as the core takes them: SI, of angles the tangent."""
        values = self.values(part)
        for p in self.parameters:
            if p.is_tangent:
                values[p.name] = math.tan(math.radians(values[p.name]))
            if p.is_half_tangent:
                values[p.name] = math.tan(math.radians(values[p.name]) / 2)
        return values

    def bonds(self, part: Part) -> bool:
        """Whether faces with this interface are bonded at the start."""
        return any(p.bonds and getattr(part, p.name) > 0 for p in self.parameters)

    def reduced(self, part: Part, factor: float) -> dict[str, float]:
        """Strengths of a part of a case, divided by a factor of safety."""
        reduced = {p.name: getattr(part, p.name) * factor for p in self.parameters if p.is_factor}
        for p in self.parameters:
            if not p.is_strength or getattr(part, p.name) is None:  # unlimited, or like another
                continue
            value = float(getattr(part, p.name))
            if p.is_tangent:
                reduced[p.name] = math.degrees(math.atan(math.tan(math.radians(value)) / factor))
            else:
                reduced[p.name] = value / factor
        return reduced

    def summary(self, part: Part) -> str:
        """The strengths of an interface in a line of text."""
        strengths = [
            p for p in self.parameters if p.is_strength and getattr(part, p.name) is not None
        ]
        if not strengths:  # a factor divides what follows from all of them
            strengths = [p for p in self.parameters if p.default is None and p.like is None]
        text = ", ".join(f"{getattr(part, p.name):g} {p.unit}" for p in strengths if not p.bonds)
        if self.bonds(part):
            bonds = [p for p in strengths if p.bonds]
            values = " ".join(f"{p.symbol} {getattr(part, p.name):.3g}" for p in bonds)
            text += f", bonded {values} {bonds[0].unit}"
        return text


def _declared(laws: list[dict[str, Any]]) -> dict[str, Law]:
    return {
        law["name"]: Law(
            law["name"],
            law["meaning"],
            law["flows"],
            law["curved"],
            law["absorbs"],
            tuple(Parameter(**p) for p in law["parameters"]),
            tuple(StateVariable(**v) for v in law["state"]),
            tuple(law["softening"]),
        )
        for law in laws
    }


INTERFACE_LAWS = _declared(native.interface_laws())
BLOCK_LAWS = _declared(native.block_laws())
SURFACE_LAWS = _declared(native.surface_laws())
STATES = {
    variable.name: variable
    for law in (*BLOCK_LAWS.values(), *INTERFACE_LAWS.values())
    for variable in law.state
}
"""State variables of all laws, by name: each is an output field."""


def interface_contradiction(part: Part) -> str:
    """Why the parameters of an interface do not fit each other, or nothing."""
    law = INTERFACE_LAWS[part.__dict__["law"]]
    why = native.interface_contradiction(law.name, law.numbers(part))
    return why.format(**law.values(part))


def block_contradiction(part: Part) -> str:
    """Why the parameters of a material do not fit each other, or nothing."""
    law = BLOCK_LAWS[part.__dict__["law"]]
    why = native.block_contradiction(law.name, law.numbers(part))
    return why.format(**law.values(part))


def surface_contradiction(part: Part) -> str:
    """Why the parameters of a surface law do not fit each other, or nothing."""
    law = SURFACE_LAWS[part.__dict__["law"]]
    why = native.surface_contradiction(law.name, law.numbers(part))
    return why.format(**law.values(part))


def models(base: type[Part], laws: dict[str, Law], required: bool = True) -> list[type[Part]]:
    """A model for every law: the fields of the base, the key `law`, the parameters of the law.

    Args:
        base: Fields that all have.
        laws: The laws.
        required: False where parameters without a default may be left out.
    """
    names = Literal[tuple(laws)]  # type: ignore[valid-type]
    made = []
    for law in laws.values():
        fields: dict[str, Any] = {p.name: p.field(required) for p in law.parameters}
        fields["law"] = (names, Field(law.name, description=f"Law: {law.meaning}"))
        name = base.__name__ + law.name.title().replace("-", "") if len(laws) > 1 else base.__name__
        made.append(create_model(name, __base__=base, __doc__=law.meaning, **fields))
    return made


def choice(made: list[type[Part]], laws: dict[str, Law]) -> Any:
    """The type of a field that takes any of the models; the key `law` says which."""
    if len(made) == 1:
        return made[0]
    first = next(iter(laws))

    def law_of(value: Any) -> str:
        name = value.get("law", first) if isinstance(value, dict) else getattr(value, "law", first)
        return name if isinstance(name, str) and name in laws else first

    tagged = tuple(Annotated[model, Tag(name)] for model, name in zip(made, laws, strict=True))
    return Annotated[Union[tagged], Discriminator(law_of)]  # noqa: UP007
