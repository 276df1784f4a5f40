"""Made-up outcrops as point clouds, of which everything is known."""

from dataclasses import dataclass

import numpy as np

from cdem.joints.directions import fisher, pole
from cdem.outcrop.facets import axes

SETS = {"a": (30.0, 95.0, 0.6), "b": (80.0, 20.0, 0.8), "c": (75.0, 280.0, 0.9)}
"""Dip, dip direction [deg] and mean spacing [m]."""
FRONT = np.array([0.35, -0.75, 0.55]) / np.linalg.norm([0.35, -0.75, 0.55])
"""Normal of the face, towards the air."""


@dataclass
class Outcrop:
    """A cloud and the planes of which it shows parts.

    Attributes:
        points: [m], shape (points, 3).
        plane: Number of each point's plane, shape (points,).
        set_of: Name of each plane's set.
        normals: Of the planes, shape (planes, 3).
        offsets: Position of the planes along the mean normal of their set [m].
        density: Points per area [1/m2], before holes.
    """

    points: np.ndarray
    plane: np.ndarray
    set_of: np.ndarray
    normals: np.ndarray
    offsets: np.ndarray
    density: float

    def only(self, kept):
        """The outcrop with some of its points."""
        return Outcrop(
            self.points[kept],
            self.plane[kept],
            self.set_of,
            self.normals,
            self.offsets,
            self.density,
        )


def blocky(size=6.0, density=800.0, noise=0.005, kappa=None, seed=1, sets=SETS, rough=0.8):
    """A face of blocks: rock where the middle of a block lies behind a rough front.

    Points are drawn on all planes; those stay that have rock on one side only.

    Args:
        size: Edge of the cube with the outcrop [m].
        density: Points per area [1/m2].
        noise: Deviation of each coordinate [m].
        kappa: Scatter of the planes of a set; None for parallel planes.
        seed: Another one draws others.
        sets: Dip, dip direction, mean spacing of each.
        rough: Depth over which blocks are missing at random [m].
    """
    random = np.random.default_rng(seed)
    means = np.array([pole(dip, direction) for dip, direction, _ in sets.values()])
    offsets, kinds = [], []
    for k, (_, _, spacing) in enumerate(sets.values()):
        gaps = spacing * (0.3 + 0.7 * random.exponential(size=int(6 * size / spacing)))
        at = np.cumsum(gaps) - 0.9 * size
        offsets.append(at[at < 0.9 * size])
        kinds.append(np.full(len(offsets[-1]), k))
    kind, offset = np.concatenate(kinds), np.concatenate(offsets)
    normals = means[kind]
    if kappa is not None:
        normals = np.array([fisher(mean, kappa, random) for mean in normals])
    shift = (offset[:, None] * means[kind] * normals).sum(axis=1)
    middles = [np.concatenate([[e[0] - 0.5], (e[1:] + e[:-1]) / 2, [e[-1] + 0.5]]) for e in offsets]
    salt = random.integers(1, 2**31, 3)

    def rock(index):
        chance = (index * salt).sum(axis=1) * 2654435761 % 1000003 / 1000003
        middle = np.column_stack([m[index[:, k]] for k, m in enumerate(middles)])
        return rough * (chance - 0.5) > np.linalg.solve(means, middle.T).T @ FRONT

    points, plane = [], []
    for number, normal in enumerate(normals):
        span = 1.8 * size
        uv = random.uniform(-span / 2, span / 2, (random.poisson(density * span**2), 2))
        x = offset[number] * means[kind[number]] + uv @ axes(normal)[:2]
        x = x[(np.abs(x) < size / 2).all(axis=1)]
        index = np.zeros((len(x), 3), np.int64)
        for k in range(3):
            own = np.flatnonzero((kind == k) & (np.arange(len(kind)) != number))
            index[:, k] = (x @ normals[own].T > shift[own]).sum(axis=1)
        beyond = index.copy()
        beyond[:, kind[number]] += 1
        points.append(x[rock(index) != rock(beyond)])
        plane.append(np.full(len(points[-1]), number))
    x, plane = np.concatenate(points), np.concatenate(plane)
    x = x + noise * random.normal(size=x.shape)
    order = random.permutation(len(x))
    return Outcrop(x[order], plane[order], np.array(list(sets))[kind], normals, offset, density)


def thinned_out(outcrop, seed=7):
    """An outcrop with an uneven density, holes, doubled points and points in the air."""
    random = np.random.default_rng(seed)
    x = outcrop.points
    span = np.ptp(x[:, 0])
    kept = random.random(len(x)) > 0.6 * (x[:, 0] - x[:, 0].min()) / span
    for _ in range(12):
        kept &= np.linalg.norm(x - x[random.integers(len(x))], axis=1) > 0.1
    out = outcrop.only(np.flatnonzero(kept))
    doubled = random.integers(len(out.points), size=len(out.points) // 5)
    air = random.uniform(x.min(axis=0), x.max(axis=0), (len(out.points) // 100, 3))
    points = np.concatenate([out.points, out.points[doubled], air])
    return Outcrop(
        points,
        np.concatenate([out.plane, out.plane[doubled], np.full(len(air), -1)]),
        out.set_of,
        out.normals,
        out.offsets,
        out.density,
    )


def ledges(width=12.0, rows=16, mean=1.5, density=900.0, noise=0.004, seed=2):
    """A wall with ledges of exponential lengths, cut off at both sides; all dips 30 or 60 deg south
    or north.

    Args:
        width: Of the wall along strike [m].
        rows: Number of levels with ledges, 0.5 m apart.
        mean: Mean length of the ledges, and of the gaps between them [m].
        density: Points per area [1/m2].
        noise: Deviation of each coordinate [m].
        seed: Another one draws others.

    Returns:
        The points [m], all true lengths of the ledges in the window [m], and of each the length
        inside and whether its two ends are inside.
    """
    random = np.random.default_rng(seed)
    depth, rise, parts, lengths, inside = 0.25, 0.5, [], [], []

    def rectangle(x, y, z):
        low, high = np.array([x, y, z]).T
        sides = np.sort(high - low)[1:]
        count = random.poisson(density * sides.prod())
        parts.append(random.uniform(low, high, (count, 3)))

    for row in range(rows):
        bottom, top = row * rise, row * rise + rise / 2
        at, end = -20 * mean, 0.0
        while at < width:
            start = at + random.exponential(mean)
            left, right = max(end, 0.0), min(start, width)
            if right > left:  # the wall between ledges
                rectangle((left, right), (0, 0), (bottom, top))
            end = start + random.exponential(mean)
            left, right = max(start, 0.0), min(end, width)
            if right > left:
                rectangle((left, right), (-depth, -depth), (bottom, top))
                rectangle((left, right), (-depth, 0), (top, top))
                rectangle((left, right), (-depth, 0), (bottom, bottom))
                lengths.append(end - start)
                inside.append((right - left, start > 0, end < width))
            for side in (start, end):
                if 0 < side < width:
                    rectangle((side, side), (-depth, 0), (bottom, top))
            at = end
        rectangle((0, width), (0, 0), (top, bottom + rise))
    cosine, sine = np.cos(np.radians(30)), np.sin(np.radians(30))
    x = np.concatenate(parts) @ np.array([[1, 0, 0], [0, cosine, sine], [0, -sine, cosine]])
    return x + noise * random.normal(size=x.shape), np.array(lengths), np.array(inside)
