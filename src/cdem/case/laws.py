"""Laws as declared by the compiled core: their keys in a case, their checks, their numbers."""

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
        symbol: Its symbol in formulas.
        unit: Unit in a case.
        meaning: Its meaning.
        at_least: Lowest allowed value [unit], or None.
        below: Upper limit, itself not allowed [unit], or None.
        at_most: Highest allowed value [unit], or None.
        default: Default value, infinity for a strength without a limit, or None.
        like: Parameter whose value is the default, or None.
        is_tangent: Whether it is an angle and the core takes its tangent.
        is_half_tangent: Whether it is an angle and the core takes the tangent of half of it.
        is_strength: Whether a factor of safety divides it (for an angle, its tangent).
        is_factor: Whether a factor of safety multiplies it.
        choices: Allowed words (the core takes the number of the word); empty for a number.
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
        """Whether the case must give it, in a pair or in the default."""
        return self.default is None and self.like is None

    def text(self, value: float) -> str:
        """A value with symbol and unit; the angle of friction speaks for itself."""
        symbol = "" if self.name == "friction_angle" else f"{self.symbol} "
        return f"{symbol}{value:g}" + ("" if self.unit == "1" else f" {self.unit}")

    def field(self, required: bool) -> tuple[Any, Any]:
        """Type and field of a pydantic model; not required: an omitted value is None."""
        if self.choices:
            return self.annotation, Field(self.choices.split()[0], description=self.meaning)
        text = f"{self.meaning} [{self.unit}]"
        if self.default == math.inf:  # no number in a case
            return self.annotation | None, Field(None, description=text)
        if self.default is not None:
            return self.annotation, Field(self.default, description=text)
        if required and self.like is None:
            return self.annotation, Field(description=text)
        return self.annotation, Field(None, validate_default=False, description=text)


@dataclass(frozen=True)
class StateVariable:
    """A state variable of a law; an output field has the same name."""

    name: str
    unit: str
    meaning: str


@dataclass(frozen=True)
class Law:
    """Declaration of a law.

    Attributes:
        name: Its value of the key `law` in a case.
        meaning: One sentence.
        flows: Block law: whether it can give inelastic strain.
        curved: Interface law: whether its joints have a closure curve.
        absorbs: Surface law: whether it has dashpots to the ground.
        parameters: In the order of the core.
        state: In the order of the core.
        softening: Block law: names of the strengths that may fall.
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
        """Parameters of a part of a case, including omitted ones."""
        given = {p.name: getattr(part, p.name) for p in self.parameters}
        of_like = {p.name: given[p.like] for p in self.parameters if p.like}
        values = {name: of_like.get(name) if v is None else v for name, v in given.items()}
        for p in self.parameters:
            if p.choices:
                values[p.name] = p.choices.split().index(getattr(part, p.name))
        return {name: math.inf if v is None else float(v) for name, v in values.items()}

    def numbers(self, part: Part) -> dict[str, float]:
        """The parameters in the core's units: SI, tangents instead of angles."""
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
            if not p.is_strength or getattr(part, p.name) is None:  # unlimited, or equal to another
                continue
            value = float(getattr(part, p.name))
            if p.is_tangent:
                reduced[p.name] = math.degrees(math.atan(math.tan(math.radians(value)) / factor))
            else:
                reduced[p.name] = value / factor
        return reduced

    def summary(self, part: Part) -> str:
        """The strengths of an interface as a line of text."""
        strengths = [
            p for p in self.parameters if p.is_strength and getattr(part, p.name) is not None
        ]
        if not strengths:  # a factor of safety acts on their result
            strengths = [p for p in self.parameters if p.default is None and p.like is None]
        text = ", ".join(p.text(getattr(part, p.name)) for p in strengths if not p.bonds)
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
    """Why the parameters of an interface contradict each other, or None."""
    law = INTERFACE_LAWS[part.__dict__["law"]]
    why = native.interface_contradiction(law.name, law.numbers(part))
    return why.format(**law.values(part))


def block_contradiction(part: Part) -> str:
    """Why the parameters of a material contradict each other, or None."""
    law = BLOCK_LAWS[part.__dict__["law"]]
    why = native.block_contradiction(law.name, law.numbers(part))
    return why.format(**law.values(part))


def surface_contradiction(part: Part) -> str:
    """Why the parameters of a surface law contradict each other, or None."""
    law = SURFACE_LAWS[part.__dict__["law"]]
    why = native.surface_contradiction(law.name, law.numbers(part))
    return why.format(**law.values(part))


def models(base: type[Part], laws: dict[str, Law], required: bool = True) -> list[type[Part]]:
    """A model for every law: the fields of the base, the key `law`, the parameters of the law.

    Args:
        base: Common fields.
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
    """Type of a field that takes any of the models; the key `law` decides."""
    if len(made) == 1:
        return made[0]
    first = next(iter(laws))

    def law_of(value: Any) -> str:
        name = value.get("law", first) if isinstance(value, dict) else getattr(value, "law", first)
        return name if isinstance(name, str) and name in laws else first

    tagged = tuple(Annotated[model, Tag(name)] for model, name in zip(made, laws, strict=True))
    return Annotated[Union[tagged], Discriminator(law_of)]  # noqa: UP007
