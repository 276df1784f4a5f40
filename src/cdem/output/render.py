"""Pictures of surfaces: of the frames of a result folder, or of a simulation as it is now."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.output_fields import CARRIED, OUTPUT_FIELDS
from cdem.errors import CdemError
from cdem.output.reader import Surface, SurfaceSeries
from cdem.output.scene import (
    SIZE,
    View,
    add_rock,
    bar,
    color_map,
    labels,
    new_plotter,
    take,
    write_title,
)

if TYPE_CHECKING:
    from cdem.run.state import RunState

DRAWN = {field.name: field for field in OUTPUT_FIELDS if field.colors}
"""Fields that `render` can colour by."""
COLOR_MAPS = {"amount": "viridis", "whole range": "viridis", "scattered label": "tab20"}
GOLDEN = 0.6180339887
"""Its multiples, modulo 1, lie far from one another."""
AROUND = 0.6
"""Rock that has flown further out than this, in sizes of the model, is not framed."""
THROUGH = 0.6
"""Opacity of rock with bolts, which are seen through it."""
OPENGL_HINT = "no OpenGL to draw with; on Debian or Ubuntu: sudo apt-get install libosmesa6 libgl1 libxrender1"


def snapshot(sim: RunState) -> Surface:
    """The surface of a simulation as it is now."""
    from cdem.run.bolt_fields import bolt_lines
    from cdem.run.fields import surface_of, values_of

    places, polygons, point_data, cell_data = surface_of(sim, values_of(sim, CARRIED))
    ends, lines, _, _ = bolt_lines(sim)
    return Surface(
        sim.time,
        places,
        polygons,
        point_data,
        cell_data,
        sim.build.group_names,
        ends[lines],
    )


def color(index: int) -> str:
    """One of twelve colours that are easy to tell apart, also without red or green (Tol), again and
    again."""
    colors = ("4477aa", "ee6677", "228833", "ccbb44", "66ccee", "aa3377", "bbbbbb", "332288",
              "ddcc77", "44aa99", "882255", "999933")  # fmt: skip
    return "#" + colors[index % len(colors)]


@cache
def can_draw() -> bool:
    """Whether off-screen drawing works; tried in another process, because a failure aborts it."""
    if not os.environ.get("DISPLAY"):  # without a screen VTK would try, and complain about, X first
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkOSOpenGLRenderWindow")
    code = (
        "import pyvista as p; q = p.Plotter(off_screen=True, window_size=(16, 16));"
        "q.add_mesh(p.Sphere()); q.screenshot(return_img=True)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
    return done.returncode == 0


def load_pyvista() -> Any:
    """pyvista, ready to draw without a screen.

    Raises:
        CdemError: It is not installed, or there is no OpenGL to draw with.
    """
    try:
        import pyvista
    except ImportError:
        raise CdemError("pictures need pyvista; pip install 'cdem[viz]'") from None
    if not can_draw():
        raise CdemError(OPENGL_HINT)
    return pyvista


def render(folder: Path, *, field: str = "displacement", movie: bool = False) -> list[Path]:
    """Draw the surface at the start, halfway and the end, and all three side by side.

    Args:
        folder: Result folder.
        field: One of `DRAWN`.
        movie: Also draw every frame into an animation.

    Returns:
        The files: PNG pictures, and a GIF for the movie.
    """
    if field not in DRAWN:
        raise CdemError(f"no field {field!r} to draw; choose one of: {', '.join(DRAWN)}")
    folder = Path(folder)
    series = SurfaceSeries(folder)
    last = len(series) - 1
    scene = _Scene(load_pyvista(), series, field)
    paths, images = [], []
    for frame in sorted({0, last // 2, last}):
        image = scene.draw(series[frame])
        path = folder / f"{field}-{frame:04d}.png"
        write_image(path, image)
        paths.append(path)
        images.append(image)
    overview = folder / f"{field}-overview.png"
    write_image(overview, np.concatenate(images, axis=1))
    paths.append(overview)
    if movie:
        paths.append(_write_movie(folder / f"{field}.gif", scene, series))
    return paths


def picture(
    surfaces: Sequence[Surface], field: str = "displacement", titles: Sequence[str] = ()
) -> NDArray[np.uint8]:
    """Surfaces of one model side by side, in the same view and colours.

    Args:
        surfaces: Frames of one run, or the same frame of several.
        field: What to colour by.
        titles: What to call them; their times if there are none.

    Returns:
        The picture, shape (height, width, 3).

    Raises:
        CdemError: The field was not recorded, or there is nothing to draw with.
    """
    scene = _Scene(load_pyvista(), surfaces, field)
    titles = titles or [""] * len(surfaces)
    images = [scene.draw(s, title) for s, title in zip(surfaces, titles, strict=True)]
    return np.concatenate(images, axis=1)


def write_image(path: Path, image: NDArray) -> None:
    """Write a picture, shape (height, width, 3), as the file's name says."""
    from PIL import Image

    Image.fromarray(image).save(path)


def _write_movie(path: Path, scene: _Scene, series: SurfaceSeries) -> Path:
    from PIL import Image

    frames = [Image.fromarray(scene.draw(series[i])) for i in range(len(series))]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=100, loop=0)
    return path


class _Scene:
    """One view and one colour range for all frames of a run."""

    def __init__(self, pyvista: Any, series: Sequence[Surface] | SurfaceSeries, field: str) -> None:
        self.pyvista, self.field = pyvista, field
        known = DRAWN.get(field)  # a field of a study may be any, and names its own unit
        self.unit = known.unit if known else ""
        self.colors = (known.colors if known else None) or "amount"
        last = series[len(series) - 1]
        values = self._values(last)
        self.high = float(np.nanpercentile(values, 99.5)) if len(values) else 1.0
        if self.colors != "amount":
            self.high = max(float(values.max()), 1.0)
        if field == "group" and last.group_names:
            self.high = len(last.group_names) - 1.0
        self.map = self._map()
        self.view = self._view(series[0], series[(len(series) - 1) // 2], last)

    def _values(self, surface: Surface) -> NDArray:
        if self.field in surface.point_data:
            return np.linalg.norm(surface.point_data[self.field], axis=1)
        if self.field not in surface.cell_data:
            raise CdemError(f"the run did not record {self.field!r}; add it to output.fields")
        values = surface.cell_data[self.field].astype(float)
        # neighbours in space have similar numbers: spread them over the palette
        return values * GOLDEN % 1 if self.colors == "scattered label" else values

    def _map(self) -> Any:
        """Colour map of values from 0 to `high`."""
        import matplotlib
        from matplotlib.colors import ListedColormap

        if self.colors == "amount":
            return color_map(COLOR_MAPS["amount"])
        if self.colors == "label":
            return ListedColormap([color(i) for i in range(round(self.high) + 1)])
        return matplotlib.colormaps[COLOR_MAPS[self.colors]]

    def _view(self, first: Surface, middle: Surface, last: Surface) -> View:
        """All of the model, seen across the main motion and from above; along -y when nothing moves
        in plan."""
        low, high = first.points.min(axis=0), first.points.max(axis=0)
        size = float(np.linalg.norm(high - low))
        moved = last.point_data.get("displacement", np.zeros((1, 3)))
        way = moved.mean(axis=0)[:2]
        way = way / np.linalg.norm(way) if np.linalg.norm(way) > 1e-3 * size else np.array([1.0, 0])
        side = np.array([way[1], -way[0]])
        # from the side, a little from where things go to, and from above
        back = np.array([*(0.8 * side + 0.6 * way), 0.75])
        away = AROUND * size
        points = np.vstack([first.points, middle.points, last.points])
        return View.framing(np.clip(points, low - away, high + away), back)

    def draw(self, surface: Surface, title: str = "") -> NDArray:
        """A picture of one frame, called by its time if it has no title, shape (height, width, 3)."""
        pyvista = self.pyvista
        mesh = pyvista.PolyData(surface.points, faces=surface.faces)
        values = self._values(surface)
        on_points = len(values) == len(surface.points) and self.field in surface.point_data
        (mesh.point_data if on_points else mesh.cell_data)[self.field] = values
        plotter = new_plotter(pyvista)
        high = max(self.high, 1e-12)
        span = (-0.5, self.high + 0.5) if self.colors == "label" else (0.0, high)
        opacity = THROUGH if len(surface.bolts) else 1.0
        look = {"scalars": self.field, "cmap": self.map, "clim": span}
        add_rock(plotter, mesh, self.view, opacity=opacity, **look)
        if len(surface.bolts):
            bars = surface.bolts.reshape(-1, 3)
            plotter.add_lines(bars, color="#202020", width=4)
        image = write_title(take(plotter, self.view), title or f"t = {surface.time:.4g} s")
        return np.concatenate([image, self._strip(surface, image.shape[1])])

    def _strip(self, surface: Surface, width: int) -> NDArray:
        """What stands below the picture: what the colours mean, and a scale."""
        metres = self.view.height / SIZE[1]
        name = "" if self.colors == "scattered label" else self.field  # whose numbers mean nothing
        if self.colors != "label":
            return bar(name, self.unit, self.map, max(self.high, 1e-12), metres, width)
        names = surface.group_names if self.field == "group" else []
        known = [names[i] if names else str(i) for i in range(round(self.high) + 1)]
        entries = [(label, color(i)) for i, label in enumerate(known)]
        return labels(entries, len(entries), width)
