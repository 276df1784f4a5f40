"""Heights of a point cloud summed by cells; run as a program, the process that unpacks LAZ.

The decompressor of LAZ ends the whole program on some damaged files; see
`cdem.case.reader_process`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cdem.case import reader_process
from cdem.case.map_system import look_up
from cdem.errors import CaseError
from cdem.terrain.projection import moved

MEND = "a point cloud is LAS or LAZ; if this one is, it is damaged: fetch it again"
CHUNK = 1_000_000  # points in memory at a time
GROUND = 2  # class of ground points (ASPRS)


def cell_sums(path: Path, file: Any, asked: dict[str, Any]) -> reader_process.Arrays:
    """Sum the heights of the points of an open cloud in each cell of a grid.

    Args:
        path: For messages.
        file: A ``laspy.LasReader``.
        asked: ``low``: south-west corner [m]; ``cell`` [m], ``columns`` and ``rows`` of the grid;
            ``classes``: "ground" for points of class 2, "all" for all; ``own`` and ``target``: the
                projections of the cloud and of the grid, None if they are the same.

    Returns:
        ``total``: sums of heights, ``count``: numbers of points, both (rows * columns,) from the
        south-west, row by row; ``taken``: number of points of those classes, inside or not.
    """
    low, cell, columns, rows = asked["low"], asked["cell"], asked["columns"], asked["rows"]
    systems = None if asked["own"] is None else (look_up(asked["own"]), look_up(asked["target"]))
    total, count, taken = np.zeros(rows * columns), np.zeros(rows * columns), 0
    for part in file.chunk_iterator(CHUNK):
        ground = asked["classes"] == "ground"
        kept = np.asarray(part.classification) == GROUND if ground else slice(None)
        xyz = np.column_stack([part.x, part.y, part.z]).astype(float)[kept]
        taken += len(xyz)
        try:
            xy = moved(xyz, *systems) if systems else xyz[:, :2]
        except CaseError as error:
            raise CaseError(f"{path}: {error}") from None
        at = np.floor((xy - low) / cell).astype(int)
        inside = ((at >= 0) & (at < [columns, rows])).all(axis=1)
        index = at[inside, 1] * columns + at[inside, 0]
        total += np.bincount(index, xyz[inside, 2], rows * columns)
        count += np.bincount(index, minlength=rows * columns)
    return {"total": total, "count": count, "taken": np.array(taken)}


def _unpack(path: Path, asked: dict[str, Any]) -> reader_process.Arrays:
    import laspy

    try:
        with laspy.open(path) as file:
            return cell_sums(path, file, asked)
    except BaseException as error:
        if type(error).__name__ != "PanicException":  # from lazrs, not an Exception
            raise
        raise CaseError(f"{path}: cannot be read ({error}); {MEND}") from None


if __name__ == "__main__":
    import laspy  # noqa: F401  # loading takes longer than reading is allowed
    import lazrs  # noqa: F401
    import pyproj  # noqa: F401

    reader_process.answer(_unpack, MEND)
