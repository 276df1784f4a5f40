"""Made-up outcrops as point clouds, of which everything is known."""

from dataclasses import dataclass, field

import numpy as np

from cdem.joints.directions import fisher, pole

SETS = {"a": (30.0, 95.0, 0.6), "b": (80.0, 20.0, 0.8), "c": (75.0, 280.0, 0.9)}
"""Dip, dip direction [deg] and mean spacing [m]."""


@dataclass
class Outcrop:
    """A cloud and the planes of which it shows parts.

    Attributes:
        points: [m], shape (points, 3).
        plane: Number of each point's plane, -1 for noise, shape (points,).
        set_of: Name of each plane's set.
        normals: Of the planes, shape (planes, 3).
        offsets: Position of the planes along the normal of their set [m].
        density: Points per area [1/m2], before holes.
    """

    points: np.ndarray
    plane: np.ndarray
    set_of: list[str]
    normals: np.ndarray
    offsets: np.ndarray
    density: float
    notes: list[str] = field(default_factory=list)


def blocky(
    size=6.0, density=800.0, noise=0.005, kappa=None, seed=1, sets=SETS, rough=0.8, uneven=0.0
):
    """A face of blocks: rock where a block between the planes lies behind a rough front.

    Points are drawn on all planes; those stay that have rock on one side only.

    Args:
        size: Edge of the cube with the outcrop [m].
        density: Points per area [1/m2].
        noise: Deviation of each coordinate [m].
        kappa: Scatter of the planes of a set; None for parallel planes.
        seed: Another one draws others.
        sets: Dip, dip direction, mean spacing of each.
        rough: Depth over which blocks are missing at random [m].
        uneven: Share of points that is lost at the far end; 0 for an even density.
    """
    random = np.random.default_rng(seed)
    planes, names = [], []
    for name, (dip, direction, spacing) in sets.items():
        mean, reach = pole(dip, direction), 0.9 * size
        gaps = spacing * (0.3 + 0.7 * random.exponential(size=int(6 * size / spacing)))
        at = np.cumsum(gaps) - reach
        for offset in at[at < reach]:
            normal = mean if kappa is None else fisher(mean, kappa, random)
            planes.append((normal, offset, mean))
            names.append(name)
    kinds = np.array(names)
    salt = random.integers(1, 2**31, 3)

    def rock(x):
        index = np.zeros((len(x), 3), np.int64)
        center = x @ np.array([0.0, 0.5, 0.87])  # the front leans back
        for k, name in enumerate(sets):
            for (normal, offset, mean), kind in zip(planes, kinds, strict=True):
                if kind == name:
                    index[:, k] += (x - offset * mean) @ normal > 0
        chance = (index * salt).sum(axis=1) * 2654435761 % 1000003 / 1000003
        del center
        return index, chance

    front = np.array([0.35, -0.75, 0.55]) / np.linalg.norm([0.35, -0.75, 0.55])
    # depth of a block: that of its middle, found by the planes about it
    own = [[p for p, kind in zip(planes, kinds, strict=True) if kind == name] for name in sets]
    axes = np.array([rows[0][2] for rows in own])
    edges = [np.array([row[1] for row in rows]) for rows in own]

    def solid(x):
        index, chance = rock(x)
        middle = np.column_stack(
            [
                np.concatenate([[e[0] - 0.5], (e[1:] + e[:-1]) / 2, [e[-1] + 0.5]])[index[:, k]]
                for k, e in enumerate(edges)
            ]
        )
        center = np.linalg.solve(axes, middle.T).T
        return center @ front < rough * (chance - 0.5)

    points, plane = [], []
    for k, (normal, offset, mean) in enumerate(planes):
        across = np.cross(normal, [0, 0, 1.0] if abs(normal[2]) < 0.9 else [1.0, 0, 0])
        across /= np.linalg.norm(across)
        along = np.cross(normal, across)
        span = 1.8 * size
        count = random.poisson(density * span**2)
        uv = random.uniform(-span / 2, span / 2, (count, 2))
        x = offset * mean + uv[:, :1] * across + uv[:, 1:] * along
        x = x[(np.abs(x) < size / 2).all(axis=1)]
        if not len(x):
            continue
        free = solid(x + 1e-6 * normal) != solid(x - 1e-6 * normal)
        points.append(x[free])
        plane.append(np.full(free.sum(), k))
    x, number = np.concatenate(points), np.concatenate(plane)
    if uneven:
        kept = random.random(len(x)) > uneven * (x[:, 0] / size + 0.5)
        x, number = x[kept], number[kept]
    x = x + noise * random.normal(size=x.shape)
    order = random.permutation(len(x))
    return Outcrop(
        x[order],
        number[order],
        names,
        np.array([p[0] for p in planes]),
        np.array([p[1] for p in planes]),
        density,
    )
