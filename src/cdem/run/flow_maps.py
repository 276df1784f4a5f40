"""Largest thickness, velocity, energy ... at each place in plan so far, and arrival times.

At each moment the rock is cut exactly along the grid lines; docs/runout.md defines every quantity.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.element_volumes import Solids

Floats = NDArray[np.float64]

MAXIMA = (
    "thickness_max",
    "velocity_max",
    "velocity_mean_max",
    "momentum_max",
    "energy_area_max",
    "energy_piece_max",
    "pressure_max",
)
"""Layers with the largest value so far; 0 in cells without rock."""
ARRIVAL = "arrival"
LAYERS = (*MAXIMA, ARRIVAL)
MET = 0.1
"""Rock has reached a cell at this thickness [m] ..."""
MET_SHARE = 0.1
"""... or at this fraction of a cell's side, if that is less."""
TRACE = 1e-9
"""Thickness or cell area below this fraction of the largest is round-off."""
MOST_CELLS = 4_000_000


@dataclass
class Moment:
    """Elements at one moment, with their motion.

    Attributes:
        time: [s].
        solids: The elements.
        velocity: Velocity of each [m/s], shape (elements, 3).
        mass: Mass of each [kg].
        piece: Piece number of each, or None if unknown.
    """

    time: float
    solids: Solids
    velocity: Floats
    mass: Floats
    piece: NDArray[np.integer] | None

    def energies_of_pieces(self) -> Floats:
        """Kinetic energy of each element's piece [J]."""
        energy = 0.5 * self.mass * np.einsum("ij,ij->i", self.velocity, self.velocity)
        if self.piece is None:
            return np.full(len(energy), np.nan)
        _, member = np.unique(self.piece, return_inverse=True)
        return np.bincount(member, energy).astype(float)[member]


@dataclass
class FlowMaps:
    """Layers over a grid in plan that grows with the rock.

    Attributes:
        cell: Side of a cell [m]; the lines of the grid lie at multiples of it.
        start: Start of arrival times [s].
        low: Column and row of the south-western cell, counted from the origin.
        layers: `LAYERS` one after the other, shape (layers, rows, columns), rows from the south.
        last: Time of the last moment included [s].
        middles: Middle of each element in plan at that time [m], shape (elements, 2).
        jump: Longest path of an element in plan between two moments, in cells.
    """

    cell: float
    start: float
    low: tuple[int, int] = (0, 0)
    layers: Floats = field(default_factory=lambda: np.zeros((len(LAYERS), 0, 0)))
    last: float = -np.inf
    middles: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    jump: float = 0.0

    @property
    def met(self) -> float:
        """Thickness at which rock has reached a cell [m]."""
        return min(MET, MET_SHARE * self.cell)

    def __getitem__(self, name: str) -> Floats:
        """A layer, shape (rows, columns), from south to north."""
        return self.layers[LAYERS.index(name)]

    @property
    def affected(self) -> NDArray[np.bool_]:
        """Cells reached by rock."""
        return np.isfinite(self[ARRIVAL])

    def take_in(self, moment: Moment) -> None:
        """Raise the layers to their values at a moment.

        Raises:
            CdemError: The grid would be too large.
        """
        middles = moment.solids.middle[:, :2].copy()
        if len(middles) == len(self.middles):
            way = np.linalg.norm(middles - self.middles, axis=1).max(initial=0.0)
            self.jump = max(self.jump, float(way) / self.cell)
        self.middles, self.last = middles, moment.time
        if len(middles) == 0:
            return
        low, shape = moment.solids.grid(self.cell)
        self._grow(low, shape)
        column, row = np.subtract(low, self.low)
        window = (slice(row, row + shape[0]), slice(column, column + shape[1]))
        now = _values(moment, self.cell, low, shape)
        for number, name in enumerate(MAXIMA):
            layer = self.layers[number][window]
            np.fmax(layer, now[name], out=layer)
        arrival = self[ARRIVAL][window]
        new = np.isnan(arrival) & (now["thickness_max"] > self.met)
        arrival[new] = moment.time - self.start

    def _grow(self, low: tuple[int, int], shape: tuple[int, int]) -> None:
        """Extend the layers to the cells of another grid, given by its corner, rows and columns."""
        if self.layers.size == 0:
            self.low, have = low, (0, 0)
        else:
            have = self.layers.shape[1:]
        west, south = np.maximum(np.subtract(self.low, low), 0)
        east, north = np.maximum(np.add(low, shape[::-1]) - np.add(self.low, have[::-1]), 0)
        if not any((west, south, east, north)):
            return
        rows, columns = int(have[0] + south + north), int(have[1] + west + east)
        check_size(self.cell, rows, columns)
        grown = np.zeros((len(LAYERS), rows, columns))
        grown[LAYERS.index(ARRIVAL)] = np.nan
        grown[:, south : south + have[0], west : west + have[1]] = self.layers
        self.low, self.layers = (int(self.low[0] - west), int(self.low[1] - south)), grown


def check_size(cell: float, rows: int, columns: int) -> None:
    """Check the size of a grid.

    Raises:
        CdemError: The grid is too large.
    """
    if rows * columns > MOST_CELLS:
        raise CdemError(
            f"cells of {cell:g} m give a map of {rows:,} x {columns:,} cells; choose a larger cell"
        )


def _values(
    moment: Moment, cell: float, low: tuple[int, int], shape: tuple[int, int]
) -> dict[str, Floats]:
    """The layers `MAXIMA` at a moment, over the smallest grid around its elements."""
    count = shape[0] * shape[1]
    velocity, density = moment.velocity, moment.mass / moment.solids.volumes()
    speed = np.linalg.norm(velocity, axis=1)
    weights = (np.ones(len(speed)), *velocity.T, density, 0.5 * density * speed**2)
    sums = np.zeros((len(weights), count))
    fastest, piece = np.zeros(count), np.zeros(count)
    of_pieces = moment.energies_of_pieces()
    for part in moment.solids.parts(cell, low, shape):
        for total, weight in zip(sums, weights, strict=True):
            total += np.bincount(part.place, part.thickness * weight[part.owner], count)
        above = np.abs(part.share) > TRACE
        place, owner = part.place[above], part.owner[above]
        np.fmax.at(fastest, place, speed[owner])
        np.fmax.at(piece, place, of_pieces[owner])
    thickness = sums[0]
    rock = thickness > TRACE * thickness.max()
    whole = np.where(rock, thickness, 1.0)
    mean = np.where(rock, np.linalg.norm(sums[1:4], axis=0) / whole, 0.0)
    values = {
        "thickness_max": np.where(rock, thickness, 0.0),
        "velocity_max": np.where(rock, fastest, 0.0),
        "velocity_mean_max": mean,
        "momentum_max": thickness * mean,
        "energy_area_max": np.where(rock, sums[5], 0.0),
        "energy_piece_max": np.where(rock, piece, 0.0),
        "pressure_max": np.where(rock, sums[4] / whole, 0.0) * mean**2,
    }
    return {name: value.reshape(shape) for name, value in values.items()}
