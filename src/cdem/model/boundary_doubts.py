"""Boundaries that drain waves, lose weight, or are held: warnings of the audit."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy

import numpy as np

from cdem.errors import CaseError
from cdem.model.boundaries import Place
from cdem.model.build import Build
from cdem.model.columns import ColumnModel, uneven_sides
from cdem.model.curves import constant
from cdem.model.faces import face_normals
from cdem.model.supports import held_components, supports_of
from cdem.model.wetted import face_pressures

UPRIGHT = 0.5
"""Vertical part of the normal of a face below which it is a side."""
HELD = 0.5
"""Fraction of the nodes of a quiet boundary, held along its normal, above which that is told."""


def boundary_doubts(build: Build) -> Iterator[str]:
    """Warnings about boundaries.

    Raises:
        CaseError: A wave comes in along an axis that other supports hold; or water presses on a side
            where the ground goes on.
    """
    case = build.case
    if not case.boundaries:
        return
    later = deepcopy(build.boundaries)
    later.follow(case, len(case.stages))
    later.held = False
    held = held_components(supports_of(case, build.topology, build.group_names, constant(), later))
    for i, place in enumerate(build.boundaries.places):
        where = f"{case.where(f'boundaries.{i}')}: boundaries.{i}"
        yield from _weightless(build, place, where)
        _refuse_water(build, place, where)
        if place.boundary.quiet:
            _refuse_held_input(place, held[place.nodes], where)
            yield from _held(build, place, held[place.nodes], where)
            yield from _draining(build, place, where)
    columns = build.modules[ColumnModel.name]
    assert isinstance(columns, ColumnModel)
    yield from uneven_sides(columns.strips or [])
    if case.elements.mass == "exact" and any(b.absorbs for b in case.boundaries):
        yield (
            f"{case.where('elements.mass')}: elements.mass: exact: blocks at quiet faces move lumped "
            "masses all the same; with lumped the whole model does"
        )
    if case.time.mass_scaling is not None:
        yield "mass scaling: waves meet the added mass and come back; leave it out in a case with boundaries"


def _weightless(build: Build, place: Place, where: str) -> Iterator[str]:
    """Tell of weight that nothing carries."""
    first = build.case.stages[0].name
    if (
        any(build.case.loads.gravity)
        and place.boundary.stage in (None, first)
        and place.boundary.absorbs
    ):
        yield (
            f"{where}: {place.boundary.name} begins with the run, so no forces of supports carry the "
            "weight on it: the rock sinks; begin with a static stage on supports, or set gravity to 0"
        )


def _refuse_water(build: Build, place: Place, where: str) -> None:
    """Refuse open water before a side with a free field."""
    if place.boundary.free_field is None or build.case.water is None:
        return
    wet = [
        face[(pressure > 0).any(axis=0)]
        for face, pressure in face_pressures(build, build.start_position)
    ]
    count = int(np.isin(np.concatenate(wet), place.faces).sum())
    if count:
        raise CaseError(
            f"{where}: water presses on {count:,} faces of {place.boundary.name} at the start, but with a "
            "free field the ground goes on behind them; limit the reservoir by its box, so that it ends "
            "before this side"
        )


def _refuse_held_input(place: Place, held: np.ndarray, where: str) -> None:
    """Refuse a wave along an axis along which all nodes of the base are held."""
    fixed = [bool(column.all()) for column in held.T]
    for given in place.boundary.inputs:
        for axis in range(3):
            if fixed[axis] and given.direction[axis]:
                raise CaseError(
                    f"{where}: the wave of {given.record} comes in along {'xyz'[axis]}, along which all "
                    f"nodes of {place.boundary.name} are held; remove the support, or that part of the "
                    "direction"
                )


def _held(build: Build, place: Place, held: np.ndarray, where: str) -> Iterator[str]:
    """Tell of a quiet boundary that other supports keep from moving along its normal."""
    t = build.topology
    normal = face_normals(t.node_position, t.face_nodes[place.faces]).mean(axis=0)
    axis = int(np.abs(normal).argmax())
    count = int(held[:, axis].sum())
    if count > HELD * len(held):
        yield (
            f"{where}: {count:,} of the {len(held):,} nodes of {place.boundary.name} stay held along "
            f"{'xyz'[axis]} by supports of other places or groups, so waves come back there; give the "
            "support the surface of the boundary, with which it ends"
        )


def _draining(build: Build, place: Place, where: str) -> Iterator[str]:
    """Tell of a quiet side without a free field in ground that is shaken from below."""
    case, t = build.case, build.topology
    shaken = any(boundary.inputs for boundary in case.boundaries)
    normal = face_normals(t.node_position, t.face_nodes[place.faces])
    upright = np.abs(normal[:, 2]).max() < UPRIGHT
    if shaken and upright and place.boundary.free_field is None:
        yield (
            f"{where}: {place.boundary.name} is a quiet side of ground that is shaken from below: it "
            "drains the wave, and the ground moves too little; give it a free_field"
        )
