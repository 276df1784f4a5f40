"""Square block swinging on its corner (Figs. 4, 5)."""

import numpy as np

from cdem.output.render import snapshot

PAPER = "Figs. 4, 5"

GRAVITY, SIDE = 9.81, 10.0
ARM = SIDE / np.sqrt(2)  # from the corner to the centre of mass [m]
START = np.radians(135)  # from straight down; the centre starts above and to the right
RATE2 = GRAVITY * ARM / (SIDE**2 / 6 + ARM**2)  # m g d / I, I = m a^2 / 6 + m d^2


def theory(times, parts=20):
    """Angles at `times` of theta'' = -(m g d / I) sin theta from rest at START (Runge-Kutta 4)."""
    state, now, angles = np.array([START, 0.0]), 0.0, []

    def rate(y):
        return np.array([y[1], -RATE2 * np.sin(y[0])])

    for then in times:
        h = (then - now) / parts
        for _ in range(parts):
            k1 = rate(state)
            k2 = rate(state + h / 2 * k1)
            k3 = rate(state + h / 2 * k2)
            k4 = rate(state + h * k3)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        now = then
        angles.append(state[0])
    return np.array(angles)


def period():
    """4 sqrt(I / (m g d)) K(sin(START / 2)); K by the arithmetic-geometric mean."""
    a, b = 1.0, np.cos(START / 2)
    for _ in range(8):
        a, b = (a + b) / 2, np.sqrt(a * b)
    return 2 * np.pi / (a * np.sqrt(RATE2))


def volume(simulation):
    """Of all blocks [m3], by the divergence theorem over their faces."""
    faces = simulation.build.topology.face_nodes
    quads = faces[faces[:, 3] >= 0]
    triangles = np.vstack([faces[:, :3], quads[:, [0, 2, 3]]])
    return np.linalg.det(simulation.fields["position"][triangles]).sum() / 6


def swing(simulation, periods):
    """Times, angles, volumes over the first, and energy errors, while the square swings."""
    mass = simulation.fields["mass"]
    rows, shown = [], [snapshot(simulation)]
    while simulation.time < periods * period():
        simulation.step(100)
        center = mass @ simulation.fields["position"] / mass.sum()
        angle = np.arctan2(center[0], -center[2])
        rows.append(
            (simulation.time, angle, volume(simulation) / SIDE**2, simulation.energies["error"])
        )
        if len(shown) < 3 and simulation.time > 0.25 * len(shown) * period():
            shown.append(snapshot(simulation))
    return np.array(rows).T, shown


def run(study):
    """Three periods; every shape when full, the updates of the paper beside the default."""
    shapes = {"hex8": 1}
    if study.full:
        shapes = {"hex8": 1, "wedge6": 2, "pyramid5": 2, "tet4": 2}
    for shape, cells in shapes.items():
        box = f"model.blocks.0.box={{size: [10, 1, 10], divisions: [{cells}, 1, {cells}], shape: {shape}}}"
        (time, angle, size, error), shown = swing(study.simulate(box), 3)
        exact = theory(time)
        study.check(f"{shape}: largest error of the angle over its amplitude", theory=0, absolute=True,
                    ours=np.abs(angle - exact).max() / START, within=1e-3)  # fmt: skip
        study.check(f"{shape}: change of volume", theory=0, absolute=True,
                    ours=np.abs(size - 1).max(), within=4e-5)  # fmt: skip
        study.check(f"{shape}: energy error", theory=0, absolute=True, ours=np.abs(error).max(),
                    within=2e-7)  # fmt: skip
        if shape == "hex8":
            study.picture("The square at the start, after a quarter and half a period", *shown)
            lines = {"pendulum": (time, np.degrees(exact)),
                     "corotational (default)": (time, np.degrees(angle))}  # fmt: skip
    if not study.full:
        study.curve("Angle of the square", "time [s]", "angle [deg]", lines)
        return
    volumes = {}
    for update in ("incremental", "paper-incremental", "paper-total"):
        (time, angle, size, _), _ = swing(study.simulate(f"elements.formulation={update}"), 1)
        lines[update], volumes[update] = (time, np.degrees(angle)), (time, 100 * (size - 1))
    study.curve("Angle of the square", "time [s]", "angle [deg]", lines)
    del volumes["paper-total"]  # a thousandfold
    study.curve("Volume change by incremental updates", "time [s]", "change [%]", volumes)
