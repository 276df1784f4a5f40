"""Forces of supports stay when quiet boundaries take their place."""

import numpy as np

BOX = "{{group: rock, box: {{size: [6, 2, 2], divisions: [6, 2, 2]}}, translate: [{x}, 0, {z}]}}"
BLOCKS = ", ".join(BOX.format(x=x, z=z) for x in (0, 6) for z in (0, 2, 4))
JOINTS = [f"model.blocks=[{BLOCKS}]", "stages.rest.tolerance=1e-7"]


def theory(bears, time):
    """Displacement of rock whose supports have gone, with or without their forces [m]."""
    return 0.0 if bears else 0.5 * 9.81 * time**2


def run(study):
    """One block, and rock with joints."""
    for name, within, settings in (("one block", 1e-9, []), ("with joints", 1e-6, JOINTS)):
        simulation = study.simulate(*settings)
        simulation.run_stage("rest")
        start = simulation.fields["position"].copy()
        simulation.run()
        study.check(f"{name}: largest displacement after 2 s", unit="m", theory=theory(True, 2.0), absolute=True,
                    ours=np.abs(simulation.fields["position"] - start).max(), within=within)  # fmt: skip
