"""Two arms that are bonded along their length, pulled apart at one end: a crack in mode I."""

import numpy as np

from cdem.output.render import snapshot

LENGTHS = ((0.3, 0.4), (0.4, 0.5))
"""Lengths of the crack over which the force is averaged [m]."""


def theory(rock, joint, width, height):
    """Length of the crack [m], opening of the end [m] and force [N] while it grows.

    Arms are Euler-Bernoulli beams on the springs of the joint (Kanninen 1973, Int. J. Fract. 9, 83):
    with EI of an arm and l = (2 k_n b / (4 EI))^(1/4) the compliance is

        C = 2 / EI (a^3 / 3 + a^2 / l + a / l^2 + 1 / (2 l^3)),    G = P^2 / (2 b) dC/da

    Args:
        rock: Material of the arms.
        joint: Interface.
        width: Of the arms [m].
        height: Of one arm [m].
    """
    stiffness = rock.young_modulus * width * height**3 / 12
    length = (2 * joint.stiffness_n.value * width / (4 * stiffness)) ** 0.25
    a = np.linspace(0.05, 0.6, 2000)
    slope = 2 / stiffness * (a + 1 / length) ** 2
    force = np.sqrt(2 * width * joint.fracture_energy_1 / slope)
    part = a**3 / 3 + a**2 / length + a / length**2 + 1 / (2 * length**3)
    return a, force * 2 / stiffness * part, force


def run(study):
    """The force over the opening, and the energy that the crack takes; finer when full."""
    for cells in (56, 112) if study.full else (56,):
        sim = study.simulate(
            *(f"model.blocks.{k}.box.divisions=[{cells}, 1, {cells // 14}]" for k in (0, 1)),
            *([] if study.full else ["materials.rock.density=10000"]),  # longer steps, slow as well
        )
        joint = sim.case.interfaces.default
        a, opening, force = theory(sim.case.materials["rock"], joint, 0.1, 0.05)
        start = sim.build.start_position
        end = np.flatnonzero((start[:, 0] < 1e-6) & (start[:, 2] > 1e-3))
        rows = []
        while sim.time < sim.case.stages[0].duration:
            sim.run_until(sim.time + 5e-4)
            opened = 2 * sim.fields["displacement"][end, 2].mean()
            rows.append((opened, sim.fields["reaction"][end, 2].sum(), sim.energies["fracture"]))
        opened, pulled, spent = np.array(rows).T
        length = np.interp(opened, opening, a)
        for first, last in LENGTHS:
            some = (length >= first) & (length <= last)
            ratio = (pulled / np.interp(opened, opening, force))[some].mean()
            study.check(f"force over theory, crack of {first} to {last} m, {cells} cells", theory=1,
                        ours=ratio, within=0.02)  # fmt: skip
        some = np.flatnonzero((length >= LENGTHS[0][0]) & (length <= LENGTHS[-1][1]))[[0, -1]]
        study.check(f"energy for each m2 of the crack, {cells} cells", unit="J/m2",
                    theory=joint.fracture_energy_1, within=0.04 * 56 / cells,
                    ours=np.diff(spent[some])[0] / (0.1 * np.diff(length[some])[0]))  # fmt: skip
        study.check(f"energy error, {cells} cells", theory=0, ours=sim.energies["error"],
                    absolute=True, within=1e-6)  # fmt: skip
    study.curve("Force at the end", "opening [mm]", "force [N]", {
        "beams on springs": (1e3 * opening, force), ".run": (1e3 * opened, pulled)})  # fmt: skip
    study.picture("The crack", snapshot(sim), field="damage")
