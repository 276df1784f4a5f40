"""Semicircular arch without mortar: smallest thickness that stands (Couplet, Heyman)."""

import numpy as np

from cdem.output.render import snapshot
from cdem.study.verdict import stage_rests

QUICK = False  # half a minute
RADIUS, DEPTH, VOUSSOIRS = 5.0, 1.0, 13


def voussoirs(thickness):
    """Corners of the voussoirs from right to left, shape (n, 8, 3): x, y (depth), z up [m]."""
    angle = np.pi * np.arange(VOUSSOIRS + 1) / VOUSSOIRS
    joint = np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=1)
    inner, outer = (r * joint for r in (RADIUS - thickness / 2, RADIUS + thickness / 2))
    front = np.stack([inner[:-1], outer[:-1], outer[1:], inner[1:]], axis=1)
    return np.concatenate([front, front + [0, DEPTH, 0]], axis=1)


def area_and_moment(polygons):
    """Areas, and areas times x of the centroids, of polygons (n, 4, (x, z))."""
    x, z = polygons[..., 0], polygons[..., 1]
    x_next, z_next = np.roll(x, -1, axis=1), np.roll(z, -1, axis=1)
    cross = x * z_next - x_next * z
    return cross.sum(axis=1) / 2, ((x + x_next) * cross).sum(axis=1) / 6


def stands(thickness, parts=4000):
    """Whether a thrust line lies inside all joints.

    Half an arch is balanced by the thrust H at the crown, at height y: at the joint at angle f from
    the vertical the resultant passes r = (H y + sum W x) / (H cos f + W sin f) from the centre. For
    given H the joints bound H y from both sides, and the gap between the bounds is concave in H.
    """
    front = voussoirs(thickness)[:, :4, ::2]  # (n, 4, (x, z))
    half = VOUSSOIRS // 2
    (x_in, z_in), (x_out, z_out) = front[half, :2]
    right_half = np.array(
        [[[0, z_in], [x_in, z_in], [x_out, z_out], [0, z_out]]]
    )  # of the keystone
    area, moment = area_and_moment(np.concatenate([right_half, front[half - 1 :: -1]]))
    weight, turn = np.cumsum(area), np.cumsum(moment)  # of all above each joint
    f = np.pi / VOUSSOIRS * (0.5 + np.arange(half + 1))
    thrust = np.linspace(0.01, 1.0, parts)[:, None] * weight[-1]
    along = thrust * np.cos(f) + weight * np.sin(f)
    least = ((RADIUS - thickness / 2) * along - turn).max(axis=1)
    most = ((RADIUS + thickness / 2) * along - turn).min(axis=1)
    return (most > least).any()


def theory():
    """Smallest t / R for this number of voussoirs; 0.1075 for infinitely many (Milankovitch 1907)."""
    thin, thick = 0.05, 0.2
    while thick - thin > 1e-6:
        middle = 0.5 * (thin + thick)
        thin, thick = (thin, middle) if stands(middle * RADIUS) else (middle, thick)
    return thick


def settings(thickness):
    """The voussoirs and the two springers, as the blocks of the case."""
    rows = [
        [[round(float(v), 9) for v in corner] for corner in block] for block in voussoirs(thickness)
    ]
    blocks = [f"{{group: arch, polyhedron: {{vertices: {block}}}}}" for block in rows]
    wide = thickness + 1.0
    for side in (-1, 1):
        start = side * RADIUS - wide / 2
        blocks.append(f"{{group: springers, box: {{size: [{wide}, {DEPTH + 1}, 1]}}, "
                      f"translate: [{start}, -0.5, -1]}}")  # fmt: skip
    return f"model.blocks=[{', '.join(blocks)}]"


def run(study):
    """Bisection over the thickness; each trial relaxes an arch of its own."""
    exact = theory()
    stand, fall = 1.06 * exact, 0.94 * exact
    trials = {}
    for ratio in (stand, fall):
        trials[ratio] = stage_rests(study.simulate(settings(ratio * RADIUS))).stable
    if trials != {stand: True, fall: False}:
        raise RuntimeError(f"stands and falls as {trials}, expected at {exact}")
    while stand - fall > (0.002 if study.full else 0.005) * exact:
        ratio = 0.5 * (stand + fall)
        if stage_rests(study.simulate(settings(ratio * RADIUS))).stable:
            stand = ratio
        else:
            fall = ratio
    study.check(f"smallest t / R, {VOUSSOIRS} voussoirs", theory=exact, ours=0.5 * (stand + fall),
                within=0.01)  # fmt: skip
    simulation = study.simulate(settings(fall * RADIUS), "stages.0={name: fall, mode: dynamic, "
                                "duration: 3, damping: {contact: 0.2, stiffness: 0.2}}")  # fmt: skip
    shown = [snapshot(simulation)]
    for time in (1.0, 1.5):
        simulation.run_until(time)
        shown.append(snapshot(simulation))
    study.picture(f"t / R = {fall:.4f}: start, 1.0 s, 1.5 s", *shown)
