"""Weight of a block under water: Archimedes, for all elements, with and without pores."""

import numpy as np

from cdem.rows import rows_of

DRY = "water.reservoir.level=-10"
TURN = "rotate: {axis: [1, 2, 3], angle: 40}"


def theory(density=2600.0, water=1000.0, gravity=9.81, volume=1.0):
    """Force on the bed [N] dry and under water (Archimedes), and the buoyancy."""
    return (
        density * gravity * volume,
        (density - water) * gravity * volume,
        water * gravity * volume,
    )


def blocks(shape, turned=False):
    """Bed and block of these elements, as a value of the case."""
    box = f"box: {{size: [1, 1, 1], divisions: [2, 2, 2], shape: {shape}}}"
    more = f", {TURN}, translate: [0, 0, 3]" if turned else ""
    return f"model.blocks=[{{group: bed, {box}, translate: [0, 0, -1]}}, {{group: block, {box}{more}}}]"


def water_on(simulation, group):
    """Sum of the forces of water on a group [N]."""
    force = rows_of(simulation.core, "node.water").force
    return force[simulation.build.nodes_of(group)].sum(axis=0)


def run(study):
    """Force on the bed, dry and wet; buoyancy of turned blocks."""
    dry, wet, buoyancy = theory()
    for shape in ("hex8", "wedge6", "tet4"):
        for biot in (0, 1):
            pores = f"materials.rock.biot={biot}"
            simulation = study.simulate(blocks(shape, turned=True), pores)
            error = water_on(simulation, "block") - [0, 0, buoyancy]
            study.check(f"buoyancy over theory, {shape}, turned, biot {biot}", theory=0.0,
                        ours=np.abs(error).max() / buoyancy, within=1e-9, absolute=True)  # fmt: skip
            for name, force, more in (("dry", dry, [DRY]), ("under water", wet, [])):
                simulation = study.simulate(blocks(shape), pores, *more)
                simulation.run()
                bed = simulation.build.nodes_of("bed")
                carried = (
                    simulation.fields["reaction"][bed, 2].sum() + water_on(simulation, "bed")[2]
                )
                study.check(f"force on the bed {name}, {shape}, biot {biot}", unit="N",
                            theory=force, ours=carried, within=3e-6)  # fmt: skip
