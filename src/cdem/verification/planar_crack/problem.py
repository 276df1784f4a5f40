"""Line explosion near a joint without friction (Day)."""

import numpy as np

from cdem.verification import line_source
from cdem.verification.hexahedra import record

PRESSURE = 1e7  # [Pa]
ALONG = (25.0, 50.0, 75.0, 100.0)  # distances along the joint [m]


def theory(rock, x, t):
    """Slip of the joint [m]: the horizontal motion of a free surface at its place.

    Day (1985). The part of the source that is even about the plane leaves no shear stress there. The
    odd part has no normal stress there, so it is half the source under a free surface, whose
    horizontal motion counts on both faces: the slip is that of the whole source under a free surface.
    """
    return line_source.motion(rock, PRESSURE, x, t)[0]


def run(study):
    """The slip at four distances."""
    size = 1.25 if study.full else 2.5
    below = line_source.half_plane(size, 250.0, 120.0)
    above = line_source.layer(size, 250.0, 120.0)
    simulation = line_source.shake(study, {"rock": below, "cover": above}, size, PRESSURE)
    low, high = (line_source.at_surface(simulation, name, ALONG) for name in ("rock", "cover"))
    t, u, _ = record(simulation, np.concatenate([low, high]), 0.06, every=2)
    slip = u[:, : len(low), 0] - u[:, len(low) :, 0]
    rock = simulation.case.materials["granite"]
    shown: dict[str, tuple] = {}
    for k, x in enumerate(ALONG):
        exact = theory(rock, x, t)
        line_source.compare(study, f"slip at {x:g} m", t, exact, slip[:, k], 0.03)
        shown |= {f"{x:g} m": (1e3 * t, 1e3 * exact),
                  f".{x:g} m, cdem": (1e3 * t[::16], 1e3 * slip[::16, k])}  # fmt: skip
    study.curve("Slip of the joint", "time [ms]", "slip [mm]", shown)
