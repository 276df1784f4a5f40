"""Fixed and driven nodes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.loads_schema import PrescribedVelocity
from cdem.mesh.topology import Topology
from cdem.model.boundaries import Boundaries
from cdem.model.curves import Curves, add_curve, add_record
from cdem.model.selection import select_nodes


def held_components(supports: Mapping[str, NDArray]) -> NDArray[np.bool_]:
    """Components of nodes that are fixed or driven, shape (nodes, 3); from `supports_of`."""
    row = supports["row"]
    return (row >= 0)[:, None] & (supports["component"][np.maximum(row, 0)] != 0)


def driven_nodes(supports: Mapping[str, NDArray]) -> NDArray[np.bool_]:
    """Nodes with a prescribed velocity, shape (nodes,); from `supports_of`."""
    row, driven = supports["row"], np.asarray(supports["velocity"].any(axis=1))
    return (row >= 0) & driven[row]


def _curve_of(case: Case, driven: PrescribedVelocity, curves: Curves) -> int:
    """Index of the curve of driven nodes."""
    if driven.record is not None:
        return add_record(case.processed(driven.record), driven.stage, curves)
    return add_curve(driven.history, driven.stage, curves)


class _Held:
    """Components of nodes that are held or driven, as they are found.

    Attributes:
        component: 1 for components that are, shape (nodes, 3).
        velocity: Their velocities for a factor of 1 [m/s].
        curve: Indices of the curves of their factors.
    """

    def __init__(self, count: int) -> None:
        self.component = np.zeros((count, 3), np.int8)
        self.velocity = np.zeros((count, 3))
        self.curve = np.zeros((count, 3), np.int32)

    def fix(self, nodes: NDArray, axes: Iterable[int]) -> None:
        """Hold components of nodes."""
        self.drive(nodes, axes, [0.0] * 3, 0)

    def drive(
        self, nodes: NDArray, axes: Iterable[int], speeds: Sequence[float], curve: int
    ) -> None:
        """Give components of nodes the speeds along x, y, z."""
        for axis in axes:
            self.component[nodes, axis] = 1
            self.velocity[nodes, axis] = speeds[axis]
            self.curve[nodes, axis] = curve


def supports_of(
    case: Case,
    topology: Topology,
    names: list[str],
    curves: Curves,
    boundaries: Boundaries,
) -> dict[str, NDArray]:
    """Rows of supported nodes: components, velocities, curves.

    Supports of boundaries that have begun are left out; all nodes of boundaries have a row, as the
    number of rows stays.
    """
    found = _Held(len(topology.node_position))
    groups = topology.block_group[topology.node_block]
    for name, group in case.groups.items():
        found.fix(groups == names.index(name), _axes(group.fix))
    for index, item in enumerate(case.loads.supports):
        if index not in boundaries.ended:
            nodes = select_nodes(case, topology, names, item, f"loads.supports.{index}")
            found.fix(nodes, _axes(item.fix))
    for index, driven in enumerate(case.loads.velocities):
        nodes = select_nodes(case, topology, names, driven, f"loads.velocities.{index}")
        curve = _curve_of(case, driven, curves)
        found.drive(nodes, _axes(driven.components), driven.velocity, curve)
    _hold_boundaries(case, curves, boundaries, found)
    return _rows(found, boundaries)


def _axes(letters: Iterable[str]) -> list[int]:
    return ["xyz".index(letter) for letter in letters]


def _hold_boundaries(case: Case, curves: Curves, boundaries: Boundaries, found: _Held) -> None:
    """Hold boundaries in static stages; let rigid ones move with their records in others."""
    for place in boundaries.acting:
        rigid = [given for given in place.boundary.inputs if given.kind == "rigid"]
        if boundaries.held or rigid:
            found.fix(place.nodes, range(3))
        for given in rigid if not boundaries.held else []:
            curve = add_record(case.processed(given.record), place.boundary.stage, curves)
            axes = np.flatnonzero(given.direction)
            found.drive(place.nodes, axes.tolist(), given.motion_of_record, curve)


def _rows(found: _Held, boundaries: Boundaries) -> dict[str, NDArray]:
    """Rows of the nodes that are held, or may be."""
    held = np.asarray(found.component.any(axis=1))
    held[boundaries.nodes] = True
    row = np.full(len(held), -1, np.int32)
    row[held] = np.arange(held.sum())
    if not held.any():  # the core looks rows up; an empty table still needs one
        held[:1] = True
    return {
        "row": row,
        "component": found.component[held],
        "velocity": found.velocity[held],
        "curve": found.curve[held],
    }
