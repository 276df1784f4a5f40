"""The running stage: its times, its records, and how it has behaved so far."""

from __future__ import annotations

from dataclasses import dataclass, field

from cdem.run.rest import Quiet

STALL_STEPS = 10_000
"""A static stage with no progress towards rest in this many steps is said to stall."""


@dataclass
class StageState:
    """The running stage.

    Attributes:
        name: Its name.
        mode: "static" or "dynamic".
        start_time: [s].
        start_step: Steps done before it.
        end_time: [s], or None for a static stage.
        row_every: Time between history rows [s].
        frame_every: Time between frames [s]; 0 in checkpoints of earlier versions, which had ten
            rows for each.
        rows: Number of history rows whose times have passed, after the first.
        frame_due: Whether a frame was due with the last of them.
        wall_time: Wall time spent in it [s].
        least_unbalance: Smallest unbalance ratio of a static stage so far, or None.
        least_step: Step at which it was reached.
        quiet: Rest of a dynamic stage that ends with it: see `Quiet`.
        parts: Static stage with `release`: number of parts released.
        held: Fraction of the forces of removed groups still held at the start of the stage [1].
        solved: Static stage with `relax: solve`: result of the last solve since the forces changed, or
            nothing.
        handed_over: Static stage with `relax: adaptive` or `solve`: whether local damping goes on, as
            the energy balance did not close.
        ways: Displacement of the farthest node of a static stage since the first look at it, over
            the mean face size, at each look: every row of its history.
        ratios: Lowest unbalance ratio since then at each look.
        wait: Steps of an elastic motion, or None as long as nobody has asked: see `patience`.
    """

    name: str
    mode: str
    start_time: float
    start_step: int
    end_time: float | None
    row_every: float
    frame_every: float = 0.0
    rows: int = 0
    frame_due: bool = False
    wall_time: float = 0.0
    least_unbalance: float | None = None
    least_step: int = 0
    quiet: Quiet = field(default_factory=Quiet)
    parts: int = 0
    held: float = 0.0
    solved: str = ""
    handed_over: bool = False
    ways: list[float] = field(default_factory=list)
    ratios: list[float] = field(default_factory=list)
    wait: int | None = None

    def watch_anew(self) -> None:
        """Forget the looks so far: what acts on the model has changed."""
        self.ways, self.ratios = [], []

    def note(self, step: int, unbalance: float) -> str:
        """Advice about a static stage that does not come to rest, or nothing."""
        if self.mode != "static":
            return ""
        if self.least_unbalance is None or unbalance < 0.95 * self.least_unbalance:
            self.least_unbalance, self.least_step = unbalance, step
        waited = step - self.least_step
        if waited < STALL_STEPS:
            return ""
        return (
            f"no progress towards rest for {waited:,} steps (does a block move freely? "
            "else try a larger tolerance or another relax)"
        )

    @property
    def next_row(self) -> float:
        """Time of the next history row [s]."""
        return self.start_time + (self.rows + 1) * self.row_every
