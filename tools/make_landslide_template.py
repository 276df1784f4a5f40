"""Make src/cdem/templates/slope.msh: a lens of tetrahedra on a slope that runs out into a valley.

Run it after changing a number here: ``python tools/make_landslide_template.py``. The mesh is the
same on every run. Groups: "bedrock", a layer of wedges, and "body", tetrahedra whose bottom faces
are top faces of the bedrock.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

DIP = np.radians(30.0)
SLOPE_LENGTH, VALLEY_LENGTH = 70.0, 70.0  # along the ground [m]
BODY_BEGIN, BODY_END, BODY_WIDTH = 8.0, 48.0, 24.0  # along the slope from its top; across [m]
THICKNESS = 9.0  # of the body at its middle [m]
CELLS = (7, 4, 2)  # of the body: along, across, up; 5 tetrahedra each
SIDE_STRIPS = (-34.0, -22.0, 22.0, 34.0)  # bedrock beside the body [m]
FLOOR = -8.0  # bottom of the bedrock in the valley [m]
JITTER = 0.16  # of the cell size, so that the blocks look like rock
# Corners of the five tetrahedra of a cell: one in the middle, and the four corners that it leaves.
MIDDLE = [(0, 0, 0), (1, 1, 0), (1, 0, 1), (0, 1, 1)]
OTHERS = [(1, 1, 1), (0, 0, 1), (0, 1, 0), (1, 0, 0)]
FIVE = [
    MIDDLE,
    *[[o, *(m for m in MIDDLE if m != far)] for o, far in zip(OTHERS, MIDDLE, strict=True)],
]
OUTPUT = Path(__file__).parents[1] / "src/cdem/templates/slope.msh"


def ground(along):
    """Points (x, z) of the ground, distances from the top of the slope [m]."""
    down = np.minimum(along, SLOPE_LENGTH)
    flat = np.maximum(along - SLOPE_LENGTH, 0)
    x = down * np.cos(DIP) + flat
    z = (SLOPE_LENGTH - down) * np.sin(DIP)
    return x, z


def body_points(rng):
    """Points of the body in slope coordinates (along, across, up), shape (nx+1, ny+1, nz+1, 3)."""
    a, b, c = np.meshgrid(*(np.linspace(0, 1, n + 1) for n in CELLS), indexing="ij")
    points = np.stack([a, b, c], axis=-1)
    # Nodes on an outer face stay in it, so only inner directions move.
    size = 1 / np.array(CELLS)
    free = (points > 1e-9) & (points < 1 - 1e-9)
    points = points + free * size * rng.uniform(-JITTER, JITTER, points.shape)
    a, b, c = np.moveaxis(points, -1, 0)
    lens = (0.5 + 0.5 * np.sin(np.pi * a)) * (0.7 + 0.3 * np.sin(np.pi * b))
    narrow = 1 - 0.15 * c  # the sides lean inwards
    along = BODY_BEGIN + (BODY_END - BODY_BEGIN) * (0.5 + (a - 0.5) * narrow)
    across = BODY_WIDTH * (b - 0.5) * narrow
    return np.stack([along, across, THICKNESS * lens * c], axis=-1)


def to_space(points):
    """Slope coordinates to x, y, z."""
    along, across, up = np.moveaxis(points, -1, 0)
    x, z = ground(along)
    return np.stack([x + up * np.sin(DIP), across, z + up * np.cos(DIP)], axis=-1)


def tetrahedra(number):
    """Five tetrahedra for each cell of a grid of node numbers, mirrored from cell to cell."""
    out = []
    for i, j, k in np.ndindex(*CELLS):
        cell = number[i : i + 2, j : j + 2, k : k + 2]
        cell = cell[:: -1 if i % 2 else 1, :: -1 if j % 2 else 1, :: -1 if k % 2 else 1]
        out += [[cell[tuple(corner)] for corner in tet] for tet in FIVE]
    return np.array(out)


def oriented(nodes, points):
    """Swap two nodes of each tetrahedron whose volume would be negative."""
    p = points[nodes]
    volume = np.linalg.det(p[:, 1:] - p[:, :1])
    nodes[volume < 0] = nodes[volume < 0][:, [0, 2, 1, 3]]
    return nodes, np.abs(volume) / 6


def ground_grid(body):
    """Grid lines of the bedrock's top, and where the body's bottom lies in it."""
    ahead = [0.0]
    behind = [*np.linspace(BODY_END, SLOPE_LENGTH, 5)[1:]]
    valley = [*np.linspace(SLOPE_LENGTH, SLOPE_LENGTH + VALLEY_LENGTH, 8)[1:]]
    left, right = SIDE_STRIPS[:2], SIDE_STRIPS[2:]
    along = np.array([*ahead, *np.linspace(BODY_BEGIN, BODY_END, CELLS[0] + 1), *behind, *valley])
    middle = np.linspace(-BODY_WIDTH / 2, BODY_WIDTH / 2, CELLS[1] + 1)
    across = np.array([*left, *middle, *right])
    grid = np.zeros((len(along), len(across), 3))
    grid[..., 0], grid[..., 1] = along[:, None], across[None, :]
    under = (slice(1, CELLS[0] + 2), slice(2, CELLS[1] + 3))
    grid[under] = body[:, :, 0]
    return grid, under


def bedrock(grid_numbers, under, body_triangles):
    """Triangles of the bedrock's top, seen from above counter-clockwise in (along, across)."""
    covered = np.zeros(np.array(grid_numbers.shape) - 1, bool)
    covered[under[0].start : under[0].stop - 1, under[1].start : under[1].stop - 1] = True
    triangles = list(body_triangles)
    for i, j in np.argwhere(~covered):
        a, b = grid_numbers[i, j], grid_numbers[i + 1, j]
        c, d = grid_numbers[i + 1, j + 1], grid_numbers[i, j + 1]
        triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    return np.array(triangles)


def build():
    """All points, the tetrahedra of the body and the wedges of the bedrock."""
    rng = np.random.default_rng(2014)
    body = body_points(rng)
    number = np.arange(body[..., 0].size).reshape(body.shape[:3])
    points = to_space(body).reshape(-1, 3)
    tets, volume = oriented(tetrahedra(number), points)
    assert volume.min() > 0.1 * volume.mean(), "sliver in the body"

    grid, under = ground_grid(body)
    top = np.full(grid.shape[:2], -1)
    top[under] = number[:, :, 0]
    new = top < 0
    top[new] = len(points) + np.arange(new.sum())
    points = np.concatenate([points, to_space(grid[new])])

    faces = np.sort(tets[:, [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]]].reshape(-1, 3), axis=1)
    bottom = faces[np.isin(faces, number[:, :, 0]).all(axis=1)]
    triangles = bedrock(top, under, bottom)
    p = points[triangles]
    facing_down = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])[:, 2] < 0
    triangles[facing_down] = triangles[facing_down][:, ::-1]

    used, renumbered = np.unique(triangles, return_inverse=True)
    renumbered = renumbered.reshape(triangles.shape)
    deep = points[used].copy()
    deep[:, 2] = FLOOR
    wedges = np.concatenate([len(points) + renumbered, used[renumbered]], axis=1)
    return np.concatenate([points, deep]), tets, wedges


def write_msh(points, tets, wedges):
    """Write gmsh's format 2.2, which nearly every program reads."""
    kinds = [(1, 6, wedges), (2, 4, tets)]  # group, gmsh's number of the shape, nodes
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]
    lines += ["$PhysicalNames", "2", '3 1 "bedrock"', '3 2 "body"', "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(points))]
    lines += [f"{n} {x:.3f} {y:.3f} {z:.3f}" for n, (x, y, z) in enumerate(points, start=1)]
    lines += ["$EndNodes", "$Elements", str(len(wedges) + len(tets))]
    for group, kind, nodes in kinds:
        for row in nodes + 1:
            lines.append(f"{len(lines)} {kind} 2 {group} {group} {' '.join(map(str, row))}")
    first = lines.index("$Elements") + 2
    for n, line in enumerate(lines[first:], start=1):
        lines[first + n - 1] = f"{n} {line.split(' ', 1)[1]}"
    OUTPUT.write_text("\n".join([*lines, "$EndElements"]) + "\n")


if __name__ == "__main__":
    points, tets, wedges = build()
    write_msh(points, tets, wedges)
    print(
        f"{OUTPUT}: {len(points)} points, {len(tets)} tetrahedra, {len(wedges)} wedges, "
        f"{OUTPUT.stat().st_size / 1e3:.0f} kB"
    )
