"""Rigid block on a plane that follows a record (Newmark)."""

import numpy as np

G = 9.81
SAMPLE = 0.005  # [s]
SLIPS = {(0, 8): (0.08280, 0.09130), (10, 20): (0.04048, 0.04624), (20, 30): (0.04392, 0.05018),
         (30, 35): (0.33490, 0.35082)}  # fmt: skip
"""Dip and friction angle [deg]: slip under the record and under the turned record [m]."""


def theory(acceleration, step, dip, friction, parts=50):
    """Slip of a rigid block down a plane (Newmark 1965), by small steps [m].

    Args:
        acceleration: Of the plane, horizontal, positive up the slope [m/s2].
        step: Time between samples [s].
        dip: Of the plane [rad].
        friction: Friction angle [rad].
        parts: Small steps between samples.
    """
    count = (len(acceleration) - 1) * parts + 1
    a = np.interp(np.arange(count) / parts, np.arange(len(acceleration)), acceleration)
    drive = G * np.sin(dip) + a * np.cos(dip)
    rate = drive - np.tan(friction) * (G * np.cos(dip) - a * np.sin(dip))
    slip = speed = 0.0
    for mean in 0.5 * (rate[1:] + rate[:-1]):
        if speed > 0 or mean > 0:
            after = max(speed + mean * step / parts, 0.0)
            slip += 0.5 * (speed + after) * step / parts
            speed = after
    return slip


def slips(simulation):
    """Times, and position of the block on the plane along x; x goes down the slope [m]."""
    simulation.run_stage("rest")
    nodes = {name: simulation.build.nodes_of(name) for name in ("table", "block")}
    start = simulation.fields["position"].copy()
    rows = []
    while simulation.run_until(simulation.time + SAMPLE) == "running":
        moved = simulation.fields["position"][:, 0] - start[:, 0]
        rows.append((simulation.time, moved[nodes["block"]].mean() - moved[nodes["table"]].mean()))
    return np.array(rows).T


def settings(dip, friction, sense):
    """Values of the case for a plane: gravity is tilted, not the model."""
    c, s = float(np.cos(np.radians(dip))), float(np.sin(np.radians(dip)))
    return (
        f"interfaces.default.friction_angle={friction}",
        f"loads.gravity=[{G * s!r}, 0, {-G * c!r}]",
        f"loads.velocities.0.velocity=[{-sense * c!r}, 0, {-sense * s!r}]",  # horizontal, up the slope
    )


def run(study):
    """Four planes under the record and, in the full run, the turned record."""
    record = study.case().processed("synthetic")
    lines = {}
    for (dip, friction), exact in SLIPS.items():
        for sense, slip, which in ((1, exact[0], "record"), (-1, exact[1], "turned record")):
            small = theory(
                sense * record.acceleration, record.step, np.radians(dip), np.radians(friction)
            )
            name = f"{dip}/{friction} deg, {which}"
            study.check(f"{name}: small steps", unit="m", theory=slip, ours=small, within=5e-4)
            if sense < 0 and (dip == 0 or not study.full):
                continue  # flat: the backward slips of the run before
            time, moved = slips(study.simulate(*settings(dip, friction, sense)))
            lines[name] = time, moved
            if dip > 0:
                study.check(f"{name}: run", unit="m", theory=slip, ours=moved[-1], within=0.005)
                continue
            ways = np.diff(moved)
            study.check(f"{name}: run, forward", unit="m", theory=slip, ours=ways[ways > 0].sum(),
                        within=0.005)  # fmt: skip
            study.check(f"{name}: run, backward", unit="m", theory=exact[1], ours=-ways[ways < 0].sum(),
                        within=0.005)  # fmt: skip
    study.curve("Slip of the block", "time [s]", "slip [m]", lines)
