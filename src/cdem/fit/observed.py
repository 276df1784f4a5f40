"""Observations as vectors, and the same vector of any run."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.map_system import look_up
from cdem.errors import CaseError
from cdem.fit.fitting import Fit
from cdem.fit.schema import OfFront, OfOutline, OfResult, OfRunout, OfThickness
from cdem.joints.tables import number, read_table
from cdem.output.deposit import Deposit
from cdem.output.mapped import read_outline
from cdem.output.runout_result import RunOut
from cdem.terrain.heights import extra
from cdem.terrain.projection import Projection
from cdem.terrain.rasters import Raster, read_grid
from cdem.terrain.schema import OutlineFile

Floats = NDArray[np.float64]
Row = dict[str, Any]

PER_LENGTH = 3
"""Points of an outline in a length over which errors are alike."""
MOST_POINTS = 400
"""Most points of one observation."""
ALIKE = 0.2
"""Default length over which errors are alike, over the diagonal of the box of an observation."""
SUBCELLS = 8
"""Most points along the side of an observed cell at which a run's thickness is read."""


@dataclass
class Observed:
    """One observation.

    Attributes:
        name: Its name in tables.
        unit: Unit of its values.
        values: Observed values, shape (size,).
        covariance: Of the errors of observation and model, shape (size, size).
        of_run: The same values of a run, from its row of the table and its run-out.
        needs_folder: Whether the run-out of a run is needed.
        at: Abscissa or places of the values, for pictures; shape (size,) or (size, 2) [m].
        notes: Messages for the user.
    """

    name: str
    unit: str
    values: Floats
    covariance: Floats
    of_run: Callable[[Row, RunOut | None], Floats]
    needs_folder: bool
    at: Floats | None = None
    notes: list[str] = field(default_factory=list)

    @property
    def deviation(self) -> float:
        """Standard deviation of a value."""
        return float(np.sqrt(np.diag(self.covariance).mean()))


def observed(fit: Fit, crs: str | None) -> list[Observed]:
    """The observations of a fit.

    Args:
        fit: The fit.
        crs: Projection of the case; None if unknown.

    Raises:
        CaseError: A file cannot be read, or a value is wrong.
    """
    found = []
    for place, part in enumerate(fit.observed):
        if isinstance(part, OfResult):
            found.append(_number(part.result, part.value, part.deviation))
        elif isinstance(part, OfRunout):
            found.append(_measure(fit, place, part))
        elif isinstance(part, OfOutline):
            found.append(_outline(fit, part, crs))
        elif isinstance(part, OfThickness):
            found.append(_thickness(part, fit.path_of(part.thickness)))
        else:
            found.append(_front(part, fit.path_of(part.front)))
    return found


def _number(name: str, value: float, deviation: float) -> Observed:
    def of_run(row: Row, found: RunOut | None) -> Floats:
        value = row.get(name)
        return np.array([math.nan if value is None else float(value)])

    return Observed(name, "", np.array([value]), np.array([[deviation**2]]), of_run, False)


def _measure(fit: Fit, place: int, part: OfRunout) -> Observed:
    def of_run(row: Row, found: RunOut | None) -> Floats:
        assert found is not None
        value: Any = found.as_dict()
        for key in part.runout.split("."):
            value = value.get(key) if isinstance(value, dict) else None
        if isinstance(value, bool) or not isinstance(value, int | float | np.number):
            raise fit.error(
                ("observed", place, "runout"), f"{part.runout} is no number of runout.json"
            )
        return np.array([float(value)])

    name = part.runout
    variance = np.array([[part.deviation**2]])
    return Observed(name, "", np.array([part.value]), variance, of_run, True)


def _outline(fit: Fit, part: OfOutline, crs: str | None) -> Observed:
    """Distance of the edge of the affected area beyond points of the mapped edge [m]."""
    shapely = extra("shapely", "reading a mapped outline")
    projection = Projection(None if crs is None else look_up(crs))
    by = part.outline if isinstance(part.outline, OutlineFile) else OutlineFile(file=part.outline)
    path = fit.path_of(by.file)
    area = read_outline(path, projection, layer=by.layer, where=by.where, told=by.crs)
    length = part.length or ALIKE * _diagonal(area.bounds)
    edge = shapely.boundary(area)
    count = int(np.clip(round(edge.length / length * PER_LENGTH), 8, MOST_POINTS))
    along = (np.arange(count) + 0.5) / count * edge.length
    at = shapely.get_coordinates(shapely.line_interpolate_point(edge, along))

    def of_run(row: Row, found: RunOut | None) -> Floats:
        assert found is not None
        return distance_beyond(found.maps.affected, at)

    covariance = part.deviation**2 * _correlation(at, length)
    notes = [f"{path}: {note}" for note in projection.notes]
    return Observed("outline", "m", np.zeros(count), covariance, of_run, True, at, notes)


def distance_beyond(met: Raster, at: Floats) -> Floats:
    """Distance of points inside the edge of an area [m]; negative outside.

    Args:
        met: Finite in the cells of the area, nan elsewhere.
        at: Points, shape (points, 2) [m].
    """
    ndimage = extra("scipy.ndimage", "comparing an outline")
    low = np.floor((at.min(axis=0) - (met.x, met.y)) / met.cell).astype(int) - 2
    high = np.ceil((at.max(axis=0) - (met.x, met.y)) / met.cell).astype(int) + 2
    rows, columns = met.values.shape
    before = np.maximum(-low, 1)
    after = np.maximum(high - (columns, rows), 1)
    inside = np.pad(np.isfinite(met.values), [(before[1], after[1]), (before[0], after[0])])
    apart = ndimage.distance_transform_edt(inside) - ndimage.distance_transform_edt(~inside)
    apart = (apart - 0.5 * np.sign(apart)) * met.cell
    place = (at - (met.x, met.y)) / met.cell - 0.5 + before
    return ndimage.map_coordinates(apart, place[:, ::-1].T, order=1, mode="nearest")


def _thickness(part: OfThickness, path: Path) -> Observed:
    """Thickness of the deposit in cells of a grid [m]."""
    grid = read_grid(path)
    known = np.argwhere(np.isfinite(grid.values))
    if (grid.values[known[:, 0], known[:, 1]] < 0).any():
        raise CaseError(f"{path}: holds thicknesses below 0; give solid rock above the ground [m]")
    stride = max(1, math.ceil(math.sqrt(len(known) / MOST_POINTS)))
    some = known[(known % stride == 0).all(axis=1)]
    if not len(some):
        some = known[:: max(1, len(known) // MOST_POINTS)]
    step = np.array(grid.step)
    at = np.array([grid.west, grid.south]) + some[:, ::-1] * step
    length = part.length or ALIKE * _diagonal((*grid.low, *grid.high))

    def of_run(row: Row, found: RunOut | None) -> Floats:
        assert found is not None
        return _mean_around(found.deposit, at, step)

    values = grid.values[some[:, 0], some[:, 1]]
    covariance = part.deviation**2 * _correlation(at, length)
    notes = []
    if stride > 1:
        notes.append(f"{path}: {len(some)} of {len(known):,} cells are used, every {stride}th")
    return Observed("thickness", "m", values, covariance, of_run, True, at, notes)


def _mean_around(deposit: Deposit, at: Floats, step: Floats) -> Floats:
    """Mean thickness of a deposit in cells around some points; 0 beyond its grid [m]."""
    ndimage = extra("scipy.ndimage", "comparing a thickness")
    count = int(np.clip(math.ceil(step.max() / deposit.cell), 1, SUBCELLS))
    offset = (np.arange(count) + 0.5) / count - 0.5
    total = np.zeros(len(at))
    for dx in offset:
        for dy in offset:
            place = (at + step * (dx, dy) - (deposit.x, deposit.y)) / deposit.cell - 0.5
            total += ndimage.map_coordinates(
                deposit.thickness, place[:, ::-1].T, order=1, mode="constant"
            )
    return total / count**2


def _front(part: OfFront, path: Path) -> Observed:
    """Distance of the front from the crown at some times [m]."""
    table = read_table(path, "table of front times", lambda row: np.isnan(number(row[0])))
    table.find({"time": ("time", "t"), "distance": ("distance", "front", "reach")})
    for key in ("time", "distance"):
        if key not in table.at:
            raise CaseError(f"{path}: has no column {key}; columns are time [s] and distance [m]")
    times, values = table.numbers("time"), table.lengths("distance")
    if not (np.isfinite(times).all() and np.isfinite(values).all()):
        raise CaseError(f"{path}: time and distance must be numbers in every row")
    order = np.argsort(times)
    times, values = times[order], values[order]

    def of_run(row: Row, found: RunOut | None) -> Floats:
        assert found is not None
        passed = found.history["time"] - found.history["time"][0]
        return np.interp(times, passed, found.history["front"])

    table.tell_unused({"time", "distance"})
    # a front that is too fast is too far at all later times
    gaps = np.abs(times[:, None] - times) / max(np.ptp(times) * ALIKE, 1e-12)
    covariance = part.deviation**2 * np.exp(-gaps)
    return Observed("front", "m", values, covariance, of_run, True, times, table.notes)


def _correlation(at: Floats, length: float) -> Floats:
    """Correlation of errors at some places: exponential in their distance."""
    return np.exp(-np.linalg.norm(at[:, None] - at[None], axis=-1) / length)


def _diagonal(box: Any) -> float:
    """Diagonal of a box: west, south, east, north."""
    west, south, east, north = (float(v) for v in box)
    return math.hypot(east - west, north - south)
