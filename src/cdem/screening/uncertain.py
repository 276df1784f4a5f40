"""Uncertain strengths, directions and loads: the file of distributions, and values drawn from it."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from cdem.case.document import Document
from cdem.case.source import Keys
from cdem.case.types import Part
from cdem.joints.directions import pole
from cdem.screening.loads import Loads
from cdem.screening.planes import STEEPEST, JointPlane
from cdem.study.sampling import draw
from cdem.study.schema import Parameter, Sampling
from cdem.units import to_number

Floats = NDArray[np.float64]

OF_SETS = {
    "friction_angle": ("deg", 0.0, 89.0),
    "cohesion": ("Pa", 0.0, 1e12),
    "dip": ("deg", 0.0, 90.0),
    "dip_direction": ("deg", -360.0, 720.0),
}
"""What may be drawn of a set: its unit, and the range of its values."""
OF_LOADS = {"water": ("1", 0.0, 1.0), "kh": ("1", 0.0, 5.0), "kv": ("1", -0.99, 0.99)}
"""The same of the loads."""
DIRECTIONS = ("dip", "dip_direction")
MOST_SAMPLES = 100_000


class _Uncertain(Part):
    uncertain: Literal[1] = Field(description="Version of this format")
    parameters: dict[str, Parameter] = Field(
        min_length=1,
        description="Distributions: SET.friction_angle, .cohesion, .dip, .dip_direction; water, kh, kv",
    )
    sampling: Sampling = Field(description="Sampling of the distributions")


class Uncertain(Document, _Uncertain):
    """Distributions of what a screening depends on.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: problem.
    """

    kind = "distribution"

    def for_sets(self, planes: Sequence[JointPlane], loads: Loads) -> None:
        """Check all names against the sets and loads.

        Raises:
            CaseError: A name is unknown, or contradicts the loads.
        """
        problems = list(self._problems(planes, loads))
        if problems:
            raise self._source.error(problems)

    def _problems(self, planes: Sequence[JointPlane], loads: Loads) -> Iterator[tuple[Keys, str]]:
        if self.sampling.count > MOST_SAMPLES:
            yield ("sampling", "count"), f"must be at most {MOST_SAMPLES:,}"
        known = [f"{plane.name}.{key}" for plane in planes for key in OF_SETS] + list(OF_LOADS)
        for name, parameter in self.parameters.items():
            keys: Keys = ("parameters", name)
            if name not in known:
                close = difflib.get_close_matches(name, known, n=1)
                hint = f"did you mean {close[0]}?" if close else f"possible are {', '.join(known)}"
                yield keys, f"is neither a value of a set nor a load; {hint}"
                continue
            if not parameter.is_drawn:
                yield keys, f"give a distribution in place of {parameter.kind}"
            if name == "water" and loads.level is not None:
                yield keys, "is drawn as a share, but --water gives a water table; leave out one"
            try:
                _scale(name, parameter)
            except ValueError as error:
                yield (*keys, "unit"), str(error)

    @property
    def turns(self) -> bool:
        """Whether directions are drawn, so that each sample has other bodies."""
        return any(name.rpartition(".")[2] in DIRECTIONS for name in self.parameters)

    def draw(self) -> dict[str, Floats]:
        """Values of all samples, by name, in the units of the file.

        Raises:
            CaseError: A value is impossible; names the parameter and its limit.
            BackendError: Latin hypercubes need the extra `sweep`.
        """
        rows = draw(self.parameters, self.sampling)
        columns = {name: np.array([row[name] for row in rows]) for name in self.parameters}
        problems: list[tuple[Keys, str]] = []
        for name, values in columns.items():
            unit, low, high = _kind(name)
            scale = _scale(name, self.parameters[name])
            bad = (values * scale < low) | (values * scale > high)
            if bad.any():
                written = self.parameters[name].unit or unit
                problems.append((
                    ("parameters", name),
                    f"{int(bad.sum())} of {len(values)} values lie outside {low / scale:g} to "
                    f"{high / scale:g} [{written}], e.g. {values[bad][0]:.4g}; limit the "
                    "distribution by low and high",
                ))  # fmt: skip
        if problems:
            raise self._source.error(problems)
        return columns

    def samples(
        self, columns: dict[str, Floats], planes: Sequence[JointPlane], loads: Loads
    ) -> Iterator[Sample]:
        """The sets and loads of each sample."""
        scales = {name: _scale(name, self.parameters[name]) for name in columns}
        for number in range(self.sampling.count):
            row = {name: float(values[number] * scales[name]) for name, values in columns.items()}
            yield Sample.of(row, planes, loads)

    def label(self, name: str) -> str:
        """Name of a parameter in pictures and tables, with its unit."""
        parameter = self.parameters[name]
        unit = parameter.unit or _kind(name)[0]
        return parameter.label or (name if unit == "1" else f"{name} [{unit}]")


@dataclass(frozen=True)
class Sample:
    """The sets and loads of one sample.

    Attributes:
        planes: The sets with their drawn values, in their order.
        loads: The loads.
    """

    planes: tuple[JointPlane, ...]
    loads: Loads

    @classmethod
    def of(cls, row: dict[str, float], planes: Sequence[JointPlane], loads: Loads) -> Sample:
        """Sets and loads with drawn values, in SI and degrees, by name."""
        drawn = replace(
            loads,
            kh=row.get("kh", loads.kh),
            kv=row.get("kv", loads.kv),
            share=row.get("water", loads.share),
        )
        return cls(tuple(_drawn(plane, row) for plane in planes), drawn)


def _drawn(plane: JointPlane, row: dict[str, float]) -> JointPlane:
    own = {key: row[f"{plane.name}.{key}"] for key in OF_SETS if f"{plane.name}.{key}" in row}
    normal = plane.normal
    if any(key in own for key in DIRECTIONS):
        dip = min(own.get("dip", plane.dip), STEEPEST)
        normal = pole(dip, own.get("dip_direction", plane.dip_direction) % 360)
    friction, cohesion = (
        own.get("friction_angle", plane.friction),
        own.get("cohesion", plane.cohesion),
    )
    return JointPlane(plane.name, normal, friction, cohesion, plane.persistence)


def _kind(name: str) -> tuple[str, float, float]:
    """Unit of a parameter, and the range of its values."""
    return OF_LOADS.get(name) or OF_SETS[name.rpartition(".")[2]]


def _scale(name: str, parameter: Parameter) -> float:
    """Factor from the unit of a parameter to SI and degrees."""
    unit = _kind(name)[0]
    return to_number(f"1 {parameter.unit}", unit) if parameter.unit else 1.0
