"""Possible values that are probably mistakes: a one-line warning for each."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from cdem._instruction_sets import cores
from cdem.mesh.arrays import lengths
from cdem.model.build import Build

MOST_FRAMES = 10_000
"""More frames of a stage than this are probably a mistake."""
DEEP = 0.1
"""Overlap over an element up to which a free fall is stopped (one boulder: 0.08 was, 0.14 was not)."""


def slips(build: Build, threads: int, unheld: dict[str, int]) -> Iterator[str]:
    """Values that are probably mistakes.

    Args:
        build: The model.
        threads: Number of threads for the run.
        unheld: Blocks of each group that are not held at the start.
    """
    yield from _tense_bolts(build)
    yield from _points_outside(build)
    yield from _frames(build)
    if threads > (there := cores()):
        yield f"--threads {threads}: there are {there} cores for this process; more threads only wait"
    yield from falls(build, unheld)


def _tense_bolts(build: Build) -> Iterator[str]:
    """Bolts that yield by their pretension alone."""
    case = build.case
    for index, bolts in enumerate(case.bolts):
        most = case.bolt_types[bolts.type].yield_force
        if bolts.pretension > most:
            place = f"bolts.{index}.pretension"
            yield (
                f"{case.where(place)}: {place}: {bolts.pretension:.4g} N is above the yield force of "
                f"{bolts.type}, {most:.4g} N: the bolt yields as it is tensioned"
            )


def _points_outside(build: Build) -> Iterator[str]:
    """Points of histories farther from the nearest node than the length of an element."""
    t, x = build.topology, build.start_position
    edges = t.node_position[t.edge_nodes]
    longest = float(lengths(edges[:, 1] - edges[:, 0]).max(initial=0.0))
    for index, entry in enumerate(build.case.histories):
        if entry.point is None:
            continue
        place = np.asarray(entry.point, float)
        away = float(lengths(x - place).min())
        if away > longest:
            node = ", ".join(f"{c:.4g}" for c in x[lengths(x - place).argmin()])
            yield (
                f"{build.case.where(f'histories.{index}')}: histories.{index}: the point of "
                f"{entry.name!r} lies outside the model; the nearest node, which is used, is "
                f"{away:.3g} m away at ({node})"
            )


def _frames(build: Build) -> Iterator[str]:
    """Stages that would write very many frames."""
    case = build.case
    every = case.output.every
    if every is None or not case.output.frames:
        return
    for stage in case.stages:
        if stage.duration is not None and stage.duration / every > MOST_FRAMES:
            yield (
                f"{case.where('output.every')}: output.every: {every:g} s makes "
                f"{stage.duration / every:,.3g} frames of stage {stage.name!r}; give a longer time"
            )


def falls(build: Build, unheld: dict[str, int]) -> Iterator[str]:
    """Blocks that may fall freely so far that contacts are too soft to stop them."""
    from cdem.model.contact_overlaps import contact_interfaces

    case = build.case
    gravity = np.asarray(case.loads.gravity, float)
    size = float(np.linalg.norm(gravity))
    if not size or not any(stage.mode == "dynamic" for stage in case.stages):
        return
    down = build.start_position @ (gravity / size)
    rows: list[dict[str, Any]] = []
    for name in unheld:
        height = float(down.max() - down[build.nodes_of(name)].max())
        speed = math.sqrt(2 * size * height)
        rows = rows or contact_interfaces(build)
        for row in rows:
            overlap = row["overlap_by_speed"] * speed
            if overlap <= DEEP:
                continue
            needed = row["stiffness_n"][1] * (overlap / DEEP) ** 2
            yield (
                f"group {name} may fall {height:.3g} m, to {speed:.3g} m/s: contacts of "
                f"{row['interface']} would overlap by {100 * overlap:.2g} % of an element, and "
                f"corners, with less area, might penetrate. Give them contact_stiffness: "
                f"{needed:.2g} Pa/m, or rock a Young's modulus {(overlap / DEEP) ** 2:.2g} times as high"
            )
