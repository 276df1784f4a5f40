"""Stiffness of the contacts of each interface, and overlap of blocks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from cdem._native import core as native
from cdem.case.interface_schema import Interface
from cdem.case.laws import INTERFACE_LAWS
from cdem.model.build import Build
from cdem.model.interfaces import interfaces_of, name_of
from cdem.model.stiffness import (
    greatest_speed,
    groups_of,
    height_along_gravity,
    interface_entries,
)


def contact_interfaces(build: Build) -> list[dict[str, Any]]:
    """One row per interface of the case: stiffness, overlap under weight and at the largest speed,
    and the smaller coefficient of restitution.

    Overlaps are relative to the height of the element, the largest of all its groups: 2 rho g H /
    (k h) for a column as high as the model, and v / c sqrt(2 E / (k h)) with c = sqrt(E / rho).
    """
    case, names = build.case, build.group_names
    laws, _ = interfaces_of(case, names)
    entries = interface_entries(case, laws, names, build.start_position)
    height = height_along_gravity(case, build.start_position)
    rows = []
    for law, entry in zip(laws, entries, strict=True):
        sides = list(_sides(build, law, *entry["stiffness_n"]))
        if not sides:
            continue
        own = INTERFACE_LAWS[law.law]
        stiffness = np.array([k for _, pair in sides for k in pair])
        weight = impact = by_speed = 0.0
        speed = greatest_speed(case, law)
        for rock, (low, _) in sides:
            modulus, soft = rock["young_modulus"], rock["young_modulus"] / (low * rock["height"])
            ratio = rock["density"] / modulus
            weight = max(weight, 2 * ratio * math.hypot(*case.loads.gravity) * height * soft)
            by_speed = max(by_speed, math.sqrt(2 * ratio * soft))
            impact = speed * by_speed
        rows.append(
            {
                "interface": name_of(law),
                "stiffness_n": [float(stiffness.min()), float(stiffness.max())],
                "height": height,
                "overlap_under_weight": float(weight),
                "speed": speed,
                "overlap_at_speed": float(impact),
                "overlap_by_speed": float(by_speed),
                "restitution": min(law.coefficients()),
                "curve_end": native.interface_curve_end(
                    law.law, own.numbers(law), float(stiffness.max())
                )
                if own.curved
                else None,
            }
        )
    return rows


def _sides(
    build: Build, law: Interface, value: float, factor: float
) -> Iterator[tuple[dict[str, float], tuple[float, float]]]:
    """Rock and height of the elements, and range of the stiffness, by group that may have it."""
    case, names = build.case, build.group_names
    for name in groups_of(law, names):
        rock = case.materials[case.groups[name].material]
        faces = build.topology.face_group == names.index(name)
        own = build.arrays["face.stiffness"][: len(faces)][faces]
        if len(own) == 0:
            continue
        low, high = (value, value) if value > 0 else (factor * own.min(), factor * own.max())
        height = rock.young_modulus / own.min()
        yield (
            {"young_modulus": rock.young_modulus, "density": rock.density, "height": height},
            (float(low), float(high)),
        )
