"""Flat ground between sides with a free field moves as a column of it does."""

import numpy as np

HEIGHT, CELLS = 60.0, 12
SPEED = 1.5  # peak of the waves [m/s]: differences show above the round-off of positions
STEP = 2e-3  # of their samples [s]


SMALL = ["records.shear.scale=1e-3", "records.push.scale=1e-3"]
NAMES = ("lower", "middle", "upper")
BOX = "{{group: {0}, box: {{size: [60, 60, {2}], divisions: [12, 12, {3}]}}, translate: [-30, -30, {1}]}}"
LAYERS = [
    "model.blocks=[" + ", ".join(BOX.format(*layer) for layer in zip(
        NAMES, (-30, 0, 20), (30, 20, 10), (6, 4, 2), strict=True)) + "]",
    "groups={" + ", ".join(f"{name}: {{material: {name}}}" for name in NAMES) + "}",
    "materials={lower: {density: 2200, young_modulus: 4.455 GPa, poisson_ratio: 0.25},"
    " middle: {density: 2000, young_modulus: 1.25 GPa, poisson_ratio: 0.25},"
    " upper: {density: 1900, young_modulus: 296.875 MPa, poisson_ratio: 0.25}}",
    "boundaries.base.surface.group=lower",
    *(f"boundaries.{side}.surface.group=[{', '.join(NAMES)}]"
      for side in ("east", "west", "north", "south")),
]  # fmt: skip


def theory(wave, times, height, speed):
    """Velocity of uniform ground at a height above its base [m/s]: up-going wave and its echo.

    v(t - z/c) + v(t - (2H - z)/c), with the wave v at the base.
    """
    return wave(times - height / speed) + wave(times - (2 * HEIGHT - height) / speed)


def pulse(times, frequency):
    """A Ricker wavelet with its peak at 0.2 s [m/s]."""
    a = (np.pi * frequency * (times - 0.2)) ** 2
    return SPEED * (1 - 2 * a) * np.exp(-a)


def run(study):
    """Several elements and layers; the free surface against the theory."""
    kinds = {
        "hexahedra": (1e-11, []),
        "wedges": (1e-11, ["model.blocks.0.box.shape=wedge6"]),
        "hexahedra that rotate": (2e-6, ["elements.formulation=corotational", *SMALL]),
        "tets": (0.01, ["model.blocks.0.box.shape=tet4"]),
        "three bonded layers": (1e-10, LAYERS),
    }
    for name, (within, settings) in kinds.items():
        simulation = study.simulate(*records(study), *settings)
        times, worst, top = motion(simulation)
        study.check(f"{name}: largest difference to the column, of the motion", theory=0,
                    ours=worst, absolute=True, within=within)  # fmt: skip
        if name == "hexahedra":
            rock = simulation.case.materials["rock"]
            modulus = rock.young_modulus / (2 * (1 + rock.poisson_ratio))
            exact = (
                theory(lambda t: pulse(t, 4.0), times, HEIGHT, np.sqrt(modulus / rock.density))
                * 2
                / np.sqrt(5)
            )  # direction [2, 1, 0]
            study.check("velocity of the surface along x, largest error", theory=0, absolute=True,
                        ours=np.abs(top - exact).max() / (2 * SPEED), within=0.02)  # fmt: skip
            study.curve("Surface", "time [s]", "velocity [m/s]",
                        {"theory": (times, exact), ".cdem": (times, top)})  # fmt: skip


def records(study):
    """Settings of the two records."""
    times = np.arange(0, 0.5, STEP)
    for name, frequency in (("shear", 4.0), ("push", 5.0)):
        samples = pulse(times, frequency).tolist()
        yield f"records.{name}={{samples: {samples}, unit: m/s, step: {STEP}}}"


def motion(simulation):
    """Times [s], largest difference to the column over its largest speed, and the surface [m/s]."""
    position = simulation.build.start_position
    build = simulation.build
    groups = [build.group_names.index(name) for name in NAMES if name in build.group_names]
    order = np.argsort(groups) if groups else np.zeros(1, int)
    level = (
        np.round((position[:, 2] / HEIGHT + 0.5) * CELLS).astype(int) + order[build.node_groups()]
    )
    corner = np.linalg.norm(position - 0.5 * HEIGHT * np.ones(3), axis=1).argmin()
    rows, worst, largest = [], 0.0, 0.0
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(1)
        velocity = simulation.fields["velocity"]
        column = simulation.core.fields()["columns.after"].reshape(-1, 4)[: level.max() + 1, :3]
        worst = max(worst, np.abs(velocity - column[level]).max())
        largest = max(largest, np.abs(column).max())
        half = 0.5 * simulation.core.scalars()["dt_last"]
        rows.append((simulation.time - half, velocity[corner, 0]))
    times, top = np.array(rows).T
    return times, worst / largest, top
