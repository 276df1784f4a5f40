"""Frames as meshes of pyvista."""

from __future__ import annotations

from typing import Any

import numpy as np

from cdem.errors import CdemError
from cdem.mesh.element_shapes import NODES
from cdem.output.reader import FrameSeries, Surface
from cdem.run.frame_files import VTK_TYPES


def surface_mesh(surface: Surface) -> Any:
    """A surface with its fields, a PolyData."""
    mesh = _pyvista().PolyData(surface.points, faces=surface.faces)
    mesh.point_data.update(surface.point_data)
    mesh.cell_data.update(surface.cell_data)
    return _told(mesh, surface.time, surface.group_names)


def volume_mesh(series: FrameSeries, frame: int) -> Any:
    """All elements of a frame with all their fields, an UnstructuredGrid; frames count from 0."""
    cells = [np.column_stack([np.full(len(ids), NODES[shape]), ids]).ravel()
             for shape, ids in series.cells.items()]  # fmt: skip
    types = [np.full(len(ids), VTK_TYPES[shape]) for shape, ids in series.cells.items()]
    mesh = _pyvista().UnstructuredGrid(
        np.concatenate(cells), np.concatenate(types).astype(np.uint8), series.points(frame)
    )
    for kind, data in (("PointData", mesh.point_data), ("CellData", mesh.cell_data)):
        for name in series.names[kind]:
            data[name] = series.field(kind, name, frame)
    return _told(mesh, float(series.times[frame]), series.group_names)


def _pyvista() -> Any:
    try:
        import pyvista
    except ImportError:
        raise CdemError("meshes need pyvista; pip install 'cdem[viz]'") from None
    return pyvista


def _told(mesh: Any, time: float, group_names: list[str]) -> Any:
    """A mesh with its time and the names of its groups."""
    mesh.field_data["time"] = [time]
    mesh.field_data["group_names"] = group_names
    return mesh
