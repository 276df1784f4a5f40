"""Monitored displacements: tables of total stations, GNSS and InSAR points, and rasters of InSAR."""

from __future__ import annotations

import datetime
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.joints.tables import LENGTHS, Table, number, read_table
from cdem.terrain.rasters import read_raster

Floats = NDArray[np.float64]

COMPONENTS = ("dx", "dy", "dz", "los")
"""Displacement to the east, to the north, upwards; along the line of sight, towards the satellite."""
NAMES: dict[str, tuple[str, ...]] = {
    "name": ("name", "point", "punkt", "station", "prism", "prisma", "pid", "benchmark"),
    "x": ("x", "east", "easting", "e", "rechtswert"),
    "y": ("y", "north", "northing", "n", "hochwert"),
    "z": ("z", "height", "elevation", "altitude", "h", "hohe", "hoehe"),
    "time": ("time", "zeit", "t"),
    "date": ("date", "datum", "epoch"),
    "dx": ("dx", "ux", "de", "ue", "displacement_x", "east_displacement", "d_east"),
    "dy": ("dy", "uy", "dn", "un", "displacement_y", "north_displacement", "d_north"),
    "dz": ("dz", "uz", "du", "displacement_z", "up_displacement", "d_up", "settlement_up"),
    "los": ("los", "dlos", "d_los", "los_displacement", "displacement_los"),
    "sx": ("sx", "sigma_x", "std_x", "sigma_e", "std_e", "s_east"),
    "sy": ("sy", "sigma_y", "std_y", "sigma_n", "std_n", "s_north"),
    "sz": ("sz", "sigma_z", "std_z", "sigma_u", "std_u", "s_up"),
    "slos": ("slos", "sigma_los", "std_los"),
}
"""Columns and their possible headings, in the form of `plain`."""
SECONDS_PER_DAY = 86400.0
TIMES = {"": 1.0, "s": 1.0, "ms": 0.001, "min": 60.0, "h": 3600.0, "d": SECONDS_PER_DAY}
TIMES |= {"seconds": 1.0, "hours": 3600.0, "days": SECONDS_PER_DAY}
"""Units of times, and their seconds."""
MOST_CELLS = 20_000
"""Most cells of a raster that are compared."""


@dataclass
class Monitored:
    """Displacements measured at some places.

    Attributes:
        path: The file.
        names: Name of each place and row.
        at: Place before the motion [m], shape (rows, 3); nan where the height is not known.
        time: Time since the start of the run [s], shape (rows,); nan for its end.
        moved: Displacement by `COMPONENTS` [m], shape (rows, 4); nan where not measured.
        deviation: Standard deviation of each [m], the same shape; nan where not known.
        notes: Messages for the user.
    """

    path: Path
    names: list[str]
    at: Floats
    time: Floats
    moved: Floats
    deviation: Floats
    notes: list[str] = field(default_factory=list)

    def only(self, rows: NDArray[np.bool_]) -> Monitored:
        """Some of the rows."""
        names = [name for name, row in zip(self.names, rows, strict=True) if row]
        moved, deviation = self.moved[rows], self.deviation[rows]
        return Monitored(
            self.path, names, self.at[rows], self.time[rows], moved, deviation, self.notes
        )


def read_monitored(path: Path, unit: str | None = None, start: str | None = None) -> Monitored:
    """Read a table, or a raster of displacements towards the satellite.

    Args:
        path: `.tif`, `.asc` ... for a raster, else a table.
        unit: Unit of the numbers of a raster; default metres.
        start: Date of the start of the run, for tables with dates.

    Raises:
        CaseError: It cannot be read; names the file, the place and the remedy.
    """
    if path.suffix.lower() in (".tif", ".tiff", ".asc", ".grd", ".vrt"):
        return _of_raster(path, unit)
    if unit is not None:
        raise CaseError(f"{path}: a table has its units in its headings, dx [mm]; leave --unit out")
    table = read_table(path, "table of displacements", lambda row: np.isnan(number(row[-1])))
    table.find(NAMES)
    _check_columns(table)
    count = len(table.rows)
    at = np.column_stack([_lengths(table, k) if k in table.at else _none(count) for k in "xyz"])
    names = table.column("name") if "name" in table.at else [str(k + 1) for k in range(count)]
    moved, deviation = _moved(table)
    table.tell_unused(NAMES)
    found = Monitored(path, names, at, _times(table, start), moved, deviation, table.notes)
    if "date" in table.at and start is None and "time" not in table.at:
        found = _changes(table, found)
    return found


def _check_columns(table: Table) -> None:
    """A table needs places and displacements."""
    for key in "xy":
        if key not in table.at:
            raise CaseError(f"{table.path}: has no column {key}: the places of the points [m]")
    if not any(key in table.at for key in COMPONENTS):
        raise CaseError(
            f"{table.path}: has no displacements; name their columns dx, dy, dz, or los, e.g. "
            "'dz [mm]'"
        )


def _moved(table: Table) -> tuple[Floats, Floats]:
    """Displacements and their standard deviations [m], each of shape (rows, 4)."""
    shape = (len(table.rows), len(COMPONENTS))
    moved, deviation = np.full(shape, np.nan), np.full(shape, np.nan)
    for k, key in enumerate(COMPONENTS):
        if key in table.at:
            moved[:, k] = _lengths(table, key, gaps=True)
        if (s := "s" + key.removeprefix("d")) in table.at:
            deviation[:, k] = _lengths(table, s)
            if (deviation[:, k] <= 0).any():
                raise CaseError(f"{table.path}: {table.name(s)} must be above 0 in every row")
    return moved, deviation


def _of_raster(path: Path, unit: str | None) -> Monitored:
    """A raster of displacements towards the satellite."""
    if unit is not None and unit.lower() not in LENGTHS:
        units = ", ".join(name for name in LENGTHS if name)
        raise CaseError(f"{path}: --unit {unit} is not known; use one of {units}")
    grid = read_raster(path).grid
    known = np.argwhere(np.isfinite(grid.values))
    stride = int(np.ceil(np.sqrt(max(1.0, len(known) / MOST_CELLS))))
    some = known[(known % stride == 0).all(axis=1)]
    if not len(some):
        raise CaseError(f"{path}: holds no numbers")
    xy = np.array([grid.west, grid.south]) + some[:, ::-1] * np.array(grid.step)
    moved = np.full((len(some), 4), np.nan)
    moved[:, 3] = grid.values[some[:, 0], some[:, 1]] * LENGTHS[(unit or "m").lower()]
    notes = [] if stride == 1 else [f"{len(some):,} of {len(known):,} cells are compared"]
    names = [f"{i},{j}" for i, j in some.tolist()]
    at = np.column_stack([xy, _none(len(some))])
    return Monitored(path, names, at, _none(len(some)), moved, np.full(moved.shape, np.nan), notes)


def _none(count: int) -> Floats:
    return np.full(count, np.nan)


def _lengths(table: Table, key: str, gaps: bool = False) -> Floats:
    """A column of lengths [m]; an empty word is a gap where gaps are allowed."""
    words, values = table.column(key), table.lengths(key)
    for row, (word, value) in enumerate(zip(words, values, strict=True)):
        if not np.isfinite(value) and not (gaps and word.lower() in ("", "nan", "-", "na")):
            raise CaseError(
                f"{table.path}:{table.lines[row]}: {table.name(key)} must be a number, got '{word}'"
            )
    return values


def _times(table: Table, start: str | None) -> Floats:
    """Times since the start of the run [s]; nan without any."""
    if "time" in table.at:
        if start is not None:
            raise CaseError(f"{table.path}: has times, not dates; leave --start out")
        times = table.numbers("time") * table.factor("time", TIMES)
        if not np.isfinite(times).all():
            row = int(np.isfinite(times).argmin())
            raise CaseError(f"{table.path}:{table.lines[row]}: time must be a number [s]")
        return times
    if start is None:
        return _none(len(table.rows))
    if "date" not in table.at:
        raise CaseError(f"{table.path}: has no column date, so --start has no effect")
    return (_dates(table) - _date(start, "--start")) * SECONDS_PER_DAY


def _dates(table: Table) -> Floats:
    """Dates as numbers of days."""
    pairs = zip(table.column("date"), table.lines, strict=True)
    return np.array([_date(word, f"{table.path}:{line}") for word, line in pairs])


def _date(word: str, where: str) -> float:
    try:
        found = datetime.datetime.fromisoformat(word.strip().replace("Z", "").replace("/", "-"))
    except ValueError:
        raise CaseError(f"{where}: '{word}' is no date; write 2024-03-31, year first") from None
    return (found - datetime.datetime(2000, 1, 1)).total_seconds() / SECONDS_PER_DAY


def _changes(table: Table, found: Monitored) -> Monitored:
    """The change from the first to the last date of each point, for the end of the run."""
    dates = _dates(table)
    rows, moved, deviation = [], [], []
    for name in dict.fromkeys(found.names):
        own = np.array([row for row, other in enumerate(found.names) if other == name])
        own = own[np.argsort(dates[own], kind="stable")]
        first, last = own[0], own[-1]
        rows.append(first)
        if len(own) == 1:
            moved.append(found.moved[last])
            deviation.append(found.deviation[last])
        else:
            moved.append(found.moved[last] - found.moved[first])
            deviation.append(np.hypot(found.deviation[last], found.deviation[first]))
    found.notes.append(
        "the change from the first to the last date of a point is compared with the end of the run; "
        "--start DATE compares every date"
    )
    return Monitored(
        found.path,
        [found.names[row] for row in rows],
        found.at[rows],
        _none(len(rows)),
        np.array(moved),
        np.array(deviation),
        found.notes,
    )
