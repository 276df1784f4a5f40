"""Size and place of a mesh: detects lengths in millimetres, and coordinates too far from the origin."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.case.plausible import range_of
from cdem.errors import MeshError
from cdem.mesh.arrays import in_pieces
from cdem.mesh.mesh import Floats, Mesh

ROUND_OFF = 2.0**-52
COARSE = 1e-8
"""Round-off of positions, relative to an element's size, that gives a warning: 500 Pa in rock of 50 GPa."""
TOO_COARSE = 1e-5
"""Round-off that is refused: 0.5 MPa."""


def check_extent(mesh: Mesh) -> None:
    """Refuse a mesh too large, too small or too far from the origin; warn of an unusual one.

    Raises:
        MeshError: Its size is not possible, or round-off of the coordinates would strain the rock.
    """
    if not np.isfinite(mesh.points).all():
        return  # `check_elements` names the place
    span = np.ptp(mesh.points, axis=0)
    sizes = {"length of the model": float(span.max()), "height of the model": float(span[2])}
    for quantity, size in sizes.items():
        impossible, what = range_of(quantity).judge(size)
        text = f"{quantity}: {what}. Lengths are in m: is the mesh in mm or cm?"
        if impossible:
            raise MeshError(text)
        if what:
            mesh.notes.append(text)
            break
    _check_distance(mesh)


def _check_distance(mesh: Mesh) -> None:
    def share(cells: NDArray) -> Floats:
        corners = mesh.points[cells]
        size = np.ptp(corners, axis=1).max(axis=1)
        return np.abs(corners).max(axis=(1, 2)) / np.maximum(size, 1e-300)

    worst = max(
        (float(in_pieces(share, c).max()) for c in mesh.cells.values() if len(c)), default=0.0
    )
    if worst * ROUND_OFF < COARSE:
        return
    middle = ", ".join(f"{x:.6g}" for x in -mesh.points.mean(axis=0))
    text = (
        f"elements lie {worst:.2g} times their size from the origin, so their corners are rounded "
        f"by {worst * ROUND_OFF:.1g} of it; move the model, e.g. model.translate: [{middle}]"
    )
    if worst * ROUND_OFF > TOO_COARSE:
        raise MeshError(text)
    mesh.notes.append(text)
