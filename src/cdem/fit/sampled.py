"""The displacement of a run at any place and time, from its frames."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.output.meshes import volume_mesh
from cdem.output.reader import FrameSeries

Floats = NDArray[np.float64]


class Sampled:
    """Displacements of a run at some places.

    Displacements count from the last frame in which they are zero: the last reset, or the start.
    A place outside of the rock gets the displacement of the nearest point of an element.

    Args:
        folder: Result folder.
        at: Places before the motion [m], shape (places, 3); with nan as height for the surface.

    Attributes:
        times: Times of the frames since that frame [s].
        distance: Distance of each place from the rock [m]; nan for a place without rock below it.

    Raises:
        CdemError: The folder has no displacements, or pyvista is not installed.
    """

    def __init__(self, folder: Path, at: Floats) -> None:
        self._series = FrameSeries(folder)
        if "displacement" not in self._series.names["PointData"]:
            raise CdemError(f"{folder}: frames hold no displacement; add it to output.fields")
        self._first = self._start()
        self.times = self._series.times[self._first :] - self._series.times[self._first]
        mesh = volume_mesh(self._series, self._first)
        self.distance, self._nodes, self._weights = _found(mesh, _with_heights(mesh, at))

    def _start(self) -> int:
        """The last frame without displacements."""
        for frame in reversed(range(len(self._series))):
            if not self._series.field("PointData", "displacement", frame).any():
                return frame
        return 0

    def at(self, time: Floats) -> Floats:
        """Displacement of each place at its own time, linear between frames [m], shape (places, 3).

        Args:
            time: Time of each place since the start [s]; nan for the end; shape (places,).
        """
        when = np.where(np.isnan(time), self.times[-1], time)
        after = np.clip(np.searchsorted(self.times, when), 1, max(1, len(self.times) - 1))
        out = np.full((len(when), 3), np.nan)
        for frame in np.unique(after):
            here = after == frame
            last = self._displacement(min(frame, len(self.times) - 1), here)
            before = self._displacement(frame - 1, here)
            span = self.times[min(frame, len(self.times) - 1)] - self.times[frame - 1]
            share = ((when[here] - self.times[frame - 1]) / span if span > 0 else 1.0) * np.ones(
                here.sum()
            )
            out[here] = before + share[:, None] * (last - before)
        return out

    def _displacement(self, frame: int, rows: NDArray[np.bool_]) -> Floats:
        field = self._series.field("PointData", "displacement", self._first + frame)
        return np.einsum("pk,pkx->px", self._weights[rows], field[self._nodes[rows]])


def _with_heights(mesh: Any, at: Floats) -> Floats:
    """Places with the height of the surface where theirs is not known; nan where there is no rock."""
    from vtkmodules.vtkCommonCore import reference

    missing = np.flatnonzero(np.isnan(at[:, 2]))
    if not len(missing):
        return at
    out = at.copy()
    surface = mesh.extract_surface(algorithm=None)
    locator = _locator(surface)
    low, high = mesh.bounds[4] - 1.0, mesh.bounds[5] + 1.0
    for row in missing:
        x, y = at[row, :2]
        hit = [0.0] * 3
        found = locator.IntersectWithLine(
            (x, y, high), (x, y, low), 1e-9, reference(0.0), hit, [0.0] * 3, reference(0)
        )
        out[row, 2] = hit[2] if found else np.nan
    return out


def _locator(mesh: Any) -> Any:
    """A search tree over the cells of a mesh."""
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

    locator = vtkStaticCellLocator()
    locator.SetDataSet(mesh)
    locator.BuildLocator()
    return locator


def _found(mesh: Any, at: Floats) -> tuple[Floats, NDArray[np.int64], Floats]:
    """Distance of places from a mesh; nodes of the nearest element, shape (places, 8), and weights."""
    from vtkmodules.vtkCommonCore import reference

    distance, weights = np.full(len(at), np.nan), np.full((len(at), 8), np.nan)
    nodes = np.zeros((len(at), 8), np.int64)
    locator = _locator(mesh)
    for row in np.flatnonzero(np.isfinite(at).all(axis=1)):
        closest, number, squared = [0.0] * 3, reference(0), reference(0.0)
        locator.FindClosestPoint(at[row], closest, number, reference(0), squared)
        cell = mesh.GetCell(int(number))
        count = cell.GetNumberOfPoints()
        shares = [0.0] * count
        cell.EvaluatePosition(closest, [0.0] * 3, reference(0), [0.0] * 3, reference(0.0), shares)
        distance[row] = float(squared) ** 0.5  # type: ignore[arg-type]
        nodes[row, :count] = [cell.GetPointId(k) for k in range(count)]
        weights[row] = 0.0
        weights[row, :count] = shares
    return distance, nodes, weights
