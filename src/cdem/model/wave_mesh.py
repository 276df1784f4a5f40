"""Whether the mesh bears the waves of a case: elements in a wave length, by group."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.schema import Group
from cdem.errors import CaseError
from cdem.mesh.arrays import in_pieces, lengths
from cdem.mesh.element_shapes import NODES
from cdem.model.build import Build
from cdem.seismic.measures import highest_frequency as of_motion

Floats = NDArray[np.float64]
GOOD, LEAST = 10.0, 5.0
"""Elements in the shortest wave length: below the first the audit warns, below the second it refuses."""
NONE = 360.0
"""Phase error of a wave too short for the mesh [deg]."""
EDGES = {
    "tet4": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "pyramid5": ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)),
    "wedge6": ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    "hex8": ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4))
    + ((0, 4), (1, 5), (2, 6), (3, 7)),
}
"""Edges of each shape."""


def highest_frequency(case: Case) -> float:
    """Highest frequency of the waves of a case; 0 if nothing in it sends waves [Hz]."""
    records = {given.record for boundary in case.boundaries for given in boundary.inputs}
    records |= {driven.record for driven in case.loads.velocities if driven.record is not None}
    shaken = (case.processed(name) for name in sorted(records))
    return max(
        (
            *(blast.highest_frequency for blast in case.loads.blasts),
            *(of_motion(record.velocity, record.step) for record in shaken),
        ),
        default=0.0,
    )


def wave_mesh(
    build: Build, interfaces: list[dict[str, Any]], frequency: float
) -> list[dict[str, Any]]:
    """A row for each group that moves: its worst element for S waves of a frequency.

    Args:
        build: The model.
        interfaces: Rows of `bonded_interfaces`.
        frequency: Highest frequency of the waves; with 0 there are no rows [Hz].
    """
    if frequency <= 0:
        return []
    step = float(build.core.scalars()["dt"])
    rows = []
    for name in build.case.movable:
        edge, place = longest_edge(build, name)
        speed = shear_speed(build, name, interfaces)
        count = speed / (frequency * edge)
        rows.append({
            "group": name,
            "edge": edge,
            "place": place,
            "speed": speed,
            "elements": count,
            "phase_error": phase_error(count, speed * step / edge),
            "bears": speed / (GOOD * edge),
        })  # fmt: skip
    return rows


def longest_edge(build: Build, group: str) -> tuple[float, list[float]]:
    """Longest edge of the elements of a group [m], and the middle of its element.

    Directions in which the whole group is fixed do not count: no wave runs along them.
    """
    t = build.topology
    free = moving_axes(build.case.groups[group])
    number = build.group_names.index(group)
    best, place = 0.0, [0.0, 0.0, 0.0]
    for shape in NODES:
        nodes = t.element_nodes[shape][t.element_group[shape] == number]
        if len(nodes) == 0:
            continue
        ends = np.array(EDGES[shape])

        def longest(nodes: NDArray, ends: NDArray = ends) -> Floats:
            x = t.node_position[nodes] * free
            return lengths(x[:, ends[:, 0]] - x[:, ends[:, 1]]).max(axis=1)

        edge = in_pieces(longest, nodes)
        worst = int(edge.argmax())
        if edge[worst] > best:
            best, place = float(edge[worst]), t.node_position[nodes[worst]].mean(axis=0).tolist()
    return best, place


def moving_axes(group: Group) -> Floats:
    """1 for each axis along which a group can move, 0 for others, shape (3,)."""
    return np.array([axis not in group.fix for axis in "xyz"], float)


def group_volume(build: Build, group: str) -> float:
    """Volume of the elements of a group [m3]."""
    t, number = build.topology, build.group_names.index(group)
    volumes = build.assembly.element_volume
    return float(sum(volumes[s][t.element_group[s] == number].sum() for s in NODES))


def shear_speed(build: Build, group: str, interfaces: list[dict[str, Any]]) -> float:
    """Speed of long S waves in a group, with the compliance of its bonds and joints [m/s]."""
    rock = build.case.materials[build.case.groups[group].material]
    shear = rock.young_modulus / (2 * (1 + rock.poisson_ratio))
    volume = group_volume(build, group)
    added = 0.0
    if group not in build.compensation:  # its elements make up for its bonds
        added = sum(
            row["shear_compliance_percent"] / 100 * row["rock_volume"]
            for row in interfaces
            if row["between"] == [group, group]
        )
    return float(np.sqrt(shear / rock.density / (1 + added / volume)))


def phase_error(count: float, courant: float) -> float:
    """Phase error of a wave along a row of elements, in a wave length [deg].

    sin(w dt / 2) = C sin(k h / 2) with C = c dt / h, and w = 2 pi c / (count h); `NONE` where the mesh
    does not carry such a wave.
    """
    sine = np.sin(np.pi * courant / count) / courant
    if sine >= 1:
        return NONE
    return float(360 * (count / np.pi * np.arcsin(sine) - 1))


def wave_doubts(case: Case, rows: list[dict[str, Any]], frequency: float) -> Iterator[str]:
    """Warnings about groups with too few elements in a wave length.

    Raises:
        CaseError: A group has fewer than `LEAST`, and the case does not allow it.
    """
    for row in rows:
        if row["elements"] >= GOOD:
            continue
        path = f"groups.{row['group']}"
        at = ", ".join(f"{x:.4g}" for x in row["place"])
        what = (
            f"{case.where(path)}: {path}: the S wave of {frequency:.4g} Hz is {row['elements']:.2g} elements "
            f"long, of {row['edge']:.3g} m at {at}; mesh the group with edges of "
            f"{row['speed'] / (GOOD * frequency):.2g} m, or send lower frequencies (band of a record, rise of a pressure): the mesh bears "
            f"{row['bears']:.3g} Hz"
        )
        if row["elements"] < LEAST and not case.waves.allow_coarse:
            raise CaseError(f"{what}. To run it all the same: waves: {{allow_coarse: true}}")
        if not case.waves.allow_coarse:
            yield what


def wave_lines(rows: list[dict[str, Any]], frequency: float) -> list[str]:
    """Lines of the audit."""
    if not rows:
        return []
    lines = ["", f"  S waves of {frequency:.4g} Hz in the mesh"]
    for row in rows:
        at = ", ".join(f"{x:.4g}" for x in row["place"])
        error = f"{row['phase_error']:.1f} deg" if row["phase_error"] < NONE else "it does not run"
        lines.append(
            f"    {row['group']}: {row['elements']:.3g} elements in a wave length (of {row['edge']:.3g} m "
            f"at {at}), phase error {error}; with {GOOD:g} the mesh bears {row['bears']:.4g} Hz"
        )
    return lines
