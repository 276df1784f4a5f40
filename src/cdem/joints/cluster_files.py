"""Points of planes that were found in a cloud, as the Discontinuity Set Extractor writes them.

Riquelme et al. (2014). Each line has x, y, z, the number of the joint set, the number of the cluster
in it, and A, B, C, D of the plane A x + B y + C z + D = 0; a cluster is one joint.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import reading
from cdem.errors import CaseError
from cdem.joints.tables import number

Floats = NDArray[np.float64]

WIDTH = 9
LONGEST_LINE = 1000
UNIT = 0.01
"""Largest deviation of the length of A, B, C from 1."""
MEND = "lines of clusters are x y z set cluster A B C D"


def is_clusters(path: Path) -> bool:
    """Whether the first line of a file is nine numbers: a point, two whole numbers, and a plane."""
    try:
        with path.open("rb") as file:
            words = file.readline(LONGEST_LINE).decode("utf-8", "replace").replace(",", " ").split()
    except OSError:
        return False
    values = np.array([number(word) for word in words])
    if len(values) != WIDTH or not np.isfinite(values).all():
        return False
    whole = (values[3:5] == np.round(values[3:5])).all()
    unit = (np.abs(values[5:8]) < 2).all() and abs(np.linalg.norm(values[5:8]) - 1) < UNIT
    return bool(whole and unit)


def read_clusters(path: Path) -> tuple[Floats, list[str], list[str]]:
    """Read the planes of clusters.

    Args:
        path: Text, as `is_clusters` tells.

    Returns:
        Unit normals, shape (clusters, 3); the set of each; messages for the user.

    Raises:
        CaseError: It cannot be read, or a plane is no plane.
    """
    with reading(path, CaseError, MEND):
        with path.open(encoding="latin-1") as file:
            comma = "," if "," in file.readline(LONGEST_LINE) else None
            file.seek(0)
            rows = np.loadtxt(file, delimiter=comma, ndmin=2)
        if rows.shape[1] != WIDTH:
            raise CaseError(f"{path}: has {rows.shape[1]} columns; {MEND}")
        wrong = ~(np.abs(np.linalg.norm(rows[:, 5:8], axis=1) - 1) < UNIT)
        if wrong.any():
            raise CaseError(f"{path}: row {wrong.argmax() + 1}: A, B, C are no unit normal; {MEND}")
        _, first = np.unique(rows[:, 3:5], axis=0, return_index=True)
    planes = rows[first]
    planes = planes[(planes[:, 3] > 0) & (planes[:, 4] > 0)]  # 0: of no set, of no cluster
    if not len(planes):
        raise CaseError(f"{path}: has no cluster with a set")
    notes = [
        f"{len(rows):,} points of {len(planes)} clusters, each a joint: x y z set cluster A B C D"
    ]
    alike = [
        int(k)
        for k in np.unique(planes[:, 3])
        if len(same := planes[planes[:, 3] == k, 5:8]) > 1 and np.ptp(same, axis=0).max() < 1e-9
    ]
    if alike:
        notes.append(
            f"all clusters of the sets {', '.join(map(str, alike))} have the plane of their set: "
            "their scatter is unknown, and kappa has no meaning"
        )
    normals = planes[:, 5:8] / np.linalg.norm(planes[:, 5:8], axis=1)[:, None]
    return normals, [f"set{k:.0f}" for k in planes[:, 3]], notes
