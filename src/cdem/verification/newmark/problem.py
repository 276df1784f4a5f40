"""Block on a shaken slope (Newmark)."""

from itertools import pairwise

import numpy as np

from cdem.output.render import snapshot


def theory(gravity, friction_angle, history):
    """Slip of a rigid block down a slope that moves as `history` says (Newmark 1965) [m].

    It slips while the slope accelerates upwards by more than a_y = g (cos t tan phi - sin t), and
    goes on until its own velocity, which falls behind at a_y, has caught up.
    """
    yield_rate = -gravity[2] * np.tan(np.radians(friction_angle)) + gravity[0]
    slip = behind = 0.0
    for (t0, v0), (t1, v1) in pairwise(history):
        rate = (v1 - v0) / (t1 - t0) - yield_rate  # at which the block falls behind while it slips
        left = t1 - t0
        if behind > 0 and rate < 0 and behind < -rate * left:
            slip, behind, left = slip + behind**2 / (-2 * rate), 0.0, 0.0
        elif behind > 0 or rate > 0:
            slip, behind = slip + behind * left + 0.5 * rate * left**2, behind + rate * left
    return slip


def shake(simulation):
    """Times, slips, and the surface before and after."""
    simulation.run_stage("rest")
    mass, start = simulation.fields["mass"], simulation.fields["position"].copy()
    groups = [simulation.build.nodes_of(name) for name in ("table", "block")]
    shown, rows = [snapshot(simulation)], []
    while simulation.run_until(simulation.time + 0.01) == "running":
        moved = simulation.fields["position"][:, 0] - start[:, 0]
        table, block = (mass[i] @ moved[i] / mass[i].sum() for i in groups)
        rows.append((simulation.time, table - block))
    return *np.array(rows).T, [*shown, snapshot(simulation)]


def run(study):
    """The slip after three pulses, of rock that is ever stiffer."""
    errors, lines = [], {}
    within = {"1 GPa": 0.02, "10 GPa": 0.005, "100 GPa": 0.002}
    for modulus in within if study.full else ["10 GPa"]:
        simulation = study.simulate(f"materials.rock.young_modulus={modulus}")
        case = simulation.case
        time, slip, shown = shake(simulation)
        exact = theory(case.loads.gravity, case.interfaces.default.friction_angle,
                       case.loads.velocities[0].history)  # fmt: skip
        study.check(f"slip after three pulses, E = {modulus}", unit="m", theory=exact,
                    ours=slip[-1], within=within[modulus])  # fmt: skip
        errors.append((case.materials["rock"].young_modulus, abs(slip[-1] / exact - 1)))
        lines[f"E = {modulus}"] = time, slip
    study.curve("Slip of the block", "time [s]", "slip [m]", lines)
    if study.full:
        study.curve("Error of the slip", "Young's modulus [Pa]", "error [1]",
                    {".cdem": tuple(np.transpose(errors))}, log=True)  # fmt: skip
    study.picture("Before and after the shaking", *shown)
