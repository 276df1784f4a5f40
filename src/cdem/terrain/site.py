"""From a DEM and an outline, in any projection and format, to the files of a landslide (`cdem site`)."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cdem.case.map_system import look_up, unfit
from cdem.errors import CaseError
from cdem.terrain import site_files
from cdem.terrain.columns import columns_of, ordinary
from cdem.terrain.features import read_features
from cdem.terrain.files import read_outline
from cdem.terrain.heights import Grid, extra
from cdem.terrain.landslide import Landslide
from cdem.terrain.plan import Plan, make_plan
from cdem.terrain.projection import (
    NOT_TRUE,
    WGS84,
    Projection,
    horizontal,
    moved,
    short_name,
    stretch,
    utm_zone,
)
from cdem.terrain.resample import Wanted, filled, label_of, read_heights

Floats = NDArray[np.float64]
ACROSS = 15  # default number of elements across a body
FAR = 4.0  # size of far elements over the size in the body
BEYOND = 3  # least number of elements between a body and the edge of the terrain


@dataclass
class Question:
    """The input of `cdem site`.

    Attributes:
        dem: File of the ground.
        outline: File of the outline.
        folder: Folder to write to.
        surface: Mapping under `surface` of the landslide file; None: write the ground alone.
        crs: Projection to work in; by default as the DEM, or the UTM zone.
        dem_crs, outline_crs: Projections of the files; they override the files.
        layer, where: Select a layer and features of the outline.
        cell: Cell of the DEM [m]; by default its own.
        size: Size of the elements in the body [m]; by default a fifteenth of its width.
        margin: Terrain around the outline, as a multiple of its longer side.
        fill: Longest distance over which gaps of the DEM are filled [m], or "all".
        unit: Unit of the heights; overrides the file.
        classes: Points of a cloud to use.
        cut: Cut the outline off at the edge of the DEM.
    """

    dem: Path
    outline: Path
    folder: Path
    surface: dict[str, Any] | None = None
    crs: str | None = None
    dem_crs: str | None = None
    outline_crs: str | None = None
    layer: str | None = None
    where: dict[str, str] = field(default_factory=dict)
    cell: float | None = None
    size: float | None = None
    margin: float = 0.5
    fill: float | Literal["all"] = 200.0
    unit: str | None = None
    classes: str = "ground"
    cut: bool = False


@dataclass
class Site:
    """The results of `cdem site`.

    Attributes:
        facts: Numbers by name, SI and degrees.
        notes: A line for each step.
        files: Files written.
        ground: Heights of the ground.
        ring: Corners of the outline [m], shape (corners, 2).
        bed: Heights of the sliding surface, NaN outside the body; None if none was chosen.
    """

    facts: dict[str, Any]
    notes: list[str]
    files: list[Path]
    ground: Grid
    ring: Floats
    bed: Grid | None = None


@dataclass
class Ground:
    """The ground and the outline in metres.

    Attributes:
        grid: Heights.
        ring: Corners of the outline [m].
        projection: Their projection.
        low, high: Corners of the rectangle to mesh [m].
        size: Size of the elements in the body [m].
    """

    grid: Grid
    ring: Floats
    projection: Projection
    low: Floats
    high: Floats
    size: float


def make_site(question: Question) -> Site:
    """Read, project, clip and fill; find the sliding surface; write the folder.

    Raises:
        CaseError: A file cannot be read, has a wrong projection, or does not cover the outline.
    """
    ground = _ground(question)
    folder = question.folder
    folder.mkdir(parents=True, exist_ok=True)
    crs = ground.projection.target
    files = [
        site_files.write_raster(folder / "dem.tif", ground.grid, crs),
        site_files.write_outline(folder / "site.gpkg", ground.ring, None, crs),
    ]
    facts = _facts_of_ground(ground)
    notes = ground.projection.notes
    title = question.outline.stem
    surface = question.surface
    text = site_files.landslide_text(
        title, ground.low, ground.high, _base(ground, surface), crs, surface
    )
    text += site_files.sizes_text(ground.size, _far(ground))
    landslide_file = folder / "landslide.yaml"
    landslide_file.write_text(text)
    files.append(landslide_file)
    if surface is None:
        return Site(facts, notes, files, ground.grid, ground.ring)
    landslide = Landslide.load(landslide_file)
    plan = make_plan(landslide)
    notes += [note for note in plan.notes if note not in notes]
    facts |= facts_of_body(plan)
    bed = site_files.bed_on_grid(plan, ground.grid)
    depth = Grid(bed.west, bed.south, bed.step, ground.grid.values - bed.values)
    site_files.write_outline(folder / "site.gpkg", ground.ring, facts["volume"], crs)
    files += [
        site_files.write_raster(folder / "surface.tif", bed, crs),
        site_files.write_raster(folder / "depth.tif", depth, crs),
    ]
    for kind in site_files.STAGES:
        case = folder / f"{kind}.yaml"
        case.write_text(site_files.case_text(kind, title, landslide, facts))
        files.append(case)
    return Site(facts, notes, files, ground.grid, ground.ring, bed)


def facts_of_body(plan: Plan) -> dict[str, Any]:
    """Volume, depth, area, and the factor of safety of the starter case."""
    columns = columns_of(plan)
    factor, azimuth = ordinary(
        columns, site_files.FRICTION, site_files.COHESION, site_files.DENSITY * site_files.GRAVITY
    )
    return {
        "volume": float(columns.volume.sum()),
        "area": float(columns.area.sum()),
        "depth": float(np.nanmax(plan.ground - plan.bed)),
        "factor": factor,
        "direction": azimuth,
    }


def _facts_of_ground(ground: Ground) -> dict[str, Any]:
    rows, columns = ground.grid.values.shape
    crs = ground.projection.target
    return {
        "crs": short_name(crs) if crs is not None else None,
        "cells": [columns, rows],
        "cell": list(ground.grid.step),
        "lowest": float(np.nanmin(ground.grid.values)),
        "highest": float(np.nanmax(ground.grid.values)),
        "size": ground.size,
    }


# ------------------------------------------------------------------ reading


def _ground(question: Question) -> Ground:
    projection = Projection(_target(question))
    ring, notes = read_outline(
        question.outline,
        question.layer,
        question.where,
        lambda label, xy: projection.bring(question.outline, label, question.outline_crs, xy),
    )
    projection.tell(*notes)
    if projection.target is not None:
        _tell_stretch(projection, ring)
    shapely = extra("shapely")
    polygon = shapely.Polygon(ring)
    size = question.size or _round(math.sqrt(polygon.area) / ACROSS)
    low, high = ring.min(axis=0), ring.max(axis=0)
    margin = max(question.margin * float((high - low).max()), (BEYOND + 1) * size)
    grid = _grid(question, projection, ring, (low - margin, high + margin))
    step = np.array(grid.step)
    # bilinear heights need points on all sides
    inner_low = np.maximum(grid.low + step / 2, low - margin)
    inner_high = np.minimum(grid.high - step / 2, high + margin)
    ring = _within(
        question, ring, inner_low + BEYOND * size, inner_high - BEYOND * size, projection
    )
    return Ground(grid, ring, projection, inner_low, inner_high, size)


def _grid(question: Question, projection: Projection, ring: Floats, box: Any) -> Grid:
    wanted = Wanted(
        box,
        question.dem_crs,
        question.cell,
        question.unit,
        classes=question.classes,
    )
    grid = read_heights(question.dem, projection, wanted)
    grid, notes = filled(question.dem, grid, question.fill, [ring])
    projection.tell(*notes)
    if np.isnan(grid.values).any():
        raise CaseError(
            f"{question.dem}: has gaps wider than --fill {question.fill}; give a larger value, or "
            f"all"
        )
    return grid


def _target(question: Question) -> Any | None:
    """The projection to work in."""
    if question.crs is not None:
        system = look_up(question.crs)
        if why := unfit(system):
            raise CaseError(f"--crs {question.crs}: {why}")
        return system
    label = question.dem_crs or label_of(question.dem)
    system = None if label is None else look_up(label)
    if system is not None and not unfit(system):
        return horizontal(system)
    found = read_features(question.outline, question.layer, question.where)
    own = question.outline_crs or found.label
    if (
        own is None
        and question.outline.suffix.lower() in (".geojson", ".json")
        and system is not None
    ):
        own = WGS84
    if own is None and system is None:
        return None
    if own is None:
        raise CaseError(f"{question.outline}: names no projection; give --outline-crs or --crs")
    if system is None:
        raise CaseError(f"{question.dem}: names no projection; give it with --dem-crs")
    corners, _ = read_outline(question.outline, question.layer, question.where)
    return utm_zone(*moved(corners, look_up(own), look_up(WGS84)).mean(axis=0).tolist())


def _tell_stretch(projection: Projection, ring: Floats) -> None:
    target: Any = projection.target
    scale = stretch(ring, target)
    note = (
        f"{short_name(target)} ({target.name}): lengths differ from lengths on the ground by "
        f"{scale:+.1e}"
    )
    if abs(scale) > NOT_TRUE:
        note += "; use the projection of the land survey, or another UTM zone"
    projection.tell(note)


def _within(
    question: Question, ring: Floats, low: Floats, high: Floats, projection: Projection
) -> Floats:
    """The outline, which must lie in the terrain; or its part in the terrain, on request."""
    shapely = extra("shapely")
    polygon, frame = shapely.Polygon(ring), shapely.box(*low, *high)
    if frame.covers(polygon):
        return ring
    parts = shapely.get_parts(polygon.intersection(frame))
    kept = max(parts, key=lambda part: part.area) if len(parts) else shapely.Polygon()
    lost = 1 - kept.area / polygon.area
    if not question.cut or lost > 0.99:
        raise CaseError(
            f"{question.outline}: {lost:.1%} of the outline lies beyond the terrain of "
            f"{question.dem.name}, or within {BEYOND} elements of its edge; use a larger DEM"
            + ("" if lost > 0.99 else ", or accept the cut with --cut")
        )
    wall = kept.exterior.intersection(frame.exterior).length
    projection.tell(
        f"{question.outline.name}: {lost:.1%} of the outline is cut off at the edge of the "
        f"terrain, "
        f"along {wall:,.0f} m"
    )
    return shapely.get_coordinates(kept.exterior)[:-1]


def _base(ground: Ground, surface: dict[str, Any] | None) -> float:
    """A flat base well below the ground, and below a base level of the given depth or volume."""
    lowest = float(np.nanmin(ground.grid.values))
    relief = float(np.nanmax(ground.grid.values)) - lowest
    by = (surface or {}).get("slbl") or {}
    area = extra("shapely").Polygon(ground.ring).area
    # a paraboloid is twice as deep as its mean; others somewhat more
    depth = by.get("depth") or 3 * (by.get("volume") or 0.0) / area
    deep = max(0.3 * relief, depth) if isinstance(depth, int | float) else 0.3 * relief
    unit = 10.0 ** max(0, math.floor(math.log10(max(relief, 1.0))) - 1)
    return math.floor((lowest - deep - 2 * _far(ground)) / unit) * unit


def _far(ground: Ground) -> float:
    return min(FAR * ground.size, 0.5 * float((ground.high - ground.low).min()))


def _round(length: float) -> float:
    """A length in two digits."""
    return round(length, 1 - math.floor(math.log10(length)))


def surface_of(
    folder: Path,
    depth: float | None,
    volume: float | None,
    given: str | None,
) -> dict[str, Any] | None:
    """The sliding surface from the options of the command, as in a landslide file.

    Args:
        folder: Folder of the landslide file; its paths start there.
        depth: Greatest depth of a sloping local base level [m].
        volume: Its volume [m3].
        given: A file of heights, or a mapping as under `surface`.

    Raises:
        CaseError: More than one is given, or the mapping is invalid.
    """
    options = [o for o in (depth, volume, given) if o is not None]
    if len(options) > 1:
        raise CaseError("give one of --depth, --volume and --surface")
    if depth is not None:
        return {"slbl": {"depth": depth}}
    if volume is not None:
        return {"slbl": {"volume": volume}}
    if given is None:
        return None
    if given.lstrip().startswith("{"):
        from cdem.case.yaml_text import parse

        data = parse(given, "--surface")
        if not isinstance(data, dict):
            raise CaseError(f"--surface: a mapping is needed, e.g. '{{plane: ...}}', got {given}")
        return data
    if not Path(given).is_file():
        raise CaseError(f"--surface {given}: no such file; or write a mapping, '{{plane: ...}}'")
    return {"grid": os.path.relpath(given, folder)}
