"""Results for figures of Feng et al. (2014) that `cdem verify` does not compute: they need the
examples of a clone, or hours."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Stored:
    """A result that is stored.

    Attributes:
        figure: Of the paper.
        quantity: Name of the quantity.
        paper: Value of the paper.
        ours: Value from cdem.
        machine: Processor and threads.
        time: Wall time.
        commits: Commits that computed it.
        command: Command that repeats it, in a clone of the repository.
    """

    figure: str
    quantity: str
    paper: str
    ours: str
    machine: str
    time: str
    commits: str
    command: str

    def text(self) -> str:
        """Lines for the terminal."""
        return (
            f"{self.figure}: {self.quantity}\n  paper: {self.paper}\n  ours:  {self.ours}\n"
            f"  stored: {self.machine}, {self.time}, commits {self.commits}\n"
            f"  repeat with: {self.command}"
        )


STORED = (
    Stored(
        figure="Figs. 22, 23",
        quantity="Jiweishan: front of the landslide 60 s after release, friction 5/5, 5/15, 10/10 "
        "and 10/15 degrees between and inside the groups",
        paper="less far and less broken with more friction (no numbers)",
        ours="3,565 m, 3,249 m, 2,315 m, 2,309 m",
        machine="two cores of an Intel Xeon of 2.5 GHz",
        time="1.5 hours for the four",
        commits="1c2c57d, 8bb822a",
        command="cd examples/jiweishan; cdem sweep friction.yaml",
    ),
    Stored(
        figure="Figs. 26 to 28",
        quantity="mean slope of the critical friction angle over the dips north and west, 48 pairs",
        paper="0.90, -0.19",
        ours="0.900, -0.194 (closed form: the same)",
        machine="one thread of an AMD EPYC (Zen 4)",
        time="87 s of processor time",
        commits="5d31224c",
        command="cd examples/apparent_dip; cdem sweep study.yaml; python slopes.py study.sweep",
    ),
)
