"""Volume cells of VTK files, polyhedra too; read aside, see `cdem.case.aside`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case import aside
from cdem.case.input_file import refuse_entities
from cdem.errors import MeshError
from cdem.mesh.mesh_files import MEND


def cells(path: Path) -> Iterator[tuple[str, NDArray[np.float64], list[list[int]]]]:
    """Every volume cell of a file: what to call it, the points of the file [m], its faces.

    Raises:
        MeshError: The file cannot be read, or pyvista is missing.
    """
    read = aside.read("cdem.model.vtk_cells", path, MEND)
    points, sizes, corners = read["points"], read["sizes"], read["corners"]
    wrong = (corners < 0) | (corners >= len(points))
    if (read["faces"] < 4).any() or (sizes < 3).any() or wrong.any():
        raise MeshError(f"{path}: a cell has less than four faces, or corners that are not there")
    loops = [loop.tolist() for loop in np.split(corners, np.cumsum(sizes)[:-1])]
    ends = np.cumsum(read["faces"])
    for number, first, end in zip(read["numbers"], ends - read["faces"], ends, strict=True):
        yield f"cell {number}", points, loops[first:end]


def _cells(path: Path) -> aside.Arrays:
    import pyvista

    refuse_entities(path)
    grid = pyvista.read(path)
    if not isinstance(grid, pyvista.UnstructuredGrid):
        raise MeshError(f"{path}: holds no volume cells, but {type(grid).__name__}")
    sizes, corners, faces, numbers = [], [], [], []
    for number in range(grid.n_cells):
        cell = grid.get_cell(number)
        if cell.dimension == 3:
            loops = [list(face.point_ids) for face in cell.faces]
            numbers.append(number)
            faces.append(len(loops))
            sizes += [len(loop) for loop in loops]
            corners += [v for loop in loops for v in loop]
    whole = {"sizes": sizes, "corners": corners, "faces": faces, "numbers": numbers}
    return {"points": np.asarray(grid.points, float)} | {
        name: np.array(part, np.int64) for name, part in whole.items()
    }


if __name__ == "__main__":
    try:
        import pyvista  # noqa: F401  # loading it takes more memory and time than reading may
    except ImportError:
        raise SystemExit("bodies in VTK files need pyvista; pip install 'cdem[viz]'") from None
    aside.answer(lambda path, _: _cells(path), MEND)
