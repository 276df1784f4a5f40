"""A record in closed form: reading, measures, baseline, spectrum."""

import numpy as np

from cdem.seismic.measures import measures, spectrum
from cdem.seismic.processing import of_acceleration, on_baseline

G = 9.81
STEP = 0.005


def theory(t):
    """Acceleration of the record at times t in s [m/s2]."""
    envelope = (t / 3) ** 2 * np.exp(2 * (1 - t / 3))
    sines = (0.55 * np.sin(2 * np.pi * 1.1 * t + 0.3) + 0.35 * np.sin(2 * np.pi * 2.7 * t + 1.1)
             + 0.25 * np.sin(2 * np.pi * 5.3 * t + 2.0))  # fmt: skip
    return 0.35 * G * envelope * sines


def drift(velocity, t):
    """The cubic of time, 0 at the begin, that is nearest to a velocity [m/s]."""
    powers = np.stack([t, t**2, t**3], axis=1)
    return powers @ np.linalg.lstsq(powers, velocity, rcond=None)[0]


def run(study):
    """The record as the case reads it, and after its baseline."""
    case = study.case()
    (_, read), (_, tapered), (_, used) = case.records["synthetic"].steps()
    t = read.times
    off = np.abs(read.acceleration - theory(t)).max() / np.abs(theory(t)).max()
    study.check("file against formula, of PGA", theory=0, ours=off, within=1e-9, absolute=True)
    found = measures(read)
    for name, exact, ours in (
        ("PGA [g]", 0.36495, found.pga / G), ("PGV [m/s]", 0.32926, found.pgv),
        ("Arias intensity [m/s]", 1.76636, found.arias), ("D5-95 [s]", 5.315, found.duration),
        ("CAV [m/s]", 7.7178, found.cav),
    ):  # fmt: skip
        study.check(name, theory=exact, ours=ours, within=1e-4)
    study.check("velocity at the end", unit="m/s", theory=-0.0096, ours=found.last_velocity,
                within=5e-5, absolute=True)  # fmt: skip
    whole = measures(on_baseline(of_acceleration(theory(t), STEP), "acceleration"))
    study.check("PGA with the baseline [g]", theory=0.36513, ours=whole.pga / G, within=1e-4)
    study.check("PGV with the baseline [m/s]", theory=0.33722, ours=whole.pgv, within=1e-4)
    study.check("velocity at the end with the baseline", unit="m/s", theory=0.0023,
                ours=whole.last_velocity, within=5e-5, absolute=True)  # fmt: skip
    left = used.velocity - (tapered.velocity - drift(tapered.velocity, t))
    study.check("baseline of the case against lstsq, of PGV", theory=0, within=1e-4, absolute=True,
                ours=np.abs(left).max() / measures(used).pgv)  # fmt: skip
    periods = np.array([0.1, 0.2, 0.5, 1.0, 2.0])
    sa = spectrum(read.acceleration, read.step, periods) / G
    for period, exact, one in zip(periods, (0.40801, 0.83673, 0.42788, 0.92173, 0.05397), sa,
                                  strict=True):  # fmt: skip
        study.check(f"Sa at {period:g} s, 5 % [g]", theory=exact, ours=one, within=1e-4)
    moved = {"as read": (t, read.velocity), "used": (t, used.velocity)}
    study.curve("Velocity", "time [s]", "velocity [m/s]", moved)
    smooth = np.geomspace(0.05, 5, 60)
    curve = spectrum(read.acceleration, read.step, smooth) / G
    study.curve("Response spectrum, 5 %", "period [s]", "Sa [g]",
                {"cdem": (smooth, curve), ".other program": (periods, sa)}, log=True)  # fmt: skip
