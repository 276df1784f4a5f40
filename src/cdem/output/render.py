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

if TYPE_CHECKING:
    from cdem.run.state import RunState

DRAWN = {field.name: field for field in OUTPUT_FIELDS if field.colors}
"""Fields that `render` can colour by."""
COLOR_MAPS = {
    "amount": "YlOrBr", "whole range": "YlOrBr", "label": "tab10", "scattered label": "tab20"
}  # fmt: skip
GOLDEN = 0.6180339887
"""Its multiples, modulo 1, lie far from one another."""
ROW = 28
"""Height of a row of the legend [pixels]."""
THROUGH = 0.6
"""Opacity of rock with bolts, which are seen through it."""
OPENGL_HINT = "no OpenGL to draw with; on Debian or Ubuntu: sudo apt-get install libosmesa6 libgl1 libxrender1"


def snapshot(sim: RunState) -> Surface:
    """The surface of a simulation as it is now."""
    from cdem.run.bolt_fields import bolt_lines
    from cdem.run.fields import surface_of, values_of

    places, vertices, point_data, cell_data = surface_of(sim, values_of(sim, CARRIED))
    counts = (vertices >= 0).sum(axis=1)
    faces = np.column_stack([counts, vertices])
    ends, lines, _, _ = bolt_lines(sim)
    return Surface(
        sim.time,
        places,
        faces[faces >= 0],
        point_data,
        cell_data,
        sim.build.group_names,
        ends[lines],
    )


def color(index: int) -> str:
    """One of ten colours that are easy to tell apart (Tableau's), again and again."""
    colors = ("4e79a7", "f28e2b", "59a14f", "e15759", "76b7b2", "edc948", "b07aa1", "ff9da7",
              "9c755f", "bab0ac")  # fmt: skip
    return "#" + colors[index % len(colors)]


def legend(entries: Sequence[tuple[str, str]], rows: int, width: int) -> NDArray[np.uint8]:
    """Labels with their colours under each other, shape (rows * ROW + 10, width, 3)."""
    import matplotlib
    from PIL import Image, ImageDraw, ImageFont

    font = ImageFont.truetype(f"{matplotlib.get_data_path()}/fonts/ttf/DejaVuSans.ttf", 19)
    image = Image.new("RGB", (width, ROW * rows + 10), "white")
    draw = ImageDraw.Draw(image)
    for number, (label, fill) in enumerate(entries):
        y = 10 + ROW * number
        draw.rectangle((20, y + 3, 38, y + 21), fill=fill, outline="#888888")
        draw.text((50, y), label, fill="black", font=font)
    return np.asarray(image)


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
        first = series[0]
        middle = series[(len(series) - 1) // 2]
        self.low_corner, self.high_corner = self._bounds(first, middle, last)
        self.camera = self._camera(first, last)

    def _values(self, surface: Surface) -> NDArray:
        if self.field in surface.point_data:
            return np.linalg.norm(surface.point_data[self.field], axis=1)
        if self.field not in surface.cell_data:
            raise CdemError(f"the run did not record {self.field!r}; add it to output.fields")
        values = surface.cell_data[self.field].astype(float)
        # neighbours in space have similar numbers: spread them over the palette
        return values * GOLDEN % 1 if self.colors == "scattered label" else values

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

    def _camera(self, first: Surface, last: Surface) -> list[Any]:
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

    def draw(self, surface: Surface, title: str = "") -> NDArray:
        """A picture of one frame, called by its time if it has no title, shape (height, width, 3)."""
        pyvista = self.pyvista
        mesh = pyvista.PolyData(surface.points, faces=surface.faces)
        values = self._values(surface)
        name = f"{self.field} [{self.unit}]" if self.unit else self.field
        on_points = len(values) == len(surface.points) and self.field in surface.point_data
        (mesh.point_data if on_points else mesh.cell_data)[name] = values
        plotter = pyvista.Plotter(off_screen=True, window_size=(1100, 800))
        plotter.set_background("white")
        by_group = self.field == "group" and len(surface.group_names) > 0
        if by_group:
            last = len(surface.group_names) - 1
            look = {"cmap": [color(i) for i in range(last + 1)], "clim": (-0.5, last + 0.5)}
        else:
            look = {
                "cmap": COLOR_MAPS[self.colors],
                "clim": (0.0, max(self.high, 1e-12)),
            }
        plotter.add_mesh(
            mesh,
            scalars=name,
            opacity=THROUGH if len(surface.bolts) else 1.0,
            **look,
            show_edges=mesh.n_cells < 20000,
            edge_color="#444444",
            line_width=0.4,
            show_scalar_bar=self.colors != "scattered label"
            and not by_group,  # whose numbers mean nothing
            # labels that leave room for the title in the middle
            scalar_bar_args={"color": "black", "vertical": False, "fmt": "%.3g", "n_labels": 4},
        )
        if len(surface.bolts):
            bars = surface.bolts.reshape(-1, 3)
            plotter.add_lines(bars, color="#202020", width=4)
        plotter.add_text(title or f"t = {surface.time:.4g} s", font_size=12, color="black")
        plotter.camera_position = self.camera
        box = np.ravel([self.low_corner, self.high_corner], order="F")
        plotter.reset_camera(bounds=box)
        plotter.camera.zoom(1.05)
        image = plotter.screenshot(return_img=True)
        plotter.close()
        if not by_group:
            return image
        entries = [(label, color(i)) for i, label in enumerate(surface.group_names)]
        return np.concatenate([image, legend(entries, len(entries), image.shape[1])])
