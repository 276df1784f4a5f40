"""Output of a screening: maps as GeoTIFF, bodies as a GeoPackage, pictures."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.output.figures import pyplot
from cdem.screening.bodies import Body, Ground
from cdem.screening.fos_map import MODES, FosMap
from cdem.screening.probability import Probability
from cdem.screening.shaking import Shaken
from cdem.terrain.heights import extra

Floats = NDArray[np.float64]

BODIES = "bodies.gpkg"
SHOWN = 10
"""Most bodies in the report."""


def outline(body: Body, ground: Ground) -> Any:
    """Polygon of a body in plan [m], bounded by the intersection of its planes with the ground (shapely)."""
    contourpy, shapely = extra("contourpy"), extra("shapely")
    rows, columns = body.window
    # one more cell on each side, where the planes lie above the ground
    i = np.arange(rows.start - 1, rows.stop + 1)
    j = np.arange(columns.start - 1, columns.stop + 1)
    x, y = ground.x[j], ground.y[i]
    t = ground.grid.values[np.ix_(i, j)] - body.bed(x[None], y[:, None])
    t = np.where(np.pad(body.cells, 1), t, np.minimum(t, -1e-9))
    lines = contourpy.contour_generator(x, y, t).lines(0.0)
    rings = [shapely.make_valid(shapely.Polygon(line)) for line in lines if len(line) >= 4]
    parts = shapely.get_parts(rings)
    return max(parts[shapely.get_type_id(parts) == 3], key=lambda part: part.area)


@dataclass(frozen=True)
class Style:
    """Look of maps in a picture.

    Attributes:
        levels: Limits of the classes.
        colors: Name of the colours in matplotlib.
        label: Label of the colours.
    """

    levels: Sequence[float]
    colors: str
    label: str


FACTOR = Style((0.6, 0.8, 1.0, 1.2, 1.5, 2.0, 3.0), "RdYlGn", "least factor of safety")
SLIP_WORDS = "permanent displacement [m]\n(darkest: or moves without shaking)"
SLIP = Style((0.001, 0.01, 0.05, 0.1, 0.3, 1.0, 3.0), "YlOrRd", SLIP_WORDS)
Map = tuple[str, NDArray, str, str]
"""Name of a file without its ending, values, meaning, unit."""


def maps_of(found: FosMap) -> list[Map]:
    """The maps of a screening."""
    plane = found.profiles.factor
    return [
        ("fos", found.factor, "least factor of safety of bodies", "1"),
        ("fos_volume", found.volume, "volume of that body", "m3"),
        (
            "fos_mode",
            found.mode,
            "1: wedge on both planes, 2: on one of them, 3: one plane, 4: lifts off",
            "1",
        ),
        ("fos_plane", plane, "plane failure per metre of width, free sides", "1"),
    ]


def maps_of_quake(shaken: Shaken) -> list[Map]:
    """The maps of an earthquake."""
    return [
        ("fos_yield", shaken.yields, "least yield acceleration of bodies", "g"),
        ("fos_newmark", shaken.slip, "largest permanent displacement of bodies", "m"),
        ("fos_plane_yield", shaken.plane_yields, "yield acceleration of profiles", "g"),
        ("fos_plane_newmark", shaken.plane_slip, "permanent displacement of profiles", "m"),
    ]


def write_maps(maps: Sequence[Map], ground: Ground, folder: Path, system: str | None) -> list[Path]:
    """Write maps as GeoTIFF; returns their paths.

    Args:
        maps: The maps.
        ground: Their ground.
        folder: Folder to write to.
        system: Map projection, EPSG code or WKT; None for none.
    """
    rasterio = extra("rasterio")
    grid = ground.grid
    (dx, dy), rows = grid.step, grid.values.shape[0]
    place = rasterio.transform.from_origin(
        grid.west - dx / 2, grid.south + (rows - 0.5) * dy, dx, dy
    )
    paths = []
    for name, values, words, unit in maps:
        whole = values.dtype == np.uint8
        paths.append(folder / f"{name}.tif")
        with rasterio.open(
            paths[-1],
            "w",
            driver="GTiff",
            width=values.shape[1],
            height=rows,
            count=1,
            dtype="uint8" if whole else "float32",
            nodata=0 if whole else np.nan,
            crs=system,
            transform=place,
            compress="deflate",
        ) as file:
            file.write(values[::-1].astype("uint8" if whole else "float32"), 1)
            file.set_band_description(1, words)
            file.set_band_unit(1, unit)
    return paths


def write_bodies(
    found: FosMap,
    path: Path,
    system: str | None,
    confirmed: list[float] | None = None,
    shaken: Shaken | None = None,
    chance: Probability | None = None,
) -> Path:
    """Write the outlines of the listed bodies as a GeoPackage; returns its path.

    Args:
        found: The bodies.
        path: The file.
        system: Map projection, EPSG code or WKT; None for none.
        confirmed: Factor of safety by `cdem critical` of the first bodies, nan for none.
        shaken: The earthquake.
        chance: The probability of failure.
    """
    raw, shapely = extra("pyogrio.raw"), extra("shapely")
    bodies = found.bodies
    by_run = np.full(len(bodies), np.nan)
    by_run[: len(confirmed or [])] = confirmed or []
    columns: dict[str, NDArray] = {
        "number": np.arange(1, len(bodies) + 1),
        "planes": np.array([body.name for body in bodies], dtype=object),
        "mode": np.array([MODES[body.kind] for body in bodies], np.int32),
        "fos": np.array([body.factor for body in bodies]),
        "fos_critical": by_run,
        "volume_m3": np.array([body.volume for body in bodies]),
        "area_first_m2": np.array([body.areas[0] for body in bodies]),
        "area_second_m2": np.array([(*body.areas, 0.0)[1] for body in bodies]),
        "x": np.array([body.point[0] for body in bodies]),
        "y": np.array([body.point[1] for body in bodies]),
        "z": np.array([body.point[2] for body in bodies]),
    }
    if shaken is not None:
        columns |= {"yield_g": shaken.listed_yields, "newmark_m": shaken.listed_slips}
    if chance is not None:
        names = ("probability", "mean_fos", "reliability")
        columns |= dict(zip(names, chance.listed.T.copy(), strict=True))
    path.unlink(missing_ok=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a missing map projection is reported elsewhere
        raw.write(
            path,
            geometry=shapely.to_wkb([outline(body, found.ground) for body in bodies]),
            field_data=list(columns.values()),
            fields=list(columns),
            geometry_type="Polygon",
            crs=system,
            layer="bodies",
            driver="GPKG",
        )
    return path


def draw(found: FosMap, path: Path) -> Path:
    """Draw the map over a hillshade, with the worst bodies; beside it, plane failure of profiles.

    Raises:
        CdemError: matplotlib is not installed.
    """
    maps = [("bodies between joints", found.factor)]
    if found.profiles.count:
        maps.append(("plane failure of profiles, sides assumed free", found.profiles.factor))
    return draw_maps(found, maps, path, FACTOR)


def draw_slip(found: FosMap, shaken: Shaken, path: Path) -> Path:
    """Draw permanent displacements of bodies, and of profiles.

    What moves without shaking has the colour of the largest displacements.

    Raises:
        CdemError: matplotlib is not installed.
    """

    def shown(yields: Floats, slip: Floats) -> Floats:
        return np.where(yields <= 0, 10 * SLIP.levels[-1], slip)

    maps = [("bodies between joints", shown(shaken.yields, shaken.slip))]
    if found.profiles.count:
        title = "plane failure of profiles, sides assumed free"
        maps.append((title, shown(shaken.plane_yields, shaken.plane_slip)))
    return draw_maps(found, maps, path, SLIP)


def draw_maps(found: FosMap, maps: Sequence[tuple[str, Floats]], path: Path, style: Style) -> Path:
    """Draw maps over a hillshade side by side, the first with the outlines of the worst bodies.

    Args:
        found: Ground and bodies.
        maps: Title and values of each map, shape (rows, columns).
        path: The PNG.
        style: Their colours.

    Raises:
        CdemError: matplotlib is not installed.
    """
    plt = pyplot()
    ground = found.ground
    rows, columns = ground.grid.values.shape
    height, width = rows * ground.grid.step[1], columns * ground.grid.step[0]
    shape = (len(maps), 1) if width > 1.5 * height else (1, len(maps))
    each = (min(6.0, 6.0 * width / height) + 0.9, min(6.0, 6.0 * height / width) + 0.9)
    size = (each[0] * shape[1] + 1.2, each[1] * shape[0])
    figure, axes = plt.subplots(*shape, figsize=size, squeeze=False, layout="constrained")
    for panel, (title, values) in zip(axes.ravel(), maps, strict=True):
        shown = _draw_map(panel, ground, values, title, style)
    figure.colorbar(shown, ax=axes, shrink=0.75, label=style.label)
    _draw_outlines(axes[0, 0], found)
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return path


def _draw_outlines(axes: Any, found: FosMap) -> None:
    """Outlines and numbers of the worst bodies."""
    from matplotlib.patheffects import withStroke

    for number, body in enumerate(found.bodies[:SHOWN], 1):
        polygon = outline(body, found.ground)
        axes.plot(*np.array(polygon.exterior.coords).T, color="black", lw=0.9)
        style = {"fontsize": 9, "fontweight": "bold", "ha": "center", "va": "center"}
        around = [withStroke(linewidth=2, foreground="white")]
        place = polygon.representative_point()
        axes.text(place.x, place.y, str(number), path_effects=around, **style)


def _draw_map(axes: Any, ground: Ground, values: Floats, title: str, style: Style) -> Any:
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm

    grid = ground.grid
    extent = (grid.low[0], grid.high[0], grid.low[1], grid.high[1])
    light = np.array([-1.0, 1.0, 1.2])  # from the north-west
    shade = ground.normal @ light / np.linalg.norm(ground.normal, axis=-1) / np.linalg.norm(light)
    place: dict[str, Any] = {"origin": "lower", "extent": extent, "interpolation": "nearest"}
    axes.imshow(np.clip(shade, 0, 1), cmap="gray", vmin=-0.1, vmax=1.1, **place)
    colors = colormaps[style.colors]
    norm = BoundaryNorm(style.levels, colors.N, extend="both" if style.levels[0] else "neither")
    shown = axes.imshow(values, cmap=colors, norm=norm, alpha=0.75, **place)
    axes.set(xlabel="x, east [m]", ylabel="y, north [m]", aspect="equal")
    axes.ticklabel_format(style="plain", useOffset=False)
    axes.tick_params(labelsize=8)
    axes.set_title(title, fontsize=10)
    return shown
