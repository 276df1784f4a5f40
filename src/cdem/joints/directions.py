"""Directions of joints: the normal of a dip and dip direction, and scatter about it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.case.bodies_schema import Joint

Floats = NDArray[np.float64]


def pole(dip: float, dip_direction: float) -> Floats:
    """Upward unit normal of a plane, x east, y north, z up.

    Args:
        dip: Steepest angle below the horizontal [deg].
        dip_direction: Azimuth of that steepest line, clockwise from north [deg].

    Example:
        >>> pole(90, 90).round(12) + 0.0  # a wall that faces east
        array([1., 0., 0.])
    """
    dip, azimuth = np.radians(dip), np.radians(dip_direction)
    across = math.sin(dip)
    return np.array([across * math.sin(azimuth), across * math.cos(azimuth), math.cos(dip)])


def poles(dip: Floats, dip_direction: Floats) -> Floats:
    """Upward unit normals, shape (planes, 3), of dips and dip directions [deg], shape (planes,)."""
    dip, azimuth = np.radians(dip), np.radians(dip_direction)
    across = np.sin(dip)
    return np.stack([across * np.sin(azimuth), across * np.cos(azimuth), np.cos(dip)], axis=-1)


def line(trend: Floats, plunge: Floats) -> Floats:
    """Unit vectors, shape (lines, 3), along lines of trend and plunge [deg], shape (lines,)."""
    trend, plunge = np.radians(trend), np.radians(plunge)
    across = np.cos(plunge)
    return np.stack([across * np.sin(trend), across * np.cos(trend), -np.sin(plunge)], axis=-1)


def dips(normals: Floats) -> tuple[Floats, Floats]:
    """Dip and dip direction [deg] of planes by their normals, shape (..., 3), up or down."""
    up = normals * np.where(normals[..., 2:] < 0, -1.0, 1.0)
    dip = np.degrees(np.arccos(np.clip(up[..., 2], -1, 1)))
    return dip, np.degrees(np.arctan2(up[..., 0], up[..., 1])) % 360


@dataclass(frozen=True)
class NamedPlane:
    """A plane, or the mean of a set of planes.

    Attributes:
        name: Name of the set.
        normal: Upward unit normal.
    """

    name: str
    normal: Floats

    @property
    def dip(self) -> float:
        """Steepest angle below the horizontal [deg]."""
        return float(dips(self.normal)[0])

    @property
    def dip_direction(self) -> float:
        """Azimuth of that steepest line, clockwise from north [deg]."""
        return float(dips(self.normal)[1])


def fisher(mean: Floats, concentration: float, random: np.random.Generator) -> Floats:
    """A unit vector of the Fisher distribution around a mean direction (Fisher 1953).

    Args:
        mean: Unit vector.
        concentration: kappa [1]; 63 % lie within 81 deg / sqrt(kappa) of the mean.
        random: Two numbers are drawn from it.
    """
    u, turn = random.random(), 2 * np.pi * random.random()
    cosine = 1 + math.log(u + (1 - u) * math.exp(-2 * concentration)) / concentration
    sine = np.sqrt(max(0.0, 1 - cosine**2))
    across = np.cross(mean, np.eye(3)[np.abs(mean).argmin()])
    across /= np.linalg.norm(across)
    return cosine * mean + sine * (
        math.cos(turn) * across + math.sin(turn) * np.cross(mean, across)
    )


def mean_normal(joint: Joint) -> Floats:
    """Unit normal of a set, without scatter."""
    if joint.dip is None or joint.dip_direction is None:
        mean = np.asarray(joint.normal, float)
    else:
        mean = pole(joint.dip, joint.dip_direction)
    return mean / np.linalg.norm(mean)
