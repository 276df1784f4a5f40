"""Rasters and vector layers of a rockfall: reach, 95 % envelopes, stops, tracks."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.output.geopackage import Features, lines, points, write_geopackage
from cdem.output.geotiff import epsg_of, write_geotiff
from cdem.output.map_layers import EARTH, REDS, VIRIDIS, Layer, limits_of, raster_style
from cdem.rockfall.ground import Ground
from cdem.rockfall.result import RUN, Result
from cdem.rockfall.tracks import Cells, cells_of
from cdem.terrain.rasters import Raster

Floats = NDArray[np.float64]
FOLDER = "maps"
LEVEL = 0.95
LAYERS = {
    "passages": Layer("1", "entries of blocks", EARTH),
    "reach_probability": Layer("%", "runs that reach the cell", EARTH, 100.0),
    "height_95": Layer("m", "95 % of the heights of the centre", VIRIDIS),
    "velocity_95": Layer("m/s", "95 % of the velocities", VIRIDIS),
    "energy_95": Layer("kJ", "95 % of the kinetic energies", REDS, 1e-3),
    "energy_max": Layer("kJ", "largest kinetic energy", REDS, 1e-3),
}
"""All rasters, by name."""
APART = 0.1
"""Time between two points of a track in the GeoPackage [s]."""


def rasters_of(result: Result) -> dict[str, Raster]:
    """The rasters, in the order and units of `LAYERS`.

    Cells lie at multiples of their side. Quantiles are over the runs that pass a cell; each run
    counts with its largest value there. With fewer runs than `maps.passes` they are not a number.
    """
    rockfall, ground = result.runs.rockfall, result.runs.ground
    cell = rockfall.cell(ground)
    first, last = np.floor(ground.low / cell), np.ceil(ground.high / cell)
    columns, rows = np.maximum(last - first, 1).astype(int).tolist()
    low = first * cell
    found = [cells_of(track, ground, low, cell, columns) for track in result.tracks]
    values = _values(found, rows * columns, len(found), rockfall.maps.passes)
    return {
        name: Raster(
            float(low[0]), float(low[1]), cell, (values[name] * layer.scale).reshape(rows, columns)
        )
        for name, layer in LAYERS.items()
    }


def _values(found: list[Cells], size: int, runs: int, least: int) -> dict[str, Floats]:
    if not found:
        return {name: np.full(size, np.nan) for name in LAYERS}
    number = np.concatenate([cells.number for cells in found])
    entries = np.concatenate([cells.entries for cells in found])
    count = np.bincount(number, minlength=size)
    passed = count > 0
    values = {
        "passages": np.where(passed, np.bincount(number, entries, size), np.nan),
        "reach_probability": np.where(passed, count / runs, np.nan),
    }
    for name in ("height", "velocity", "energy"):
        of = np.concatenate([getattr(cells, name) for cells in found])
        values[f"{name}_95"] = quantiles(number, of, size, LEVEL, least)
        if name == "energy":
            values["energy_max"] = quantiles(number, of, size, 1.0, 1)
    return values


def quantiles(number: NDArray[np.int64], of: Floats, size: int, level: float, least: int) -> Floats:
    """A quantile in each cell, linear between the values by rank, as `numpy.quantile`.

    Args:
        number: Cell of each value.
        of: The values.
        size: Number of cells.
        level: Fraction below the quantile [1].
        least: Least number of values in a cell; others get not a number.
    """
    ordered = of[np.lexsort((of, number))]
    count = np.bincount(number, minlength=size)
    first = np.cumsum(count) - count
    out = np.full(size, np.nan)
    some = np.flatnonzero(count >= least)
    at = level * (count[some] - 1)
    whole = np.floor(at).astype(int)
    low = ordered[first[some] + whole]
    high = ordered[first[some] + np.minimum(whole + 1, count[some] - 1)]
    out[some] = low + (at - whole) * (high - low)
    return out


def write_maps(result: Result, rasters: Mapping[str, Raster], folder: Path) -> list[Path]:
    """Write a GeoTIFF and a style for QGIS of each raster into the folder `maps`."""
    (folder / FOLDER).mkdir(exist_ok=True)
    crs, least = result.runs.rockfall.system, result.runs.rockfall.maps.passes
    paths = []
    for name, raster in rasters.items():
        layer, path = LAYERS[name], folder / FOLDER / f"{name}.tif"
        tags = {"cdem_quantity": layer.title, "cdem_runs": str(len(result.rows))}
        if name.endswith("_95"):
            tags["cdem_least_passes"] = str(least)
        write_geotiff(path, raster, epsg=epsg_of(crs), name=name, unit=layer.unit, tags=tags)
        path.with_suffix(".qml").write_text(raster_style(layer, limits_of(name, raster.values)))
        paths += [path, path.with_suffix(".qml")]
    return paths


def write_vectors(result: Result, folder: Path) -> Path:
    """Write rockfall.gpkg: starts, stops, tracks and barriers, with styles.

    Raises:
        BackendError: The extra `terrain` is not installed.
    """
    path = folder / "rockfall.gpkg"
    columns = {
        (f"{name}_{unit.replace('/', '_')}" if unit else name): np.array(
            [row[name] for row in result.rows], dtype=object if isinstance(row0, str) else None
        )
        for name, unit in RUN.items()
        for row0 in [result.rows[0][name]]
    }
    tracks = [_thinned(track.samples) for track in result.tracks]
    starts = np.array([track.places[0] for track in result.tracks])
    stops = np.array([track.places[-1] for track in result.tracks])
    layers = [
        points("stops", stops, columns, "#d62728"),
        points("starts", starts, {"run": columns["run"]}, "#1f77b4"),
        lines("tracks", tracks, columns, "#7f7f7f"),
        *_barriers(result, result.runs.ground),
    ]
    write_geopackage(path, layers, result.runs.rockfall.system)
    return path


def _thinned(samples: Floats) -> Floats:
    """Places of a track at intervals of time, and its end."""
    number = np.unique(np.floor(samples[:, 0] / APART + 1e-9).astype(int), return_index=True)[1]
    kept = np.append(number, len(samples) - 1)
    places = samples[kept, 1:4]
    return places if len(places) > 1 else np.repeat(places, 2, axis=0)


def _barriers(result: Result, ground: Ground) -> list[Features]:
    found = result.barriers
    if not found:
        return []
    columns = {
        "barrier": np.array([b.barrier.name for b in found], dtype=object),
        "runs": np.array([b.reached for b in found]),
        "passages": np.array([len(b.run) for b in found]),
        **{
            f"{name}_95_{unit}": np.array(
                [b.quantiles(name)[1].value if b.reached else np.nan for b in found]
            )
            for name, unit in (("top", "m"), ("velocity", "m_s"), ("energy", "J"))
        },
    }
    return [lines("barriers", [np.array(b.barrier.line) for b in found], columns, "#2ca02c")]
