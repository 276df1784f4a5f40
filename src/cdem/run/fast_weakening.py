"""Friction that falls with the speed of slip faster than a step can follow."""

from __future__ import annotations

from dataclasses import dataclass

from cdem.model.interfaces import interfaces_of, name_of
from cdem.run.state import RunState


@dataclass
class FastWeakening:
    """The worst contact of an interface.

    Attributes:
        interface: Its name, or what it is between.
        ratio: Part of a change of speed that comes back in the next step by the change of friction [1].
        place: Where the contact is [m].
        step: Time step [s].
    """

    interface: str
    ratio: float
    place: tuple[float, float, float]
    step: float

    def text(self) -> str:
        """One line for the user."""
        place = ", ".join(f"{x:.4g}" for x in self.place)
        return (
            f"friction of interface {self.interface} falls with the speed of slip {self.ratio:.3g} times "
            f"as fast as a step of {self.step:.3g} s can follow at ({place}) m: the contact may "
            f"chatter. Take time.step below {0.5 * self.step / self.ratio:.2g} s, or a larger velocity"
        )


def fast_weakenings(sim: RunState) -> list[FastWeakening]:
    """The worst contact of each interface that falls faster than a step can follow."""
    found = [one for one in sim.core.fast_weakenings() if one[1] >= 1]
    if not found:
        return []
    laws, _ = interfaces_of(sim.case, sim.build.group_names)
    step = float(sim.core.scalars()["dt"])
    return [
        FastWeakening(name_of(laws[index]), ratio, (x, y, z), step)
        for index, ratio, x, y, z in found
    ]
