"""Bolts as lines for frames and pictures: their present positions and forces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.rows import rows_of
from cdem.run.state import RunState

Lines = tuple[NDArray[np.float64], NDArray[np.int32], dict[str, NDArray], dict[str, NDArray]]

ACTS = (1, 2)
"""Phases of an installed bolt."""


def bolt_lines(sim: RunState) -> Lines:
    """Positions of the nodes of installed bolts [m], the bars between them, and fields on both.

    Fields of nodes: `slip` towards the toe [m], `grout_force` on the rock [N], `grout_state`
    (0 holds, 1 and 2 slips). Fields of bars: `axial_force`, tension positive [N], `bar_state`
    (0 elastic, 1 and 2 yields in tension and compression, 3 ruptured, 4 cut), `bolt`.
    """
    state, first = sim.core.fields(), sim.build.arrays["bolts.first"]
    bolt = np.repeat(np.arange(len(first) - 1), np.diff(first))
    hosts = rows_of(sim.core, "bolts.hosts").numbers[: len(bolt)]
    weights = rows_of(sim.core, "bolts.weights").numbers[: len(bolt)]
    places = np.einsum(
        "ph,phx->px", weights, rows_of(sim.core, "node.motion").position[np.maximum(hosts, 0)]
    )
    shown = np.isin(state["bolts.phase"], ACTS)[bolt]
    number = np.cumsum(shown) - 1
    bars = np.flatnonzero(shown[:-1] & (bolt[:-1] == bolt[1:])) if len(bolt) else bolt
    lines = np.stack([number[bars], number[bars + 1]], axis=1).astype(np.int32)
    broken = state["bolts.bar_broken"][bars]
    bar_state = np.where(broken > 0, broken + 2, state["bolts.bar_state"][bars])
    points = {
        "slip": state["bolts.slip"][shown],
        "grout_force": state["bolts.grout_force"][shown],
        "grout_state": state["bolts.grout_state"][shown].astype(np.int32),
    }
    cells = {
        "axial_force": state["bolts.axial_force"][bars],
        "bar_state": bar_state.astype(np.int32),
        "bolt": bolt[bars].astype(np.int32),
    }
    return places[shown], lines, points, cells
