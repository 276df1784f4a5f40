"""Volume cells of VTK files, read in a process of its own: VTK may die of a damaged file.

Run as ``python -m cdem.model.vtk_cells FILE OUT.npz``; an error is one line on stderr and status 1.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import reading, refuse_entities
from cdem.errors import MeshError
from cdem.mesh.mesh_files import MEND

SECONDS, BYTES_PER_SECOND = 20.0, 100_000
"""Time that the process may take [s], and bytes for which it may take a second more [1/s]."""


def cells(path: Path) -> Iterator[tuple[str, NDArray[np.float64], list[list[int]]]]:
    """Every volume cell of a file: what to call it, the points of the file [m], its faces.

    Raises:
        MeshError: The file cannot be read, or pyvista is missing.
    """
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "cells.npz"
        command = [sys.executable, "-m", __name__, str(path), str(out)]
        try:
            ended = subprocess.run(
                command,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=SECONDS + path.stat().st_size / BYTES_PER_SECOND,
            )
        except subprocess.TimeoutExpired:
            raise MeshError(f"{path}: reading it does not come to an end; {MEND}") from None
        if ended.returncode == 1 and ended.stderr.strip():
            raise MeshError(ended.stderr.strip().splitlines()[-1])
        if ended.returncode or not out.is_file():
            raise MeshError(f"{path}: VTK died of it (status {ended.returncode}); {MEND}")
        with np.load(out) as read:
            points, sizes, corners, faces, numbers = (read[name] for name in read.files)
    wrong = (corners < 0) | (corners >= len(points))
    if (faces < 4).any() or (sizes < 3).any() or wrong.any():
        raise MeshError(f"{path}: a cell has less than four faces, or corners that are not there")
    loops = [loop.tolist() for loop in np.split(corners, np.cumsum(sizes)[:-1])]
    ends = np.cumsum(faces)
    for number, first, end in zip(numbers, ends - faces, ends, strict=True):
        yield f"cell {number}", points, loops[first:end]


def _main(path: Path, out: Path) -> None:
    try:
        import pyvista
    except ImportError:
        raise MeshError(f"{path}: reading this needs pyvista; pip install 'cdem[viz]'") from None
    sizes, corners, faces, numbers = [], [], [], []
    with reading(path, MeshError, MEND):
        refuse_entities(path)
        grid = pyvista.read(path)
        if not isinstance(grid, pyvista.UnstructuredGrid):
            raise MeshError(f"{path}: holds no volume cells, but {type(grid).__name__}")
        for number in range(grid.n_cells):
            cell = grid.get_cell(number)
            if cell.dimension == 3:
                loops = [list(face.point_ids) for face in cell.faces]
                numbers.append(number)
                faces.append(len(loops))
                sizes += [len(loop) for loop in loops]
                corners += [v for loop in loops for v in loop]
        points = np.asarray(grid.points, float)
    whole = (np.array(part, np.int64) for part in (sizes, corners, faces, numbers))
    np.savez(out, points, *whole)


if __name__ == "__main__":
    try:
        _main(Path(sys.argv[1]), Path(sys.argv[2]))
    except MeshError as error:
        sys.exit(" ".join(str(error).split()))
