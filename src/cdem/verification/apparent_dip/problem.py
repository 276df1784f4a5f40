"""Sliding along an apparent dip: critical friction angle (CFFA, Figs. 24-28)."""

import itertools

import numpy as np

from cdem.output.render import snapshot
from cdem.study.critical import find_critical

PAPER = "Figs. 24 to 28"

GRAVITY = 9.81


def theory(north, west):
    """Critical friction angle [deg] of a rigid body on a bed that dips `north` and `west` [deg].

    It slides north along a vertical wall on its west side, whose tan(phi) is half the bed's:

        N_bed = W cos^2(a) sqrt(1 + tan^2 a + tan^2 b),  N_wall = W cos^2(a) tan b,  T = W sin a.
    """
    a, b = np.tan(np.radians([north, west]))
    along = np.cos(np.radians(north))
    return np.degrees(np.arctan((a / along) / (np.sqrt(1 + a * a + b * b) + b / 2)))


def settings(north, west):
    """Bed, body and held gravity for two apparent dips [deg], as values of the case."""
    a, b = np.tan(np.radians([north, west]))

    def prism(x0, x1, y0, y1, low, high):
        """Vertical prism between two planes parallel to the bed."""
        plan = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        rows = [[x, y, x * b - y * a + z] for z in (low, high) for x, y in plan]
        return [[round(float(v), 9) for v in row] for row in rows]

    turn = np.radians(north)
    held = [0.0, -GRAVITY * np.sin(turn) * np.cos(turn), -GRAVITY * np.cos(turn) ** 2]
    return [
        f"model.blocks.0.polyhedron.vertices={prism(0, 8, -4, 18, -3, 0)}",
        f"model.blocks.2.polyhedron.vertices={prism(0, 4, 0, 10, 0, 3)}",
        f"loads.gravity={[float(g) for g in held]}",
    ]


def rub(case, degrees):
    """Friction angle of the bed; the wall's tangent is half of it."""
    case.set("interfaces.bed.friction_angle", degrees)
    half = np.degrees(np.arctan(0.5 * np.tan(np.radians(degrees))))
    case.set("interfaces.wall.friction_angle", float(half))


def run(study):
    """The dips of Jiweishan; when full, all pairs of five each way, and the mean slopes."""
    dips = [(20.344, 5.674)]
    if study.full:
        dips += itertools.product((10, 15, 20, 25, 30), (0, 5, 10, 20, 30))
    found = {}
    for north, west in dips:
        case, exact = study.case(*settings(north, west)), theory(north, west)
        between = (exact - 1.5, exact + 1.5)
        found[north, west] = find_critical(case, rub, between, tolerance=0.05,
                                           threads=study.threads).value  # fmt: skip
        study.check(f"critical friction angle, dips {north:g} north, {west:g} west", unit="deg",
                    theory=exact, ours=found[north, west], within=0.1, absolute=True)  # fmt: skip
    if study.full:
        rows = np.array([(n, w, value) for (n, w), value in list(found.items())[1:]])
        ones = np.ones(len(rows))
        plane = np.linalg.lstsq(np.column_stack([rows[:, :2], ones]), rows[:, 2], rcond=None)[0]
        exact = [theory(n, w) for n, w, _ in rows]
        best = np.linalg.lstsq(np.column_stack([rows[:, :2], ones]), exact, rcond=None)[0]
        for i, (name, paper) in enumerate((("north", 0.90), ("west", -0.19))):
            study.check(f"mean slope over the dip {name}", theory=best[i], ours=plane[i],
                        paper=paper, within=0.01, absolute=True)  # fmt: skip
        lines = {}
        for west in (0, 5, 10, 20, 30):
            some = rows[rows[:, 1] == west]
            lines[f"theory, {west} deg west"] = some[:, 0], [theory(n, west) for n in some[:, 0]]
            lines[f".cdem, {west} deg west"] = some[:, 0], some[:, 2]
        study.curve("Critical friction angle", "dip north [deg]", "angle [deg]", lines)
    simulation = study.simulate(
        "stages.1={name: slide, mode: dynamic, duration: 2, set: {loads.gravity: [0, 0, -9.81],"
        " interfaces.bed.friction_angle: 5, interfaces.wall.friction_angle: 2.5}}"
    )
    simulation.run_stage("load")
    shown = [snapshot(simulation)]
    simulation.run()
    study.picture("The body with 5 degrees of friction, start and 2 s", *shown,
                  snapshot(simulation))  # fmt: skip
