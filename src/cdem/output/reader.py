"""The files of a result folder read back: summary, histories, frames of surface and volume."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.element_shapes import NODES
from cdem.run.writers import VTK_TYPES

MESHIO_NAMES = {"tet4": "tetra", "pyramid5": "pyramid", "wedge6": "wedge", "hex8": "hexahedron"}


def read_summary(folder: Path) -> dict[str, Any]:
    """Content of summary.json.

    Raises:
        CdemError: The folder holds no finished or stopped run.
    """
    path = Path(folder) / "summary.json"
    try:
        return json.loads(path.read_text())
    except FileNotFoundError:
        if (Path(folder) / "checkpoint.h5").is_file():
            raise CdemError(
                f"{folder}: the run has not come to an end: it is still going, or was killed (then "
                "go on with cdem run --resume); its log is run.log, its last state checkpoint.h5"
            ) from None
        raise CdemError(f"{folder}: no summary.json; is this a result folder?") from None
    except json.JSONDecodeError as error:
        raise CdemError(f"{path}: not readable ({error})") from None


def read_histories(folder: Path) -> dict[str, NDArray[np.float64]]:
    """Columns of histories.csv by name."""
    path = Path(folder) / "histories.csv"
    if not path.is_file():
        raise CdemError(f"{folder}: no histories.csv; is this a result folder?")
    with path.open(newline="") as file:
        reader = csv.reader(file)
        names = next(reader)
        rows = [[float(v) for v in row] for row in reader if len(row) == len(names)]
    if not rows:
        raise CdemError(f"{path}: holds no rows yet")
    return dict(zip(names, np.array(rows).T, strict=True))


@dataclass
class Surface:
    """One frame of surface.vtkhdf.

    Attributes:
        time: [s].
        points: [m], shape (points, 3).
        faces: Connectivity with the number of vertices before each face, as pyvista wants it.
        point_data: By name.
        cell_data: By name.
        group_names: By the numbers of the field "group"; empty where the file does not tell.
    """

    time: float
    points: NDArray[np.float64]
    faces: NDArray[np.int64]
    point_data: dict[str, NDArray]
    cell_data: dict[str, NDArray]
    group_names: list[str]


def _open(path: Path) -> tuple[Any, NDArray[np.float64]]:
    """Root of a VTKHDF series and the times of its whole frames [s]."""
    import h5py

    if not path.is_file():
        raise CdemError(
            f"{path.parent}: no {path.name}, which holds the frames; was output.frames switched off?"
        )
    try:
        root = h5py.File(path, "r", locking=False)["VTKHDF"]
    except (OSError, KeyError) as error:
        raise CdemError(f"{path}: not readable ({error})") from None
    frames = int(root["Steps"].attrs["NSteps"])
    if frames == 0:
        raise CdemError(f"{path}: holds no frames yet")
    return root, root["Steps/Values"][:frames]


def _group_names(root: Any) -> list[str]:
    return [str(name) for name in root["CellData/group"].attrs.get("names", [])]


class SurfaceSeries:
    """Frames of surface.vtkhdf, read one at a time; those below 0 count from the end."""

    def __init__(self, folder: Path) -> None:
        self._root, self.times = _open(Path(folder) / "surface.vtkhdf")

    def __len__(self) -> int:
        return len(self.times)

    def __getitem__(self, frame: int) -> Surface:
        root, steps = self._root, self._root["Steps"]
        frame = range(len(self))[frame]
        points, cells, ids = (
            int(root[n][frame])
            for n in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds")
        )
        first_point = int(steps["PointOffsets"][frame])
        first_cell = int(steps["CellOffsets"][frame, 0])
        first_id = int(steps["ConnectivityIdOffsets"][frame, 0])
        offsets = root["Offsets"][first_cell + frame : first_cell + frame + cells + 1]
        connectivity = root["Connectivity"][first_id : first_id + ids]
        faces = np.insert(connectivity, offsets[:-1], np.diff(offsets))

        def fields(kind: str, count: int) -> dict[str, NDArray]:
            out = {}
            for name, data in root[kind].items():
                start = int(steps[f"{kind}Offsets/{name}"][frame])
                out[name] = data[start : start + count]
            return out

        return Surface(
            float(self.times[frame]),
            root["Points"][first_point : first_point + points],
            faces,
            fields("PointData", points),
            fields("CellData", cells),
            _group_names(root),
        )


class FrameSeries:
    """Frames of frames.vtkhdf: the whole volume, whose elements stay the same.

    Attributes:
        times: [s].
        cells: By shape, node ids (elements, nodes of the shape); fields list the shapes in this order.
        names: Fields that every frame has, by kind: "PointData", "CellData".
    """

    def __init__(self, folder: Path) -> None:
        self.path = Path(folder) / "frames.vtkhdf"
        self._root, self.times = _open(self.path)
        self._rows = {
            "PointData": int(self._root["NumberOfPoints"][0]),
            "CellData": len(self._root["Types"]),
        }
        self.names = {kind: list(self._root[kind]) for kind in self._rows}
        types, ids = self._root["Types"][:], self._root["Connectivity"][:]
        starts = self._root["Offsets"][:]
        self.cells: dict[str, NDArray[np.int64]] = {}
        for shape, nodes in NODES.items():
            some = np.flatnonzero(types == VTK_TYPES[shape])
            if len(some):
                self.cells[shape] = ids[starts[some][:, None] + np.arange(nodes)]

    def __len__(self) -> int:
        return len(self.times)

    @property
    def group_names(self) -> list[str]:
        """Names of the groups, by the numbers of the field "group"."""
        names = _group_names(self._root)
        if not names:
            raise CdemError(f"{self.path}: does not name its groups; run the case again")
        return names

    def points(self, frame: int) -> NDArray[np.float64]:
        """Positions of the nodes [m], shape (nodes, 3)."""
        return self._read("Points", int(self._root["Steps/PointOffsets"][frame]), "PointData")

    def field(self, kind: str, name: str, frame: int) -> NDArray:
        """A field on the nodes ("PointData") or elements ("CellData") of a frame."""
        start = int(self._root[f"Steps/{kind}Offsets/{name}"][frame])
        return self._read(f"{kind}/{name}", start, kind)

    def _read(self, name: str, start: int, kind: str) -> NDArray:
        return self._root[name][start : start + self._rows[kind]]


def export(folder: Path, *, to: str = "vtu") -> list[Path]:
    """Write every frame as a .vtu file, and a .pvd that lists them for ParaView."""
    import meshio

    if to != "vtu":
        raise CdemError(f"cannot export to {to!r}; choose vtu")
    folder = Path(folder)
    series = FrameSeries(folder)
    out = folder / "vtu"
    out.mkdir(exist_ok=True)
    cells = [(MESHIO_NAMES[shape], nodes) for shape, nodes in series.cells.items()]
    blocks = np.cumsum([len(nodes) for _, nodes in cells])[:-1]
    paths, entries = [], []
    for frame, time in enumerate(series.times):
        data = {
            kind: {name: series.field(kind, name, frame) for name in names}
            for kind, names in series.names.items()
        }
        mesh = meshio.Mesh(
            series.points(frame),
            cells,
            point_data=data["PointData"],
            cell_data={n: np.split(v, blocks) for n, v in data["CellData"].items()},
        )
        target = out / f"frame-{frame:04d}.vtu"
        meshio.write(target, mesh, binary=True, compression=None)
        entries.append(f'<DataSet timestep="{float(time)!r}" file="vtu/{target.name}"/>\n')
        paths.append(target)
    pvd = folder / "frames.pvd"
    pvd.write_text(
        '<VTKFile type="Collection" version="0.1">\n<Collection>\n'
        f"{''.join(entries)}</Collection>\n</VTKFile>\n"
    )
    return [*paths, pvd]
