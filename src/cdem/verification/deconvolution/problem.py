"""Motion of the surface of layered ground, back to the up-going wave below it."""

from pathlib import Path

import numpy as np

from cdem.case.profile import Profile
from cdem.seismic.site_response import at_surface, deconvolved, surface_over_outcrop

STEP, COUNT, HIGHEST = 0.002, 8000, 20.0


def theory(t, frequency=4.0, at=1.0):
    """Ricker pulse with a peak of 1."""
    q = (np.pi * frequency * (t - at)) ** 2
    return (1 - 2 * q) * np.exp(-q)


def column(layers, upgoing, cell):
    """Surface of a column of lumped masses on a dashpot, by central differences.

    Args:
        layers: From the surface down; the last is the half space.
        upgoing: Velocity of the up-going wave below the column, every `STEP`.
        cell: Height of a cell [m].
    """
    cells = [layer for layer in layers[-2::-1] for _ in range(round(layer.thickness / cell))]
    density, speed = (np.array([getattr(c, k) for c in cells]) for k in ("density", "speed"))
    mass, stiffness = np.zeros(len(cells) + 1), density * speed**2 / cell
    mass[:-1] += density * cell / 2
    mass[1:] += density * cell / 2
    parts = int(np.ceil(STEP / (0.8 * cell / speed.max())))
    dt, dashpot = STEP / parts, np.zeros(len(mass))
    dashpot[0] = layers[-1].density * layers[-1].speed
    fine = np.interp(
        np.arange((len(upgoing) - 1) * parts + 1) / parts, np.arange(len(upgoing)), upgoing
    )
    u, v, out = np.zeros(len(mass)), np.zeros(len(mass)), []
    for k, now in enumerate(fine):
        if k % parts == 0:
            out.append(v[-1])
        spring = stiffness * np.diff(u)
        force = np.zeros(len(mass))
        force[:-1] += spring
        force[1:] -= spring
        force[0] += 2 * dashpot[0] * now
        v = ((mass / dt - dashpot / 2) * v + force) / (mass / dt + dashpot / 2)
        u = u + dt * v
    return np.array(out)


def run(study):
    """Round trip, peaks of the amplification, and a column that knows no matrices."""
    ground = Profile.load(Path(__file__).parent / "profile.yaml").ground
    t = np.arange(COUNT) * STEP
    pulse = theory(t)
    surface = at_surface(ground, pulse, STEP)
    study.check("PGV of the surface", theory=6.4745, ours=np.abs(surface).max(), within=1e-4)
    back, _ = deconvolved(ground, surface, STEP, HIGHEST)
    study.check("round trip, largest difference", theory=0, ours=np.abs(back - pulse).max(),
                within=5e-9, absolute=True)  # fmt: skip
    peaks = {3.183: 5.779, 6.727: 5.664, 9.966: 4.219}
    for frequency, exact in peaks.items():
        ours = abs(surface_over_outcrop(ground, np.array([frequency]))[0])
        study.check(
            f"surface over outcrop at {frequency:g} Hz", theory=exact, ours=ours, within=1e-3
        )
    of_column = column(ground, pulse[:2500], 0.5)
    study.check("PGV of the surface of the column", theory=6.4745, ours=np.abs(of_column).max(),
                within=0.003)  # fmt: skip
    below, _ = deconvolved(ground, np.r_[of_column, np.zeros(2500)], STEP, HIGHEST)
    study.check("surface of the column, deconvolved: largest difference", theory=0,
                ours=np.abs(below[:1500] - pulse[:1500]).max(), within=0.01, absolute=True)  # fmt: skip
    study.curve("Up-going wave", "time [s]", "velocity [1]",
                {"pulse": (t[:1500], pulse[:1500]),
                 "from the surface of the column": (t[:1500], below[:1500])})  # fmt: skip
    f = np.linspace(0.05, 15, 600)
    study.curve("Amplification", "frequency [Hz]", "surface over outcrop [1]",
                {"layers": (f, np.abs(surface_over_outcrop(ground, f))),
                 ".before": (list(peaks), list(peaks.values()))})  # fmt: skip
