"""Block sliding down a bed, whatever the mesh of the bed (Eq. 15)."""

import numpy as np

from cdem.output.render import snapshot

PAPER = "Fig. 18, Eq. 15"

BEDS = {
    "one face": ([1, 1, 1], "hex8"),
    "160 hexahedra": ([20, 8, 1], "hex8"),
    "2,016 tets": ([28, 12, 1], "tet4"),
}


def theory(gravity, friction_angle):
    """a = g (sin t - cos t tan phi), Feng et al. (2014), Eq. 15 [m/s2]."""
    return gravity[0] + gravity[2] * np.tan(np.radians(friction_angle))


def slide(simulation, until, after=0.1, every=200):
    """Times and speeds of the block along x, from `after` on."""
    nodes = simulation.build.nodes_of("block")
    mass = simulation.fields["mass"][nodes]
    rows = []
    while simulation.time < until:
        simulation.step(every)
        if simulation.time > after:
            speed = mass @ simulation.fields["velocity"][nodes, 0] / mass.sum()
            rows.append((simulation.time, speed))
    return np.array(rows).T


def run(study):
    """Three beds; sliders of one and of eight elements when full, and half the time step."""
    lines = {}
    variants: dict[str, list[str]] = {"": []}
    if study.full:
        variants |= {
            ", slider of 8 elements": ["model.blocks.1.box.divisions=[2, 2, 2]"],
            ", half the time step": ["time.safety=0.4"],
        }
    for name, (divisions, shape) in BEDS.items():
        for variant, settings in variants.items():
            bed = [f"model.blocks.0.box.divisions={divisions}", f"model.blocks.0.box.shape={shape}"]
            simulation = study.simulate(*bed, *settings)
            before = snapshot(simulation)
            time, speed = slide(simulation, 0.5)
            lines[name + variant] = time, speed
            study.check(f"acceleration on {name}{variant}", unit="m/s2", within=5e-5,
                        ours=np.polyfit(time, speed, 1)[0],
                        theory=theory(simulation.case.loads.gravity, 10))  # fmt: skip
    study.curve("Speed of the block", "time [s]", "speed [m/s]", lines)
    study.picture("On the bed of tets: start and 0.5 s", before, snapshot(simulation))
