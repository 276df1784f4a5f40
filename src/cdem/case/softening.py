"""Fall of strengths of rock with the slip across a band of elements: `materials.NAME.softening`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from cdem._native import core as native
from cdem.case.laws import BLOCK_LAWS, Law
from cdem.case.types import Part, Quantity

Problem = tuple[tuple[str | int, ...], str]  # path, problem
_Slip = Annotated[float, Quantity("m", at_least=0)]
_Stresses = list[tuple[_Slip, Annotated[float, Quantity("Pa", at_least=0)]]]
_Angles = list[tuple[_Slip, Annotated[float, Quantity("deg", at_least=0, below=90)]]]


def _table(what: str, unit: str) -> Any:
    return Field(None, description=f"{what}: rows of slip [m] and value [{unit}], from slip 0 on")


class Softening(Part):
    """Strengths over the slip across a band of elements: plastic strain times element size."""

    cohesion: _Stresses | None = _table("Cohesion", "Pa")
    friction_angle: _Angles | None = _table("Friction angle; its tangent is interpolated", "deg")
    dilation_angle: _Angles | None = _table("Dilation angle; its tangent is interpolated", "deg")
    tensile_strength: _Stresses | None = _table("Tensile strength, over the opening", "Pa")
    fracture_energy: Annotated[float, Quantity("J/m2", above=0)] | None = Field(
        None,
        description="Instead of tensile_strength, for a linear fall to 0: the energy spent "
        "by then [J/m2]",
    )
    joint_cohesion: _Stresses | None = _table("Cohesion of the weak plane", "Pa")
    joint_friction_angle: _Angles | None = _table("Friction angle of the weak plane", "deg")
    joint_dilation_angle: _Angles | None = _table("Dilation angle of the weak plane", "deg")
    joint_tensile_strength: _Stresses | None = _table(
        "Tensile strength across the weak plane", "Pa"
    )


def tables_of(material: Part) -> dict[str, list[tuple[float, float]]]:
    """Tables of a material in the core's units, by name: slip [m], value [Pa] or tangent."""
    softening = getattr(material, "softening", None)
    if softening is None:
        return {}
    tables = {}
    tangents = {p.name for p in BLOCK_LAWS[material.__dict__["law"]].parameters if p.is_tangent}
    for name in _law(material).softening:
        rows = getattr(softening, name)
        if rows and name in tangents:
            rows = [(slip, math.tan(math.radians(value))) for slip, value in rows]
        if rows:
            tables[name] = [(float(slip), float(value)) for slip, value in rows]
    strength = material.__dict__.get("tensile_strength")
    if softening.fracture_energy and strength:
        tables["tensile_strength"] = [
            (0.0, strength), (2 * softening.fracture_energy / strength, 0.0)
        ]  # fmt: skip
    return tables


def reduced_tables(material: Part, factor: float) -> dict[str, list[tuple[float, float]]]:
    """Tables of a material with strengths divided by a factor of safety, by path in the material."""
    softening = getattr(material, "softening", None)
    reduced = {}
    for p in BLOCK_LAWS[material.__dict__["law"]].parameters if softening else ():
        rows = getattr(softening, p.name, None)
        if not rows or not p.is_strength:
            continue

        def less(value: float, angle: bool = p.is_tangent) -> float:
            if angle:
                return math.degrees(math.atan(math.tan(math.radians(value)) / factor))
            return value / factor

        reduced[f"softening.{p.name}"] = [(slip, less(value)) for slip, value in rows]
    return reduced


def softening_problems(material: Part) -> Iterator[Problem]:
    """Contradictions in the softening of a material."""
    softening = getattr(material, "softening", None)
    if softening is None:
        return
    law = _law(material)
    if not law.softening:
        can = " or ".join(one.name for one in BLOCK_LAWS.values() if one.softening)
        yield ("softening",), f"a material of law {law.name} does not soften; give law: {can}"
        return
    yield from _wrong_names(law, softening)
    for name in law.softening:
        if rows := getattr(softening, name):
            yield from _wrong_rows(material, name, rows)
    if softening.fracture_energy is not None:
        if softening.tensile_strength is not None:
            yield (
                ("softening", "fracture_energy"),
                "give it or the table tensile_strength, not both",
            )
        if not getattr(material, "tensile_strength", None):
            yield (
                ("softening", "fracture_energy"),
                "needs a tensile_strength above 0 of the material",
            )
    yield from _too_much_dilation(material)


def _law(material: Part) -> Law:
    return BLOCK_LAWS[material.__dict__["law"]]


def _wrong_names(law: Law, softening: Softening) -> Iterator[Problem]:
    given = [name for name, value in softening if value is not None]
    for name in given:
        if name not in (*law.softening, "fracture_energy"):
            can = ", ".join(law.softening)
            yield ("softening", name), f"law {law.name} has no such strength; it has {can}"
    if not given:
        yield ("softening",), "has no table; leave it out, or give e.g. cohesion"


def _wrong_rows(material: Part, name: str, rows: list[tuple[float, float]]) -> Iterator[Problem]:
    where = ("softening", name)
    slips, values = [slip for slip, _ in rows], [value for _, value in rows]
    at_start = getattr(material, name)
    if at_start is None:
        yield where, f"needs {name} of the material, the value at slip 0"
    elif slips[0] != 0 or not math.isclose(values[0], at_start, rel_tol=1e-9):
        yield (
            where,
            f"must begin with [0, {at_start:g}], the {name} of the material, got {list(rows[0])}",
        )
    for k in range(1, len(rows)):
        if slips[k] <= slips[k - 1]:
            yield (*where, k), f"slips must increase, got {slips[k]:g} m after {slips[k - 1]:g} m"
        if values[k] > values[k - 1]:
            yield (*where, k), f"must fall or stay, got {values[k]:g} after {values[k - 1]:g}"
    most = native.fall_pieces + 1
    if not 2 <= len(rows) <= most:
        yield where, f"takes 2 to {most} rows, got {len(rows)}"


def _too_much_dilation(material: Part) -> Iterator[Problem]:
    """Check that dilation stays below friction at every slip: else it would create energy."""
    tables = tables_of(material)
    for plane in ("", "joint_"):
        friction, dilation = f"{plane}friction_angle", f"{plane}dilation_angle"
        if not tables.keys() & {friction, dilation}:
            continue

        def at(name: str, slip: float) -> float:
            start = math.tan(math.radians(material.__dict__[name]))
            rows = np.array(tables.get(name, [(0.0, start)]))
            return float(np.interp(slip, rows[:, 0], rows[:, 1]))

        slips = [slip for name in (friction, dilation) for slip, _ in tables.get(name, [])]
        for slip in sorted(slips):
            if at(dilation, slip) > at(friction, slip) * (1 + 1e-9):
                yield (
                    ("softening",),
                    f"{dilation} must not be larger than {friction} at any slip: it is at {slip:g} m; "
                    f"let {dilation} fall as well",
                )
                break
