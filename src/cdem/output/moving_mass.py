"""The moving elements of a run, frame by frame: their pieces, and flow through sections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case.reader import load_case_data
from cdem.errors import CdemError
from cdem.mesh.element_volumes import Solids
from cdem.output.reader import FrameSeries

Floats = NDArray[np.float64]

STILL = 1e-6
"""Rock counts as unmoved below this displacement, relative to its size."""
MOVING = 0.1
"""Moving groups moved at least this fraction of the farthest group's displacement."""
SECTION = {"time": "s", "area": "m2", "velocity": "m/s", "discharge": "m3/s", "passed": "m3"}
FRAGMENT = {
    "piece": "1", "elements": "1", "volume": "m3", "mass": "kg", "diameter": "m", "x": "m",
    "y": "m", "z": "m", "attached": "1", "share_of_smaller": "1",
}  # fmt: skip


class Body:
    """The moving elements of a run, frame by frame.

    Attributes:
        folder: The result folder.
        frames: From the last reset of displacements to the end.
        start: The elements at the start.
        mass: Mass of each element [kg].
        gravity: Magnitude of gravity [m/s2].
        crs: Projection of the coordinates as given in the case, or None.
    """

    def __init__(self, folder: Path, groups: Sequence[str] | None) -> None:
        self.folder = folder
        self.series = FrameSeries(folder)
        self.frames = range(self._first(), len(self.series))
        if len(self.frames) < 2:
            raise CdemError(
                f"{self.series.folder}: has no frame after the start at "
                f"{self.series.times[self.frames[0]]:.6g} s; run-out needs a later one"
            )
        names = self.series.group_names
        self.group = self.series.field("CellData", "group", 0)
        self.groups = self._moving(names) if groups is None else list(dict.fromkeys(groups))
        for name in self.groups:
            if name not in names:
                raise CdemError(f"{folder}: no group {name!r}; it has: {', '.join(names)}")
        self.chosen = np.isin(self.group, [names.index(name) for name in self.groups])
        self.cells = self._cells(self.chosen)
        self.nodes = np.unique(np.concatenate([c.ravel() for c in self.cells.values()]))
        case, _ = load_case_data(folder / "case.yaml")  # as data: its own laws may be missing
        densities = [
            case["materials"][case["groups"][name]["material"]]["density"] for name in names
        ]
        self.density = np.array(densities)[self.group[self.chosen]]
        self.gravity = float(np.linalg.norm([float(g) for g in case["loads"]["gravity"]]))
        self.crs: str | None = case.get("crs")
        self.start = self.solids(self.frames[0])
        self.mass = self.density * self.solids(0).volumes()  # the mesh is undeformed

    def _cells(self, chosen: NDArray[np.bool_]) -> dict[str, NDArray[np.int64]]:
        """Nodes of chosen elements by shape."""
        first, cells = 0, {}
        for shape, nodes in self.series.cells.items():
            some = nodes[chosen[first : first + len(nodes)]]
            first += len(nodes)
            if len(some):
                cells[shape] = some
        return cells

    def _first(self) -> int:
        """Last frame without displacements: settling before a reset does not count as run-out."""
        if "displacement" in self.series.names["PointData"]:
            for frame in reversed(range(len(self.series))):
                if not self.series.field("PointData", "displacement", frame).any():
                    return frame
        return 0

    def _moving(self, names: list[str]) -> list[str]:
        """Groups with a mean displacement of at least a tenth of the farthest group's."""
        start = self.series.points(self.frames[0])
        moved = self.series.points(self.frames[-1]) - start
        elements = np.concatenate(
            [moved[nodes].mean(axis=1) for nodes in self.series.cells.values()]
        )
        count = np.bincount(self.group, minlength=len(names))
        way = [np.bincount(self.group, e, len(names)) / np.maximum(count, 1) for e in elements.T]
        distance = np.linalg.norm(way, axis=0)
        if distance.max() <= STILL * np.ptp(start, axis=0).max():
            raise CdemError(f"{self.series.folder}: nothing has moved; name the groups to measure")
        return [n for n, d in zip(names, distance, strict=True) if d >= MOVING * distance.max()]

    def solids(self, frame: int) -> Solids:
        return Solids.of(self.series.points(frame), self.cells)

    def velocities(self, frame: int) -> Floats:
        """Mean velocity of each element's nodes [m/s]; not a number if it was not recorded."""
        return self._means("velocity", frame)

    def displacements(self, frame: int) -> Floats:
        """Mean displacement of each element's nodes since the last reset [m]; see `velocities`."""
        return self._means("displacement", frame)

    def _means(self, name: str, frame: int) -> Floats:
        if name not in self.series.names["PointData"]:
            return np.full((len(self.mass), 3), np.nan)
        nodal = self.series.field("PointData", name, frame)
        return np.concatenate([nodal[nodes].mean(axis=1) for nodes in self.cells.values()])

    def ground(self, x: Floats, y: Floats) -> Floats:
        """Height of unmoved rock at the end, at the points of a grid: see `Solids.tops` [m]."""
        last = self.frames[-1]
        others = ~self.chosen
        if "out" in self.series.names["CellData"]:
            others &= self.series.field("CellData", "out", last) == 0
        if not others.any():
            return np.full((len(y), len(x)), np.nan)
        return Solids.of(self.series.points(last), self._cells(others)).tops(x, y)

    def stays(self, frame: int) -> NDArray[np.bool_]:
        """Elements still inside the domain of the case.

        Raises:
            CdemError: All elements have left.
        """
        if "out" not in self.series.names["CellData"]:
            return np.ones(len(self.mass), bool)
        stays = self.series.field("CellData", "out", frame)[self.chosen] == 0
        if not stays.any():
            raise CdemError(
                f"{self.series.folder}: all of {', '.join(self.groups)} has left model.domain at t = "
                f"{self.series.times[frame]:.6g} s, so no run-out can be measured; enlarge "
                f"model.domain"
            )
        return stays

    def pieces(self, frame: int, volume: Floats, stays: NDArray[np.bool_]) -> Pieces | None:
        """Connected pieces of the remaining elements, or None if they were not recorded.

        Args:
            frame: Number of the frame.
            volume: Volume of these elements [m3].
            stays: Mask of the remaining elements among the moving ones.
        """
        if "piece" not in self.series.names["CellData"]:
            return None
        piece = self.series.field("CellData", "piece", frame)
        others = np.unique(piece[~self.chosen])
        ids, member = np.unique(piece[self.chosen][stays], return_inverse=True)
        return Pieces(ids, member, np.bincount(member, volume).astype(float), np.isin(ids, others))


@dataclass
class Pieces:
    """Connected pieces: number, piece of each element, volume [m3], whether attached to other groups."""

    ids: NDArray[np.int32]
    member: NDArray[np.intp]
    volume: Floats
    attached: NDArray[np.bool_]

    def row(self) -> tuple[float, float, float]:
        """Number of pieces, and the volume fractions of the largest and of attached ones."""
        whole = self.volume.sum()
        return (
            float(len(self.ids)),
            float(self.volume.max() / whole),
            float(self.volume[self.attached].sum() / whole),
        )

    def table(self, mass: Floats, centroid: Floats) -> dict[str, NDArray]:
        """Columns `FRAGMENT`, largest first."""
        count = len(self.ids)
        heavy = np.bincount(self.member, mass, count)
        places = [np.bincount(self.member, mass * c, count) / heavy for c in centroid.T]
        order = np.argsort(-self.volume, kind="stable")
        volume = self.volume[order]
        below = np.cumsum(volume[::-1])[::-1] - volume
        columns: dict[str, NDArray] = {
            "piece": self.ids, "elements": np.bincount(self.member, minlength=count),
            "volume": self.volume, "mass": heavy, "diameter": np.cbrt(6 * self.volume / np.pi),
            **dict(zip("xyz", places, strict=True)), "attached": self.attached.astype(int),
        }  # fmt: skip
        return {n: v[order] for n, v in columns.items()} | {
            "share_of_smaller": below / volume.sum()
        }


@dataclass
class Section:
    """Flow of rock through an upright section over a line in plan; positive forwards.

    Attributes:
        line: x and y of its ends [m].
        history: Columns `SECTION`, one value for each frame.
    """

    line: tuple[float, ...]
    history: dict[str, Floats]


class Line:
    """Records the rock through one section.

    Args:
        line: x0, y0, x1, y1 [m].
        forward: Direction of motion in plan, shape (2,).
        start: The elements at the start; the section counts their initial volumes.
    """

    def __init__(self, line: Sequence[float], forward: Floats, start: Solids) -> None:
        self.line = tuple(float(v) for v in line)
        if len(self.line) != 4 or not np.isfinite(self.line).all():
            raise CdemError(f"a section needs x0, y0, x1, y1, got {list(line)}")
        self.begin, end = np.reshape(self.line, (2, 2))
        self.length = float(np.linalg.norm(end - self.begin))
        if self.length == 0:
            raise CdemError(f"a section needs two different ends, got {list(line)}")
        self.along = (end - self.begin) / self.length
        normal = np.array([self.along[1], -self.along[0]])
        self.normal = normal if normal @ forward >= 0 else -normal
        self.volume = start.volumes()
        self.share = start.shares_ahead(self.begin, self.normal)
        self.passed = 0.0
        self.rows: list[list[float]] = []

    def follow(
        self,
        time: float,
        solids: Solids,
        stays: NDArray[np.bool_],
        velocity: Floats,
        before: Floats,
        now: Floats,
    ) -> None:
        """Add a frame: its time [s], elements, mask of elements still inside the domain, their
        velocities, and old and new centroids."""
        area = stays * solids.cut_areas(self.begin, self.along, self.length)
        discharge = float(area @ (velocity[:, :2] @ self.normal))
        share = solids.shares_ahead(self.begin, self.normal)
        last, here = ((c[:, :2] - self.begin) @ self.normal for c in (before, now))
        # point of the centroid's straight path since the last frame nearest to the line
        t = np.clip(last / np.where(last == here, 1.0, last - here), 0.0, 1.0)[:, None]
        r = ((before + t * (now - before))[:, :2] - self.begin) @ self.along
        within = (r >= 0) & (r <= self.length)
        self.passed += float((self.volume * (share - self.share))[within].sum())
        self.share = share
        whole = float(area.sum())
        speed = discharge / whole if whole > 0 else np.nan
        self.rows.append([time, whole, speed, discharge, self.passed])

    def section(self) -> Section:
        """The histories so far."""
        return Section(self.line, dict(zip(SECTION, np.array(self.rows).T, strict=True)))
