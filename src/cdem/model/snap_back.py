"""Bonds and elements that would lose strength faster than they unload are refused."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.case.case import Case
from cdem.case.interface_schema import Interface
from cdem.case.laws import INTERFACE_LAWS
from cdem.case.softening import tables_of
from cdem.errors import ModelError
from cdem.mesh.topology import Topology
from cdem.model.flat_arrays import Assembly
from cdem.model.stiffness import bond_row

KINDS = ("triangles", "quads", "overlaps")


def check_fall(case: Case, t: Topology, laws: list[Interface], parts: Assembly) -> None:
    """Refuse bonds of a law whose strength falls over so small a displacement that they snap back.

    A law loses strength at a rate of at most A [Pa/m] with opening and B with slip, and a bond
    unloads by
    k_n and k_s: A / k_n + B / k_s must be below 1, in any mix of modes. If stiffness follows from
    the elements, smaller ones help.

    Raises:
        ModelError: It is not; with the worst place and a remedy.
    """
    for number, law in enumerate(laws):
        own = INTERFACE_LAWS[law.law]
        normal, shear = native.interface_steepest_fall(own.name, own.numbers(law))
        if not normal and not shear:
            continue
        for kind in KINDS:
            faces = parts.pair_faces[kind].reshape(-1, 2)
            k = parts.arrays[f"{kind}.stiffness"].reshape(2, -1)[:, : len(faces)]
            has = parts.arrays[f"{kind}.interface"][: len(faces)] == number
            ratio = np.where(has, normal / k[0] + shear / k[1], 0.0)
            worst = int(ratio.argmax()) if len(ratio) else -1
            if worst >= 0 and ratio[worst] >= 1:
                raise ModelError(_why(case, t, law, number, faces[worst], ratio[worst], parts))


def _why(
    case: Case,
    t: Topology,
    law: Interface,
    number: int,
    faces: NDArray[np.integer],
    ratio: float,
    parts: Assembly,
) -> str:
    pairs = len(case.interfaces.pairs)
    path = f"interfaces.pairs.{number}" if number < pairs else "interfaces.default"
    nodes = t.face_nodes[faces[0]]
    x, y, z = t.node_position[nodes[nodes >= 0]].mean(axis=0)
    row = bond_row(law)
    if row[0] > 0 and row[2] > 0:
        remedy = f"bonds {1.01 * ratio:.3g} times as stiff"
    else:
        height = parts.arrays["face.height"][faces].min()
        remedy = f"elements of {height / (1.01 * ratio):.3g} m at most (here {height:.3g} m)"
    return (
        f"{case.where(path)}: {path}: bonds at ({x:.4g}, {y:.4g}, {z:.4g}) would lose strength faster "
        f"than they unload, by a factor of {ratio:.3g}; it takes {remedy}, or more fracture energy"
    )


PER_CELL = {"hex8": 1, "wedge6": 2, "pyramid5": 6, "tet4": 6}
"""Elements of a shape in a cell of a box, as in core/elements/shapes.hpp."""


def check_softening(case: Case, t: Topology, names: list[str], parts: Assembly) -> None:
    """Refuse elements so large that their rock would snap back.

    With h the edge of a cube of the volume of a cell, tensile strength that falls by A [Pa/m] with
    slip needs A h < E, cohesion A h < mu.

    Raises:
        ModelError: It is not; with the worst element and the size needed.
    """
    for group, name in enumerate(names):
        material = case.materials[case.groups[name].material]
        tables = tables_of(material)
        young = material.young_modulus
        shear = young / (2 * (1 + material.poisson_ratio))
        for strength, stiffness in (
            ("tensile_strength", young), ("cohesion", shear),
            ("joint_tensile_strength", young), ("joint_cohesion", shear),
        ):  # fmt: skip
            rows = np.array(tables.get(strength, []))
            fall = (-np.diff(rows[:, 1]) / np.diff(rows[:, 0])).max() if len(rows) else 0.0
            if fall == 0:
                continue
            for shape, count in PER_CELL.items():
                size = np.cbrt(count * parts.element_volume[shape])
                size = np.where(t.element_group[shape] == group, size, 0.0)
                worst = int(size.argmax()) if len(size) else -1
                if worst >= 0 and size[worst] * fall >= stiffness:
                    x, y, z = t.node_position[t.element_nodes[shape][worst]].mean(axis=0)
                    path = f"materials.{case.groups[name].material}.softening"
                    energy = ", or more fracture energy" if strength == "tensile_strength" else ""
                    raise ModelError(
                        f"{case.where(path)}: {path}: {strength} would fall faster than the element at "
                        f"({x:.4g}, {y:.4g}, {z:.4g}) unloads, by a factor of "
                        f"{size[worst] * fall / stiffness:.3g}; it takes elements of "
                        f"{0.99 * stiffness / fall:.3g} m at most (here {size[worst]:.3g} m), or a "
                        f"longer slip{energy}"
                    )
