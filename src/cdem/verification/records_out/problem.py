"""Measures of motions against closed forms."""

import math
import tempfile
from pathlib import Path

import numpy as np

from cdem.output.motions import measure
from cdem.run.simulation import Simulation
from cdem.seismic.measures import arias, measures, newmark_slip, oscillate, spectrum

G = 9.81


def theory(peak, least, w):
    """Slip of a block on a flat base that moves with peak sin(w t) for half a cycle [m].

    Newmark (1965): it slides from the time when the base exceeds the yield acceleration `least`
    until the velocity of the base, less `least` times the time since, is 0.
    """
    start, end = math.asin(least / peak) / w, math.pi / w
    sine = (math.sin(w * end) - math.sin(w * start)) / w
    during = (
        peak / w * (math.cos(w * start) * (end - start) - sine) - least * (end - start) ** 2 / 2
    )
    speed = peak / w * (math.cos(w * start) - math.cos(w * end)) - least * (end - start)
    return during + speed**2 / (2 * least)


def check_closed_forms(study):
    """Oscillators, Arias intensity, slip."""
    step = spectrum(np.full(4001, 0.3), 1e-3, np.array([1.0]), 0.0)[0]
    study.check("Sa of a step of 0.3 m/s2, undamped", unit="m/s2", theory=0.6, ours=step,
                within=1e-9)  # fmt: skip
    t, w, xi = np.arange(20001) * 1e-3, 2 * math.pi, 0.05
    ours = oscillate(np.sin(w * t), 1e-3, np.array([1.0]), xi)[:, 0]
    own = w * math.sqrt(1 - xi**2)
    fall = np.exp(-xi * w * t)
    exact = (np.cos(w * t) - fall * (np.cos(own * t) + xi * w / own * np.sin(own * t))) / (
        2 * xi * w**2
    )
    study.check("resonance at 5 %, largest difference over the peak", theory=0, within=1e-5,
                ours=np.abs(ours - exact).max() / np.abs(exact).max(), absolute=True)  # fmt: skip
    found = arias(2 * np.sin(w * t[:5001]), 1e-3)[-1]
    study.check("Arias intensity of a sine", unit="m/s", theory=math.pi * 4 * 5 / (4 * G), ours=found,
                within=1e-9)  # fmt: skip
    t = np.arange(15001) * 2e-4
    pulse = np.where(t <= 0.5, 0.5 * G * np.sin(w * t), 0.0)
    study.check("slip under half a sine", unit="m", theory=theory(0.5 * G, 0.2 * G, w),
                ours=newmark_slip(pulse, 2e-4, 0.2 * G), within=1e-5)  # fmt: skip


def run(study):
    """Closed forms, then a run that is measured from its result folder."""
    check_closed_forms(study)
    case = study.case()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "results"
        Simulation(case, threads=study.threads, output=place).run()
        found = measure(place, to=None, yields=[], stage=None)
    record = case.processed("sine")
    exact, ours = measures(record), found.motions[0].parts["x"]
    for name, quantity in (("PGA", "pga"), ("PGV", "pgv"), ("Arias intensity", "arias")):
        study.check(f"{name} of the run", theory=getattr(exact, quantity),
                    ours=getattr(measures(ours), quantity), within=0.01)  # fmt: skip
    periods = np.array([0.1, 0.3, 0.5, 1.0])
    of_run = spectrum(ours.acceleration, ours.step, periods)
    of_record = spectrum(record.acceleration, record.step, periods)
    for period, one, other in zip(periods, of_record, of_run, strict=True):
        study.check(
            f"Sa of the run at {period:g} s", unit="m/s2", theory=one, ours=other, within=0.01
        )
    study.curve("Acceleration", "time [s]", "acceleration [m/s2]",
                {"record": (record.times, record.acceleration),
                 "history of the run": (ours.times, ours.acceleration)})  # fmt: skip
