"""Sliding of a slice on a plane with cohesion: factor of safety (Hoek & Bray)."""

import numpy as np

from cdem.output.render import snapshot
from cdem.study.critical import find_critical, parameter, strength_reduction

LENGTH, WIDTH, HEIGHT = 8.0, 4.0, 5.0  # in plan, along the strike, vertical [m]
DIP = 35.0  # of the plane [deg]


def theory(case, dip):
    """Factor of safety of a slice on a plane (Hoek & Bray 1981, plane failure), its two shares.

    F = (c A + W cos(dip) tan(phi)) / (W sin(dip)): the first term is from cohesion.
    """
    law, turn = case.interfaces.pairs[0], np.radians(dip)
    weight = -case.loads.gravity[2] * case.materials["rock"].density * LENGTH * WIDTH * HEIGHT
    area = LENGTH * WIDTH / np.cos(turn)
    friction = weight * np.cos(turn) * np.tan(np.radians(law.friction_angle))
    return np.array([law.cohesion * area, friction]) / (weight * np.sin(turn))


def inclined(dip):
    """Bed and slice on a plane of another dip [deg], as values of the case."""
    fall = -LENGTH * np.tan(np.radians(dip))
    plan = ((0, 0), (LENGTH, 0), (LENGTH, WIDTH), (0, WIDTH))

    def prism(low):
        rows = [[x, y, low + z + fall * (x > 0)] for z in (0, HEIGHT) for x, y in plan]
        return [[round(float(v), 9) for v in row] for row in rows]

    return [
        f"model.blocks.{i}.polyhedron.vertices={prism(low)}" for i, low in enumerate((-HEIGHT, 0))
    ]


def factor(study, *settings):
    """Factor of safety by strength reduction."""
    case = study.case(*settings)
    return find_critical(case, strength_reduction(), (0.7, 3.0), tolerance=5e-4,
                         threads=study.threads).value  # fmt: skip


def vary(study, quantity, between):
    """Value of cohesion or friction angle at which the slice goes."""
    path = f"interfaces.plane.{quantity}"
    return find_critical(study.case(), parameter(path), between, tolerance=3e-4 * between[1],
                         threads=study.threads).value  # fmt: skip


def stiffen(study, exact):
    """Stiffer bonds: stress gathers at the ends of the slice, where the first bond breaks."""
    rows = []
    for stiffness in (0.1, 1, 10, 100):  # [GPa/m]
        law = [f"interfaces.pairs.0.stiffness_{way}={stiffness} GPa/m" for way in "ns"]
        ours = factor(study, *law)
        rows.append((stiffness, 1 - ours / exact))
        if stiffness <= 10:
            study.check(f"factor of safety, bonds of {stiffness:g} GPa/m", theory=exact, ours=ours,
                        within=3e-3 * stiffness)  # fmt: skip
    stiffness, short = np.transpose(rows)
    study.curve("Error of the factor of safety", "stiffness of the bonds [GPa/m]",
                "relative error [1]", {".cdem": (stiffness, short),
                "first order": (stiffness, short[0] * stiffness / stiffness[0])}, log=True)  # fmt: skip


def run(study):
    """Strength reduction, and one parameter varied; other dips and stiffer bonds when full."""
    case = study.case()
    law, (cohesion, friction) = case.interfaces.pairs[0], theory(case, DIP)
    study.check("factor of safety", theory=cohesion + friction, ours=factor(study), within=4e-4)
    study.check("cohesion at which it goes", unit="Pa", ours=vary(study, "cohesion", (1e4, 3e4)),
                theory=law.cohesion * (1 - friction) / cohesion, within=5e-4)  # fmt: skip
    tangent = np.tan(np.radians(law.friction_angle)) * (1 - cohesion) / friction
    study.check("friction angle at which it goes", unit="deg", theory=np.degrees(np.arctan(tangent)),
                ours=vary(study, "friction_angle", (2.0, 20.0)), within=4e-3, absolute=True)  # fmt: skip
    if study.full:
        dips = (25, 30, 35, 45, 55, 65)
        found = [factor(study, *inclined(dip)) for dip in dips]
        for dip, ours in zip(dips, found, strict=True):
            study.check(f"factor of safety, dip {dip} deg", theory=theory(case, dip).sum(), ours=ours,
                        within=4e-4)  # fmt: skip
        line = np.linspace(dips[0], dips[-1], 50)
        study.curve("Factor of safety", "dip of the plane [deg]", "factor of safety [1]", {
            "theory": (line, [theory(case, dip).sum() for dip in line]), ".cdem": (dips, found)})  # fmt: skip
        stiffen(study, cohesion + friction)
    simulation = study.simulate(
        "stages.1={name: slide, mode: dynamic, duration: 1, damping: {contact: 0.1, stiffness: 0.2},"
        " set: {interfaces.plane.cohesion: 15 kPa}}"
    )
    simulation.run_stage("load")
    shown = [snapshot(simulation)]
    simulation.run()
    study.picture("With 15 kPa of cohesion: start and 1 s", *shown, snapshot(simulation))
