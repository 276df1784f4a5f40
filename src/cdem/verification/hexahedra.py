"""Meshes of hexahedra with named faces for problems of waves, and records of their nodes."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import ArrayLike

from cdem.run.simulation import Simulation
from cdem.verification.runner import Study


def simulate(
    study: Study,
    points: np.ndarray,
    cells: Mapping[str, np.ndarray],
    faces: Mapping[str, np.ndarray],
    *settings: str,
) -> Simulation:
    """A simulation of the problem's case with a mesh, see `write`; settings as for `Study.simulate`."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.msh"
        write(path, points, cells, faces)
        return study.simulate(f"model.mesh={path}", *settings)


def write(
    path: Path, points: np.ndarray, cells: Mapping[str, np.ndarray], faces: Mapping[str, np.ndarray]
) -> None:
    """Write a mesh of gmsh.

    Args:
        path: The file.
        points: Positions [m], shape (points, 3).
        cells: Hexahedra of each group, shape (cells, 8).
        faces: Quadrilaterals of each named surface, shape (faces, 4).
    """
    rows = [*(("hexahedron", c) for c in cells.values()), *(("quad", f) for f in faces.values())]
    tags = [np.full(len(numbers), 1 + tag) for tag, (_, numbers) in enumerate(rows)]
    dimensions = [3] * len(cells) + [2] * len(faces)
    names = zip([*cells, *faces], dimensions, strict=True)
    mesh = meshio.Mesh(
        points, rows, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array([1 + tag, dim]) for tag, (name, dim) in enumerate(names)},
    )  # fmt: skip
    meshio.write(path, mesh, "gmsh22", binary=True)


def extruded(
    plane: np.ndarray, quads: np.ndarray, thickness: float
) -> tuple[np.ndarray, np.ndarray]:
    """Points and hexahedra of one layer of a plane mesh.

    Args:
        plane: Positions in the plane [m], shape (points, 2).
        quads: Counter-clockwise quadrilaterals, shape (cells, 4).
        thickness: Of the layer [m].
    """
    points = np.concatenate(
        [np.column_stack([plane, np.full(len(plane), z)]) for z in (0, thickness)]
    )
    return points, np.hstack([quads, quads + len(plane)])


def walls(sides: np.ndarray, count: int) -> np.ndarray:
    """Faces of the layer over sides of its quadrilaterals.

    Args:
        sides: Pairs of points, shape (sides, 2).
        count: Points in the plane.
    """
    a, b = sides.T
    return np.column_stack([a, b, b + count, a + count])


def outer_sides(quads: np.ndarray) -> np.ndarray:
    """Sides of quadrilaterals that only one of them has, shape (sides, 2)."""
    sides = np.concatenate([quads[:, [k, (k + 1) % 4]] for k in range(4)])
    _, first, count = np.unique(
        np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True
    )
    return sides[first[count == 1]]


def record(
    simulation: Simulation, nodes: np.ndarray, until: float, every: int = 1
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Step to a time; times [s], displacements [m] and velocities [m/s] of nodes.

    Returns:
        Times, shape (rows,); displacements and velocities, shape (rows, nodes, 3). Velocities belong
        to half a step earlier.
    """
    times, displacements, velocities = [], [], []
    while simulation.time < until:
        simulation.step(every)
        times.append(simulation.time)
        displacements.append(simulation.fields["displacement"][nodes])
        velocities.append(simulation.fields["velocity"][nodes])
    return np.array(times), np.array(displacements), np.array(velocities)


def nearest(simulation: Simulation, places: ArrayLike) -> np.ndarray:
    """Nodes nearest to places [m], shape (places,)."""
    at = simulation.build.start_position
    return np.array([np.abs(at - place).sum(axis=1).argmin() for place in np.asarray(places)])
