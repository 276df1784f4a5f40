"""Patches of the outer pair list: the exposed faces of one element, which follow each other."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.ranks.kinds import Rows


def patches_of(elements: NDArray[Any]) -> Rows:
    """The patch of every exposed face, by its first exposed face.

    Args:
        elements: Element behind each exposed face.
    """
    begins = np.ones(len(elements), bool)
    begins[1:] = elements[1:] != elements[:-1]
    return np.flatnonzero(begins)[np.cumsum(begins) - 1]


def mothers_of(slot_first: NDArray[Any], slot_pairs: NDArray[Any]) -> Rows:
    """An exposed face at the vertex of every pair of vertex and face, of the vertex's element.

    The pairs of the outer list are padded; every other pair has such a face.
    """
    mothers = np.zeros(int(slot_pairs.max(initial=-1)) + 1, np.int64)
    slots = np.repeat(np.arange(len(slot_first) - 1), np.diff(slot_first))
    mothers[slot_pairs] = slots // 4
    return mothers


def first_patches(vertex: Rows, face: Rows, movable: NDArray[Any]) -> Rows:
    """The patch that has found a pair of patches: a movable one, the earlier of two.

    Args:
        vertex: Patch of the vertex of every pair.
        face: Patch of its face.
        movable: Whether exposed faces can move.
    """
    can_move = movable.astype(bool)
    by_vertex = can_move[vertex] & (~can_move[face] | (vertex < face))
    return np.where(by_vertex, vertex, face)
