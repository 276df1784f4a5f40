"""Speed of P and S waves: first mode of a bar."""

import numpy as np

LENGTH = 20.0


def theory(rock, kind):
    """Wave speed [m/s]: sqrt(E (1 - nu) / ((1 + nu) (1 - 2 nu) rho)) or sqrt(G / rho)."""
    e, nu, rho = rock.young_modulus, rock.poisson_ratio, rock.density
    modulus = {
        "P": e * (1 - nu) / ((1 + nu) * (1 - 2 * nu)),  # no lateral strain
        "S": e / (2 * (1 + nu)),
    }
    return np.sqrt(modulus[kind] / rho)


def speed(simulation, axis, periods):
    """Wave speed from the zero crossings of the first mode's amplitude [m/s].

    A bar held at one end has modes sin((2 n + 1) pi x / 2 L). Whatever else moves, the projection on
    the first oscillates at w = pi c / 2 L.
    """
    x = simulation.build.start_position[:, 0]
    weight = simulation.fields["mass"] * np.sin(np.pi * x / (2 * LENGTH))
    crossings: list[float] = []
    before = None
    while len(crossings) < 2 * periods:
        simulation.step(4)
        now = simulation.time, weight @ simulation.fields["displacement"][:, axis]
        if before is not None and before[1] * now[1] < 0:
            share = before[1] / (before[1] - now[1])
            crossings.append(before[0] + share * (now[0] - before[0]))
        before = now
    half = (crossings[-1] - crossings[0]) / (len(crossings) - 1)
    return 2 * LENGTH / half


def run(study):
    """Both waves; all shapes and a convergence study when full."""
    shapes = ("hex8", "wedge6", "pyramid5", "tet4") if study.full else ("hex8",)
    ways = {"P": ([], 0),
            "S": (["groups.bar.fix=[x, z]", "groups.bar.velocity=[0, 1, 0]"], 1)}  # fmt: skip
    for shape in shapes:
        for kind, (settings, axis) in ways.items():
            sizes = {20: 3e-3 if shape == "pyramid5" else 1e-3}
            if study.full and shape in ("hex8", "tet4"):
                sizes = {5: 2e-2, 10: 5e-3, 20: 1e-3, 40: 3e-4}
            errors = []
            for cells, within in sizes.items():
                lateral = max(1, cells // 20)  # cubes, so that waves in tets stay plane
                box = f"{{size: [20, 1, 1], divisions: [{cells}, {lateral}, {lateral}], shape: {shape}}}"
                simulation = study.simulate(f"model.blocks.0.box={box}", *settings)
                exact = theory(simulation.case.materials["rock"], kind)
                ours = speed(simulation, axis, 3)
                study.check(f"{kind} wave speed, {shape}, {cells} cells", unit="m/s", theory=exact,
                            ours=ours, within=within)  # fmt: skip
                errors.append((LENGTH / cells, abs(ours / exact - 1)))
            if len(errors) > 1:
                h, error = np.transpose(errors)
                study.curve(f"Error of the {kind} wave speed, {shape}", "cell [m]", "error [1]",
                            {".cdem": (h, error), "second order": (h, error[-1] * (h / h[-1]) ** 2)},
                            log=True)  # fmt: skip
