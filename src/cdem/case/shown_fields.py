"""Quantities for pictures: recorded fields, and components and principal values made of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cdem.case.output_fields import OUTPUT_FIELDS, OutputField

Looks = Literal["amount", "signed", "whole range", "label", "scattered label"]
"""Colours of a field: as in `Colors`, or "signed": between two ends, one of which may be below
zero."""
Recorded = NDArray
Values = Callable[[Recorded], NDArray]

AXES = ("x", "y", "z")
MISES = "von_mises_stress"
TENSOR = ("xx", "yy", "zz", "xy", "yz", "zx")
YIELDED = ("never", "shear before", "tension before", "shear now", "tension now")
"""Names of the numbers of `yield_class`."""


@dataclass(frozen=True)
class Shown:
    """A quantity for pictures.

    Attributes:
        name: Name on the command line.
        meaning: One line.
        unit: Unit of the values.
        looks: Kind of colours.
        of: The recorded field that it is made from.
        values: Function from rows of that field to one value each.
        labels: Names of the values 0, 1, ... of a label.
    """

    name: str
    meaning: str
    unit: str
    looks: Looks
    of: str
    values: Values
    labels: tuple[str, ...] = ()


def size_of(vectors: NDArray) -> NDArray:
    """Lengths of vectors, shape (rows, 3)."""
    return np.linalg.norm(vectors, axis=1)


def principal(stress: NDArray, place: int) -> NDArray:
    """The principal value at this place, 0 for the largest, of rows xx yy zz xy yz zx."""
    xx, yy, zz, xy, yz, zx = np.asarray(stress, float).T
    tensors = np.stack([xx, xy, zx, xy, yy, yz, zx, yz, zz], axis=1).reshape(-1, 3, 3)
    return np.linalg.eigvalsh(tensors)[:, 2 - place]


def von_mises_stress(stress: NDArray) -> NDArray:
    """sqrt(3 J2) of rows xx yy zz xy yz zx."""
    s = np.asarray(stress, float)
    deviator = s[:, :3] - s[:, :3].mean(axis=1, keepdims=True)
    return np.sqrt(1.5 * ((deviator**2).sum(axis=1) + 2 * (s[:, 3:] ** 2).sum(axis=1)))


def yield_class(bits: NDArray) -> NDArray:
    """Place in `YIELDED` of each row of the field "yielded"; rock and weak plane combined."""
    bits = np.asarray(bits).astype(int)
    bits = (bits | bits >> 4) & 15
    cases = [(bits & 2) > 0, (bits & 1) > 0, (bits & 8) > 0, (bits & 4) > 0]
    return np.select(cases, [4, 3, 2, 1], 0)


def _column(rows: NDArray, place: int) -> NDArray:
    return rows[:, place]


def _itself(rows: NDArray) -> NDArray:
    return rows


def _of_field(field: OutputField) -> list[Shown]:
    """Quantities that can be shown of a recorded field."""
    if field.name in ("displacement", "velocity"):
        parts = [
            Shown(f"{field.name}_{a}", f"{field.meaning} along {a}", field.unit, "signed", field.name,
                  partial(_column, place=k))
            for k, a in enumerate(AXES)
        ]  # fmt: skip
        return [Shown(field.name, field.meaning, field.unit, "amount", field.name, size_of), *parts]
    if field.name == "stress":
        return _of_stress("", field) + [
            Shown(
                MISES, "Von Mises stress, sqrt(3 J2)", "Pa", "amount", field.name, von_mises_stress
            )
        ]
    if field.name == "effective_stress":
        return _of_stress("effective_", field)
    if field.name == "yielded":
        meaning = "Plastic flow in the element, now or earlier"
        return [Shown(field.name, meaning, "", "label", field.name, yield_class, YIELDED)]
    if field.colors is None:
        return []
    return [Shown(field.name, field.meaning, field.unit, field.colors, field.name, _itself)]


def _of_stress(prefix: str, field: OutputField) -> list[Shown]:
    what = "effective stress" if prefix else "stress"
    parts = [
        Shown(f"{prefix}stress_{c}", f"{what.capitalize()} {c}, tension positive", "Pa", "signed",
              field.name, partial(_column, place=k))
        for k, c in enumerate(TENSOR)
    ]  # fmt: skip
    for number, which in ((1, "largest"), (2, "middle"), (3, "smallest")):
        meaning = f"{which.capitalize()} principal {what}, tension positive"
        most = {1: ": the most tensile", 2: "", 3: ": the most compressive"}[number]
        parts.append(
            Shown(f"{prefix}sigma_{number}", meaning + most, "Pa", "signed", field.name,
                  partial(principal, place=number - 1))
        )  # fmt: skip
    return parts


AXIAL_FORCE = Shown(
    "axial_force", "Axial force of bolts, tension positive", "N", "signed", "axial_force", _itself
)
"""The quantity that colours bolts; the rock is then pale."""
SHOWN = {shown.name: shown for field in OUTPUT_FIELDS for shown in _of_field(field)}
SHOWN[AXIAL_FORCE.name] = AXIAL_FORCE
"""All by name, in the order of the list of fields."""
