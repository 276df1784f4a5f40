"""A block of tets as a rigid body: its mass, centre, velocity, spin and energies, and its place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """The rigid part of the motion of a block.

    Attributes:
        centre: Centre of mass [m].
        velocity: Of the centre of mass [m/s].
        spin: Angular velocity, whose angular momentum is that of the block [rad/s].
        translation: Kinetic energy of the translation [J].
        rotation: Kinetic energy of the rotation [J].
    """

    centre: Floats
    velocity: Floats
    spin: Floats
    translation: float
    rotation: float


class RigidBlock:
    """A block of linear tets of one density.

    All sums are exact for velocities that are linear in each tet, as those of the block are:
    the integral of a product of linear functions over a tet is V/20 (sum a_i sum b_j + sum a_i b_i).

    Args:
        points: Corners without stress [m], shape (points, 3).
        tets: Points of each tet, shape (tets, 4).
        density: [kg/m3].
    """

    def __init__(self, points: Floats, tets: NDArray[np.int64], density: float) -> None:
        self._tets = tets
        corners = points[tets]
        a, b, c = (corners[:, k] - corners[:, 0] for k in (1, 2, 3))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
        self._share = density * volume
        self.volume = float(volume.sum())
        self.mass = float(self._share.sum())
        centre = self._mean(points)
        self.shape = points - centre
        self.radius = float(np.linalg.norm(self.shape, axis=1).max())
        self._weights = np.bincount(tets.ravel(), np.repeat(self._share, 4) / 4, len(points))

    def _mean(self, values: Floats) -> Floats:
        """Mean over the mass of values at the points, shape (points, 3)."""
        return self._share @ values[self._tets].mean(axis=1) / self.mass

    def _products(self, left: Floats, right: Floats) -> Floats:
        """Integral over the mass of the products left_i right_j, shape (3, 3)."""
        a, b = left[self._tets], right[self._tets]
        sums = np.einsum("t,ti,tj->ij", self._share, a.sum(axis=1), b.sum(axis=1))
        return (sums + np.einsum("t,tki,tkj->ij", self._share, a, b)) / 20

    def motion(self, position: Floats, velocity: Floats) -> Motion:
        """The rigid part of a motion.

        Args:
            position: Of the points [m], shape (points, 3).
            velocity: Of the points [m/s], shape (points, 3).
        """
        centre, mean = self._mean(position), self._mean(velocity)
        arm = position - centre
        moments = self._products(arm, velocity - mean)
        momentum = np.array(
            [moments[1, 2] - moments[2, 1], moments[2, 0] - moments[0, 2],
             moments[0, 1] - moments[1, 0]]
        )  # fmt: skip
        square = self._products(arm, arm)
        inertia = np.trace(square) * np.eye(3) - square
        spin = np.linalg.solve(inertia, momentum)
        return Motion(
            centre, mean, spin, 0.5 * self.mass * float(mean @ mean), 0.5 * float(momentum @ spin)
        )

    def placed(self, position: Floats) -> Floats:
        """Points of the block without stress at its present place and attitude [m].

        The attitude has the least mean square distance from the present points (Kabsch 1976, Acta
        Cryst. A 32, 922), each with the mass of its corners.

        Args:
            position: Present points [m], shape (points, 3).
        """
        centre = self._mean(position)
        u, _, v = np.linalg.svd((self.shape * self._weights[:, None]).T @ (position - centre))
        keep = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ v))])
        return centre + self.shape @ (u @ keep @ v)
