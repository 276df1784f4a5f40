"""A beam of two layers with a crack between them, bent at three points: a crack in mode II."""

import numpy as np

from cdem.output.render import snapshot

QUICK = False  # 40 s; quick are `softening_joint` in shear and `dcb`, a crack that runs
LENGTHS = (0.39, 0.43)
"""Lengths of the crack between which force and energy are compared [m]."""
WIDTH, HEIGHT, HALF = 0.02, 0.05, 0.5
"""Of the beam, of one layer, and half of the span [m]."""


def softening_zone(rock, joint, a):
    """Length of the softening part [m] and shear force [N] while a crack of length a [m] grows.

    Layers are beams that carry an axial force N, which the joint builds up: N' = b tau. The slip is
    s' = 2 N / (E b h) - 6 M / (E b h^2) from the crack's end on, so with the shear force V

        s'' = 8 tau / (E h) - 6 V / (E b h^2)

    tau rises by k s to c and falls to nothing at s = 2 G / c. Both parts have closed forms. They join
    where s = c / k, and the length of the softening part follows by halving its bracket.
    """
    modulus, stiffness = rock.young_modulus, joint.stiffness_s.value
    first, last = joint.cohesion / stiffness, 2 * joint.fracture_energy_2 / joint.cohesion
    fall = joint.cohesion / (last - first)
    decay, turn = (np.sqrt(8 * k / (modulus * HEIGHT)) for k in (stiffness, fall))
    whole = 3 / (4 * WIDTH * HEIGHT)  # tau of a beam in one piece for each V
    slope = 6 * a / (modulus * WIDTH * HEIGHT**2)

    def state(zone):
        sine, cosine = np.sin(turn * zone), np.cos(turn * zone)
        shear = (last - first) / (whole / fall * (1 - cosine) + slope / turn * sine)
        far = 1 - 2 * np.exp(-decay * (HALF - a - zone))  # V changes sign below the load
        inside = shear * (whole / fall * turn * sine + slope * cosine)
        return shear, inside - decay * (first - shear * whole / stiffness * far)

    short, long = 0.0, min(HALF - a, 0.5 * np.pi / turn)
    while long - short > 1e-9:
        zone = 0.5 * (short + long)
        short, long = (zone, long) if state(zone)[1] > 0 else (short, zone)
    return short, state(short)[0]


def deflection(rock, joint, a, zone, shear):
    """Of the point of the load [m]: curvature times the moment of a unit load, and shear (5/6 b h)."""
    modulus, stiffness = rock.young_modulus, joint.stiffness_s.value
    first, last = joint.cohesion / stiffness, 2 * joint.fracture_energy_2 / joint.cohesion
    fall = joint.cohesion / (last - first)
    decay, turn = (np.sqrt(8 * k / (modulus * HEIGHT)) for k in (stiffness, fall))
    whole = 3 * shear / (4 * WIDTH * HEIGHT)
    x = np.linspace(0, 2 * HALF, 20001)
    soft = turn * (x - a)
    softening = whole * (1 - np.cos(soft)) + (
        6 * shear * a * fall / (modulus * WIDTH * HEIGHT**2 * turn) * np.sin(soft)
    )
    start, load = np.exp(-decay * (x - a - zone)), np.exp(-decay * np.abs(HALF - x))
    left = whole * (1 - load)
    left += start * (joint.cohesion - whole * (1 - np.exp(-decay * (HALF - a - zone))))
    tau = np.select([x < a, x < a + zone, x < HALF], [0, softening, left], -whole * (1 - load))
    step = x[1]
    axial = WIDTH * step * (np.cumsum(tau) - 0.5 * tau)
    unit = 0.5 * np.minimum(x, 2 * HALF - x)
    moment = 2 * shear * unit
    curvature = (moment - HEIGHT * axial) * 6 / (modulus * WIDTH * HEIGHT**3)
    sheared = 0.6 * 2 * shear * HALF * (1 + rock.poisson_ratio) / (modulus * WIDTH * HEIGHT)
    return float(np.sum(curvature * unit) * step + sheared)


def theory(rock, joint):
    """Lengths of the crack [m], deflection [m] and force [N] while it grows."""
    rows = []
    for a in np.linspace(0.38, 0.47, 46):
        zone, shear = softening_zone(rock, joint, a)
        rows.append((a, deflection(rock, joint, a, zone, shear), 2 * shear))
    return np.array(rows).T


def run(study):
    """The force over the deflection, and the energy that the crack takes; finer when full."""
    for cells in (100, 200) if study.full else (100,):
        sim = study.simulate(
            *(
                f"model.blocks.{k}.box.divisions=[{length * cells // 100}, 1, {cells // 50}]"
                for k, length in enumerate((38, 62, 100))
            )
        )
        joint = sim.case.interfaces.pairs[0]
        crack, bent, force = theory(sim.case.materials["rock"], joint)
        start = sim.build.start_position
        load = np.flatnonzero((np.abs(start[:, 0] - HALF) < 1e-6) & (start[:, 2] > HEIGHT - 1e-4))
        rows = []
        while sim.time < sim.case.stages[0].duration:
            sim.run_until(sim.time + 5e-4)
            down = -sim.fields["displacement"][load, 2].mean()
            rows.append((down, -sim.fields["reaction"][load, 2].sum(), sim.energies["fracture"]))
        down, pressed, spent = np.array(rows).T
        length = np.interp(down, bent, crack)
        some = np.flatnonzero((length >= LENGTHS[0]) & (length <= LENGTHS[1]))
        first, last = LENGTHS
        study.check(f"force over theory, crack of {first} to {last} m, {cells} cells", theory=1,
                    ours=(pressed / np.interp(down, bent, force))[some].mean(), within=0.04)  # fmt: skip
        study.check(f"energy for each m2 of the crack, {cells} cells", unit="J/m2",
                    theory=joint.fracture_energy_2, within=0.04,
                    ours=np.ptp(spent[some]) / (WIDTH * np.ptp(length[some])))  # fmt: skip
        study.check(f"energy error, {cells} cells", theory=0, ours=sim.energies["error"],
                    absolute=True, within=3e-6)  # fmt: skip
    study.curve("Force at the load", "deflection [mm]", "force [N]", {
        "beams with a softening joint": (1e3 * bent, force), ".run": (1e3 * down, pressed)})  # fmt: skip
    study.picture("The crack", snapshot(sim), field="damage")
