"""Output of a screening: maps as GeoTIFF, bodies as a GeoPackage, a picture, and a report as text."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.joints.survey import plane_text
from cdem.output.figures import pyplot
from cdem.screening.bodies import Body, Ground
from cdem.screening.fos_map import MODES, FosMap
from cdem.screening.planes import JointPlane
from cdem.terrain.heights import extra
from cdem.units import coordinates

Floats = NDArray[np.float64]

WORDS = {
    "both": "slides on both planes",
    "first": "slides on one of two planes",
    "second": "slides on one of two planes",
    "plane": "slides on a single plane",
}
BODIES = "bodies.gpkg"
SHOWN = 10
"""Most bodies in the report."""
LEVELS = (0.6, 0.8, 1.0, 1.2, 1.5, 2.0, 3.0)
"""Classes of the factor of safety in the picture."""


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


def write_maps(found: FosMap, folder: Path, system: str | None) -> list[Path]:
    """Write the maps as GeoTIFF; returns their paths.

    Args:
        found: The maps.
        folder: Folder to write to.
        system: Map projection, EPSG code or WKT; None for none.
    """
    rasterio = extra("rasterio")
    grid = found.ground.grid
    (dx, dy), rows = grid.step, grid.values.shape[0]
    place = rasterio.transform.from_origin(
        grid.west - dx / 2, grid.south + (rows - 0.5) * dy, dx, dy
    )
    maps: list[tuple[str, NDArray, str, str]] = [
        ("fos", found.factor, "least factor of safety of bodies", "1"),
        ("fos_volume", found.volume, "volume of that body", "m3"),
        ("fos_mode", found.mode, "1: wedge on both planes, 2: on one of them, 3: one plane", "1"),
        ("fos_plane", found.profiles.factor, "plane failure per metre of width, free sides", "1"),
    ]
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
    found: FosMap, path: Path, system: str | None, confirmed: list[float] | None = None
) -> Path:
    """Write the outlines of the listed bodies as a GeoPackage; returns its path.

    Args:
        found: The bodies.
        path: The file.
        system: Map projection, EPSG code or WKT; None for none.
        confirmed: Factor of safety by `cdem critical` of the first bodies, nan for none.
    """
    raw, shapely = extra("pyogrio.raw"), extra("shapely")
    bodies = found.bodies
    by_run = np.full(len(bodies), np.nan)
    by_run[: len(confirmed or [])] = confirmed or []
    columns: dict[str, NDArray] = {
        "number": np.arange(1, len(bodies) + 1),
        "planes": np.array([body.name for body in bodies], dtype=object),
        "mode": np.array([MODES[body.sliding.kind] for body in bodies], np.int32),
        "fos": np.array([body.factor for body in bodies]),
        "fos_critical": by_run,
        "volume_m3": np.array([body.volume for body in bodies]),
        "area_first_m2": np.array([body.areas[0] for body in bodies]),
        "area_second_m2": np.array([(*body.areas, 0.0)[1] for body in bodies]),
        "x": np.array([body.point[0] for body in bodies]),
        "y": np.array([body.point[1] for body in bodies]),
        "z": np.array([body.point[2] for body in bodies]),
    }
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
    plt = pyplot()
    ground, profiles = found.ground, found.profiles
    rows, columns = ground.grid.values.shape
    height, width = rows * ground.grid.step[1], columns * ground.grid.step[0]
    panels = 2 if profiles.count else 1
    shape = (panels, 1) if width > 1.5 * height else (1, panels)
    each = (min(6.0, 6.0 * width / height) + 0.9, min(6.0, 6.0 * height / width) + 0.9)
    size = (each[0] * shape[1] + 1.2, each[1] * shape[0])
    figure, axes = plt.subplots(*shape, figsize=size, squeeze=False, layout="constrained")
    titles = ["bodies between joints", "plane failure of profiles, sides assumed free"]
    maps = (found.factor, profiles.factor)
    for panel, values, title in zip(axes.ravel(), maps, titles, strict=False):
        shown = _draw_map(panel, ground, values, title)
    figure.colorbar(shown, ax=axes, shrink=0.75, label="least factor of safety", extend="both")
    from matplotlib.patheffects import withStroke

    for number, body in enumerate(found.bodies[:SHOWN], 1):
        polygon = outline(body, ground)
        axes[0, 0].plot(*np.array(polygon.exterior.coords).T, color="black", lw=0.9)
        style = {"fontsize": 9, "fontweight": "bold", "ha": "center", "va": "center"}
        around = [withStroke(linewidth=2, foreground="white")]
        place = polygon.representative_point()
        axes[0, 0].text(place.x, place.y, str(number), path_effects=around, **style)
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return path


def _draw_map(axes: Any, ground: Ground, values: Floats, title: str) -> Any:
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm

    grid = ground.grid
    extent = (grid.low[0], grid.high[0], grid.low[1], grid.high[1])
    light = np.array([-1.0, 1.0, 1.2])  # from the north-west
    shade = ground.normal @ light / np.linalg.norm(ground.normal, axis=-1) / np.linalg.norm(light)
    style = {"origin": "lower", "extent": extent, "interpolation": "nearest"}
    axes.imshow(np.clip(shade, 0, 1), cmap="gray", vmin=-0.1, vmax=1.1, **style)
    colors = colormaps["RdYlGn"]
    norm = BoundaryNorm(LEVELS, colors.N, extend="both")
    shown = axes.imshow(values, cmap=colors, norm=norm, alpha=0.75, **style)
    axes.set(xlabel="x, east [m]", ylabel="y, north [m]", aspect="equal")
    axes.ticklabel_format(style="plain", useOffset=False)
    axes.tick_params(labelsize=8)
    axes.set_title(title, fontsize=10)
    return shown


def text(
    found: FosMap, planes: Sequence[JointPlane], notes: Sequence[str], system: str | None
) -> str:
    """The results as text."""
    limits, grid = found.limits, found.ground.grid
    rows, columns = grid.values.shape
    lines = [f"note: {note}" for note in notes]
    if system is None:
        lines.append("note: the ground has no map projection, so the maps have none")
    lines.append(
        f"{rows} x {columns} cells of {grid.step[0]:g} m; volumes from {limits.smallest:g} to "
        f"{limits.largest:g} m3; {limits.unit_weight / 1e3:.1f} kN/m3, dry"
    )
    for plane in planes:
        lines.append(
            f"  {plane.name}: {plane_text(plane.dip, plane.dip_direction)}, friction "
            f"{plane.friction:.1f} deg, cohesion {plane.cohesion / 1e3:g} kPa, persistence "
            f"{plane.persistence:g}"
        )
    lines.append(
        f"{found.count:,} bodies at {found.tried:,} points; they cover "
        f"{100 * np.isfinite(found.factor).mean():.1f} % of the map; {found.profiles.count:,} profiles "
        "of plane failure"
    )
    if found.count and found.at_limit > 0.5 * found.count:
        share = 100 * found.at_limit / found.count
        lines.append(
            f"note: {share:.0f} % of the bodies are near the largest volume, which limits "
            f"the result"
        )
    if found.bodies:
        lines.append("  no.     factor  volume [m3]  planes, mode, and point where they daylight")
    for number, body in enumerate(found.bodies[:SHOWN], 1):
        lines.append(
            f"  {number:3}  {body.factor:9.3f}  {body.volume:11,.0f}  {body.name}, "
            f"{WORDS[body.sliding.kind]}, ({coordinates(body.point.round(1))})"
        )
    left = len(found.bodies) - SHOWN
    return "\n".join([*lines, f"  ... and {left} more in bodies.gpkg"] if left > 0 else lines)


def facts(found: FosMap) -> dict[str, Any]:
    """The results, ready for JSON."""
    return {
        "bodies_found": found.count,
        "points": found.tried,
        "covered": float(np.isfinite(found.factor).mean()),
        "profiles": found.profiles.count,
        "bodies": [
            {
                "planes": body.name,
                "mode": MODES[body.sliding.kind],
                "fos": body.factor,
                "volume": body.volume,
                "areas": list(body.areas),
                "point": body.point.tolist(),
            }
            for body in found.bodies
        ],
    }
