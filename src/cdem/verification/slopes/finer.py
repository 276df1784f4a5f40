"""A slope with a finer mesh, or with rock of another stiffness: its factor must not change."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from typing import Any

import meshio
import numpy as np

from cdem.mesh.primitives import box
from cdem.verification.slopes.slope import GRAVITY, Slope


def finer(slope: Slope, cells: int) -> Slope:
    """Divide each body into cells by cells hexahedra; sections must have four corners."""
    case = deepcopy(slope.case)
    kept: list[dict[str, Any]] = []
    points: list[np.ndarray] = []
    hexes: list[np.ndarray] = []
    numbers: list[np.ndarray] = []
    groups: list[str] = []
    for block in case["model"]["blocks"]:
        if "box" in block:
            block["box"]["divisions"] = [cells, 1, cells]
            kept.append(block)
            continue
        corners = _in_turn(np.array(block["polyhedron"]["vertices"], float))
        unit = box("", (1, 1, 1), (cells, 1, cells))
        across, along = unit.points[:, [0]], unit.points[:, [2]]
        low = (1 - across) * corners[0] + across * corners[1]
        high = (1 - across) * corners[3] + across * corners[2]
        x = (1 - along) * low + along * high
        x[:, 1] = unit.points[:, 1] * np.ptp(np.array(block["polyhedron"]["vertices"])[:, 1])
        hexes.append(np.asarray(unit.cells["hex8"]) + sum(len(p) for p in points))
        points.append(x)
        if block["group"] not in groups:
            groups.append(block["group"])
        numbers.append(np.full(len(hexes[-1]), groups.index(block["group"]) + 1))
    case["model"]["blocks"] = kept
    if not points:
        return replace(slope, case=case)
    tags = [np.concatenate(numbers)]
    mesh = meshio.Mesh(np.concatenate(points), [("hexahedron", np.concatenate(hexes))],
                       cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
                       field_data={g: np.array([n, 3]) for n, g in enumerate(groups, 1)})  # fmt: skip
    return replace(slope, case=case, mesh=mesh)


def _in_turn(vertices: np.ndarray) -> np.ndarray:
    """Four corners of the front of a prism, counter-clockwise seen against y, shape (4, 3)."""
    front = vertices[np.abs(vertices[:, 1] - vertices[0, 1]) < 1e-9]
    middle = front.mean(axis=0)
    angle = np.arctan2(front[:, 2] - middle[2], front[:, 0] - middle[0])
    return np.asarray(front[np.argsort(angle)])


def stiffer(slope: Slope, strain: float) -> Slope:
    """Rock so stiff that the weight of the slope's height compresses it by a strain."""
    case: dict[str, Any] = deepcopy(slope.case)
    for material in case["materials"].values():
        material["young_modulus"] = material["density"] * GRAVITY * slope.height / strain
    return replace(slope, case=case)
