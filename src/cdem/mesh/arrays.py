"""Rows of large arrays: lengths, determinants, order, links, work in pieces that fit into a cache."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

PIECE = 1 << 16
"""Rows processed at once: temporary data are a few MB, and their memory is reused."""


def in_pieces(function: Callable[..., NDArray], *arrays: NDArray) -> NDArray:
    """Apply a function of rows to arrays of equal length, piece by piece; one row of result each."""
    count = len(arrays[0])
    starts = range(0, max(count, 1), PIECE)
    return np.concatenate([function(*(a[i : i + PIECE] for a in arrays)) for i in starts])


def first_of_each(owner: NDArray, count: int) -> NDArray[np.int32]:
    """First item of each owner in a list ordered by owner, and the end, (count + 1,)."""
    first = np.zeros(count + 1, np.int32)
    np.cumsum(np.bincount(owner, minlength=count), out=first[1:])
    return first


def found_in(numbers: Iterable[NDArray], count: int) -> NDArray[np.intp]:
    """Numbers below a limit that occur in lists, ascending; many times faster than `np.unique`."""
    found = np.zeros(count, bool)
    for some in numbers:
        found[some] = True
    return np.flatnonzero(found)


def lengths(vectors: Floats) -> Floats:
    """Lengths along the last axis; several times faster than `np.linalg.norm` on short vectors."""
    return np.sqrt(np.einsum("...x,...x->...", vectors, vectors))


def matrix_product(a: Floats, b: Floats) -> Floats:
    """Products of small matrices, summed in one order on every CPU; BLAS has a different order on each."""
    return np.einsum("...ij,...jk->...ik", a, b)


def along(vectors: Floats, direction: Floats) -> Floats:
    """Components of vectors (rows) along one direction, with the same bits on every CPU."""
    return np.einsum("...x,x->...", vectors, direction)


def in_plane(a: Floats, b: Floats, normal: Floats, x: Floats) -> tuple[Floats, Floats]:
    """u, v of x = u a + v b + w normal, for vectors x in rows; with the same bits on every CPU."""
    across, over = np.cross(b, normal), np.cross(normal, a)
    whole = along(across, a)
    return along(x, across) / whole, along(x, over) / whole


def same_everywhere(values: Floats) -> Floats:
    """Numbers rounded up to 28 bits, by at most a hundred-millionth.

    A number up to 4e-12 above such a value is rounded down to it: values of regular bodies often
    differ from such values by round-off only. For results of LAPACK and vectorized functions, whose
    last
    bits depend on the CPU, and for which eight digits suffice: limits of the time step, hourglass
    springs.
    """
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.ceil(mantissa * 2.0**28 - 2.0**-10) / 2.0**28, exponent)


def inverses(m: Floats) -> Floats:
    """Inverses of positive definite matrices (..., n, n), with the same bits on every CPU."""
    n = m.shape[-1]
    a, out = m.copy(), np.broadcast_to(np.eye(n), m.shape).copy()
    for k in range(n):
        pivot = a[..., k, k, None].copy()
        a[..., k, :] /= pivot
        out[..., k, :] /= pivot
        factor = a[..., :, k].copy()
        factor[..., k] = 0.0
        a -= factor[..., None] * a[..., None, k, :]
        out -= factor[..., None] * out[..., None, k, :]
    return out


def solve_semidefinite(m: Floats, target: Floats, tolerance: float) -> Floats:
    """A solution of m x = target, with the same bits on every CPU.

    Args:
        m: Symmetric, with no negative eigenvalue, shape (n, n).
        target: Right side; a sum of columns of m.
        tolerance: Pivots below this fraction of the largest count as zero, and their unknowns are
            zero.
    """
    a, right = m.copy(), target.copy()
    left = np.ones(len(m), bool)
    least = tolerance * np.diag(m).max()
    while left.any():
        k = int(np.argmax(np.where(left, np.diag(a), -np.inf)))
        if a[k, k] <= least:
            break
        left[k] = False
        right[k] /= a[k, k]
        a[k] /= a[k, k]
        factor = a[:, k].copy()
        factor[k] = 0.0
        a -= factor[:, None] * a[k]
        right -= factor * right[k]
    right[left] = 0.0
    return right


def determinant(m: Floats) -> Floats:
    """Determinants of 3 x 3 matrices; many times faster than one by one in LAPACK."""
    a, b, c = (m[..., row, :] for row in range(3))
    return (
        a[..., 0] * (b[..., 1] * c[..., 2] - b[..., 2] * c[..., 1])
        + a[..., 1] * (b[..., 2] * c[..., 0] - b[..., 0] * c[..., 2])
        + a[..., 2] * (b[..., 0] * c[..., 1] - b[..., 1] * c[..., 0])
    )


def in_order(keys: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Whole numbers from 0 up in a stable order, and the original index of each.

    If both fit into 63 bits they are sorted as one number, many times faster than by argsort.
    """
    bits = len(keys).bit_length()
    if int(keys.max(initial=0)).bit_length() + bits > 63:
        order = np.argsort(keys, kind="stable")
        return keys[order], order
    packed = (keys << bits) | np.arange(len(keys))
    packed.sort()
    return packed >> bits, packed & ((1 << bits) - 1)


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
        # link whole trees, not single items: a long chain then takes few rounds
        np.minimum.at(label, at_a, low)
        np.minimum.at(label, at_b, low)
        label = label[label]
        if (label == before).all():
            return label
