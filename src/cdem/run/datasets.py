"""Datasets of HDF5 by low-level calls: a run has thousands, and h5py's own calls are three times slower."""

from __future__ import annotations

from collections.abc import Iterator

import h5py
import numpy as np
from h5py import h5d, h5o, h5p, h5s, h5t
from numpy.typing import NDArray


def put(
    root: h5py.Group, name: str, values: NDArray, chunks: tuple[int, ...] | None = None
) -> None:
    """Write a dataset, and missing groups on its path.

    Args:
        root: The file or group that gets it.
        name: Path with slashes.
        values: Numbers of any shape.
        chunks: Shape of the pieces with a checksum each; None for none.
    """
    values = np.asarray(values, order="C")
    properties = h5p.create(h5p.DATASET_CREATE)
    properties.set_obj_track_times(False)  # so that the same numbers give the same bytes
    if chunks:
        properties.set_chunk(chunks)
        properties.set_fletcher32()
    links = h5p.create(h5p.LINK_CREATE)
    links.set_create_intermediate_group(True)
    kind, space = h5t.py_create(values.dtype, logical=True), h5s.create_simple(values.shape)
    dataset = h5d.create(root.id, name.encode(), kind, space, properties, links)
    if values.size:
        dataset.write(h5s.ALL, h5s.ALL, values)


def read_all(root: h5py.Group, but: str) -> Iterator[tuple[str, NDArray]]:
    """Names, with slashes, and values of all datasets but one."""
    names: list[bytes] = []
    h5o.visit(root.id, names.append)
    for name in names:
        item = h5o.open(root.id, name)
        if isinstance(item, h5d.DatasetID) and name != but.encode():
            values = np.empty(item.shape, item.dtype)
            if values.size:
                item.read(h5s.ALL, h5s.ALL, values)
            yield name.decode(), values
