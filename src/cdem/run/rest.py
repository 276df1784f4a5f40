"""Rest of blocks: their speeds, whether they are at rest, and blocks that have left the model."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SLOW_SPEED = 0.1
"""Speed above which a block moves [m/s]: the cut-off of rockfall codes (RocFall). Slower blocks may
rock on their contacts: they can climb half a millimetre."""
REST_SPEED = 0.01
"""A block rests if the mean speed of its centre over `REST_SPAN` is lower [m/s]."""
STILL_SPEED = 1e-3
"""Below this speed every block rests, even if none was ever faster [m/s]."""
REST_ENERGY = 1e-3
"""Fraction of the stage's largest kinetic energy: 3 % of the momentum; RAMMS stops at 5 % of the
largest momentum (Christen, Kowalski & Bartelt 2010)."""
REST_SPAN = 0.5
"""Time that rest must last [s]: at the top of its throw a block is slow for 2 ms."""


@dataclass
class Motion:
    """Blocks as rigid bodies, without their elastic vibration.

    Attributes:
        speed: Root mean square speed of each block's mass in its rigid motion [m/s].
        energy: Kinetic energy of each of these motions [J].
        middle: Centre of mass of each block [m], shape (blocks, 3).
    """

    speed: Floats
    energy: Floats
    middle: Floats

    def without(self, blocks: NDArray[np.intp]) -> Motion:
        """The motion of all blocks except these."""
        columns = (self.speed, self.energy, self.middle)
        return Motion(*(np.delete(column, blocks, axis=0) for column in columns))


def middles(first: NDArray[np.int32], mass: Floats, position: Floats) -> Floats:
    """Centre of mass of each block [m], shape (blocks, 3); arguments as in `rigid_motion`."""
    whole = np.add.reduceat(mass, first[:-1])
    return np.add.reduceat(mass[:, None] * position, first[:-1], axis=0) / whole[:, None]


@np.errstate(over="ignore", invalid="ignore")  # also used for a failed run
def rigid_motion(
    first: NDArray[np.int32], mass: Floats, position: Floats, velocity: Floats
) -> Motion:
    """Rigid part of the motion of every block.

    Args:
        first: First node of each block, whose nodes follow one another, and the end, (blocks + 1,).
        mass: Of the nodes [kg].
        position: Of the nodes [m], shape (nodes, 3).
        velocity: Of the nodes [m/s], shape (nodes, 3).
    """
    starts, block = first[:-1], np.repeat(np.arange(len(first) - 1), np.diff(first))

    def sums(rows: Floats) -> Floats:
        return np.add.reduceat(rows, starts, axis=0)

    whole = sums(mass)
    mean = sums(mass[:, None] * velocity) / whole[:, None]
    middle = middles(first, mass, position)
    arm = position - middle[block]
    spin = sums(mass[:, None] * np.cross(arm, velocity))
    square = mass * np.einsum("ij,ij->i", arm, arm)
    products = sums(mass[:, None, None] * arm[:, :, None] * arm[:, None, :])
    inertia = sums(square)[:, None, None] * np.eye(3) - products
    turning = np.einsum("bi,bi->b", spin, np.linalg.solve(inertia, spin[..., None])[..., 0])
    double = whole * np.einsum("bi,bi->b", mean, mean) + turning  # twice the energy
    return Motion(np.sqrt(double / whole), 0.5 * double, middle)


@dataclass
class Quiet:
    """How long all blocks have rested, judged at the rows of the histories.

    Attributes:
        peak: Largest kinetic energy of the stage so far [J].
        since: Start of rest [s], or None during motion.
        middle: x, y, z of the blocks' middles at that time [m], one after the other.
        rests: Whether rest has lasted long enough.
    """

    peak: float = 0.0
    since: float | None = None
    middle: list[float] = field(default_factory=list)
    rests: bool = False

    def look(self, time: float, motion: Motion) -> None:
        """Add the motion at a time [s]."""
        energy, fastest = float(motion.energy.sum()), float(motion.speed.max(initial=0.0))
        self.peak = max(self.peak, energy)
        slow = fastest < SLOW_SPEED and energy <= REST_ENERGY * self.peak
        if not (slow or fastest < STILL_SPEED):
            self.since = None
        elif self.since is None or self._moved(motion) > REST_SPEED * REST_SPAN:
            self.since, self.middle = time, motion.middle.ravel().tolist()
        self.rests = self.since is not None and time - self.since >= REST_SPAN

    def _moved(self, motion: Motion) -> float:
        """Largest displacement of a middle since rest began [m]; inf if a block has left."""
        before = np.reshape(self.middle, (-1, 3))
        if before.shape != motion.middle.shape:
            return np.inf
        return float(np.linalg.norm(motion.middle - before, axis=1).max(initial=0.0))


@dataclass
class Departure:
    """The first block of a group that fell below the model or left its domain.

    Attributes:
        group: Its group.
        block: Its number.
        time: Time of detection [s].
        place: Its middle at that time [m].
        speed: Root mean square speed of its mass at that time [m/s].
        out: Whether it left the domain and was removed.
    """

    group: str
    block: int
    time: float
    place: list[float]
    speed: float
    out: bool = False

    def text(self) -> str:
        """A one-line warning."""
        place = ", ".join(f"{x:.4g}" for x in self.place)
        if self.out:
            return (
                f"block {self.block} of group {self.group} left model.domain at {self.speed:.3g} m/s: it "
                f"was at ({place}) m at t = {self.time:.4g} s, and is removed, like all blocks "
                f"that "
                "follow it"
            )
        return (
            f"block {self.block} of group {self.group} fell past the edge of the model: it is at "
            f"({place}) m at t = {self.time:.4g} s, below the whole initial model, and keeps "
            f"falling at "
            f"{self.speed:.3g} m/s unless model.domain removes it"
        )


def fallen(
    first: NDArray[np.int32], start: Floats, position: Floats, gravity: list[float]
) -> NDArray[np.intp]:
    """Blocks that lie completely below the lowest initial point; none without gravity.

    Args:
        first: First node of each block, and the end.
        start: Positions of the nodes at the start [m], shape (nodes, 3).
        position: Present positions [m].
        gravity: [m/s2].
    """
    down = np.asarray(gravity, float)
    if not down.any():
        return np.zeros(0, np.intp)
    highest = np.minimum.reduceat(position @ down, first[:-1])
    return np.flatnonzero(highest > (start @ down).max())
