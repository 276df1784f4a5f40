"""Friction that falls with the speed of slip too fast for the time step."""

from __future__ import annotations

from dataclasses import dataclass

from cdem.model.interfaces import interfaces_of, name_of
from cdem.run.state import RunState


@dataclass
class FastWeakening:
    """The worst contact of an interface.

    Attributes:
        interface: Its name, or the two groups.
        ratio: Fraction of a change of speed that returns in the next step through friction [1].
        place: Position of the contact [m].
        step: Time step [s].
    """

    interface: str
    ratio: float
    place: tuple[float, float, float]
    step: float

    def text(self) -> str:
        """A one-line warning."""
        place = ", ".join(f"{x:.4g}" for x in self.place)
        return (
            f"friction of interface {self.interface} falls with the speed of slip {self.ratio:.3g} times "
            f"too fast for a step of {self.step:.3g} s at ({place}) m: the contact may "
            f"chatter. Take time.step below {0.5 * self.step / self.ratio:.2g} s, or a larger velocity"
        )


def fast_weakenings(sim: RunState) -> list[FastWeakening]:
    """The worst contact of each interface whose friction falls too fast for the step."""
    found = [one for one in sim.core.fast_weakenings() if one[1] >= 1]
    if not found:
        return []
    laws, _ = interfaces_of(sim.case, sim.build.group_names)
    step = float(sim.core.scalars()["dt"])
    return [
        FastWeakening(name_of(laws[index]), ratio, (x, y, z), step)
        for index, ratio, x, y, z in found
    ]
