"""Cuts through the volume of a run by a plane: faces with the fields of the elements that they cut."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.output.meshes import volume_mesh
from cdem.output.reader import FrameSeries, Surface

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Plane:
    """A cutting plane, seen from its front.

    Attributes:
        text: The user's text.
        place: A point of it [m].
        back: Unit normal, towards the viewer.
        ends: Ends of an upright plane in plan [m], shape (2, 3); None for an infinite plane.
    """

    text: str
    place: Floats
    back: Floats
    ends: Floats | None = None

    @classmethod
    def parse(cls, text: str) -> Plane:
        """The plane x=VALUE, y=VALUE or z=VALUE, or the upright one over the line X0,Y0,X1,Y1.

        The eye is south of y=VALUE, east of x=VALUE and above z=VALUE; X0,Y0 is at its left.

        Raises:
            CdemError: The text is neither.
        """
        try:
            found = re.fullmatch(r"\s*([xyz])\s*=\s*(\S+)\s*", text)
            if found:
                axis = "xyz".index(found[1])
                back = np.eye(3)[axis] * (-1 if axis == 1 else 1)
                return cls(text, np.eye(3)[axis] * float(found[2]), back)
            x0, y0, x1, y1 = (float(word) for word in text.split(","))
        except ValueError:
            raise CdemError(
                f"--slice {text}: give a plane as x=VALUE, y=VALUE or z=VALUE, or an upright one as "
                "X0,Y0,X1,Y1 [m]"
            ) from None
        ends = np.array([[x0, y0, 0.0], [x1, y1, 0.0]])
        along = ends[1] - ends[0]
        if not np.linalg.norm(along) > 0:
            raise CdemError(f"--slice {text}: the two points of the line are equal")
        back = np.cross(along / np.linalg.norm(along), [0.0, 0.0, 1.0])
        return cls(text, ends[0], back, ends)


class Cuts:
    """Frames of a run, cut by a plane, one at a time."""

    def __init__(self, volumes: FrameSeries, plane: Plane) -> None:
        self.volumes, self.plane = volumes, plane

    def __len__(self) -> int:
        return len(self.volumes)

    def __getitem__(self, frame: int) -> Surface:
        """The cut of a frame, without absent blocks.

        Raises:
            CdemError: The plane misses the model.
        """
        whole = volume_mesh(self.volumes, frame)
        there = whole
        if "out" in whole.cell_data:
            there = whole.extract_cells(np.flatnonzero(whole.cell_data["out"] == 0))
        cut = there.slice(normal=self.plane.back, origin=self.plane.place)
        if self.plane.ends is not None and cut.n_cells:
            along = self.plane.ends[1] - self.plane.ends[0]
            for end, way in zip(self.plane.ends, (-along, along), strict=True):
                cut = cut.clip(normal=way, origin=end)
        if cut.n_cells == 0:
            ends = zip("xyz", whole.points.min(axis=0), whole.points.max(axis=0), strict=True)
            box = ", ".join(f"{axis} from {low:.4g} to {high:.4g}" for axis, low, high in ends)
            raise CdemError(f"--slice {self.plane.text}: misses the model, which has {box} m")
        points, polygons = np.asarray(cut.points, float), _polygons(cut)
        time, data = float(self.volumes.times[frame]), (dict(cut.point_data), dict(cut.cell_data))
        return Surface(time, points, polygons, *data, self.volumes.group_names)


def _polygons(mesh: Any) -> NDArray[np.int64]:
    """Point ids of the faces of a mesh, with -1 last in faces with fewer corners."""
    from pyvista import convert_array

    cells = mesh.GetPolys()
    corners = np.diff(convert_array(cells.GetOffsetsArray()))
    polygons = np.full((len(corners), corners.max()), -1, np.int64)
    inside = np.arange(corners.max()) < corners[:, None]
    polygons[inside] = convert_array(cells.GetConnectivityArray())
    return polygons


def outlines(surface: Surface) -> NDArray[np.int64]:
    """Edges of a cut at its rim and between blocks, as point ids, shape (edges, 2)."""
    polygons, block = surface.polygons, surface.cell_data["block"]
    following = np.roll(polygons, -1, axis=1)
    last = (polygons >= 0).sum(axis=1) - 1
    following[np.arange(len(polygons)), last] = polygons[:, 0]
    real = polygons >= 0
    edges = np.sort(np.stack([polygons[real], following[real]], axis=1), axis=1)
    owner = np.broadcast_to(block[:, None], polygons.shape)[real]
    unique, of = np.unique(edges, axis=0, return_inverse=True)
    of = of.ravel()
    low = np.full(len(unique), np.iinfo(np.int64).max)
    high = np.full(len(unique), -1, np.int64)
    np.minimum.at(low, of, owner)
    np.maximum.at(high, of, owner)
    return unique[(low < high) | (np.bincount(of) == 1)]
