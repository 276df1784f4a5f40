"""Tracks of blocks: passages of lines, and largest values in each cell of a map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.rockfall.fall import COLUMNS
from cdem.rockfall.ground import Ground

Floats = NDArray[np.float64]
PASSAGE = {
    "time": "s", "x": "m", "y": "m", "along": "m", "height": "m", "bottom": "m", "top": "m",
    "height_normal": "m", "velocity": "m/s", "vx": "m/s", "vy": "m/s", "vz": "m/s",
    "azimuth": "deg", "inclination": "deg", "spin": "rad/s", "energy_translation": "J",
    "energy_rotation": "J", "energy": "J",
}  # fmt: skip
"""Columns of a passage, with units."""
FINE = 4.0
"""Points of a track in a cell, at least, as it crosses a side."""


@dataclass(frozen=True)
class Track:
    """The track of one run.

    Attributes:
        samples: Columns `COLUMNS`, shape (samples, columns).
        mass: Of the block [kg].
    """

    samples: Floats
    mass: float

    def __getitem__(self, name: str) -> Floats:
        return self.samples[:, COLUMNS.index(name)]

    @property
    def places(self) -> Floats:
        """Centres of mass [m], shape (samples, 3)."""
        return self.samples[:, 1:4]

    @property
    def speed(self) -> Floats:
        """Speed of the centre of mass [m/s]."""
        return np.linalg.norm(self.samples[:, 4:7], axis=1)

    @property
    def translation(self) -> Floats:
        """Kinetic energy of translation [J]."""
        return 0.5 * self.mass * self.speed**2

    @property
    def energy(self) -> Floats:
        """Kinetic energy of translation and rotation [J]."""
        return self.translation + self["rotation"]

    def at(self, number: Floats) -> Track:
        """The track at fractional numbers of samples, linear in between."""
        whole = np.minimum(number.astype(int), len(self.samples) - 2)
        part = (number - whole)[:, None]
        rows = (1 - part) * self.samples[whole] + part * self.samples[whole + 1]
        return Track(rows, self.mass)


def crossings(track: Track, line: Floats) -> tuple[Floats, Floats]:
    """Where the centre of a block passes through the vertical plane of a line.

    Args:
        track: The track.
        line: Corners [m], shape (corners, 2).

    Returns:
        Fractional numbers of samples, ascending, and distances along the line [m].
    """
    xy = track.places[:, :2]
    numbers, along, walked = [], [], 0.0
    for k, (begin, way) in enumerate(zip(line, np.diff(line, axis=0), strict=False)):
        length = float(np.hypot(*way))
        if length == 0:
            continue
        to = xy - begin
        side = way[0] * to[:, 1] - way[1] * to[:, 0]
        at = np.flatnonzero((side[:-1] >= 0) != (side[1:] >= 0))
        part = side[at] / (side[at] - side[at + 1])
        place = (to[at] + part[:, None] * (to[at + 1] - to[at])) @ way / length
        last = k == len(line) - 2
        on = (place >= 0) & ((place <= length) if last else (place < length))
        numbers.append(at[on] + part[on])
        along.append(walked + place[on])
        walked += length
    number, distance = (np.concatenate([np.zeros(0), *parts]) for parts in (numbers, along))
    order = np.argsort(number, kind="stable")
    return number[order], distance[order]


def passages(track: Track, line: Floats, ground: Ground) -> dict[str, Floats]:
    """Every passage of a line in the order of time: columns `PASSAGE`."""
    number, along = crossings(track, line)
    if not len(number):
        return {name: np.zeros(0) for name in PASSAGE}
    t = track.at(number)
    height, slope = ground.plane(t.places[:, :2])
    above = t["z"] - height
    flat = np.hypot(t["vx"], t["vy"])
    return {
        "time": t["time"], "x": t["x"], "y": t["y"], "along": along, "height": above,
        "bottom": above + t["bottom"], "top": above + t["top"],
        "height_normal": above / np.sqrt(1 + (slope**2).sum(axis=-1)),
        "velocity": t.speed, "vx": t["vx"], "vy": t["vy"], "vz": t["vz"],
        "azimuth": np.degrees(np.arctan2(t["vx"], t["vy"])) % 360,
        "inclination": np.degrees(np.arctan2(t["vz"], flat)),
        "spin": np.linalg.norm(t.samples[:, 7:10], axis=1),
        "energy_translation": t.translation, "energy_rotation": t["rotation"],
        "energy": t.energy,
    }  # fmt: skip


@dataclass(frozen=True)
class Cells:
    """Cells of a map that one run has passed, each once.

    Attributes:
        number: Row times the columns of the map, plus column; ascending.
        entries: How often the block came into it.
        height: Greatest height of the centre above the ground [m].
        velocity: Greatest speed [m/s].
        energy: Greatest kinetic energy, with rotation [J].
    """

    number: NDArray[np.int64]
    entries: NDArray[np.int64]
    height: Floats
    velocity: Floats
    energy: Floats


def cells_of(track: Track, ground: Ground, low: Floats, cell: float, columns: int) -> Cells:
    """Largest values of a run in the cells of a map.

    Args:
        track: The track.
        ground: The ground.
        low: South-west corner of the map [m].
        cell: Side of a cell [m].
        columns: Cells from west to east.
    """
    way = np.abs(np.diff(track.places[:, :2], axis=0)).max(axis=1)
    parts = np.maximum(1, np.ceil(FINE * way / cell)).astype(int)
    number = np.concatenate(
        [np.repeat(np.arange(len(parts)), parts) + _fractions(parts), [len(parts)]]
    )
    t = track.at(number)
    above = t["z"] - ground.height(t.places[:, :2])
    on = np.isfinite(above)
    column, row = np.floor((t.places[on, :2] - low) / cell).astype(np.int64).T
    at = row * columns + column
    comes = np.concatenate([[True], at[1:] != at[:-1]])
    values = {"height": above[on], "velocity": t.speed[on], "energy": t.energy[on]}
    found, place = np.unique(at, return_inverse=True)

    def most(of: Floats) -> Floats:
        out = np.full(len(found), -np.inf)
        np.maximum.at(out, place, of)
        return out

    entries = np.bincount(place, comes, len(found)).astype(np.int64)
    return Cells(found, entries, *(most(value) for value in values.values()))


def _fractions(parts: NDArray[np.int64]) -> Floats:
    """0, 1/n, 2/n ... for each n."""
    first = np.repeat(np.cumsum(parts) - parts, parts)
    return (np.arange(parts.sum()) - first) / np.repeat(parts, parts)
