"""Joints of finite size: random discs, blocks that they meet, and faces of a cut inside them."""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case.bodies_schema import MOST_DISCS, Discs, Joint, Power, Radii
from cdem.errors import CaseError
from cdem.joints.convex_cells import Cells, Floats, Ints
from cdem.joints.cutting import cut
from cdem.joints.directions import fisher, mean_normal
from cdem.joints.disc_files import read_rows
from cdem.mesh.arrays import along, lengths


@dataclass(frozen=True)
class Disc:
    """One disc: its centre [m], unit normal, and radius [m]."""

    center: Floats
    normal: Floats
    radius: float


def read_discs(path: Path, notes: list[str] | None = None) -> list[Disc]:
    """Read discs from a file, as `disc_files.read_rows` does.

    Args:
        path: The file.
        notes: Receives notes on assumptions and unused data.

    Raises:
        CaseError: It cannot be read, or a value is missing or out of range.
    """
    return [Disc(*row) for row in read_rows(path, [] if notes is None else notes)]


def draw_discs(joint: Joint, discs: Discs, points: Floats) -> list[Disc]:
    """Draw the discs of a random set.

    Args:
        joint: The set; gives name, seed and mean direction.
        discs: Its discs.
        points: Corners of the body to cut [m], shape (points, 3).

    Raises:
        CaseError: They are too many, or none.
    """
    assert discs.radius is not None
    low, high = points.min(axis=0), points.max(axis=0)
    count = discs.count
    if count is None:
        assert discs.density is not None
        most = _largest(discs.radius)
        low, high = low - most, high + most
        wanted = discs.density * float(np.prod(high - low))
        if wanted > MOST_DISCS:
            raise CaseError(f"{wanted:.3g} discs are too many; give a lower density")
        count = round(wanted)
    random = np.random.default_rng([joint.seed, zlib.crc32(joint.name.encode())])
    centers = low + (high - low) * random.random((count, 3))
    radii = _draw_radii(discs.radius, count, random)
    mean = mean_normal(joint)
    found = []
    for center, radius in zip(centers, radii, strict=True):
        normal = mean if joint.scatter is None else fisher(mean, joint.scatter.fisher, random)
        found.append(Disc(center, normal, float(radius)))
    return found


def _largest(radius: float | Radii) -> float:
    if not isinstance(radius, Radii):
        return radius
    spread = radius.uniform or radius.power or radius.lognormal
    assert spread is not None
    return spread.max


def _draw_radii(radius: float | Radii, count: int, random: np.random.Generator) -> Floats:
    if not isinstance(radius, Radii):
        return np.full(count, radius)
    if (log := radius.lognormal) is not None:
        sigma = math.sqrt(math.log1p((log.deviation / log.mean) ** 2))
        drawn = np.full(count, np.inf)
        while (above := drawn > log.max).any():
            normal = random.standard_normal(int(above.sum()))
            drawn[above] = log.mean * np.exp(sigma * normal - sigma**2 / 2)
        return drawn
    spread = radius.uniform or radius.power
    assert spread is not None
    part = random.random(count)
    if not isinstance(spread, Power):
        return spread.min + (spread.max - spread.min) * part
    power = 1 - spread.exponent
    return (spread.min**power + (spread.max**power - spread.min**power) * part) ** (1 / power)


def cut_by_disc(
    c: Cells, disc: Disc, joint: int, bridges: Ints, *, among: NDArray[np.bool_], thinnest: float
) -> tuple[Cells, bool, int]:
    """Cut the blocks that a disc meets by its plane.

    Args:
        c: The cells.
        disc: The disc.
        joint: Source number of faces with their centre in the disc.
        bridges: Source numbers of rock bridges; the last is for this cut.
        among: Groups that it may cut.
        thinnest: A block is left whole if it reaches less than this far to one side [m].

    Returns:
        The new cells, whether the disc met any block, and the number of blocks met but left whole
            because a part would be too thin.
    """
    offset = float((disc.normal * disc.center).sum())
    met = blocks_met(c, disc) & _blocks_among(c, among)
    cells, thin = cut(
        c, disc.normal, offset, int(bridges[-1]), among=among, thinnest=thinnest, only=met
    )
    return _claimed(cells, disc, offset, joint, bridges), bool(met.any()), thin


def _blocks_among(c: Cells, among: NDArray[np.bool_]) -> NDArray[np.bool_]:
    out = np.zeros(c.blocks, bool)
    out[c.block] = among[c.group]
    return out


def _claimed(c: Cells, disc: Disc, offset: float, joint: int, bridges: Ints) -> Cells:
    """Turn rock bridges in the disc's plane with their centre in the disc into joint faces.

    Both sides of a cut are the same polygon here, so both become joint or neither; parts made of
    them by later planes stay so.
    """
    off = np.abs(along(c.points, disc.normal) - offset) > c.near
    flat = np.isin(c.source, bridges)
    flat[c.owner()[off[c.corner]]] = False
    faces = np.flatnonzero(flat)
    inside = [k for k in faces.tolist() if _holds(disc, c.points[_corners(c, k)])]
    source = c.source.copy()
    source[inside] = joint
    return replace(c, source=source)


def _corners(c: Cells, face: int) -> Ints:
    return c.corner[c.first[face] : c.first[face + 1]]


def _holds(disc: Disc, x: Floats) -> bool:
    """Whether the centroid of a plane polygon lies in a disc of its plane."""
    a, b = x[1:-1] - x[0], x[2:] - x[0]
    area = along(np.cross(a, b), disc.normal)
    center = x[0] + (area[:, None] * (a + b)).sum(axis=0) / (3 * area.sum())
    return bool(np.linalg.norm(center - disc.center) <= disc.radius)


def blocks_met(c: Cells, disc: Disc) -> NDArray[np.bool_]:
    """Blocks that a disc meets: it crosses their cut by its plane, inside or between cells."""
    distance = along(c.points - disc.center, disc.normal)
    near = c.near
    side = (distance > near).astype(np.int8) - (distance < -near).astype(np.int8)
    owner = c.owner()
    of_corner = c.cell[owner]
    least, most = (np.zeros(len(c.block), np.int8) for _ in range(2))
    np.minimum.at(least, of_corner, side[c.corner])
    np.maximum.at(most, of_corner, side[c.corner])
    flat = np.ones(len(c.cell), bool)  # faces in the plane
    flat[owner[side[c.corner] != 0]] = False
    crossed = (least < 0) & (most > 0)
    crossed[c.cell[flat]] = True
    met = _holding(c, disc.center, crossed)
    faces, start, end = _segments(c, distance, side, crossed[of_corner] & ~flat[owner], owner)
    met[c.cell[faces[_away(disc.center, start, end) <= disc.radius]]] = True
    below, above, blocks = (np.zeros(c.blocks, bool) for _ in range(3))
    below[c.block[least < 0]], above[c.block[most > 0]], blocks[c.block[met]] = True, True, True
    return blocks & below & above


def _holding(c: Cells, point: Floats, some: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cells, among some, that contain a point."""
    first = c.first[:-1]
    x, y, z = (c.points[c.corner[first + k]] for k in range(3))
    normal = np.cross(y - x, z - x)
    outside = np.einsum("ij,ij->i", normal, point - x) > c.near * lengths(normal)
    held = some.copy()
    held[c.cell[outside]] = False
    return held


def _segments(
    c: Cells, distance: Floats, side: NDArray[np.int8], some: NDArray[np.bool_], owner: Ints
) -> tuple[Ints, Floats, Floats]:
    """Crossings of a plane with faces: the faces, and both ends of each crossing."""
    a, b = c.corner[some], c.corner[c.following()[some]]
    face = owner[some]
    crossed, on = side[a] * side[b] < 0, side[a] == 0
    way = distance[a[crossed]] / (distance[a[crossed]] - distance[b[crossed]])
    between = c.points[a[crossed]] + way[:, None] * (c.points[b[crossed]] - c.points[a[crossed]])
    points = np.concatenate([between, c.points[a[on]]])
    of = np.concatenate([face[crossed], face[on]])
    order = np.argsort(of, kind="stable")
    faces, first, count = np.unique(of[order], return_index=True, return_counts=True)
    pairs = first[count == 2]
    return faces[count == 2], points[order[pairs]], points[order[pairs + 1]]


def _away(point: Floats, start: Floats, end: Floats) -> Floats:
    """Distance of a point from segments [m]."""
    way = end - start
    square = np.maximum(np.einsum("ij,ij->i", way, way), np.finfo(float).tiny)
    part = np.clip(np.einsum("ij,ij->i", point - start, way) / square, 0, 1)
    return lengths(start + part[:, None] * way - point)
