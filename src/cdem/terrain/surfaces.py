"""Sliding surfaces by their shape: planes, the highest of several, ellipsoids, splines through points."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.terrain.files import Bring
from cdem.terrain.heights import Heights, Plane, extra
from cdem.terrain.points import read_points

Floats = NDArray[np.float64]
PLANAR, ALIGNED = 4.0, 0.8
"""A plane through lines is reported as doubtful with M below the first, or K above the second."""


class Highest:
    """The highest of several surfaces: the rock above all of them slides.

    Args:
        surfaces: The surfaces.
    """

    def __init__(self, surfaces: Sequence[Heights]) -> None:
        self._surfaces = surfaces
        self.low = np.max([s.low for s in surfaces], axis=0)
        self.high = np.min([s.high for s in surfaces], axis=0)

    def __call__(self, xy: Floats) -> Floats:
        return np.max([surface(xy) for surface in self._surfaces], axis=0)


class Ellipsoid:
    """The lower half of an ellipsoid; beyond its edge it continues as its mirror image.

    Args:
        centre: Centre [m], shape (3,).
        axes: Half axes along the azimuth, across it, and normal to both [m], shape (3,).
        azimuth: Direction of the first axis in plan, clockwise from north [deg].
        tilt: Plunge of the first axis below the horizontal [deg].
    """

    def __init__(self, centre: Floats, axes: Floats, azimuth: float, tilt: float) -> None:
        a, t = math.radians(azimuth), math.radians(tilt)
        along = np.array([math.sin(a) * math.cos(t), math.cos(a) * math.cos(t), -math.sin(t)])
        across = np.array([math.cos(a), -math.sin(a), 0.0])
        turned = np.column_stack([along, across, np.cross(along, across)])
        self._form = turned @ np.diag(1 / axes**2) @ turned.T  # x . form x = 1 on it
        self._centre = centre
        self.low, self.high = np.full(2, -np.inf), np.full(2, np.inf)

    def __call__(self, xy: Floats) -> Floats:
        form, d = self._form, np.asarray(xy, float) - self._centre[:2]
        linear = 2 * d @ form[:2, 2]
        rest = np.einsum("ij,jk,ik->i", d, form[:2, :2], d) - 1
        under_root = linear**2 - 4 * form[2, 2] * rest
        root = np.sign(under_root) * np.sqrt(np.abs(under_root))
        return self._centre[2] - (linear + root) / (2 * form[2, 2])


class Spline:
    """A thin plate through points: the smoothest surface; a plane for coplanar points.

    Args:
        points: Points [m], shape (points, 3).

    Raises:
        CaseError: There are fewer than three, two at one place, or all lie on one line.
    """

    def __init__(self, points: Floats) -> None:
        self._middle = points[:, :2].mean(axis=0)
        self._scale = max(float(np.ptp(points[:, :2], axis=0).max()), 1e-9)
        interpolate = extra("scipy.interpolate")
        try:
            self._through = interpolate.RBFInterpolator(
                self._local(points), points[:, 2], kernel="thin_plate_spline", degree=1
            )
        except (ValueError, np.linalg.LinAlgError):
            raise CaseError(
                f"a surface through {len(points)} points needs three or more, not on one line and no "
                "two at one place"
            ) from None
        # within the points; beyond them errors of a metre grow to several
        self.low, self.high = np.full(2, -np.inf), np.full(2, np.inf)

    def _local(self, xy: Floats) -> Floats:
        return (np.asarray(xy, float)[:, :2] - self._middle) / self._scale

    def __call__(self, xy: Floats) -> Floats:
        return np.asarray(self._through(self._local(xy)), float)


def fit_plane(points: Floats, name: str) -> tuple[Plane, list[str]]:
    """The plane with the least squares of distances to points.

    Args:
        points: Points [m], shape (points, 3).
        name: Their name in notes.

    Returns:
        The plane, and its quality: M = ln(l1/l3) is large for coplanar points,
        K = ln(l1/l2) / ln(l2/l3) for collinear ones (Fernandez, 2005).

    Raises:
        CaseError: The points are collinear, or the plane is vertical.
    """
    middle = points.mean(axis=0)
    spread, axes = np.linalg.eigh(np.cov((points - middle).T))
    if len(points) < 3 or spread[1] <= 1e-12 * spread[2]:
        raise CaseError(f"{name}: its points lie on one line, which defines no plane")
    normal = axes[:, 0] * (np.sign(axes[2, 0]) or 1.0)
    dip = math.degrees(math.acos(min(1.0, float(normal[2]))))
    if dip > 89.9:
        raise CaseError(f"{name}: the plane through its points is vertical")
    direction = math.degrees(math.atan2(normal[0], normal[1])) % 360
    # flat to rounding counts as flat
    least = max(float(spread[0]), 1e-12 * float(spread[2]))
    planar = math.log(spread[2] / least)
    aligned = math.log(spread[2] / spread[1]) / math.log(spread[1] / least)
    note = (
        f"{name}: plane {dip:.2f} deg towards {direction:05.1f} deg, {math.sqrt(max(spread[0], 0.0)):.2g} m "
        f"off (M = {planar:.1f}, K = {aligned:.2f})"
    )
    if planar < PLANAR or aligned > ALIGNED:
        note += "; doubtful: the lines are nearly collinear, or not in a plane"
    return Plane(dip, direction, (float(middle[0]), float(middle[1]), float(middle[2]))), [note]


def through_points(path: Path, columns: Mapping[str, str], bring: Bring) -> Heights:
    """A surface through points of a file: planes for points with dips, else a thin plate.

    Raises:
        CaseError: The file cannot be read, or does not determine a surface.
    """
    found = read_points(path, columns, bring)
    xyz = np.column_stack([found["x"], found["y"], found["z"]])
    if "dip" not in found:
        return Spline(xyz)
    rows = zip(found["dip"], found["dip_direction"], xyz.tolist(), strict=True)
    return Highest([Plane(float(dip), float(to), tuple(at)) for dip, to, at in rows])
