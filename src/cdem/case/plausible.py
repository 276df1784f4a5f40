"""Usual and possible values of a case, with sources; values outside are reported."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from cdem.case.blast_checks import cut_pulses
from cdem.case.curve_times import in_static_stages, record_users
from cdem.case.interface_schema import InterfacePair
from cdem.case.laws import SURFACE_LAWS
from cdem.case.record_checks import record_doubts
from cdem.case.schema import CaseParts, Stage
from cdem.case.types import Part, Stiffness
from cdem.units import to_number

Keys = tuple[str | int, ...]
Problem = tuple[Keys, str]  # path, warning

PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"))
QUASI_STATIC = 0.9
"""Local damping above which even a slow test is distorted."""
DYNAMIC_LOCAL = 0.2
"""Local damping above which a dynamic stage no longer shows inertia."""


@dataclass(frozen=True)
class Range:
    """Usual and possible values of one quantity.

    Attributes:
        quantity: Its name.
        places: Paths in a case, ``*`` for any name or number; none for a measure of the model.
        unit: Unit of all the numbers here.
        usual: Lowest and highest usual value [unit].
        possible: Limits outside which a case is refused [unit], or None.
        source: Source of the ranges.
        zero: Whether 0 is usual as well.
        meant: Units that are often left out, most likely first.
        in_mm: Its values in models of mm, t, s (so N and MPa); possible as well.
    """

    quantity: str
    places: tuple[str, ...]
    unit: str
    usual: tuple[float, float]
    possible: tuple[float, float] | None
    source: str
    zero: bool = False
    meant: tuple[str, ...] = ()
    in_mm: tuple[float, float] | None = None

    def judge(self, value: float) -> tuple[bool, str]:
        """Whether a value is impossible, and a message; None if it is usual.

        Args:
            value: In `unit`; the sign is ignored.
        """
        size = abs(value)
        if (self.zero and size == 0) or self.usual[0] <= size <= self.usual[1]:
            return False, ""
        in_mm = self.in_mm is not None and self.in_mm[0] <= size <= self.in_mm[1]
        impossible = self.possible is not None and not (
            in_mm or self.possible[0] <= size <= self.possible[1]
        )
        low, high = (written(v, self.unit) for v in self.usual)
        said = f"{written(value, self.unit)} is {'not possible' if impossible else 'unusual'}"
        units = " (is the whole model in mm, t, s?)" if in_mm else ""
        return impossible, f"{said}; usual is {low} to {high}{units}{self._meant(value)}"

    def _meant(self, value: float) -> str:
        fitting = []
        for unit in self.meant:
            if self.usual[0] <= abs(value) * to_number(f"1 {unit}", self.unit) <= self.usual[1]:
                fitting.append(f'"{value:g} {unit}"')
        return f"; did you mean {' or '.join(fitting)}?" if fitting else ""


BODIES = "Jaeger, Cook & Zimmerman (2007), Fundamentals of Rock Mechanics; steel for platens"
RANGES = (
    Range(
        "density", ("materials.*.density",), "kg/m3", (500, 8000), (10, 1e12),
        f"{BODIES}; possible: plastic foam, to densities scaled for longer steps", meant=("t/m3",),
        in_mm=(5e-10, 8e-9),
    ),
    Range(
        "Young's modulus", ("materials.*.young_modulus",), "Pa", (1e6, 1e12), (1e3, 2e12),
        "Hoek & Diederichs (2006), rock masses 0.1 to 100 GPa; soft clay (Bowles 1996) to twice "
        "steel; possible: gelatine to diamond", meant=("GPa", "MPa"),
    ),
    Range(
        "Poisson's ratio", ("materials.*.poisson_ratio",), "1", (0, 0.45), None,
        "Gercek (2007): rock 0.05 to 0.45; 0 for some exact solutions",
    ),
    Range(
        "friction angle", ("interfaces.default.friction_angle", "interfaces.pairs.*.friction_angle"),
        "deg", (2, 75), None, "Barton & Choubey (1977): joints 20 to 70; clay gouge from 4",
        zero=True, meant=("rad",),
    ),
    Range(
        "dilation angle", ("interfaces.default.dilation_angle", "interfaces.pairs.*.dilation_angle"),
        "deg", (0.6, 45), None, "Barton & Choubey (1977)", zero=True, meant=("rad",),
    ),
    Range(
        "cohesion", ("interfaces.default.cohesion", "interfaces.pairs.*.cohesion"),
        "Pa", (100, 1e11), None,
        "Hoek & Brown (1997): rock 0.1 to 50 MPa; higher values mean unbreakable",
        zero=True, meant=("kPa", "MPa"),
    ),
    Range(
        "tensile strength", ("interfaces.default.tensile_strength",
                             "interfaces.pairs.*.tensile_strength"),
        "Pa", (100, 1e11), None,
        "Perras & Diederichs (2014): rock 1 to 25 MPa; higher values mean unbreakable",
        zero=True, meant=("kPa", "MPa"),
    ),
    Range(
        "interface stiffness", ("interfaces.default.stiffness_n", "interfaces.default.stiffness_s",
                                "interfaces.default.contact_stiffness",
                                "interfaces.pairs.*.stiffness_n", "interfaces.pairs.*.stiffness_s",
                                "interfaces.pairs.*.contact_stiffness"),
        "Pa/m", (1e5, 1e14), None,
        "Bandis, Lumsden & Barton (1983): joints 0.1 to 1000 GPa/m; soft fillings below",
        meant=("GPa/m", "MPa/m"),
    ),
    Range(
        "restitution", ("interfaces.default.restitution", "interfaces.default.restitution.normal",
                        "interfaces.default.restitution.tangential",
                        "interfaces.pairs.*.restitution", "interfaces.pairs.*.restitution.normal",
                        "interfaces.pairs.*.restitution.tangential"),
        "1", (0.1, 1), None,
        "Imre, Raebsamen & Springman (2008), Chau, Wong & Wu (2002): rock on rock 0.3 to 0.9; "
        "lower values shorten the step",
    ),
    Range(
        "dip of joints", ("model.joints.*.dip",), "deg", (2, 90), None,
        "dips of geological surveys are whole degrees", zero=True, meant=("rad",),
    ),
    Range(
        "gravity", ("loads.gravity",), "m/s2", (1.6, 25), (0, 5000),
        "Moon to Jupiter; possible: geotechnical centrifuges (Taylor 1995), small ones to 500 g",
        zero=True, in_mm=(9700, 9900),
    ),
    Range(
        "initial speed", ("groups.*.velocity",), "m/s", (0, 300), None,
        "rock avalanches reach 100 m/s (Hungr, Leroueil & Picarelli 2014)",
    ),
    Range(
        "driven speed", ("loads.velocities.*.velocity",), "m/s", (0, 100), None,
        "shaking and impact; slow tests are driven at 1e-4 to 0.1 m/s",
    ),
    Range(
        "traction", ("loads.tractions.*.traction",), "Pa", (1, 1e10), None,
        "from wind to the strength of the hardest rock", zero=True, meant=("kPa", "MPa"),
    ),
    Range(
        "bolt area", ("bolt_types.*.area",), "m2", (1e-5, 0.02), None,
        "Hoek, Kaiser & Bawden (1995): bars and strands 100 to 2000 mm2, cables to 0.01 m2",
        meant=("mm2", "cm2"),
    ),
    Range(
        "contact damping", ("stages.*.damping.contact",), "1", (0, 2), None,
        "a fraction of critical",
    ),
    Range(
        "length of the model", (), "m", (1e-3, 5e4), (1e-9, 1.3e7),
        "a grain to the largest landslides; possible: up to the Earth",
    ),
    Range(
        "height of the model", (), "m", (1e-3, 1e4), (1e-9, 1.3e7),
        "a grain to the highest mountains; possible: up to the Earth",
    ),
)  # fmt: skip
"""The one table of usual values; docs/checks.md is made from it."""


def range_of(quantity: str) -> Range:
    """The table's entry for a quantity."""
    return next(entry for entry in RANGES if entry.quantity == quantity)


def written(value: float, unit: str) -> str:
    """A number with its unit, stresses with a prefix."""
    if unit in ("Pa", "Pa/m"):
        for factor, prefix in PREFIXES:
            if abs(value) >= factor:
                return f"{value / factor:g} {prefix}{unit}"
    return f"{value:g}" if unit == "1" else f"{value:g} {unit}"


def doubts(case: CaseParts) -> tuple[list[Problem], list[Problem]]:
    """Impossible and unusual values of a case: path and message.

    Args:
        case: The case. Values that a pair of groups takes from the default are reported at the
            default.
    """
    impossible: list[Problem] = []
    unusual: list[Problem] = []
    for entry in RANGES:
        for keys, value in _values(case, entry):
            wrong, what = entry.judge(value)
            if what:
                (impossible if wrong else unusual).append((keys, what))
    unusual += _gravity(case)
    for found, told in zip(record_doubts(case), (impossible, unusual), strict=True):
        told += found
    unusual += in_static_stages(case)
    unusual += cut_pulses(case)
    for index, stage in enumerate(case.stages):
        unusual += _local_damping(case, index, stage)
    return impossible, unusual


def _values(case: CaseParts, entry: Range) -> Iterator[tuple[Keys, float]]:
    for place in entry.places:
        for keys, value in _at(case, tuple(place.split(".")), ()):
            if isinstance(value, Stiffness) and not value.relative:
                yield keys, value.value
            elif isinstance(value, list):
                yield keys, math.hypot(*value)
            elif isinstance(value, int | float):
                yield keys, float(value)


def _at(node: Any, rest: Keys, path: Keys) -> Iterator[tuple[Keys, Any]]:
    """Values at a path with wildcards, with their paths."""
    if not rest:
        yield path, node
        return
    key, rest = rest[0], rest[1:]
    inside: Iterable[tuple[str | int, Any]]
    if key == "*":
        inside = node.items() if isinstance(node, dict) else enumerate(node)
    elif isinstance(node, InterfacePair) and key in node.inherited():
        inside = ()
    else:
        inside = [(key, getattr(node, str(key)))] if hasattr(node, str(key)) else ()
    for name, value in inside:
        yield from _at(value, rest, (*path, name))


def _is_written(part: Part, *keys: str) -> bool:
    for key in keys:
        if key not in part.model_fields_set:
            return False
        part = getattr(part, key)
    return True


def _gravity(case: CaseParts) -> Iterator[Problem]:
    gravity, loads = case.loads.gravity, case.loads
    place: Keys = ("loads", "gravity")
    given = any(path.startswith("loads.gravity") for stage in case.stages for path in stage.set)
    if any(gravity):
        if gravity[2] >= 0:
            way = "points up" if gravity[2] > 0 else "has no downward part"
            text = ", ".join(f"{g:g}" for g in gravity)
            yield place, f"[{text}] m/s2 {way}; z is up: usual is [0, 0, -9.81]"
    elif not (
        _is_written(case, "loads", "gravity") or given or loads.tractions or loads.velocities
    ):
        yield (
            place,
            "is not given, so there is no weight; usual is [0, 0, -9.81] (write [0, 0, 0] for "
            "none)",
        )


def _local_damping(case: CaseParts, index: int, stage: Stage) -> Iterator[Problem]:
    local = stage.damping.local or 0.0
    keys: Keys = ("stages", index, "damping", "local")
    if local > QUASI_STATIC:
        yield keys, f"{local:g} is unusual; usual is 0.8 in a static stage, 0 in a dynamic one"
    elif (
        stage.mode == "dynamic"
        and local > DYNAMIC_LOCAL
        and not (case.loads.velocities or case.loads.tractions)
    ):
        yield (
            keys,
            f"{local:g} in a dynamic stage slows every motion, even a fall; usual is 0 to 0.05 "
            "(0.8 is for static stages and slow tests)",
        )
    if stage.mode == "dynamic" and local > 0 and _has_waves(case):
        yield (
            keys,
            f"{local:g} distorts the waves of records and at quiet surfaces, as it brakes every node by "
            "its force; use rayleigh or maxwell",
        )


def _has_waves(case: CaseParts) -> bool:
    """Whether a record sends waves in, or a surface lets them out."""
    quiet = any(SURFACE_LAWS[entry.law].absorbs for _, entry in case.surface_entries)
    return quiet or any(record_users(case))
