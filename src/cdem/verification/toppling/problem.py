"""Angle at which a tilted 4:1 column topples (Table 1)."""

import numpy as np

from cdem.output.render import snapshot
from cdem.run.simulation import Simulation
from cdem.study.critical import find_critical

PAPER = "Fig. 15, Table 1"

GRAVITY = 9.81
# cells along a side of the bed, of 3 m, and of the column, of 1 m
MESHES = {"1:1": (3, 1), "1:2": (6, 1), "2:3": (9, 2)}


def theory(width, height):
    """Angle [deg] at which the weight leaves the base over its lower edge: atan(width / height)."""
    return np.degrees(np.arctan2(width, height))


def tilt(case, degrees):
    """Turn gravity instead of the model."""
    angle = np.radians(degrees)
    case.set("loads.gravity", [GRAVITY * np.sin(angle), 0.0, -GRAVITY * np.cos(angle)])


def act_at_indented(study, limit, width, height):
    """The paper's contacts stand on a base that is narrower by the indentation."""
    values = (0.002, 0.01, 0.05)
    angles = [limit("contact.action=indented", f"contact.indentation={a}") for a in values]
    exact = [theory(width * (1 - a), height) for a in values]
    for indentation, angle, there in zip(values, angles, exact, strict=True):
        study.check(f"tilt, contacts act at the indented, indentation {indentation}", unit="deg",
                    theory=there, ours=angle, within=0.003, absolute=True)  # fmt: skip
    whole = theory(width, height)
    study.curve("Error of forces at the indented point", "indentation [1]", "error [deg]",
                {"atan((1 - a) b / h)": (values, [whole - t for t in exact]),
                 ".contact.action: indented": (values, [whole - a for a in angles])}, log=True)  # fmt: skip


def soften(study, limit, exact):
    """Contacts that give let the column lean: the error grows with 1 / k."""
    softness = (0.01, 0.1, 1)
    errors = [abs(limit(f"interfaces.default.stiffness_n={k} E/h",
                        f"interfaces.default.stiffness_s={k} E/h") - exact) for k in softness]  # fmt: skip
    study.curve("Error of soft contacts", "k h / E [1]", "error [deg]",
                {".cdem": (softness, errors),
                 "1 / k": (softness, [errors[0] * softness[0] / k for k in softness])}, log=True)  # fmt: skip


def run(study):
    """Bisection over meshes; when full also over influences and over where the contacts act."""

    def limit(*settings):
        """Middle of the bracket [deg]."""
        return find_critical(study.case(*settings), tilt, (13.2, 14.4), tolerance=0.002,
                             threads=study.threads).value  # fmt: skip

    width, _, height = study.case().model.blocks[1].box.size
    exact = theory(width, height)
    for name, (below, above) in MESHES.items() if study.full else [("1:1", MESHES["1:1"])]:
        divisions = [f"model.blocks.{i}.box.divisions=[{n}, {n}, 1]"
                     for i, n in enumerate((below, above))]  # fmt: skip
        if below > 3 * above:  # the column's own face is touched, and yields; README.md
            divisions.append("interfaces.default.contact_stiffness=10 E/h")
        study.check(f"tilt, meshes {name}", unit="deg", theory=exact, ours=limit(*divisions),
                    paper=14.01 if name == "1:1" else None, within=0.003, absolute=True)  # fmt: skip
    if study.full:
        study.influences("tilt", limit, theory=exact, within=0.003, absolute=True, unit="deg")
        act_at_indented(study, limit, width, height)
        soften(study, limit, exact)
    case = study.case()
    simulation = Simulation(case, threads=study.threads)
    tilt(case, 16.0)
    shown = [snapshot(simulation)]
    simulation.core.set_gravity(case.loads.gravity)
    for time in (1.2, 2.0):
        while simulation.time < time:
            simulation.step(100)
        shown.append(snapshot(simulation))
    study.picture("A tilt of 16 degrees", *shown)
