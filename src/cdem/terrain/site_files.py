"""Files of `cdem site`: rasters, the outline, the landslide file and a case to start from."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.terrain.heights import Grid, extra
from cdem.terrain.landslide import Landslide
from cdem.terrain.plan import Plan
from cdem.terrain.projection import name_of
from cdem.terrain.rasters import NOTHING
from cdem.terrain.slbl import OnTriangles

Floats = NDArray[np.float64]
BETWEEN = (
    0.8,
    2.0,
)  # an unbroken body rests on a curved bed at a higher factor than the columns
GROUP = "slide"
FRICTION, COHESION, DENSITY, GRAVITY = 25.0, 0.0, 2600.0, 9.81
"""Assumptions of the cases for the sliding surface [deg], [Pa], and for the rock [kg/m3]."""


def write_raster(path: Path, grid: Grid, crs: Any | None) -> Path:
    """Write a GeoTIFF of 32-bit heights [m].

    Args:
        path: The file.
        grid: Heights; NaN for missing data.
        crs: Its projection, or None.
    """
    rasterio = extra("rasterio")
    rows, columns = grid.values.shape
    head = {
        "driver": "GTiff", "width": columns, "height": rows, "count": 1, "dtype": "float32",
        "nodata": NOTHING, "compress": "deflate", "predictor": 3,
        "transform": extra("rasterio.transform").from_origin(grid.low[0], grid.high[1], *grid.step),
    }  # fmt: skip
    if crs is not None:
        head["crs"] = extra("rasterio.crs").CRS.from_wkt(crs.to_wkt())
    values = np.where(np.isfinite(grid.values), grid.values, NOTHING)[::-1]
    with rasterio.open(path, "w", **head) as file:
        file.write(values.astype(np.float32), 1)
        file.units = ("metre",)
    return path


def write_outline(path: Path, ring: Floats, volume: float | None, crs: Any | None) -> Path:
    """Write a GeoPackage with the layer `outline`: one polygon, its group and its volume [m3]."""
    shapely = extra("shapely")
    raw = extra("pyogrio.raw")
    path.unlink(missing_ok=True)
    fields = [np.array([GROUP], object)] + ([] if volume is None else [np.array([volume])])
    names = ["group", "volume_m3"][: len(fields)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about a missing projection
        raw.write(
            path,
            np.array([shapely.to_wkb(shapely.Polygon(ring))]),
            fields,
            names,
            layer="outline",
            geometry_type="Polygon",
            crs=None if crs is None else crs.to_wkt(),
            driver="GPKG",
        )
    return path


def bed_on_grid(plan: Plan, grid: Grid) -> Grid:
    """The sliding surface at the points of a grid; NaN outside bodies."""
    shapely = extra("shapely")
    rows, columns = grid.values.shape
    x = grid.west + grid.step[0] * np.arange(columns)
    y = grid.south + grid.step[1] * np.arange(rows)
    xy = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    triangles = plan.triangles[plan.body >= 0]
    corners = plan.points[triangles]
    body = shapely.union_all(shapely.polygons(np.concatenate([corners, corners[:, :1]], axis=1)))
    inside = shapely.contains_xy(body, xy)
    z = np.full(len(xy), np.nan)
    if inside.any():
        z[inside] = OnTriangles(plan.points, triangles, plan.bed)(xy[inside])
    return Grid(grid.west, grid.south, grid.step, z.reshape(rows, columns))


def landslide_text(
    title: str, low: Floats, high: Floats, base: float, crs: Any | None, surface: dict | None
) -> str:
    """The landslide file without its sizes."""
    lines = [
        "# Written by cdem site; edit it, then: cdem mesh landslide.yaml -o landslide.msh",
        f"title: {_quoted(title)}",
    ]
    if crs is not None:
        lines.append(f"crs: {_quoted(name_of(crs))}")
    lines += [
        "terrain: {grid: dem.tif}",
        f"extent: {{x: [{low[0]:.2f}, {high[0]:.2f}], y: [{low[1]:.2f}, {high[1]:.2f}], "
        f"base: {base:g}}}",
    ]
    if surface is None:
        lines += [
            "# choose a sliding surface, then remove the #; see docs/terrain.md",
            '# surface: {slbl: {depth: "60 m"}}',
            f"# bodies: [{{group: {GROUP}, outline: {{file: site.gpkg, layer: outline}}}}]",
        ]
    else:
        lines += [
            f"surface: {_flow(surface)}",
            f"bodies: [{{group: {GROUP}, outline: {{file: site.gpkg, layer: outline}}}}]",
        ]
    return "\n".join(lines) + "\n"


def sizes_text(size: float, far: float) -> str:
    """The last line of a landslide file."""
    return f"sizes: {{body: {size:g}, far: {far:g}}}   # ASSUMED: halve body to see its effect\n"


def between_text(factor: float) -> str:
    """Factors at which a search may begin, from the factor of the columns."""
    if not np.isfinite(factor):
        return "RESTS FAILS"
    return " ".join(f"{part * factor:.2f}" for part in BETWEEN)


STAGES = {
    "case": """  - name: slide
    mode: dynamic
    duration: "20 s"   # ASSUMED: until it rests
    reset_displacement: true
    damping: {contact: 0.1, stiffness: 0.1}   # ASSUMED
""",
    "safety": """  - name: decide
    mode: static
    reset_displacement: true
""",
}
"""The last stage of the two cases: the slide, and the test whether the body rests."""


def case_text(kind: str, title: str, landslide: Landslide, facts: dict[str, Any]) -> str:
    """A case in which the body is one block on its bed.

    Args:
        kind: "case" to let it slide, "safety" for `cdem critical`.
        title: One line.
        landslide: Names and extent.
        facts: Factor of safety by columns.
    """
    low, high = (np.array([s[k] for s in (landslide.extent.x, landslide.extent.y)]) for k in (0, 1))
    (west, south), (east, north) = low - landslide.sizes.far, high + landslide.sizes.far
    between = between_text(facts["factor"])
    how = {
        "case": "cdem check case.yaml; cdem run case.yaml; cdem runout case.results",
        "safety": f"cdem critical safety.yaml --factor --between {between}",
    }[kind]
    crs = f"crs: {_quoted(landslide.system)}\n" if landslide.system else ""
    rock = landslide.bedrock
    return f"""# Written by cdem site; needs the mesh: cdem mesh landslide.yaml -o landslide.msh
#
#   {how}
#
# Values marked ASSUMED are not measured; cdem check lists them.
cdem: 2
title: {_quoted(title)}
{crs}units: SI
model:
  mesh: landslide.msh
  # one: a single block that deforms; elements: it may break between all elements (then give the
  # pair [{GROUP}, {GROUP}] strengths of its own)
  split: {{{rock}: one, {GROUP}: one}}
  domain: {{min: [{west:.2f}, {south:.2f}, null], max: [{east:.2f}, {north:.2f}, null]}}
materials:
  rock: {{density: {DENSITY:g}, young_modulus: "5 GPa", poisson_ratio: 0.25}}   # ASSUMED
groups:
  {rock}: {{material: rock, fix: [x, y, z]}}
  {GROUP}: {{material: rock}}
interfaces:
  # bonded while its weight settles; the last stage releases it
  default: {{friction_angle: "{FRICTION:g} deg", cohesion: "100 MPa", tensile_strength: "100 MPa"}}   # ASSUMED
  pairs:
    - {{name: bed, between: [{rock}, {GROUP}]}}   # friction as in default
loads: {{gravity: [0, 0, -{GRAVITY:g}]}}
stages:
  - {{name: settle, mode: static, tolerance: 1e-4}}
{STAGES[kind]}    set:
      interfaces.bed.cohesion: {COHESION:g}   # ASSUMED
      interfaces.bed.tensile_strength: 0   # ASSUMED
      interfaces.default.cohesion: 0
      interfaces.default.tensile_strength: 0
output: {{every: 0.5}}
histories:
  - {{name: {GROUP}, group: {GROUP}, quantities: [centroid, displacement, velocity]}}
"""


def _quoted(text: str) -> str:
    """Text of one line as YAML."""
    return json.dumps(" ".join(text.split()), ensure_ascii=False)


def _flow(data: Any) -> str:
    """Plain data as YAML on one line."""
    return json.dumps(data, ensure_ascii=False)
