"""Layout of pictures: the view of a model, light and edges, the strip with legend and scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Image = NDArray[np.uint8]

SIZE = (1100, 760)
"""Width and height of a view, without the strip below [pixels]."""
LOWEST = 300
"""Least height of a view [pixels]."""
SMOOTH = True
"""Every pixel is the mean of many; this takes most of the time of a picture."""
MARGIN = 1.06
"""Margin of a view, relative to the framed size."""
NEUTRAL = "#e2dccf"
"""Colour of rock with an amount near zero."""
NOTHING = 0.004
"""Fraction of the range that counts as near zero."""
BLEND = 0.08
"""Between it and this fraction of the range, the colour of rock blends into the colour map."""
PALE = "#efece6"
"""Colour of rock around coloured bolts."""
REACH, BIAS = 0.03, 0.1
"""Radius within which corners and gaps of a still are darkened, in heights of the picture, and the
fraction of it that is ignored."""
SHARP = 25.0
"""Edges between faces at a larger angle are drawn [deg]."""
LIFT = 1e-3
"""Distance of drawn edges in front of their faces, in heights of the picture."""
MOST_LINES = 20_000
"""Most faces of a mesh whose lines are drawn."""
MATTE = {"ambient": 0.45, "diffuse": 0.65, "specular": 0.0}
"""Response of surfaces to light: little shading, so that colours match the legend."""
TITLE = 44
"""Height of the row of a title [pixels]."""
ROW = 28
"""Height of a row of the strip [pixels]."""
END = 24
"""Margin at the ends of a colour bar [pixels]."""
ARROW = 30
"""Length of an axis in the strip, for an axis in the plane of the picture [pixels]."""
PREFIXES = {-3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


@dataclass(frozen=True)
class View:
    """A parallel view along a direction, with given points in the picture.

    Attributes:
        focus: Middle of the picture [m].
        back: Unit vector from there to the camera.
        height: Height of the picture [m].
        far: Distance of the camera [m].
        size: Width and height of the picture [pixels].
    """

    focus: Floats
    back: Floats
    height: float
    far: float
    size: tuple[int, int]

    @property
    def right(self) -> Floats:
        """Unit vector to the right of the picture."""
        return _right(self.back)

    @property
    def up(self) -> Floats:
        """Unit vector upwards in the picture."""
        return np.cross(self.back, self.right)

    @property
    def metres(self) -> float:
        """Size of a pixel [m]."""
        return self.height / self.size[1]

    @classmethod
    def fitting(cls, points: Floats, back: Floats) -> View:
        """The same view at the width of `SIZE` and at most its height: low models give low pictures."""
        view = cls.framing(points, back)
        places = points @ view.right, points @ view.up
        width, height = (max(float(np.ptp(place)), 1e-9) for place in places)
        pixels = int(np.clip(SIZE[0] * height / width, LOWEST, SIZE[1]))
        return cls.framing(points, back, (SIZE[0], pixels))

    @classmethod
    def framing(cls, points: Floats, back: Floats, size: tuple[int, int] = SIZE) -> View:
        """The view with a picture of this size [pixels] and all points, shape (points, 3)."""
        back = back / np.linalg.norm(back)
        right = _right(back)
        up = np.cross(back, right)
        places = np.stack([points @ right, points @ up, points @ back], axis=1)
        low, high = places.min(axis=0), places.max(axis=0)
        middle = 0.5 * (low + high)
        height = max(high[1] - low[1], (high[0] - low[0]) * size[1] / size[0], 1e-9) * MARGIN
        far = 2.0 * float(np.linalg.norm(high - low)) + 1e-9
        return cls(middle @ np.stack([right, up, back]), back, float(height), far, size)

    def aim(self, plotter: Any) -> None:
        """Point the camera of a plotter."""
        camera = plotter.camera
        camera.position, camera.focal_point = self.focus + self.far * self.back, self.focus
        camera.up = self.up
        camera.parallel_projection = True
        camera.parallel_scale = 0.5 * self.height
        plotter.renderer.ResetCameraClippingRange()


def _right(back: Floats) -> Floats:
    """Unit vector to the right for a viewer against this vector: x for a plan."""
    right = np.cross([0.0, 0.0, 1.0], back)
    length = np.linalg.norm(right)
    return np.array([1.0, 0.0, 0.0]) if length < 1e-6 else right / length


def new_plotter(pyvista: Any, size: tuple[int, int] = SIZE) -> Any:
    """A white plotter with light from the upper left behind the camera."""
    plotter = pyvista.Plotter(off_screen=True, window_size=size, lighting="none")
    plotter.set_background("white")
    lamp = {"light_type": "camera light", "intensity": 0.75}
    plotter.add_light(pyvista.Light(position=(-0.7, 0.8, 1.0), focal_point=(0, 0, 0), **lamp))
    plotter.add_light(pyvista.Light(light_type="headlight", intensity=0.35))
    return plotter


def add_rock(plotter: Any, mesh: Any, view: View, **look: Any) -> None:
    """Draw faces of rock with the colours of `look`, its sharp edges, and thin lines of its mesh."""
    lines = {}
    if mesh.n_cells < MOST_LINES:
        lines = {
            "show_edges": True,
            "edge_color": "#333333",
            "edge_opacity": 0.35,
            "line_width": 0.5,
        }
    plotter.add_mesh(mesh, show_scalar_bar=False, smooth_shading=False, **MATTE, **lines, **look)
    _add_edges(plotter, mesh, view)


def add_ground(plotter: Any, mesh: Any, view: View, **look: Any) -> None:
    """Draw faces of static rock, smooth between its sharp edges, without the lines of its mesh."""
    whole = mesh.clean(tolerance=1e-6 * view.height, absolute=True)
    smooth = whole.compute_normals(
        cell_normals=False, split_vertices=True, feature_angle=SHARP, consistent_normals=False
    )
    plotter.add_mesh(smooth, show_scalar_bar=False, smooth_shading=True, **MATTE, **look)
    _add_edges(plotter, whole, view)


def _add_edges(plotter: Any, mesh: Any, view: View) -> None:
    edges = mesh.triangulate().extract_feature_edges(
        feature_angle=SHARP, boundary_edges=True, manifold_edges=False, non_manifold_edges=False
    )
    if edges.n_cells:
        edges.points += LIFT * view.height * view.back  # keeps them out of the faces
        plotter.add_mesh(edges, color="#222222", line_width=1.3, lighting=False)


def take(plotter: Any, view: View, *, occlusion: bool = False) -> Image:
    """The picture of a plotter, which is then closed, shape (height, width, 3).

    Args:
        plotter: The plotter.
        view: The view.
        occlusion: Whether to darken corners and gaps, which takes a second or more.
    """
    view.aim(plotter)
    if occlusion:
        radius = REACH * view.height
        plotter.enable_ssao(radius=radius, bias=BIAS * radius, kernel_size=32, blur=True)
    if SMOOTH:
        plotter.enable_anti_aliasing("ssaa")
    image = plotter.screenshot(return_img=True)
    plotter.close()
    return image


def color(index: int) -> str:
    """One of twelve colours that are easy to tell apart, also without red or green (Tol); they
    repeat."""
    colors = ("4477aa", "ee6677", "228833", "ccbb44", "66ccee", "aa3377", "bbbbbb", "332288",
              "ddcc77", "44aa99", "882255", "999933")  # fmt: skip
    return "#" + colors[index % len(colors)]


def color_map(name: str) -> Any:
    """A colour map of amounts, neutral near zero and pale for small values."""
    import matplotlib
    from matplotlib.colors import ListedColormap, to_rgba

    place = np.linspace(0, 1, 500)
    colors = matplotlib.colormaps[name](place)
    part = np.clip((place - NOTHING) / (BLEND - NOTHING), 0, 1)[:, None]
    part = part * part * (3 - 2 * part)
    return ListedColormap((1 - part) * np.array(to_rgba(NEUTRAL)) + part * colors)


def _font(size: int) -> Any:
    import matplotlib
    from PIL import ImageFont

    return ImageFont.truetype(f"{matplotlib.get_data_path()}/fonts/ttf/DejaVuSans.ttf", size)


def with_title(image: Image, title: str) -> Image:
    """A picture with a title above it, shape (height + TITLE, width, 3)."""
    from PIL import Image as Pictures
    from PIL import ImageDraw

    picture = Pictures.new("RGB", (image.shape[1], len(image) + TITLE), "white")
    picture.paste(Pictures.fromarray(image), (0, TITLE))
    ImageDraw.Draw(picture).text((16, 8), title, fill="black", font=_font(24))
    return np.asarray(picture)


def bar(name: str, unit: str, colors: Any, span: tuple[float, float], width: int) -> Image:
    """A colour bar, shape (3 ROW, width, 3).

    Args:
        name: Name of the coloured field.
        unit: Unit of its values; a prefix is added if that makes them shorter.
        colors: Colour map of matplotlib.
        span: Values at its two ends.
        width: Width of the picture [pixels].
    """
    from matplotlib.ticker import MaxNLocator
    from PIL import Image as Pictures
    from PIL import ImageDraw

    largest = max(abs(value) for value in span)
    power = 3 * int(np.floor(np.log10(largest) / 3)) if largest > 0 and unit not in ("", "1") else 0
    power = power if power in PREFIXES and (abs(power) >= 3 and unit != "m") else 0
    label = name.replace("_", " ") + (f" [{PREFIXES[power]}{unit}]" if unit else "")
    left, length = END, width - 2 * END
    ramp = (255 * colors(np.linspace(0, 1, length))[:, :3]).astype(np.uint8)
    strip = np.full((3 * ROW, width, 3), 255, np.uint8)
    strip[ROW + 2 : 2 * ROW - 6, left : left + length] = ramp
    picture = Pictures.fromarray(strip)
    draw, font = ImageDraw.Draw(picture), _font(18)
    draw.text((left, 2), label, fill="black", font=font)
    low, high = (value / 10.0**power for value in span)
    for tick in MaxNLocator(4).tick_values(low, high):
        place = left + length * (tick - low) / (high - low)
        if left - 0.5 <= place <= left + length + 0.5:
            draw.line((place, 2 * ROW - 6, place, 2 * ROW), fill="black")
            text = f"{tick:g}".replace("-", "\N{MINUS SIGN}")
            draw.text((place, 2 * ROW + 2), text, fill="black", font=font, anchor="ma")
    return np.asarray(picture)


def foot(legend: Image, view: View, width: int, *, north: bool) -> Image:
    """The strip below a picture: scale and directions on the left, a legend in the right half.

    Args:
        legend: At most half as wide as the picture.
        view: View of the picture.
        width: Width of the picture [pixels].
        north: Whether y is north: then a north arrow is drawn, else the three axes.
    """
    from PIL import Image as Pictures
    from PIL import ImageDraw

    picture = Pictures.new("RGB", (width, max(len(legend), 3 * ROW)), "white")
    picture.paste(Pictures.fromarray(legend), (width // 2, 0))
    draw = ImageDraw.Draw(picture)
    single = min(width, SIZE[0])  # the first of several side by side
    _draw_scale(draw, view.metres, single)
    _draw_directions(draw, view, (0.36 * single, 1.7 * ROW), north=north)
    return np.asarray(picture)


def _draw_scale(draw: Any, metres: float, width: int) -> None:
    """A scale bar on the left of a strip, of a round length up to a fifth of the picture."""
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


def _draw_directions(draw: Any, view: View, place: tuple[float, float], *, north: bool) -> None:
    """A north arrow, or arrows along the axes, in the directions of the picture."""
    arrows = [("N", np.array([0.0, 1.0, 0.0]))] if north else zip("xyz", np.eye(3), strict=True)
    for name, way in arrows:
        flat = np.array([way @ view.right, -(way @ view.up)])
        length = float(np.linalg.norm(flat))
        if length < 0.15:  # towards the viewer
            continue
        ahead = flat / length
        side = np.array([-ahead[1], ahead[0]])
        start = np.array(place) - (0.7 * ARROW * ahead if north else 0)
        tip = start + (1.4 * ahead if north else flat) * ARROW
        draw.line((*start, *(tip - 4 * ahead)), fill="black", width=2)
        head = [tip, tip - 9 * ahead + 4 * side, tip - 9 * ahead - 4 * side]
        draw.polygon([tuple(point) for point in head], fill="black")
        draw.text(tuple(tip + 10 * ahead), name, fill="black", font=_font(16), anchor="mm")


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
