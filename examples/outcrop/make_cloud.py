"""Make outcrop.laz: a made-up rock face of blocks between three sets of joints, as a scanner sees it.

Points are drawn on all joints; those stay that have rock on one side and air on the other.
"""

import sys
from pathlib import Path

import laspy
import numpy as np

from cdem.joints.directions import fisher, pole
from cdem.outcrop.facets import axes

SETS = ((32, 115, 0.7), (82, 20, 0.9), (70, 265, 1.0))
"""Dip and dip direction [deg], mean spacing [m]."""
KAPPA = 1000  # scatter of the joints of a set: 63 % within 1.8 deg
SIZE, DENSITY, NOISE = 8.0, 750.0, 0.006  # [m], [1/m2], [m]
ROUGH = 0.9  # depth over which blocks have fallen out [m]
MAP = np.array([684_200.0, 5_165_400.0, 1_410.0])  # UTM zone 32
FRONT = pole(55, 145)


def main(path: Path) -> None:
    """Draw the joints, the blocks that have fallen out, and the points."""
    random = np.random.default_rng(6)
    means = np.array([pole(dip, direction) for dip, direction, _ in SETS])
    offsets = []
    for _, _, spacing in SETS:
        gaps = spacing * (0.3 + 0.7 * random.exponential(size=60))
        at = np.cumsum(gaps) - 0.9 * SIZE
        offsets.append(at[at < 0.9 * SIZE])
    kind = np.repeat(np.arange(3), [len(at) for at in offsets])
    normals = np.array([fisher(means[k], KAPPA, random) for k in kind])
    through = np.concatenate(offsets)[:, None] * means[kind]
    places = (through * normals).sum(axis=1)
    middles = [np.concatenate([[at[0]], (at[1:] + at[:-1]) / 2, [at[-1]]]) for at in offsets]
    fallen = random.random([len(middle) for middle in middles])  # chance of each block

    def rock(index: np.ndarray) -> np.ndarray:
        """Whether blocks, by their numbers along the three sets, are there."""
        middle = np.column_stack([m[index[:, k]] for k, m in enumerate(middles)])
        depth = np.linalg.solve(means, middle.T).T @ FRONT
        return depth < ROUGH * (fallen[tuple(index.T)] - 0.5)

    points = []
    for number, normal in enumerate(normals):
        flat = random.uniform(-SIZE, SIZE, (random.poisson(DENSITY * 4 * SIZE**2), 2))
        x = through[number] + flat @ axes(normal)[:2]
        x = x[(np.abs(x) < SIZE / 2).all(axis=1)]
        index = np.zeros((len(x), 3), int)
        for k in range(3):
            own = np.flatnonzero((kind == k) & (np.arange(len(kind)) != number))
            index[:, k] = (x @ normals[own].T > places[own]).sum(axis=1)
        beyond = index.copy()
        beyond[:, kind[number]] += 1
        points.append(x[rock(index) != rock(beyond)])
    x = np.concatenate(points)
    bush = np.linalg.norm(x - x[len(x) // 3], axis=1) < 0.5  # a hole behind a bush
    x = x[~bush] + NOISE * random.normal(size=(int((~bush).sum()), 3)) + MAP
    header = laspy.LasHeader(point_format=0, version="1.2")
    header.scales, header.offsets = np.full(3, 0.002), MAP
    cloud = laspy.LasData(header)
    # neighbours follow one another, so that the file packs well
    x = x[np.lexsort(np.floor(x / 0.25).T)]
    cloud.x, cloud.y, cloud.z = x.T
    cloud.write(path)
    print(f"{path}: {len(x):,} points")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "outcrop.laz"))
