"""The interface between two kinds of faces."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.case.case import Case
from cdem.case.interface_schema import Interface, InterfacePair
from cdem.case.laws import INTERFACE_LAWS
from cdem.errors import CaseError
from cdem.mesh.topology import Topology, group_touching
from cdem.model.flat_arrays import Floats

UNBREAKABLE = 1e8
"""Strength [Pa] above any rock: cohesion up to 50 MPa, tensile strength up to 25 MPa."""


def interfaces_of(case: Case, names: list[str]) -> tuple[list[Interface], NDArray[np.int32]]:
    """Interface laws in use, and the index for each pair of kinds of faces (-1: none was given).

    Kinds of faces are those in `Topology.face_kind`. A contact on a face made by a set of joints
    has
    the law of that set, if there is one and the toucher (first index) is of the same set or group:
    a corner that rests on a joint may touch it as a corner of any face of its block. All other
    contacts have the law of their groups.
    """
    laws: list[Interface] = list(case.interfaces.pairs)
    table = np.full((len(names), len(names)), -1, np.int32)
    if case.interfaces.default is not None:
        laws.append(case.interfaces.default)
        table[:] = len(laws) - 1
    for index, pair in enumerate(case.interfaces.pairs):
        for name in pair.between or []:
            if name not in names:
                raise CaseError(
                    f"{case.where(f'interfaces.pairs.{index}.between')}: interfaces.pairs.{index}."
                    f"between: no group {name!r} in the model; it has: {', '.join(names)}"
                )
        if pair.between is not None:
            a, b = (names.index(name) for name in pair.between)
            table[a, b] = table[b, a] = index
    sets = case.model.joint_surfaces
    table = np.tile(table, (1 + len(sets), 1 + len(sets)))
    for index, pair in enumerate(case.interfaces.pairs):
        if pair.joint is not None:
            start = len(names) * (1 + sets.index(pair.joint))
            table[start : start + len(names), start : start + len(names)] = index
            for group in range(len(names)):
                table[group :: len(names), start + group] = index
    return laws, table


def check_interfaces(
    case: Case, topology: Topology, names: list[str], table: NDArray[np.int32]
) -> None:
    """Refuse a model in which two groups touch, or may come to touch, without an interface."""
    for a, b in sorted(group_touching(topology)):
        if table[names.index(a), names.index(b)] < 0:
            raise CaseError(
                f"{case.where('interfaces')}: interfaces: groups {a!r} and {b!r} touch but have no "
                f"interface; add a pair 'between: [{a}, {b}]' or interfaces.default"
            )
    missing = table[: len(names), : len(names)] < 0
    for index in range(len(names)):  # a block does not touch itself
        if (topology.block_group == index).sum() < 2:
            missing[index, index] = False
    if missing.any():
        first = np.argwhere(missing)[0]
        a, b = names[first[0]], names[first[1]]
        raise CaseError(
            f"{case.where('interfaces')}: interfaces: groups {a!r} and {b!r} may come to touch but "
            f"have no interface; add a pair 'between: [{a}, {b}]' or interfaces.default"
        )


def name_of(law: Interface) -> str:
    """Name of an interface in messages."""
    if not isinstance(law, InterfacePair):
        return "default"
    if law.name:
        return law.name
    return " - ".join(law.between) if law.between else f"joint {law.joint}"


def that_may_break(case: Case) -> NDArray[np.bool_]:
    """Interfaces, in the order of `interfaces_of`, with a realistic strength of rock in any stage.

    Bonds with strengths of `UNBREAKABLE` or more never break.
    """
    trial = case.model_copy(deep=True)

    def weak() -> NDArray[np.bool_]:
        laws = [*trial.interfaces.pairs, trial.interfaces.default]
        found = [_least_strength(law) for law in laws if law is not None]
        return np.array(found, float) < UNBREAKABLE

    breaks = weak()
    for stage in trial.stages:
        for path, value in stage.set.items():
            trial.set(path, value)
        breaks = breaks | weak()
    return breaks


def _least_strength(law: Interface) -> float:
    strengths = [p.name for p in INTERFACE_LAWS[law.law].parameters if p.bonds]
    return min((float(getattr(law, name)) for name in strengths), default=0.0)


def strength_factors_of(law: Interface) -> Callable[[NDArray[np.int32]], Floats] | None:
    """Function from faces of pairs, shape (pairs, 2), to factors on their strength; None: all are 1."""
    given = law.heterogeneity
    if given is None:
        return None

    def factors(faces: NDArray[np.int32]) -> Floats:
        flat = np.ascontiguousarray(faces, np.int32).ravel()
        return native.weibull_factors(flat, given.seed, given.weibull, given.mean)

    return factors


def bonded_pairs(laws: list[Interface], table: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Pairs of groups with strength, shape (groups, groups); False for groups without a law."""
    strong = [INTERFACE_LAWS[law.law].bonds(law) for law in laws]
    return np.array([*strong, False])[table]
