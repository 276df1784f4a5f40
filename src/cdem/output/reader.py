"""Reads the files of a result folder: summary, histories, frames of surface and volume."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.element_shapes import NODES
from cdem.mesh.hdf5_links import refuse_links
from cdem.run.checkpoint import has_checkpoint
from cdem.run.frame_files import (
    ELEMENTS,
    KINDS,
    VTK_TYPES,
    frame_numbers,
    frame_path,
    names_of_groups,
)
from cdem.whole_files import refuse_link

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
        if has_checkpoint(Path(folder)):
            raise CdemError(
                f"{folder}: the run has not ended: it is in progress, or was killed (then continue "
                f"it "
                "with cdem run --resume); its log is run.log, its last state checkpoint.h5"
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
        raise CdemError(f"{path}: contains no rows yet")
    return dict(zip(names, np.array(rows).T, strict=True))


@dataclass
class Surface:
    """One frame of the surface.

    Attributes:
        time: [s].
        points: [m], shape (points, 3).
        polygons: Point ids, shape (faces, corners), with -1 last in faces with fewer: (faces, 4)
            for
            a surface, up to (faces, 6) for a cut through it.
        point_data: By name.
        cell_data: By name.
        group_names: Names by number of the field "group"; empty if the file lacks them.
        bolts: Ends of the bars of bolts, shape (bars, 2, 3) [m].
        bolt_forces: Axial force of each bar, tension positive [N].
    """

    time: float
    points: NDArray[np.float64]
    polygons: NDArray[np.int64]
    point_data: dict[str, NDArray]
    cell_data: dict[str, NDArray]
    group_names: list[str]
    bolts: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2, 3)))
    bolt_forces: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))

    @property
    def faces(self) -> NDArray[np.int64]:
        """Point ids with the number of vertices before each face, in the format of pyvista."""
        corners = (self.polygons >= 0).sum(axis=1)
        faces = np.column_stack([corners, self.polygons])
        return faces[faces >= 0]


class _Frames:
    """Frames of a series by index: the files of its folder, opened one at a time.

    Args:
        folder: The folder.
        numbers: Numbers of the frames; None for all.

    Attributes:
        times: [s].
    """

    def __init__(self, folder: Path, numbers: Sequence[int] | None = None) -> None:
        self.folder = folder
        refuse_link(folder)
        self._checked: set[Path] = set()
        numbers = frame_numbers(folder) if numbers is None else numbers
        self._paths = [frame_path(folder, number) for number in numbers]
        if not self._paths:
            raise CdemError(
                f"{folder}: contains no frames; was output.frames switched off, or has the run "
                f"only begun?"
            )
        self.times = np.array(
            [self.read(k, ["FieldData/TimeValue"])[0][0] for k in range(len(self))]
        )

    def __len__(self) -> int:
        return len(self._paths)

    def read(self, frame: int, names: Sequence[str]) -> list[NDArray]:
        """Datasets of a frame."""
        with self._root(frame) as root:
            return [root[name][()] for name in names]

    @contextmanager
    def _root(self, frame: int) -> Iterator[Any]:
        """The group VTKHDF of a frame.

        Raises:
            CdemError: The file is damaged.
        """
        import h5py

        path = self._paths[frame]
        try:
            with h5py.File(path, "r", locking=False) as hdf5:
                self._check(path, hdf5)
                yield hdf5["VTKHDF"]
        except (OSError, KeyError, RuntimeError, ValueError, IndexError) as error:
            raise CdemError(
                f"{path}: is damaged ({error}); move it away to read the other frames"
            ) from None

    def _check(self, path: Path, hdf5: Any) -> None:
        """Refuse a file with links to files other than the elements' file; checked once per file."""
        import h5py

        if path in self._checked:
            return
        refuse_link(path)
        refuse_links(hdf5, path, ELEMENTS, CdemError)
        elements = path.with_name(ELEMENTS)
        if elements.is_file() and elements not in self._checked:
            refuse_link(elements)
            with h5py.File(elements, "r", locking=False) as other:
                refuse_links(other, elements, kind=CdemError)
        self._checked |= {path, elements}


class SurfaceSeries(_Frames):
    """Frames of the surface, read one at a time; negative numbers count from the end."""

    def __init__(self, folder: Path) -> None:
        bolts, surface = Path(folder) / "bolts", Path(folder) / "surface"
        known = set(frame_numbers(bolts))  # a run writes them after the surface
        numbers = [n for n in frame_numbers(surface) if n in known or not bolts.is_dir()]
        super().__init__(surface, numbers)
        self._bolts = _Frames(bolts, numbers) if known else None

    @property
    def has_bolts(self) -> bool:
        """Whether the case has bolts; some may not be installed yet."""
        return self._bolts is not None

    def _bars(self, frame: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Ends of the bars of bolts [m], shape (bars, 2, 3), and their axial forces [N]."""
        if self._bolts is None:
            return np.zeros((0, 2, 3)), np.zeros(0)
        names = ["Points", "Connectivity", "CellData/axial_force"]
        points, ends, forces = self._bolts.read(frame, names)
        return points[ends].reshape(-1, 2, 3), forces

    def __getitem__(self, frame: int) -> Surface:
        frame = range(len(self))[frame]
        with self._root(frame) as root:
            corners, connectivity = np.diff(root["Offsets"][()]), root["Connectivity"][()]
            polygons = np.full((len(corners), 4), -1)
            polygons[np.arange(4) < corners[:, None]] = connectivity
            return Surface(
                float(self.times[frame]),
                root["Points"][()],
                polygons,
                {name: data[()] for name, data in root["PointData"].items()},
                {name: data[()] for name, data in root["CellData"].items()},
                names_of_groups(root),
                *self._bars(frame),
            )


class FrameSeries(_Frames):
    """Frames of the whole volume, with constant elements.

    Attributes:
        times: [s].
        cells: Node ids by shape (elements, nodes of the shape); fields list the shapes in this
            order.
        names: Fields in every frame, by kind: "PointData", "CellData".
        group_names: Names by number of the field "group".
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(Path(folder) / "frames")
        with self._root(0) as root:
            self.names = {kind: list(root[kind]) for kind in KINDS}
            self.group_names = names_of_groups(root)
            types, ids, starts = (root[name][()] for name in ("Types", "Connectivity", "Offsets"))
        self.cells: dict[str, NDArray[np.int64]] = {}
        for shape, nodes in NODES.items():
            some = np.flatnonzero(types == VTK_TYPES[shape])
            if len(some):
                self.cells[shape] = ids[starts[some][:, None] + np.arange(nodes)]

    def points(self, frame: int) -> NDArray[np.float64]:
        """Positions of the nodes [m], shape (nodes, 3)."""
        return self.read(frame, ["Points"])[0]

    def field(self, kind: str, name: str, frame: int) -> NDArray:
        """A field on the nodes ("PointData") or elements ("CellData") of a frame."""
        return self.read(frame, [f"{kind}/{name}"])[0]


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
