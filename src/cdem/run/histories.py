"""Histories of a case: column names and values."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cdem.case.boundaries_schema import Boundary
from cdem.errors import CaseError
from cdem.rows import rows_of
from cdem.run.state import RowBefore, RunState

FORCES = {"force": "node.reaction", "water_force": "node.water", "surface_force": "node.surface"}
"""Arrays of the core with forces on nodes; force is that of supports, as at a loading plate."""


@dataclass(frozen=True)
class Track:
    """Columns of a quantity in a history.

    Attributes:
        names: Of the columns.
        values: Their values now.
    """

    names: list[str]
    values: Callable[[], Sequence[float] | NDArray[np.float64]]


def tracks(sim: RunState) -> list[Track]:
    """The columns of every quantity in the case's histories."""
    units = {
        "centroid": "m", "displacement": "m", "velocity": "m/s", "acceleration": "m/s2",
        "force": "N", "water_force": "N", "surface_force": "N",
    }  # fmt: skip
    out: list[Track] = []
    position = sim.build.start_position
    for entry in sim.case.histories:
        if entry.bolt is not None:
            out += _of_bolts(sim, entry.name, entry.bolt, entry.quantities)
            continue
        if entry.boundary is not None:
            out += _of_boundary(sim, entry.name, entry.boundary, entry.quantities)
            continue
        if entry.group is not None:
            nodes = sim.build.nodes_of(entry.group)
        else:
            place = np.asarray(entry.point, float)
            nodes = np.array([np.linalg.norm(position - place, axis=1).argmin()])
        for quantity in entry.quantities:
            if quantity == "energy":
                name = f"{entry.name}.kinetic_energy [J]"
                out.append(Track([name], partial(_kinetic, sim, nodes)))
                continue
            of_time = partial(_value, sim, quantity, nodes)
            if quantity == "acceleration":
                of_time = partial(_acceleration, sim, entry.name, nodes)
            out.append(Track(_names(entry.name, quantity, units[quantity]), of_time))
    return out


def _names(history: str, quantity: str, unit: str) -> list[str]:
    return [f"{history}.{quantity}_{axis} [{unit}]" for axis in "xyz"]


def _of_boundary(sim: RunState, name: str, boundary: str, quantities: Sequence[str]) -> list[Track]:
    """Motion of a boundary, the wave that comes in there, and the one that leaves: base less up."""
    place = next(p for p in sim.build.boundaries.places if p.boundary.name == boundary)

    def wave(quantity: str) -> NDArray[np.float64]:
        up, base = incoming_wave(sim, place.boundary), np.zeros(3)
        if quantity != "v_up":
            base = _value(sim, "velocity", place.nodes.astype(np.intp))
        return {"v_base": base, "v_up": up, "v_down": base - up}[quantity]

    return [
        Track(_names(name, quantity, "m/s"), partial(wave, quantity)) for quantity in quantities
    ]


def incoming_wave(sim: RunState, boundary: Boundary) -> NDArray[np.float64]:
    """Velocity of the wave that comes in through a boundary, at the middle of the last step [m/s]."""
    begin = 0.0 if boundary.stage is None else sim.begins.get(boundary.stage, np.inf)
    time = sim.time - 0.5 * float(sim.core.scalars()["dt_last"]) - begin
    total = np.zeros(3)
    for given in boundary.inputs:
        record = sim.case.processed(given.record)
        if given.kind == "compliant" and time > 0:
            times = record.step * np.arange(len(record.velocity))
            speed = np.interp(time, times, record.velocity, 0.0, 0.0)
            total += speed * np.array(given.motion_of_record)
    return total


def _acceleration(sim: RunState, name: str, nodes: NDArray[np.intp]) -> NDArray[np.float64]:
    """Mean acceleration of some nodes since the row before [m/s2]; of the same step, the same.

    Velocities are those of the middle of a step, so the change between two rows is that of the
    mean acceleration between the middles of their last steps.
    """
    time, velocity = sim.time, _value(sim, "velocity", nodes)
    then = sim.rows_before.get(name)
    if then is not None and then.time >= time:
        return np.array(then.acceleration)
    acceleration = np.zeros(3)
    if then is not None:
        acceleration = (velocity - then.velocity) / (time - then.time)
    sim.rows_before[name] = RowBefore(time, velocity.tolist(), acceleration.tolist())
    return acceleration


def _of_bolts(sim: RunState, name: str, bolt: str, quantities: Sequence[str]) -> list[Track]:
    """Value of a bolt, or the value of largest magnitude among the bolts of an entry."""
    bolts = sim.build.bolts
    first = bolts.first
    numbers = bolts.numbers(bolt)
    if not numbers:
        raise CaseError(f"{sim.case.where('histories')}: histories: {name}: no bolt {bolt!r}")
    nodes = np.concatenate([np.arange(first[i], first[i + 1]) for i in numbers])
    heads = first[numbers]
    columns = {
        "axial_force": ("bolts.axial_force", nodes, "N"),
        "slip": ("bolts.slip", nodes, "m"),
        "plate_force": ("bolts.end_force", heads, "N"),
    }

    def largest(column: str, some: NDArray[np.intp]) -> list[float]:
        values = sim.core.fields()[column][some]
        return [float(values[np.abs(values).argmax()])]

    return [
        Track([f"{name}.{q} [{unit}]"], partial(largest, column, some))
        for q in quantities
        for column, some, unit in [columns[q]]
    ]


def _value(sim: RunState, quantity: str, nodes: NDArray[np.intp]) -> NDArray[np.float64]:
    """A quantity of some nodes; read for these nodes alone, as histories may have many rows."""
    if quantity in FORCES:
        return rows_of(sim.core, FORCES[quantity]).force[nodes].sum(axis=0)
    motion = rows_of(sim.core, "node.motion")
    values = motion.velocity[nodes] if quantity == "velocity" else motion.position[nodes]
    if quantity == "displacement":
        values = values - sim.reference[nodes]
    mass = sim.core.array("node.mass")[0][nodes]
    return (mass[:, None] * values).sum(axis=0) / mass.sum()


def _kinetic(sim: RunState, nodes: NDArray[np.intp]) -> list[float]:
    fields = sim.fields
    return [float(0.5 * (fields["mass"][nodes, None] * fields["velocity"][nodes] ** 2).sum())]
