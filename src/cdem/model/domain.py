"""The box that the blocks of a model must not leave: `model.domain` of the case."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.case.bodies_schema import Domain
from cdem.case.case import Case
from cdem.errors import CaseError
from cdem.mesh.topology import Topology

Floats = NDArray[np.float64]


def bounds(domain: Domain) -> tuple[Floats, Floats]:
    """Lowest and highest corner [m]; infinite on open sides."""
    low = [-np.inf if side is None else side for side in domain.min]
    high = [np.inf if side is None else side for side in domain.max]
    return np.array(low), np.array(high)


def outside(domain: Domain, middle: Floats) -> NDArray[np.bool_]:
    """Whether the middles of blocks are outside, shape (blocks, 3) [m]."""
    low, high = bounds(domain)
    return np.any((middle < low) | (middle > high), axis=1)


def leaving(
    domain: Domain, middle: Floats, body: NDArray[np.int32], out: NDArray[np.bool_]
) -> NDArray[np.intp]:
    """Blocks of bodies that have left the domain: the middles of all their blocks are outside.

    Args:
        domain: The box.
        middle: Centre of mass of each block [m], shape (blocks, 3).
        body: Label of each block's body: bonded blocks are one body.
        out: Whether each block has already been removed.
    """
    gone = outside(domain, middle)
    return np.flatnonzero(gone & ~out & ~np.isin(body, body[~gone]))


def check_domain(case: Case, topology: Topology, names: list[str]) -> None:
    """Make sure that the whole model begins inside its domain.

    Raises:
        CaseError: It does not; names the place.
    """
    if case.model.domain is None:
        return
    low, high = bounds(case.model.domain)
    position = topology.node_position
    beyond = np.maximum(low - position, position - high)
    node, axis = np.unravel_index(np.argmax(beyond), beyond.shape)
    if beyond[node, axis] <= 0:
        return
    group = names[topology.block_group[topology.node_block[node]]]
    side, limit = ("max", high) if position[node, axis] > high[axis] else ("min", low)
    path = f"model.domain.{side}"
    raise CaseError(
        f"{case.where(path)}: {path}: is {limit[axis]:.10g} m along {'xyz'[axis]}, but group {group!r} "
        f"begins at ({', '.join(f'{x:.6g}' for x in position[node])}) m; the domain must contain "
        f"the "
        "whole model at the start"
    )
