"""A state of the core, kept to return to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.run.state import RunState


@dataclass
class Kept:
    """All arrays and numbers of a state, as a checkpoint has them."""

    arrays: dict[str, NDArray[Any]]
    scalars: dict[str, bool | int | float]


def keep(sim: RunState) -> Kept:
    """A copy of the present state."""
    return Kept({name: np.array(a) for name, a in sim.core.fields().items()}, sim.core.scalars())


def bring_back(sim: RunState, state: Kept) -> None:
    """Return to a state, bit for bit."""
    sim.core.restore(state.arrays, state.scalars)
    sim.core.prepare()
