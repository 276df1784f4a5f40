"""The rows that a rank owns as one message: a list of the arrays, then their bytes."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.ranks.merge import OwnRows

PLACE = 8
"""Arrays begin at multiples of so many bytes."""
TABLES = ("rows", "numbers", "lengths", "links")


def packed(own: OwnRows) -> NDArray[np.uint8]:
    """A message with the rows of a rank."""
    arrays = list(_arrays_of(own))
    listed = [[table, name, array.dtype.str, array.shape] for table, name, array in arrays]
    text = np.frombuffer(json.dumps(listed).encode(), np.uint8)
    length = np.array([len(text)], np.int64)
    parts = [length.view(np.uint8), text, *(_bytes_of(array) for _, _, array in arrays)]
    return np.concatenate([_filled(part) for part in parts])


def unpacked(message: NDArray[np.uint8]) -> OwnRows:
    """The rows in a message; views of it."""
    length = int(message[:PLACE].view(np.int64)[0])
    listed = json.loads(message[PLACE : PLACE + length].tobytes())
    own, first = OwnRows(), PLACE + _up(length)
    for table, name, dtype, shape in listed:
        size = int(np.prod(shape)) * np.dtype(dtype).itemsize
        array = message[first : first + size].view(dtype).reshape(shape)
        first += _up(size)
        if table in TABLES:
            getattr(own, table)[name] = array
        else:
            own.vertex_faces = array
    return own


def _arrays_of(own: OwnRows) -> Iterator[tuple[str, str, NDArray[Any]]]:
    for table in TABLES:
        for name, array in getattr(own, table).items():
            yield table, name, array
    yield "vertex_faces", "", own.vertex_faces


def _bytes_of(array: NDArray[Any]) -> NDArray[np.uint8]:
    return np.ascontiguousarray(array).reshape(-1).view(np.uint8)


def _up(size: int) -> int:
    return -(-size // PLACE) * PLACE


def _filled(part: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.pad(part, (0, _up(len(part)) - len(part)))
