"""Volume cells of VTK files, also polyhedra; read in a process of its own, see `cdem.case.reader_process`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case import reader_process
from cdem.case.input_file import refuse_entities
from cdem.errors import MeshError
from cdem.mesh.mesh_files import MEND, cell_groups


def cells(path: Path) -> Iterator[tuple[str, NDArray[np.float64], list[list[int]], str]]:
    """Every volume cell: its name, the points of the file, its faces, its material.

    The material is empty in a file with one material, else e.g. `material2`, from its cell data.

    Raises:
        MeshError: The file cannot be read, or pyvista is missing.
    """
    read = reader_process.read("cdem.model.vtk_cells", path, MEND)
    points, sizes, corners = read["points"], read["sizes"], read["corners"]
    wrong = (corners < 0) | (corners >= len(points))
    if (read["faces"] < 4).any() or (sizes < 3).any() or wrong.any():
        raise MeshError(f"{path}: a cell has less than four faces, or missing corners")
    loops = [loop.tolist() for loop in np.split(corners, np.cumsum(sizes)[:-1])]
    ends = np.cumsum(read["faces"])
    rows = zip(read["numbers"], ends - read["faces"], ends, read["kinds"].tolist(), strict=True)
    for number, first, end, kind in rows:
        yield f"cell {number}", points, loops[first:end], kind


def _cells(path: Path) -> reader_process.Arrays:
    import pyvista

    refuse_entities(path)
    grid = pyvista.read(path)
    if not isinstance(grid, pyvista.UnstructuredGrid):
        raise MeshError(f"{path}: contains no volume cells, but {type(grid).__name__}")
    sizes, corners, faces, numbers = [], [], [], []
    for number in range(grid.n_cells):
        cell = grid.get_cell(number)
        if cell.dimension == 3:
            loops = [list(face.point_ids) for face in cell.faces]
            if cell.type == pyvista.CellType.VOXEL:  # its faces number corners row by row
                loops = [[a, b, d, c] for a, b, c, d in loops]
            numbers.append(number)
            faces.append(len(loops))
            sizes += [len(loop) for loop in loops]
            corners += [v for loop in loops for v in loop]
    kinds = cell_groups({name: np.asarray(grid.cell_data[name]) for name in grid.cell_data})
    of_cell = np.full(len(numbers), "") if kinds is None else kinds[numbers].astype(str)
    if len(set(of_cell.tolist())) < 2:
        of_cell = np.full(len(numbers), "")
    whole = {"sizes": sizes, "corners": corners, "faces": faces, "numbers": numbers}
    return {"points": np.asarray(grid.points, float), "kinds": of_cell} | {
        name: np.array(part, np.int64) for name, part in whole.items()
    }


if __name__ == "__main__":
    try:
        import pyvista  # noqa: F401  # loading it takes more memory and time than reading is allowed
    except ImportError:
        raise SystemExit("bodies in VTK files need pyvista; pip install 'cdem[viz]'") from None
    reader_process.answer(lambda path, _: _cells(path), MEND)
