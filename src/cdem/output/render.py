"""Pictures of surfaces: of the frames of a result folder, or of a simulation."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem.case import child
from cdem.case.output_fields import CARRIED
from cdem.case.shown_fields import AXIAL_FORCE, SHOWN
from cdem.errors import CdemError
from cdem.output.cuts import Cuts, Plane
from cdem.output.page_facts import case_facts
from cdem.output.painter import Frames, Painter
from cdem.output.reader import FrameSeries, Surface, SurfaceSeries

if TYPE_CHECKING:
    from cdem.run.state import RunState

OPENGL_HINT = "no OpenGL to draw with; on Debian or Ubuntu: sudo apt-get install libosmesa6 libgl1 libxrender1"


def snapshot(sim: RunState) -> Surface:
    """The present surface of a simulation."""
    from cdem.run.bolt_fields import bolt_lines
    from cdem.run.fields import surface_of, values_of

    places, polygons, point_data, cell_data = surface_of(sim, values_of(sim, CARRIED))
    ends, lines, _, of_bars = bolt_lines(sim)
    return Surface(
        sim.time,
        places,
        polygons,
        point_data,
        cell_data,
        sim.build.group_names,
        ends[lines],
        of_bars["axial_force"],
    )


@cache
def can_draw() -> bool:
    """Whether off-screen drawing works; tried in another process, because a failure aborts it."""
    if not os.environ.get("DISPLAY"):  # without a screen VTK would try X first and complain
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkOSOpenGLRenderWindow")
    code = (
        "import pyvista as p; q = p.Plotter(off_screen=True, window_size=(16, 16));"
        "q.add_mesh(p.Sphere()); q.screenshot(return_img=True)"
    )
    done = subprocess.run(child.code(code), cwd=child.AWAY, capture_output=True, check=False)
    return done.returncode == 0


def load_pyvista() -> Any:
    """pyvista, ready to draw without a screen.

    Raises:
        CdemError: It is not installed, or OpenGL is missing.
    """
    try:
        import pyvista
    except ImportError:
        raise CdemError("pictures need pyvista; pip install 'cdem[viz]'") from None
    if not can_draw():
        raise CdemError(OPENGL_HINT)
    return pyvista


def render(
    folder: Path,
    *,
    field: str = "displacement",
    time: float | None = None,
    cut: str | None = None,
    before_after: bool = False,
    movie: bool = False,
) -> list[Path]:
    """Draw the surface of a run, or a cut through it.

    Without `time` and `before_after`: at the start, halfway, the end, and all three side by side.

    Args:
        folder: Result folder.
        field: One of `SHOWN`.
        time: Draw only the frame next to this time [s].
        cut: Plane to cut by instead, as `Plane.parse` takes it.
        before_after: Draw only the first and the last frame, side by side.
        movie: Also draw every frame into an animation.

    Returns:
        The files: PNG pictures, and a GIF for the movie.

    Raises:
        CdemError: The run has no such field, the plane misses it, or pyvista or OpenGL is missing.
    """
    folder = Path(folder)
    pyvista = load_pyvista()
    frames = _frames(folder, field, cut)
    scene = Painter(pyvista, frames, field, north=case_facts(folder)["north"], occlusion=True)
    stem = field if cut is None else f"{field}-{cut.replace(' ', '')}"
    last = len(frames) - 1
    if before_after:
        images = [scene.draw(frames[k], f"{word}, t = {frames[k].time:.4g} s")
                  for k, word in ((0, "before"), (last, "after"))]  # fmt: skip
        paths = [folder / f"{stem}-before-after.png"]
        write_image(paths[0], scene.with_foot(images))
    else:
        times = FrameSeries(folder).times
        chosen = {0, last // 2, last} if time is None else {int(np.abs(times - time).argmin())}
        paths, images = [], []
        for frame in sorted(chosen):
            images.append(scene.draw(frames[frame]))
            paths.append(folder / f"{stem}-{frame:04d}.png")
            write_image(paths[-1], scene.with_foot(images[-1:]))
        if time is None:
            paths.append(folder / f"{stem}-overview.png")
            write_image(paths[-1], scene.with_foot(images))
    if movie:
        scene.occlusion = False
        paths.append(_write_movie(folder / f"{stem}.gif", scene, frames))
    return paths


def _frames(folder: Path, field: str, cut: str | None) -> _Carried | Cuts:
    """The frames of a folder to draw, with the source of a field.

    Raises:
        CdemError: They lack the field.
    """
    surfaces, volumes = SurfaceSeries(folder), FrameSeries(folder)
    of_volume = {name for names in volumes.names.values() for name in names}
    first = surfaces[0]
    known = of_volume if cut else of_volume | first.point_data.keys() | first.cell_data.keys()
    if surfaces.has_bolts and not cut:
        known = known | {AXIAL_FORCE.of}
    there = [name for name, shown in SHOWN.items() if shown.of in known]
    if field not in there:
        missing = (
            "no field" if field not in SHOWN else "a slice has no" if cut else ("the run has no")
        )
        raise CdemError(f"{missing} {field!r} to draw; choose one of: {', '.join(there)}")
    if cut:
        return Cuts(volumes, Plane.parse(cut))
    return _Carried(surfaces, volumes, SHOWN[field].of)


class _Carried:
    """Surfaces of a run, with a field of the elements on their faces."""

    def __init__(self, surfaces: SurfaceSeries, volumes: FrameSeries, field: str) -> None:
        self.surfaces, self.volumes, self.field = surfaces, volumes, field

    def __len__(self) -> int:
        return len(self.surfaces)

    def __getitem__(self, frame: int) -> Surface:
        surface = self.surfaces[frame]
        known = surface.point_data.keys() | surface.cell_data.keys() | {AXIAL_FORCE.of}
        if self.field not in known:
            if "element" not in surface.cell_data:
                raise CdemError(
                    f"{self.surfaces.folder}: comes from an older cdem, whose surface lacks the "
                    f"numbers of "
                    f"elements: cannot draw {self.field}; run the case again, or use --slice"
                )
            rows = self.volumes.field("CellData", self.field, frame)
            surface.cell_data[self.field] = rows[surface.cell_data["element"]]
        return surface


def picture(
    surfaces: Sequence[Surface], field: str = "displacement", titles: Sequence[str] = ()
) -> NDArray[np.uint8]:
    """Surfaces of one model side by side, with the same view and colours.

    Args:
        surfaces: Frames of one run, or the same frame of several.
        field: Field that colours them.
        titles: Titles; by default their times.

    Returns:
        The picture, shape (height, width, 3).

    Raises:
        CdemError: The field was not recorded, or pyvista or OpenGL is missing.
    """
    scene = Painter(load_pyvista(), surfaces, field)
    titles = titles or [""] * len(surfaces)
    return scene.with_foot([scene.draw(s, t) for s, t in zip(surfaces, titles, strict=True)])


def write_image(path: Path, image: NDArray) -> None:
    """Write a picture, shape (height, width, 3); the file's name gives the format."""
    from PIL import Image

    Image.fromarray(image).save(path)


def _write_movie(path: Path, scene: Painter, frames: Frames) -> Path:
    from PIL import Image

    pictures = [scene.with_foot([scene.draw(frames[k])]) for k in range(len(frames))]
    some = pictures[:: max(1, len(pictures) // 8)]
    palette = Image.fromarray(np.concatenate(some)).quantize(
        256
    )  # one palette for all frames avoids flicker
    images = [Image.fromarray(picture).quantize(palette=palette) for picture in pictures]
    images[0].save(path, save_all=True, append_images=images[1:], duration=100, loop=0)
    return path
