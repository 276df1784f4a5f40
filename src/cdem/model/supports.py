"""Fixed and driven nodes."""

from __future__ import annotations

from collections.abc import Mapping

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
    count = len(topology.node_position)
    component = np.zeros((count, 3), np.int8)
    velocity = np.zeros((count, 3))
    curve = np.zeros((count, 3), np.int32)

    def hold(nodes: NDArray, axes: list[int], speeds: list[float], index: int) -> None:
        for axis, speed in zip(axes, speeds, strict=True):
            component[nodes, axis] = 1
            velocity[nodes, axis] = speed
            curve[nodes, axis] = index

    groups = topology.block_group[topology.node_block]
    for name, group in case.groups.items():
        axes = ["xyz".index(c) for c in group.fix]
        hold(groups == names.index(name), axes, [0.0] * len(axes), 0)
    for index, item in enumerate(case.loads.supports):
        if index in boundaries.ended:
            continue
        nodes = select_nodes(case, topology, names, item, f"loads.supports.{index}")
        axes = ["xyz".index(c) for c in item.fix]
        hold(nodes, axes, [0.0] * len(axes), 0)
    for index, driven in enumerate(case.loads.velocities):
        nodes = select_nodes(case, topology, names, driven, f"loads.velocities.{index}")
        axes = ["xyz".index(c) for c in driven.components]
        curve_of = _curve_of(case, driven, curves)
        hold(nodes, axes, [driven.velocity[a] for a in axes], curve_of)

    for place in boundaries.acting:
        rigid = [given for given in place.boundary.inputs if given.kind == "rigid"]
        if boundaries.held or rigid:
            hold(place.nodes, [0, 1, 2], [0.0] * 3, 0)
        for given in rigid if not boundaries.held else []:
            curve_of = add_record(case.processed(given.record), place.boundary.stage, curves)
            axes = [a for a in range(3) if given.direction[a]]
            hold(place.nodes, axes, [given.motion_of_record[a] for a in axes], curve_of)

    held = np.asarray(component.any(axis=1))
    held[boundaries.nodes] = True
    row = np.full(count, -1, np.int32)
    row[held] = np.arange(held.sum())
    if not held.any():  # the core looks rows up; an empty table still needs one
        held[:1] = True
    return {
        "row": row,
        "component": component[held],
        "velocity": velocity[held],
        "curve": curve[held],
    }
