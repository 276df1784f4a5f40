"""How pictures look: the view that frames a model, light and edges, the strip with legend and scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Image = NDArray[np.uint8]

SIZE = (1100, 760)
"""Width and height of a view, without the strip below it [pixels]."""
MARGIN = 1.06
"""The view is so much wider or higher than what it frames."""
NEUTRAL = "#e2dccf"
"""Rock where an amount is next to nothing."""
NOTHING = 0.004
"""So much of the range is next to nothing."""
SHARP = 25.0
"""Edges between faces that meet at a larger angle are drawn [deg]."""
LIFT = 1e-3
"""Edges are drawn so far before their faces, in heights of the picture."""
MOST_LINES = 20_000
"""Faces of a mesh whose lines are drawn, at most."""
MATTE = {"ambient": 0.45, "diffuse": 0.65, "specular": 0.0}
"""How surfaces take light: so little shading that colours stay those of the legend."""
ROW = 28
"""Height of a row of the strip [pixels]."""
PREFIXES = {-3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


@dataclass(frozen=True)
class View:
    """A parallel view along a direction that frames points.

    Attributes:
        focus: In the middle of the picture [m].
        back: Unit vector from there to the camera.
        height: Of the picture [m].
        far: Distance of the camera [m].
    """

    focus: Floats
    back: Floats
    height: float
    far: float

    @classmethod
    def framing(cls, points: Floats, back: Floats, size: tuple[int, int] = SIZE) -> View:
        """The view of a picture of this size [pixels] that shows all points, shape (points, 3)."""
        back = back / np.linalg.norm(back)
        right = np.cross([0.0, 0.0, 1.0], back)
        right /= np.linalg.norm(right)
        up = np.cross(back, right)
        places = np.stack([points @ right, points @ up, points @ back], axis=1)
        low, high = places.min(axis=0), places.max(axis=0)
        middle = 0.5 * (low + high)
        height = max(high[1] - low[1], (high[0] - low[0]) * size[1] / size[0], 1e-9) * MARGIN
        far = 2.0 * float(np.linalg.norm(high - low)) + 1e-9
        return cls(middle @ np.stack([right, up, back]), back, float(height), far)

    def aim(self, plotter: Any) -> None:
        """Point the camera of a plotter."""
        camera = plotter.camera
        camera.position, camera.focal_point = self.focus + self.far * self.back, self.focus
        camera.up = (0, 0, 1)
        camera.parallel_projection = True
        camera.parallel_scale = 0.5 * self.height
        plotter.renderer.ResetCameraClippingRange()


def new_plotter(pyvista: Any, size: tuple[int, int] = SIZE) -> Any:
    """A white plotter with light from the upper left behind the camera."""
    plotter = pyvista.Plotter(off_screen=True, window_size=size, lighting="none")
    plotter.set_background("white")
    lamp = {"light_type": "camera light", "intensity": 0.75}
    plotter.add_light(pyvista.Light(position=(-0.7, 0.8, 1.0), focal_point=(0, 0, 0), **lamp))
    plotter.add_light(pyvista.Light(light_type="headlight", intensity=0.35))
    return plotter


def add_rock(plotter: Any, mesh: Any, view: View, **look: Any) -> None:
    """Draw faces of rock in the colours of `look`, its sharp edges, and thin lines of its mesh."""
    lines = {}
    if mesh.n_cells < MOST_LINES:
        lines = {
            "show_edges": True,
            "edge_color": "#333333",
            "edge_opacity": 0.35,
            "line_width": 0.5,
        }
    plotter.add_mesh(mesh, show_scalar_bar=False, smooth_shading=False, **MATTE, **lines, **look)
    edges = mesh.triangulate().extract_feature_edges(
        feature_angle=SHARP, boundary_edges=True, manifold_edges=False, non_manifold_edges=False
    )
    if edges.n_cells:
        edges.points += LIFT * view.height * view.back  # not half in the faces
        plotter.add_mesh(edges, color="#222222", line_width=1.3, lighting=False)


def take(plotter: Any, view: View) -> Image:
    """The picture of a plotter, which is closed, shape (height, width, 3)."""
    view.aim(plotter)
    plotter.enable_anti_aliasing("ssaa")
    image = plotter.screenshot(return_img=True)
    plotter.close()
    return image


def color_map(name: str) -> Any:
    """A colour map of amounts, in which next to nothing is neutral."""
    import matplotlib
    from matplotlib.colors import ListedColormap, to_rgba

    colors = matplotlib.colormaps[name](np.linspace(0, 1, 500))
    colors[: round(NOTHING * len(colors))] = to_rgba(NEUTRAL)
    return ListedColormap(colors)


def _font(size: int) -> Any:
    import matplotlib
    from PIL import ImageFont

    return ImageFont.truetype(f"{matplotlib.get_data_path()}/fonts/ttf/DejaVuSans.ttf", size)


def write_title(image: Image, title: str) -> Image:
    """A picture with a title in its upper left corner."""
    from PIL import Image as Pictures
    from PIL import ImageDraw

    picture = Pictures.fromarray(image)
    ImageDraw.Draw(picture).text((16, 10), title, fill="black", font=_font(24))
    return np.asarray(picture)


def bar(name: str, unit: str, colors: Any, high: float, metres: float, width: int) -> Image:
    """A strip with a colour bar from 0 to `high`, and a scale, shape (3 ROW, width, 3).

    Args:
        name: Of what is coloured.
        unit: Of its values; a prefix is put before it where that makes them shorter.
        colors: Colour map of matplotlib.
        high: Largest value.
        metres: That a pixel stands for [m].
        width: Of the strip [pixels].
    """
    from matplotlib.ticker import MaxNLocator
    from PIL import Image as Pictures
    from PIL import ImageDraw

    power = 3 * int(np.floor(np.log10(high) / 3)) if high > 0 and unit not in ("", "1") else 0
    power = power if power in PREFIXES and (abs(power) >= 3 and unit != "m") else 0
    label = name.replace("_", " ") + (f" [{PREFIXES[power]}{unit}]" if unit else "")
    left, length = width // 2, width // 2 - 60
    ramp = (255 * colors(np.linspace(0, 1, length))[:, :3]).astype(np.uint8)
    strip = np.full((3 * ROW, width, 3), 255, np.uint8)
    strip[ROW + 2 : 2 * ROW - 6, left : left + length] = ramp
    picture = Pictures.fromarray(strip)
    draw, font = ImageDraw.Draw(picture), _font(18)
    draw.text((left, 2), label, fill="black", font=font)
    for tick in MaxNLocator(4).tick_values(0, high / 10**power):
        place = left + length * tick / (high / 10**power)
        if left <= place <= left + length:
            draw.line((place, 2 * ROW - 6, place, 2 * ROW), fill="black")
            draw.text((place, 2 * ROW + 2), f"{tick:g}", fill="black", font=font, anchor="ma")
    _draw_scale(draw, metres, width)
    return np.asarray(picture)


def _draw_scale(draw: Any, metres: float, width: int) -> None:
    """A scale bar at the left of a strip, of a round length up to a fifth of the picture."""
    most = 0.2 * width * metres
    base = 10.0 ** np.floor(np.log10(most))
    length = base * max(step for step in (1, 2, 5) if step * base <= most)
    text = f"{length:g} m" if length >= 1 else f"{100 * length:g} cm" if length >= 0.01 else (
        f"{1000 * length:g} mm")  # fmt: skip
    x, y, pixels = 24, ROW + 12, length / metres
    draw.line((x, y, x + pixels, y), fill="black", width=3)
    for end in (x, x + pixels):
        draw.line((end, y - 6, end, y + 6), fill="black", width=2)
    draw.text((x + pixels / 2, y + 8), text, fill="black", font=_font(18), anchor="ma")


def labels(entries: Sequence[tuple[str, str]], rows: int, width: int) -> Image:
    """Names with their colours under each other, shape (rows * ROW + 10, width, 3)."""
    from PIL import Image as Pictures
    from PIL import ImageDraw

    picture = Pictures.new("RGB", (width, ROW * rows + 10), "white")
    draw = ImageDraw.Draw(picture)
    for number, (label, fill) in enumerate(entries):
        y = 10 + ROW * number
        draw.rectangle((20, y + 3, 38, y + 21), fill=fill, outline="#888888")
        draw.text((50, y), label, fill="black", font=_font(19))
    return np.asarray(picture)
