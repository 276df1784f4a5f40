"""Slopes of soil: factor of safety by strength reduction (Griffiths & Lane, Dawson et al.)."""

import tempfile
from pathlib import Path

import meshio
import numpy as np

from cdem.mesh.primitives import box
from cdem.study.critical import find_critical, strength_reduction

HEIGHT, UNIT = 10.0, 20e3  # [m], [N/m3]
SLOPES = {
    "Griffiths & Lane": {"angle": np.degrees(np.arctan(0.5)), "crest": 12.0, "cohesion": 10e3,
                         "dilation": 0.0, "allowed": (1.36, 1.42)},
    "Dawson": {"angle": 45.0, "crest": 15.0, "cohesion": 12.38e3, "dilation": 20.0,
               "allowed": (0.98, 1.05)},
}  # fmt: skip
"""Angle [deg], crest [m], cohesion [Pa], dilation angle [deg] and allowed factors of safety:

Griffiths & Lane (1999), example 1, 2:1, c / (gamma H) = 0.05: 1.4 by finite elements, 1.38 by
Bishop & Morgenstern. Dawson, Roth & Drescher (1999): the cohesion at which limit analysis gives 1.
"""


def theory(slope):
    """Factor of safety: the middle of the allowed range, and half of its width."""
    low, high = SLOPES[slope]["allowed"]
    return (low + high) / 2, (high - low) / 2


def mesh(slope, rows, shape):
    """Rows of equal height and of equal number of cells, as long as the slope is there."""
    s = SLOPES[slope]
    foot = s["crest"] + HEIGHT / np.tan(np.radians(s["angle"]))
    cells = round(0.5 * (foot + s["crest"]) / HEIGHT * rows)
    soil = box("slope", (1.0, HEIGHT / rows, HEIGHT), (cells, 1, rows), shape=shape, mirrored=True)
    x = np.array(soil.points)
    x[:, 0] *= foot - x[:, 2] / np.tan(np.radians(s["angle"]))
    kind = {"hex8": "hexahedron", "tet4": "tetra"}[shape]
    tag = [np.ones(len(soil.cells[shape]), int)]
    return meshio.Mesh(x, [(kind, soil.cells[shape])],
                       cell_data={"gmsh:physical": tag, "gmsh:geometrical": tag},
                       field_data={"slope": np.array([1, 3])})  # fmt: skip


def factor_of_safety(study, slope, rows, shape, *settings, tolerance=0.01, report=None):
    """The middle of the bracket."""
    s = SLOPES[slope]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "slope.msh"
        meshio.write(path, mesh(slope, rows, shape), "gmsh22", binary=False)
        strength = {
            "cohesion": s["cohesion"],
            "friction_angle": 20,
            "dilation_angle": s["dilation"],
        }
        case = study.case(
            f"model.mesh={path}", f"materials.soil.dilation_angle={s['dilation']}", *settings
        )
        for key, value in strength.items():
            case.stages[1].set[f"materials.soil.{key}"] = value
        found = find_critical(case, strength_reduction(), (0.8, 1.8), tolerance=tolerance,
                              threads=study.threads, report=report)  # fmt: skip
    return found.value


def run(study):
    """Hexahedra and tets; one slope on a coarse mesh, or all on both when full."""
    for slope in SLOPES if study.full else ("Dawson",):
        middle, half = theory(slope)
        for shape in ("hex8", "tet4"):
            for rows in (10, 20) if study.full else (10,):
                ours = factor_of_safety(study, slope, rows, shape)
                study.check(f"factor of safety, {slope}, {shape}, {rows} rows", theory=middle,
                            ours=ours, within=half if rows == 20 else 1.5 * half,
                            absolute=True)  # fmt: skip
