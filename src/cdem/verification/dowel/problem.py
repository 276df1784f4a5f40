"""Dowel: resistance that a bolt adds to a joint's friction."""

import numpy as np


def theory(shift, law, dowel, pressure=1e6, area=1.0):
    """Force that drives the slab [N]: friction, and the dowel's, elastic and then plastic."""
    friction = pressure * area * np.tan(np.radians(law.friction_angle))
    return friction + np.minimum(dowel.stiffness * shift, dowel.strength)


def run(study):
    """Driven to 6.45 mm; the dowel yields at 4 mm."""
    simulation = study.simulate()
    case = simulation.case
    nodes = simulation.build.nodes_of("slab")
    start, rows = simulation.fields["position"].copy(), []
    while simulation.time < 0.7 - 1e-9 and simulation.run_until(simulation.time + 0.01):
        moved = (simulation.fields["position"] - start)[nodes, 0].mean()
        rows.append((simulation.time, moved, simulation.fields["reaction"][nodes, 0].sum()))
    time, shift, force = np.array(rows).T
    slides = time > 0.1
    exact = theory(shift, case.interfaces.default, case.bolt_types["bar"].dowel)
    for where, at in (("2 mm", 0.002), ("6 mm, where it has yielded", 0.006)):
        k = np.abs(shift - at).argmin()
        study.check(f"force at {where}", theory=exact[k], ours=force[k], within=2e-4, unit="N")
    study.check("energy lost in the bolt", theory=200e3 * (shift[-1] - 0.004), within=1e-3, unit="J",
                ours=simulation.energies["bolt_loss"])  # fmt: skip
    study.check("error of the energy ledger", theory=0, ours=simulation.energies["error"],
                within=1e-6, absolute=True)  # fmt: skip
    study.curve("Force that drives the slab", "shift [m]", "force [N]", {
        "theory": (shift[slides], exact[slides]), ".cdem": (shift[slides], force[slides])})  # fmt: skip
