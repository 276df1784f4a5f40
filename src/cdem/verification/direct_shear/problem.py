"""Direct shear of a joint with dilation."""

import numpy as np


def theory(slip, pressure, law, stiffness=0.0):
    """Shear stress [Pa], pressure [Pa] and opening [m] of a joint sheared by `slip` (growing) [m].

    Elastic, then plastic slip s with |tau| = sigma tan(phi), which opens the joint by tan(psi) s
    until s has reached the dilation slip. Against a stiffness K of what is around the opening
    raises the pressure by K tan(psi) s, and tau = k_s (slip - s) gives s.
    """
    friction, dilation = np.tan(np.radians([law.friction_angle, law.dilation_angle]))
    shear = law.stiffness_s.value / 2  # only the slab's semi-springs act, for half of the area each
    plastic = np.maximum(shear * slip - pressure * friction, 0)
    opening = dilation * np.minimum(
        plastic / (shear + stiffness * dilation * friction), law.dilation_slip
    )
    pressure = pressure + stiffness * opening
    return np.minimum(shear * slip, pressure * friction), pressure, opening


def shear(simulation, end):
    """Rows of time, slip, shear stress, pressure and height of the slab; and the ledger's error."""
    nodes, start = simulation.build.nodes_of("slab"), simulation.fields["position"].copy()
    low = nodes[start[nodes, 2] < 0.1]
    rows = []
    while simulation.time < end - 1e-9 and simulation.run_until(simulation.time + 0.01):
        moved = (simulation.fields["position"] - start)[low].mean(axis=0)
        force = simulation.contacts["force"].sum(axis=0)
        rows.append((simulation.time, moved[0], -force[0], force[2], moved[2]))
    return np.array(rows).T, simulation.energies["error"]


def run(study):
    """At constant load and back; under a fixed lid."""
    simulation = study.simulate()
    law, load = simulation.case.interfaces.default, 1e6
    (time, slip, stress, _, height), error = shear(simulation, 0.5)
    forth = (time > 0.051) & (time < 0.361)
    rest = height[time < 0.051][-1]
    theirs = theory(slip[forth], load, law)
    study.check("constant load: shear stress while it slides", theory=theirs[0][-1],
                ours=stress[forth][-1], within=1e-12, unit="Pa")  # fmt: skip
    study.check("constant load: opening at half of the dilation slip", theory=theirs[2][10],
                ours=(height[forth] - rest)[10], within=0.0034, unit="m")  # fmt: skip
    study.check("constant load: opening in the end", theory=theirs[2][-1],
                ours=height[forth][-1] - rest, within=1e-12, unit="m")  # fmt: skip
    study.check("constant load: opening stays when it slides back", theory=height[forth][-1] - rest,
                ours=height[-1] - rest, within=1e-13, unit="m")  # fmt: skip
    study.check("constant load: error of the energy ledger", theory=0, ours=error, within=1e-8,
                absolute=True)  # fmt: skip
    study.curve("Opening of the joint", "slip [m]", "opening [m]", {
        "theory": (slip[forth], theirs[2]),
        ".constant load": (slip[forth], height[forth] - rest)})  # fmt: skip

    simulation = study.simulate(file="lid.yaml")
    rock, slab = simulation.case.materials["rock"], simulation.case.model.blocks[1].box
    stiffness = 1 / (2 / law.stiffness_n.value + slab.size[2] / rock.young_modulus)
    (time, slip, stress, pressure, _), error = shear(simulation, 0.4)
    forth = time > 0.051
    theirs = theory(slip[forth], load, law, stiffness)
    for name, place, within in (
        ("at half of the dilation slip", 10, 5e-4),
        ("in the end", -1, 5e-9),
    ):
        study.check(f"fixed lid: pressure {name}", theory=theirs[1][place], within=within,
                    ours=pressure[forth][place], unit="Pa")  # fmt: skip
        study.check(f"fixed lid: shear stress {name}", theory=theirs[0][place], within=within,
                    ours=stress[forth][place], unit="Pa")  # fmt: skip
    study.check("fixed lid: error of the energy ledger", theory=0, ours=error, within=1e-8,
                absolute=True)  # fmt: skip
    study.curve("Pressure and shear stress under a fixed lid", "slip [m]", "stress [Pa]", {
        "pressure, theory": (slip[forth], theirs[1]), ".pressure": (slip[forth], pressure[forth]),
        "shear stress, theory": (slip[forth], theirs[0]),
        ".shear stress": (slip[forth], stress[forth])})  # fmt: skip
