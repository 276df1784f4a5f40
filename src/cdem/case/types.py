"""Field types of a case: numbers with a unit and a range, vectors, and interface stiffness."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    StringConstraints,
)
from pydantic_core import core_schema

from cdem.units import describe, to_number


class Part(BaseModel):
    """Base of every mapping of a case: unknown keys are errors, and assignments are checked."""

    model_config = ConfigDict(
        extra="forbid",
        validate_assignment=True,
        allow_inf_nan=False,
        coerce_numbers_to_str=True,
    )


@dataclass(frozen=True)
class Quantity:
    """A number with a unit and a range; reads ``30e9`` as well as ``"30 GPa"``.

    Attributes:
        unit: Unit of the number in the case.
        above: Lower limit, itself not allowed [unit].
        at_least: Lower limit, itself allowed [unit].
        below: Upper limit, itself not allowed [unit].
        at_most: Upper limit, itself allowed [unit].
        auto: Whether the word ``auto`` is allowed.
    """

    unit: str
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None
    auto: bool = False

    def read(self, value: object) -> float | str:
        """Return the number in ``unit``, or ``"auto"``; ValueError if it is not allowed."""
        if self.auto and value == "auto":
            return "auto"
        number = to_number(value, self.unit)
        too_low = (self.above is not None and number <= self.above) or (
            self.at_least is not None and number < self.at_least
        )
        too_high = (self.below is not None and number >= self.below) or (
            self.at_most is not None and number > self.at_most
        )
        if too_low or too_high:
            raise ValueError(f"must {self.range_text()} [{self.unit}], got {describe(value)}")
        return number

    def range_text(self) -> str:
        """Say the range in words: ``lie in [0, 0.5)``, ``be above 0``."""
        low = self.above if self.above is not None else self.at_least
        high = self.below if self.below is not None else self.at_most
        if low is not None and high is not None:
            left, right = "[("[self.above is not None], "])"[self.below is not None]
            return f"lie in {left}{low:g}, {high:g}{right}"
        if low is not None:
            return f"be {'above' if self.above is not None else 'at least'} {low:g}"
        return f"be {'below' if self.below is not None else 'at most'} {high:g}"

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        limits = {
            "exclusiveMinimum": self.above,
            "minimum": self.at_least,
            "exclusiveMaximum": self.below,
            "maximum": self.at_most,
        }
        number = {"type": "number"} | {k: v for k, v in limits.items() if v is not None}
        kinds: list[dict[str, Any]] = [number, {"type": "string", "examples": [f"1 {self.unit}"]}]
        return {"anyOf": [{"const": "auto"}, *kinds] if self.auto else kinds, "unit": self.unit}


@dataclass(frozen=True)
class Stiffness:
    """Stiffness of an interface per area.

    Attributes:
        value: Stiffness [Pa/m], or when ``relative`` the multiple of E/h [1]; 0 for auto.
        relative: Whether ``value`` multiplies E/h, E the Young's modulus and h the height of the
            element behind the face.
    """

    value: float
    relative: bool

    @classmethod
    def read(cls, value: object) -> Stiffness:
        """Read ``auto``, a number [Pa/m], text such as ``"5 GPa/m"``, or ``"10 E/h"``."""
        if isinstance(value, cls):
            return value
        if value == "auto":
            return AUTO
        if isinstance(value, str) and (match := re.fullmatch(r"\s*(\S+)\s+E\s*/\s*h\s*", value)):
            return cls(Quantity("1", above=0).read(match[1]), relative=True)  # type: ignore[arg-type]
        if isinstance(value, str) and not re.match(r"\s*[-+.\d]", value):
            raise ValueError(f"must be auto, a number [Pa/m], '3 GPa/m' or '1 E/h', got {value!r}")
        return cls(Quantity("Pa/m", above=0).read(value), relative=False)  # type: ignore[arg-type]

    def as_pair(self) -> tuple[float, float]:
        """Return (stiffness [Pa/m], 0), or (0, multiple of E/h)."""
        return (0.0, self.value) if self.relative else (self.value, 0.0)

    def write(self) -> float | str:
        """Return the text in a case file: auto, a number [Pa/m] or ``"10 E/h"``."""
        if self == AUTO:
            return "auto"
        return f"{self.value!r} E/h" if self.relative else self.value

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(
            cls.read,
            serialization=core_schema.plain_serializer_function_ser_schema(lambda s: s.write()),
        )

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict[str, Any]:
        texts = {"type": "string", "examples": ["10 E/h", "5 GPa/m"]}
        number = {"type": "number", "exclusiveMinimum": 0}
        return {"anyOf": [{"const": "auto"}, number, texts], "unit": "Pa/m"}


AUTO = Stiffness(0.0, relative=True)
"""The value that lets the program choose."""


def _as_list(value: object) -> object:
    """Accept NumPy arrays as lists in a case built in Python."""
    return value.tolist() if hasattr(value, "tolist") else value


Three = Field(min_length=3, max_length=3)
Listed = BeforeValidator(_as_list)
Length3 = Annotated[list[Annotated[float, Quantity("m")]], Three, Listed]
Size3 = Annotated[list[Annotated[float, Quantity("m", above=0)]], Three, Listed]
Direction3 = Annotated[list[Annotated[float, Quantity("1")]], Three, Listed]
Velocity3 = Annotated[list[Annotated[float, Quantity("m/s")]], Three, Listed]
Spin3 = Annotated[list[Annotated[float, Quantity("rad/s")]], Three, Listed]
Acceleration3 = Annotated[list[Annotated[float, Quantity("m/s2")]], Three, Listed]
Stress6 = Annotated[
    list[Annotated[float, Quantity("Pa")]], Field(min_length=6, max_length=6), Listed
]
StressGradient6 = Annotated[
    list[Annotated[float, Quantity("Pa/m")]], Field(min_length=6, max_length=6), Listed
]
Stress3 = Annotated[list[Annotated[float, Quantity("Pa")]], Three, Listed]
Divisions3 = Annotated[list[Annotated[int, Field(ge=1, le=100_000)]], Three, Listed]
Angle = Annotated[float, Quantity("deg")]


def _one_line(text: str) -> str:
    """Refuse line ends and other invisible characters."""
    for character in text:
        if unicodedata.category(character) in ("Cc", "Cs", "Zl", "Zp"):
            raise ValueError(f"must be plain text of one line, got the character {character!a}")
    return text


def _file_name(text: str) -> str:
    """Refuse names that some system does not allow as a part of a file name."""
    for character in text:
        if character in '/\\:*?"<>|':
            raise ValueError(f"names files, so it cannot contain the character {character}")
    if len(text.encode()) > LONGEST_FILE_NAME:
        raise ValueError(f"names files, so it cannot be longer than {LONGEST_FILE_NAME} bytes")
    return text


LONGEST_FILE_NAME = 200
MOST_SEEDS = 2**63 - 1
Line = Annotated[str, AfterValidator(_one_line)]
Name = Annotated[str, StringConstraints(min_length=1), AfterValidator(_one_line)]
FileName = Annotated[Name, AfterValidator(_file_name)]
