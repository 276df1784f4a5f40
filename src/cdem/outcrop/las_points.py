"""Points of LAS and LAZ clouds; run as a program, the process that reads them.

The decompressor of LAZ ends the whole program on some damaged files; see
`cdem.case.reader_process`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cdem.case import reader_process
from cdem.errors import CaseError
from cdem.terrain.cloud_sums import CHUNK, MEND


def read(path: Path, asked: dict[str, Any]) -> reader_process.Arrays:
    """Points of all classes [m], ``most`` at most; and ``every``, of which one was taken."""
    import laspy

    try:
        with laspy.open(path) as file:
            factor = _metres(path, file.header.parse_crs())
            every = -(-file.header.point_count // asked["most"]) or 1
            parts, start = [], 0
            for part in file.chunk_iterator(CHUNK):
                xyz = np.column_stack([part.x, part.y, part.z]).astype(float)
                parts.append(xyz[-start % every :: every] * factor)
                start += len(xyz)
    except BaseException as error:
        if type(error).__name__ != "PanicException":  # from lazrs, not an Exception
            raise
        raise CaseError(f"{path}: cannot be read ({error}); {MEND}") from None
    points = np.concatenate(parts) if parts else np.zeros((0, 3))
    return {"points": points, "every": np.array(every), "factor": factor}


def _metres(path: Path, system: Any) -> np.ndarray:
    """Factors of x, y, z to metres by the projection that a cloud names; 1 without one.

    Raises:
        CaseError: It is in degrees.
    """
    if system is None:
        return np.ones(3)
    if system.is_geographic:
        raise CaseError(
            f"{path}: is in degrees ({system.name}); project it to metres, e.g. to UTM, first"
        )
    units = [axis.unit_conversion_factor for axis in system.axis_info] or [1.0]
    plan = float(units[0])
    return np.array([plan, plan, float(units[2]) if len(units) > 2 else plan])


if __name__ == "__main__":
    import laspy  # noqa: F401  # loading takes longer than reading is allowed
    import lazrs  # noqa: F401
    import pyproj  # noqa: F401

    reader_process.answer(read, MEND)
