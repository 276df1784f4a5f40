"""Looking at results: text, plots, pictures, ParaView files and a report, from the folder alone."""

from __future__ import annotations

import base64
import csv
import html
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError

if TYPE_CHECKING:
    from cdem.simulation import Simulation

UNITS = {
    "displacement": "m",
    "velocity": "m/s",
    "damage": "1",
    "group": "",
    "block": "",
    "joint": "",
}
"""Fields that `render` can colour by, with their units."""
OPENGL_HINT = "no OpenGL to draw with; on Debian or Ubuntu: sudo apt-get install libosmesa6 libgl1 libxrender1"
ENERGY_COLUMNS = ("kinetic", "strain", "contact", "friction", "damping", "fracture", "external")


def read_summary(folder: Path) -> dict[str, Any]:
    """Content of summary.json.

    Raises:
        CdemError: The folder holds no finished or stopped run.
    """
    path = Path(folder) / "summary.json"
    try:
        return json.loads(path.read_text())
    except FileNotFoundError:
        raise CdemError(
            f"{folder}: no summary.json; the run has not come to an end yet, or this is no result "
            "folder"
        ) from None
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
    """

    time: float
    points: NDArray[np.float64]
    faces: NDArray[np.int64]
    point_data: dict[str, NDArray]
    cell_data: dict[str, NDArray]


def snapshot(sim: Simulation) -> Surface:
    """The surface of a simulation as it is now."""
    from cdem.results import damage_of, surface_of

    points = {name: sim.fields[name] for name in ("displacement", "velocity")}
    places, vertices, point_data, cell_data = surface_of(sim, points, damage_of(sim))
    counts = (vertices >= 0).sum(axis=1)
    faces = np.column_stack([counts, vertices])
    return Surface(sim.time, places, faces[faces >= 0], point_data, cell_data)


class SurfaceSeries:
    """Frames of surface.vtkhdf, read one at a time."""

    def __init__(self, folder: Path) -> None:
        import h5py

        path = Path(folder) / "surface.vtkhdf"
        if not path.is_file():
            raise CdemError(f"{folder}: no surface.vtkhdf to draw; was output.frames switched off?")
        try:
            self._file = h5py.File(path, "r", locking=False)
        except OSError as error:
            raise CdemError(f"{path}: not readable ({error})") from None
        self._root = self._file["VTKHDF"]
        self.times = self._root["Steps/Values"][:]
        if len(self.times) == 0:
            raise CdemError(f"{path}: holds no frames yet")

    def __len__(self) -> int:
        return len(self.times)

    def __getitem__(self, frame: int) -> Surface:
        root, steps = self._root, self._root["Steps"]
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
        )


# ---------------------------------------------------------------------- text


def info(folder: Path) -> str:
    """The summary as a page of text."""
    s = read_summary(folder)
    lines = [
        f"{s['title'] or 'untitled case'}: {s['status']}",
        f"  {s['steps']:,} steps to t = {s['time']:.6g} s in {s['wall_time']:.1f} s "
        f"({s['steps'] / max(s['wall_time'], 1e-9):,.0f} steps/s), dt {s['time_step']:.4g} s, "
        f"{s['device']}, {s['threads']} threads, cdem {s['version']}",
        "  " + ", ".join(f"{v:,} {k.replace('_', ' ')}" for k, v in s["counts"].items()),
    ]
    for stage in s["stages"]:
        lines.append(
            f"  stage {stage['name']} ({stage['mode']}): {stage['status']} after "
            f"{stage['steps']:,} steps, {stage['time']:.6g} s, wall {stage['wall_time']:.1f} s"
        )
    e = s["energies"]
    if e:
        lines.append(f"  energy closing error {100 * e['error']:.3g} %")
        lines.append("  " + ", ".join(f"{k} {e[k]:.4g} J" for k in ENERGY_COLUMNS))
    if s["unbalance_ratio"] is not None:
        lines.append(f"  unbalance ratio {s['unbalance_ratio']:.3g}")
    lines.append(
        f"  broken springs: {s['broken']['tension']:,} tension, {s['broken']['shear']:,} shear"
    )
    lines.append(
        f"  {'group':<18}{'mass [kg]':>13}{'moved [m]':>12}{'most [m]':>12}{'speed [m/s]':>13}"
    )
    for name, g in s["groups"].items():
        moved, speed = np.linalg.norm(g["displacement"]), np.linalg.norm(g["velocity"])
        lines.append(
            f"  {name:<18}{g['mass']:>13.5g}{moved:>12.5g}{g['max_displacement']:>12.5g}{speed:>13.5g}"
        )
    return "\n".join(lines) + "\n"


# ---------------------------------------------------------------------- plots


def pyplot():
    """matplotlib's pyplot, ready to draw into files.

    Raises:
        CdemError: matplotlib is not installed.
    """
    try:
        import matplotlib
    except ImportError:
        raise CdemError("plots need matplotlib; pip install 'cdem[viz]'") from None
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"axes.spines.top": False, "axes.spines.right": False, "figure.dpi": 130})
    return plt


def plot(folder: Path) -> list[Path]:
    """Draw energies, unbalance and all histories; returns the PNG files."""
    plt = pyplot()
    folder = Path(folder)
    columns = read_histories(folder)
    time = columns.pop("time [s]")
    paths = [_plot_energies(plt, folder, time, columns)]
    if (columns["unbalance ratio"] > 0).any():
        figure, axes = plt.subplots(figsize=(6.4, 3.2))
        axes.semilogy(columns["step"], np.maximum(columns["unbalance ratio"], 1e-16))
        axes.set(xlabel="step", ylabel="unbalance ratio")
        paths.append(_save(plt, figure, folder / "unbalance.png"))
    names: dict[str, list[str]] = {}
    for column in columns:
        if "." in column:
            names.setdefault(column.split(".")[0], []).append(column)
    for name, members in names.items():
        paths.append(_plot_history(plt, folder, name, members, time, columns))
    return paths


def _save(plt, figure, path: Path) -> Path:
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)
    return path


def _plot_energies(plt, folder: Path, time, columns) -> Path:
    figure, (upper, lower) = plt.subplots(
        2, 1, figsize=(6.4, 5.2), sharex=True, height_ratios=[3, 1]
    )
    for name in ENERGY_COLUMNS:
        key = f"{name} energy [J]" if f"{name} energy [J]" in columns else f"{name} work [J]"
        if np.abs(columns[key]).max() > 0:
            upper.plot(time, columns[key], label=name, lw=1.4)
    upper.set(ylabel="energy [J]")
    upper.legend(frameon=False, fontsize=8, ncols=2)
    lower.plot(time, 100 * columns["energy error"], color="k", lw=1)
    lower.set(xlabel="time [s]", ylabel="closing error [%]")
    return _save(plt, figure, folder / "energies.png")


def _plot_history(plt, folder: Path, name: str, members: list[str], time, columns) -> Path:
    quantities: dict[str, list[str]] = {}
    for column in members:
        label = column.split(".", 1)[1]
        quantity = label.split(" [")[0]
        quantity = quantity[:-2] if quantity.endswith(("_x", "_y", "_z")) else quantity
        quantities.setdefault(quantity, []).append(column)
    figure, rows = plt.subplots(
        len(quantities), 1, figsize=(6.4, 2.4 * len(quantities) + 0.6), sharex=True, squeeze=False
    )
    for axes, (quantity, some) in zip(rows[:, 0], quantities.items(), strict=True):
        for column in some:
            part = column.split(".", 1)[1].split(" [")[0]
            axes.plot(time, columns[column], label=part[-1] if len(some) == 3 else None, lw=1.4)
        unit = some[0].rsplit("[", 1)[1].rstrip("]")
        axes.set(ylabel=f"{quantity.replace('_', ' ')} [{unit}]")
        if len(some) == 3:
            axes.legend(frameon=False, fontsize=8)
    rows[-1, 0].set(xlabel="time [s]")
    rows[0, 0].set_title(name)
    return _save(plt, figure, folder / f"history-{name}.png")


# ---------------------------------------------------------------------- pictures


def can_draw() -> bool:
    """Whether off-screen drawing works; tried in another process, because a failure aborts it."""
    code = (
        "import pyvista as p; q = p.Plotter(off_screen=True, window_size=(16, 16));"
        "q.add_mesh(p.Sphere()); q.screenshot(return_img=True)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
    return done.returncode == 0


def _pyvista():
    try:
        import pyvista
    except ImportError:
        raise CdemError("pictures need pyvista; pip install 'cdem[viz]'") from None
    if not os.environ.get("DISPLAY"):  # without a screen VTK would try, and complain about, X first
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkOSOpenGLRenderWindow")
    if not can_draw():
        raise CdemError(OPENGL_HINT)
    return pyvista


def render(folder: Path, *, field: str = "displacement", movie: bool = False) -> list[Path]:
    """Draw the surface at the start, halfway and the end, and all three side by side.

    Args:
        folder: Result folder.
        field: One of `UNITS`.
        movie: Also draw every frame into an animation.

    Returns:
        The files: PNG pictures, and a GIF for the movie.
    """
    if field not in UNITS:
        raise CdemError(f"no field {field!r} to draw; choose one of: {', '.join(UNITS)}")
    folder = Path(folder)
    series = SurfaceSeries(folder)
    last = len(series) - 1
    scene = _Scene(_pyvista(), series, field)
    paths, images = [], []
    for frame in sorted({0, last // 2, last}):
        image = scene.draw(series[frame])
        path = folder / f"{field}-{frame:04d}.png"
        _write_image(path, image)
        paths.append(path)
        images.append(image)
    overview = folder / f"{field}-overview.png"
    _write_image(overview, np.concatenate(images, axis=1))
    paths.append(overview)
    if movie:
        paths.append(_write_movie(folder / f"{field}.gif", scene, series))
    return paths


def picture(surfaces: Sequence[Surface], field: str = "displacement") -> NDArray[np.uint8]:
    """Surfaces of one run side by side, in the same view and colours, shape (height, width, 3)."""
    scene = _Scene(_pyvista(), surfaces, field)
    return np.concatenate([scene.draw(surface) for surface in surfaces], axis=1)


def _write_image(path: Path, image: NDArray) -> None:
    from PIL import Image

    Image.fromarray(image).save(path)


def _write_movie(path: Path, scene: _Scene, series: SurfaceSeries) -> Path:
    from PIL import Image

    frames = [Image.fromarray(scene.draw(series[i])) for i in range(len(series))]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=100, loop=0)
    return path


class _Scene:
    """One view and one colour range for all frames of a run."""

    def __init__(self, pyvista, series: Sequence[Surface] | SurfaceSeries, field: str) -> None:
        self.pyvista, self.field = pyvista, field
        last = series[len(series) - 1]
        values = self._values(last)
        self.high = float(np.nanpercentile(values, 99.5)) if len(values) else 1.0
        if field in ("group", "block", "joint", "damage"):
            self.high = max(float(values.max()), 1.0)
        first = series[0]
        middle = series[(len(series) - 1) // 2]
        self.low_corner, self.high_corner = self._bounds(first, middle, last)
        self.camera = self._camera(first, last)

    def _values(self, surface: Surface) -> NDArray:
        if self.field in surface.point_data:
            return np.linalg.norm(surface.point_data[self.field], axis=1)
        if self.field not in surface.cell_data:
            raise CdemError(f"the run did not record {self.field!r}; add it to output.fields")
        return surface.cell_data[self.field].astype(float)

    @staticmethod
    def _bounds(*frames: Surface) -> tuple[NDArray, NDArray]:
        """What to show: all that moved with half its size around it, but nothing beyond the model."""
        low = np.min([f.points.min(axis=0) for f in frames], axis=0)
        high = np.max([f.points.max(axis=0) for f in frames], axis=0)
        places = []
        for f in frames:
            displacement = f.point_data.get("displacement", np.zeros((1, 3)))
            moved = np.linalg.norm(displacement, axis=1)
            if moved.max() > 1e-3 * np.linalg.norm(high - low):
                some = moved > 0.2 * np.nanpercentile(moved, 99.5)
                places += [f.points[some], f.points[some] - displacement[some]]
        if not places:
            return low, high
        near, far = np.vstack(places).min(axis=0), np.vstack(places).max(axis=0)
        margin = 0.5 * (far - near).max()
        return np.maximum(low, near - margin), np.minimum(high, far + margin)

    def _camera(self, first: Surface, last: Surface):
        """Look across the main motion from above; along -y when nothing moves in plan."""
        moved = last.point_data.get("displacement", np.zeros((1, 3)))
        way = moved.mean(axis=0)[:2]
        size = float(np.linalg.norm(self.high_corner - self.low_corner))
        way = way / np.linalg.norm(way) if np.linalg.norm(way) > 1e-3 * size else np.array([1.0, 0])
        side = np.array([way[1], -way[0]])
        # from the side, a little from where things go to, and from above
        back = np.array([*(0.8 * side + 0.6 * way), 0.75])
        center = 0.5 * (self.low_corner + self.high_corner)
        return [center + 2.0 * size * back / np.linalg.norm(back), center, (0, 0, 1)]

    def draw(self, surface: Surface) -> NDArray:
        """A picture of one frame, shape (height, width, 3)."""
        pyvista = self.pyvista
        mesh = pyvista.PolyData(surface.points, faces=surface.faces)
        values = self._values(surface)
        name = f"{self.field} [{UNITS[self.field]}]" if UNITS[self.field] else self.field
        on_points = len(values) == len(surface.points) and self.field in surface.point_data
        (mesh.point_data if on_points else mesh.cell_data)[name] = values
        plotter = pyvista.Plotter(off_screen=True, window_size=(1100, 800))
        plotter.set_background("white")
        plotter.add_mesh(
            mesh,
            scalars=name,
            cmap="tab10" if self.field in ("group", "joint") else "YlOrBr",
            clim=(0.0, max(self.high, 1e-12)),
            show_edges=mesh.n_cells < 20000,
            edge_color="#444444",
            line_width=0.4,
            scalar_bar_args={"color": "black", "vertical": False, "fmt": "%.3g"},
        )
        plotter.add_text(f"t = {surface.time:.4g} s", font_size=12, color="black")
        plotter.camera_position = self.camera
        box = np.ravel([self.low_corner, self.high_corner], order="F")
        plotter.reset_camera(bounds=box)
        plotter.camera.zoom(1.05)
        image = plotter.screenshot(return_img=True)
        plotter.close()
        return image


# ---------------------------------------------------------------------- files


def export(folder: Path, *, to: str = "vtu") -> list[Path]:
    """Write every frame as a .vtu file, and a .pvd that lists them for ParaView."""
    import h5py
    import meshio

    if to != "vtu":
        raise CdemError(f"cannot export to {to!r}; choose vtu")
    folder = Path(folder)
    path = folder / "frames.vtkhdf"
    if not path.is_file():
        raise CdemError(f"{folder}: no frames.vtkhdf to export; was output.frames switched off?")
    out = folder / "vtu"
    out.mkdir(exist_ok=True)
    paths, entries = [], []
    with h5py.File(path, "r", locking=False) as file:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        cells = _meshio_cells(root)
        count, size = int(root["NumberOfPoints"][0]), len(root["Types"])
        for frame, time in enumerate(steps["Values"][:]):
            start = int(steps["PointOffsets"][frame])
            data: dict[str, dict[str, NDArray]] = {}
            for kind, rows in (("PointData", count), ("CellData", size)):
                data[kind] = {}
                for name, values in root[kind].items():
                    first = int(steps[f"{kind}Offsets/{name}"][frame])
                    data[kind][name] = values[first : first + rows]
            blocks = np.cumsum([len(c[1]) for c in cells])[:-1]
            mesh = meshio.Mesh(
                root["Points"][start : start + count],
                cells,
                point_data=data["PointData"],
                cell_data={n: np.split(v, blocks) for n, v in data["CellData"].items()},
            )
            target = out / f"frame-{frame:04d}.vtu"
            meshio.write(target, mesh, binary=True, compression=None)
            entries.append(f'<DataSet timestep="{time!r}" file="vtu/{target.name}"/>')
            paths.append(target)
    pvd = folder / "frames.pvd"
    body = "".join(e.replace("np.float64(", "").replace(')"', '"') + "\n" for e in entries)
    pvd.write_text(
        f'<VTKFile type="Collection" version="0.1">\n<Collection>\n{body}</Collection>\n</VTKFile>\n'
    )
    return [*paths, pvd]


def _meshio_cells(root) -> list[tuple[str, NDArray]]:
    names = {10: ("tetra", 4), 14: ("pyramid", 5), 13: ("wedge", 6), 12: ("hexahedron", 8)}
    types, connectivity, offsets = root["Types"][:], root["Connectivity"][:], root["Offsets"][:]
    out = []
    for kind, (name, nodes) in names.items():
        some = np.flatnonzero(types == kind)
        if len(some):
            out.append((name, connectivity[offsets[some][:, None] + np.arange(nodes)]))
    return out


def report(folder: Path) -> Path:
    """Write report.html: summary, energy balance, pictures, all in one file."""
    folder = Path(folder)
    s = read_summary(folder)
    pictures = plot(folder)
    try:
        pictures = render(folder)[-1:] + pictures
        missing = ""
    except CdemError as error:
        missing = f"<p>No pictures: {html.escape(str(error))}</p>"
    e = s["energies"]
    rows = "".join(f"<tr><td>{k}</td><td>{e[k]:.6g} J</td></tr>" for k in ENERGY_COLUMNS if e)
    images = "".join(
        f'<img alt="{p.stem}" src="data:image/png;base64,'
        f'{base64.b64encode(p.read_bytes()).decode()}">'
        for p in pictures
    )
    closing = f"{100 * e['error']:.3g} %" if e else "not sampled"
    page = f"""<!doctype html>
<html lang="en"><meta charset="utf-8"><title>{html.escape(s["title"] or "cdem run")}</title>
<style>body{{font:16px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em}}
img{{max-width:100%;display:block;margin:1em 0}}td{{padding:.1em 1.5em .1em 0}}
pre{{background:#f4f4f4;padding:1em;overflow:auto}}</style>
<h1>{html.escape(s["title"] or "cdem run")}</h1>
<p>Energy balance closes to <b>{closing}</b>.</p>
<pre>{html.escape(info(folder))}</pre>{missing}{images}
<h2>Energies at the end</h2><table>{rows}</table>
<p>Files beside this page: case.yaml, summary.json, histories.csv, frames.vtkhdf, surface.vtkhdf,
checkpoint.h5, run.log.</p></html>
"""
    path = folder / "report.html"
    path.write_text(page)
    return path
