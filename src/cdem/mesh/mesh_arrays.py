"""A mesh as named arrays, for transfer between processes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.mesh import Mesh


def to_arrays(mesh: Mesh) -> dict[str, NDArray]:
    """Points, cells, groups, surfaces and notes by name; names are arrays of texts."""
    arrays = {
        "points": mesh.points,
        "names": np.array(mesh.group_names, str),
        "surfaces": np.array(list(mesh.surfaces), str),
        "notes": np.array(mesh.notes, str),
    }
    arrays |= {f"cells {shape}": cells for shape, cells in mesh.cells.items()}
    arrays |= {f"group {shape}": groups for shape, groups in mesh.cell_group.items()}
    for number, parts in enumerate(mesh.surfaces.values()):
        arrays |= {f"surface {number} {k}": part for k, part in enumerate(parts)}
    return arrays


def from_arrays(arrays: dict[str, NDArray]) -> Mesh:
    """The mesh of these arrays from `to_arrays`."""

    def some(kind: str) -> dict[str, NDArray]:
        return {k.removeprefix(kind): a for k, a in arrays.items() if k.startswith(kind)}

    surfaces = {
        name: list(some(f"surface {number} ").values())
        for number, name in enumerate(arrays["surfaces"].tolist())
    }
    names, notes = arrays["names"].tolist(), arrays["notes"].tolist()
    return Mesh(arrays["points"], some("cells "), some("group "), names, surfaces, notes)
