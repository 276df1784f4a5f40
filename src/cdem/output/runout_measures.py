"""Measurements on the moving elements of a run, frame by frame and at the end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.element_volumes import Solids
from cdem.output.moving_mass import STILL, Body, Line
from cdem.output.reader import read_histories
from cdem.output.travel import energy_line, lengths
from cdem.run.flow_maps import FlowMaps, Moment
from cdem.run.rest import SLOW_SPEED

Floats = NDArray[np.float64]

SAME = 1e-9
"""Heights and lengths count as equal within this fraction of the body's size."""


HISTORY = {
    "time": "s", "front": "m", "reach_99_9": "m", "reach_95": "m", "centre": "m",
    "centre_x": "m", "centre_y": "m", "centre_z": "m", "speed": "m/s", "speed_most": "m/s",
    "volume": "m3", "kinetic_energy": "J", "pieces": "1", "largest": "1", "attached": "1",
    "path": "m", "energy_line": "m", "broken_tension": "1", "broken_shear": "1",
}  # fmt: skip
"""Columns of runout.csv with their units."""


@dataclass
class EndMotion:
    """Motion of the rock at the end: as recorded, but at most its mean since the previous frame.

    Attributes:
        fastest: Speed of the fastest moving element [m/s].
        mean: Mean speed of the mass [m/s].
        share: Fraction of the mass faster than `SLOW_SPEED`.
    """

    fastest: float
    mean: float
    share: float

    @classmethod
    def of(cls, body: Body, end: Solids, stays: NDArray[np.bool_]) -> EndMotion:
        """Motion of the remaining elements."""
        last, before = body.frames[-1], body.frames[-2]
        passed = body.series.times[last] - body.series.times[before]
        way = np.linalg.norm(end.centroids() - body.solids(before).centroids(), axis=1) / passed
        recorded = np.linalg.norm(body.velocities(last), axis=1)
        speed = np.where(np.isnan(recorded), way, recorded)
        lasting, mass = np.minimum(speed, way), body.mass[stays]  # else an element may only vibrate
        moves = stays & (lasting >= SLOW_SPEED)
        return cls(
            float(speed[moves].max(initial=0.0)),
            float(mass @ lasting[stays] / mass.sum()),
            float(body.mass[moves].sum() / mass.sum()),
        )


def follow(
    body: Body,
    way: Floats,
    origin: float,
    lines: Sequence[Line],
    flow: FlowMaps,
    seen: Sequence[int],
) -> tuple[dict[str, Floats], dict[str, NDArray]]:
    """Columns `HISTORY` frame by frame, without springs, and the pieces at the end.

    Args:
        body: The moving elements.
        way: Unit vector along the motion.
        origin: Origin of distances along it [m].
        lines: Sections that record the rock of every frame.
        flow: Maps that add frames.
        seen: Frames for the maps.
    """
    rows, before = [], body.start.centroids()
    for frame in body.frames:
        time, solids, velocity = (
            body.series.times[frame],
            body.solids(frame),
            body.velocities(frame),
        )
        stays, centroid = body.stays(frame), solids.centroids()
        left, mass = solids.only(stays), body.mass[stays]
        volume = left.volumes()
        pieces = body.pieces(frame, volume, stays)
        now = Moment(time, left, velocity[stays], mass, None if pieces is None else pieces.member)
        rows.append(
            [
                *_row(now, volume, centroid[stays], way, origin),
                *((np.nan,) * 3 if pieces is None else pieces.row()),
                mass.sum(),
            ]
        )
        for line in lines:
            line.follow(time, solids, stays, velocity, before, centroid)
        if frame in seen:
            flow.take_in(now)
        before = centroid
    columns = np.array(rows).T
    history = dict(zip(list(HISTORY), columns[:-1], strict=False))
    places = np.column_stack([history[f"centre_{k}"] for k in "xyz"])
    history["path"] = lengths(places)
    history["energy_line"] = energy_line(
        history["centre_z"], history["kinetic_energy"], columns[-1] * body.gravity
    )
    history |= _broken(body.folder, history["time"])
    return history, {} if pieces is None else pieces.table(mass, centroid[stays])


def _row(now: Moment, volume: Floats, centroid: Floats, way: Floats, origin: float) -> list[float]:
    """The columns `HISTORY` of a moment, up to the kinetic energy.

    Args:
        now: The remaining elements.
        volume: Volume of each [m3].
        centroid: Centroid of each [m], shape (elements, 3).
        way: Unit vector along the motion.
        origin: Origin of distances along it [m].
    """
    solids, mass = now.solids, now.mass
    density = mass / volume  # mass is constant, volume is not
    centre = mass @ centroid / mass.sum()
    speed = np.linalg.norm(now.velocity, axis=1)
    return [
        now.time,
        (solids.triangles @ way).max() - origin,
        *(solids.level_below_which(q, way, density) - origin for q in (0.999, 0.95)),
        centre @ way - origin,
        *centre,
        np.linalg.norm(mass @ now.velocity) / mass.sum(),
        speed.max(),
        volume.sum(),
        0.5 * mass @ speed**2,
    ]


def direction_of(body: Body, end: Solids) -> float:
    """Direction in which the centre of mass has moved in plan, clockwise from y [deg]."""
    moved = body.mass @ (end.centroids() - body.start.centroids()) / body.mass.sum()
    size = np.ptp(body.start.middle, axis=0).max()
    if np.linalg.norm(moved[:2]) <= STILL * size:
        raise CdemError("the centre of mass has not moved in plan; give a direction (an azimuth)")
    return float(np.degrees(np.arctan2(moved[0], moved[1])))


def crown_of(points: Floats, way: Floats) -> Floats:
    """Highest point; of several, the rearmost."""
    near = SAME * np.ptp(points, axis=0).max()
    top = points[points[:, 2] >= points[:, 2].max() - near]
    return top[(top @ way).argmin()]


def front_of(body: Body, frame: int, way: Floats) -> Floats:
    """Farthest point, at the height of the lowest corner of its element.

    The top and the foot of an upright front are equally far; the foot counts.
    """
    points, stays = body.series.points(frame), body.stays(frame)
    best, foot, first = -np.inf, 0.0, 0
    for all_of_shape in body.cells.values():
        nodes = all_of_shape[stays[first : first + len(all_of_shape)]]
        first += len(all_of_shape)
        if len(nodes) == 0:
            continue
        x = points[nodes]
        element, corner = np.unravel_index((x @ way).argmax(), x.shape[:2])
        if x[element, corner] @ way > best:
            best, place, foot = x[element, corner] @ way, x[element, corner], x[element, :, 2].min()
    return np.array([*place[:2], foot])


def _broken(folder: Path, times: Floats) -> dict[str, Floats]:
    """Springs broken by the time of each frame, by kind."""
    columns = read_histories(folder)
    row = np.searchsorted(columns["time [s]"], times, side="right") - 1
    return {f"broken_{k}": columns[f"broken {k}"][row] for k in ("tension", "shear")}
