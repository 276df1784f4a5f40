"""Rows of large arrays: lengths, determinants, order, links, work in pieces that fit into a cache."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

PIECE = 1 << 16
"""Rows that are worked on at once: what lies in between is a few MB, and its memory is used again."""


def in_pieces(function: Callable[..., NDArray], *arrays: NDArray) -> NDArray:
    """A function of the rows of arrays of equal length, one row of result for each, piece by piece."""
    count = len(arrays[0])
    starts = range(0, max(count, 1), PIECE)
    return np.concatenate([function(*(a[i : i + PIECE] for a in arrays)) for i in starts])


def first_of_each(owner: NDArray, count: int) -> NDArray[np.int32]:
    """Where each owner's items start in a list in the order of owners, and its end, (count + 1,)."""
    first = np.zeros(count + 1, np.int32)
    np.cumsum(np.bincount(owner, minlength=count), out=first[1:])
    return first


def lengths(vectors: Floats) -> Floats:
    """Lengths along the last axis; several times faster than `np.linalg.norm` on short vectors."""
    return np.sqrt(np.einsum("...x,...x->...", vectors, vectors))


def determinant(m: Floats) -> Floats:
    """Determinants of 3 x 3 matrices; many times faster than one by one in LAPACK."""
    a, b, c = (m[..., row, :] for row in range(3))
    return (
        a[..., 0] * (b[..., 1] * c[..., 2] - b[..., 2] * c[..., 1])
        + a[..., 1] * (b[..., 2] * c[..., 0] - b[..., 0] * c[..., 2])
        + a[..., 2] * (b[..., 0] * c[..., 1] - b[..., 1] * c[..., 0])
    )


def order_of_rows(rows: NDArray) -> NDArray[np.intp]:
    """Order of rows of whole numbers from -1 up: by the first column, then the second and so on."""
    bits = int(rows.max(initial=0) + 1).bit_length()
    columns = 63 // bits  # that fit into one key: fewer keys are sorted much faster
    keys = []
    for start in range(0, rows.shape[1], columns):
        key = np.zeros(len(rows), np.int64)
        for column in rows[:, start : start + columns].T:
            key = (key << bits) + (column + 1)
        keys.append(key)
    return np.lexsort(keys[::-1])


def same_rows(rows: NDArray) -> NDArray[np.int64]:
    """A number for every row of whole numbers from -1 up, equal for equal rows."""
    order = order_of_rows(rows)
    rows = rows[order]
    number = np.empty(len(rows), np.int64)
    number[order] = np.cumsum(np.r_[True, (rows[1:] != rows[:-1]).any(axis=1)]) - 1
    return number


def components(count: int, a: NDArray, b: NDArray) -> NDArray:
    """Smallest member of each item's connected component, for links a - b between items."""
    label = np.arange(count)
    while True:
        at_a, at_b = label[a], label[b]
        low = np.minimum(at_a, at_b)
        before = label.copy()
        # hang whole trees, not single items: a long chain then takes few rounds
        np.minimum.at(label, at_a, low)
        np.minimum.at(label, at_b, low)
        label = label[label]
        if (label == before).all():
            return label
