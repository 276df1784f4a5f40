"""Stiffness of bonds and contacts: from the case, by default, or from an allowed overlap."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.interface_schema import Interface, InterfacePair, Overlap
from cdem.case.laws import INTERFACE_LAWS
from cdem.case.types import AUTO, Stiffness
from cdem.mesh.arrays import along, lengths

Floats = NDArray[np.float64]

BOND = Stiffness(10.0, relative=True)
"""Factor for joints: they add a tenth of the compliance of the elements beside them."""
CONTACT = 1.0
"""Least factor for contacts: friction and limit loads do not depend on it, and it allows long
steps."""
DEEPEST = Overlap(overlap=0.01, impact=0.02)
"""Contacts are stiffer if blocks would overlap by more at 1 E / h, as in soft rock."""
SOFTEST, STIFFEST = 0.03, 10.0
"""Limits of a stiffness from an allowed overlap, in E / h."""


def bond_row(law: Interface) -> list[float]:
    """Value and factor of k_n, then of k_s of bonds; a value of 0 means factor times E / h."""
    normal, shear = _of_bonds(law)
    return [*normal.as_pair(), *shear.as_pair()]


def interface_entries(
    case: Case, laws: list[Interface], names: list[str], position: Floats
) -> list[dict[str, Any]]:
    """Interfaces in the core's format, with stiffness, restitution and rolling resistance.

    Args:
        case: The case.
        laws: Its interfaces.
        names: Groups of the model.
        position: Initial positions of the model's nodes [m], shape (nodes, 3).
    """
    entries, height = [], height_along_gravity(case, position)
    for law in laws:
        normal, shear, in_series = _of_contacts(case, law, names, height)
        entries.append(
            {
                "law": law.law,
                "stiffness_n": normal.as_pair(),
                "stiffness_s": shear.as_pair(),
                "in_series": in_series,
                "restitution": law.coefficients(),
                "rolling_resistance": law.rolling_resistance,
                "parameters": INTERFACE_LAWS[law.law].numbers(law),
            }
        )
    return entries


def _of_bonds(law: Interface) -> tuple[Stiffness, Stiffness]:
    normal, shear = (BOND if k == AUTO else k for k in (law.stiffness_n, law.stiffness_s))
    return normal, shear


def _of_contacts(
    case: Case, law: Interface, names: list[str], height: float
) -> tuple[Stiffness, Stiffness, bool]:
    """k_n, k_s, and whether E / h combines both sides in series (else the stiffer side)."""
    given = law.contact_stiffness
    if isinstance(given, Overlap):
        both = Stiffness(overlap_factor(case, law, given, names, height), relative=True)
        return both, both, True
    known = law.stiffness_n != AUTO or law.stiffness_s != AUTO
    if given == AUTO and known:
        return *_of_bonds(law), False
    if given == AUTO:
        factor = max(CONTACT, overlap_factor(case, law, DEEPEST, names, height))
        given = Stiffness(factor, relative=True)
    return given, given, True


def overlap_factor(
    case: Case, law: Interface, allowed: Overlap, names: list[str], height: float
) -> float:
    """Stiffness over E / h with which contacts overlap by a given amount under weight and in
    impacts.

    A column of rock of this height makes a joint overlap by rho g H / k, twice as much if the
    vertices of one side alone touch; a block of speed v by v / c sqrt(2 E h / k), c = sqrt(E / rho).
    The softest group that may have the interface is used.
    """
    gravity = math.hypot(*case.loads.gravity)
    speed = greatest_speed(case, law)
    most = 0.0
    for name in groups_of(law, names):
        rock = case.materials[case.groups[name].material]
        ratio = rock.density / rock.young_modulus
        weight = 2 * ratio * gravity * height / allowed.overlap
        impact = 2 * ratio * (speed / allowed.impact) ** 2
        most = max(most, weight, impact)
    return min(STIFFEST, max(SOFTEST, most))


def groups_of(law: Interface, names: list[str]) -> list[str]:
    """Groups that may have an interface."""
    if isinstance(law, InterfacePair) and law.between is not None:
        return law.between
    return names


def greatest_speed(case: Case, law: Interface) -> float:
    """Speed of impacts: as given, or the largest initial or driven speed of a group [m/s]."""
    allowed = law.contact_stiffness
    if isinstance(allowed, Overlap) and allowed.speed is not None:
        return allowed.speed
    speeds = [math.hypot(*group.velocity) for group in case.groups.values()]
    for driven in case.loads.velocities:
        most = max(abs(factor) for _, factor in driven.history) if driven.history else 1.0
        speeds.append(most * math.hypot(*driven.velocity))
    return max(speeds)


def height_along_gravity(case: Case, position: Floats) -> float:
    """Height of a model along gravity, or its greatest length without gravity [m]."""
    gravity = np.array(case.loads.gravity)
    if not gravity.any():
        return float(np.ptp(position, axis=0).max())
    return float(np.ptp(along(position, gravity / lengths(gravity))))
