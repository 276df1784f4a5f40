"""Compliance that bonds add to a body, and bodies whose mesh is too coarse for bending."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.arrays import components, found_in, in_pieces, lengths
from cdem.model.build import Build
from cdem.rows import rows_of

Floats = NDArray[np.float64]

KINDS = ("triangles", "quads", "overlaps")
PLANES = ((0, 1), (1, 2), (2, 0))
BEAM = 4.0
"""A body is a beam if its length exceeds its width and height by this factor."""
HELD = 0.25
"""Fraction of its points: a body fixed at more of them does not bend as a beam."""
DEEP = 2.5
"""Tets over the depth of a beam below which the audit warns: 3, less the scatter of irregular ones."""


def bonded_interfaces(build: Build) -> list[dict[str, Any]]:
    """One row per bonded pair of groups or set of joints: pairs, area, rock beside, stiffness, compliance.

    It is the compliance of the bonds over the compliance of the rock beside them, both under the
    same
    uniform stress, which is exact for layers. The largest value is given: of tension or bending
    along x, y, z, and of shear in the three planes.
    """
    t, a, case = build.topology, build.assembly, build.case
    volume = np.concatenate(list(a.element_volume.values()))
    groups, sets = len(build.group_names), [None, *case.model.joint_surfaces]
    rows: dict[tuple[str, str, str | None], dict[str, Any]] = {}
    for kind in KINDS:
        faces = a.pair_faces[kind]
        if len(faces) == 0:
            continue
        normal = rows_of(build.core, f"{kind}.stiffness").normal
        area = build.arrays[f"{kind}.area"][: len(faces)]
        soft = _softness(build, kind)
        group = np.sort(t.face_group[faces], axis=1)
        joint = (t.face_kind // groups)[faces]
        joint = np.where(joint[:, 0] == joint[:, 1], joint[:, 0], 0)
        where = (joint.astype(np.int64) * groups + group[:, 0]) * groups + group[:, 1]
        for number in np.flatnonzero(np.bincount(where)):
            some = where == number
            k, i, j = number // groups**2, number // groups % groups, number % groups
            key = (build.group_names[i], build.group_names[j], sets[k])
            empty = {"pairs": 0, "area": 0.0, "soft": np.zeros(6), "k": [], "w": [], "e": []}
            row = rows.setdefault(key, empty)
            row["pairs"] += int(some.sum())
            row["area"] += float(area[some].sum())
            row["soft"] += soft[some].sum(axis=0)
            row["k"] += [float(normal[some].min()), float(normal[some].max())]
            strength = build.arrays[f"{kind}.strength"]
            row["w"] += strength[: len(faces)][some].tolist() if strength.size else [1.0]
            row["e"].append(t.face_element[faces[some]].ravel())
    return [_row(key, row, volume) for key, row in rows.items()]


def _row(key: tuple, row: dict[str, Any], volume: Floats) -> dict[str, Any]:
    beside = volume[found_in(row["e"], len(volume))].sum()
    percent = 100 * row["soft"] / beside
    return {
        "between": list(key[:2]),
        "joint": key[2],
        "bonded_pairs": row["pairs"],
        "area": row["area"],
        "rock_volume": float(beside),
        "stiffness_n": [min(row["k"]), max(row["k"])],
        "strength_factors": [min(row["w"]), max(row["w"])],
        "compliance_percent": float(percent[:3].max()),
        "compliance_along_xyz": percent[:3].tolist(),
        "shear_compliance_percent": float(percent[3:].max()),
        "shear_compliance_in_xy_yz_zx": percent[3:].tolist(),
    }


def _softness(build: Build, kind: str) -> Floats:
    """Strain from each pair, over the strain of the rock, times a volume [m3], (pairs, 6).

    A plane of normal n and area A adds A (n_x^4 / k_n + n_x^2 (1 - n_x^2) / k_s) to the compliance
    along x, and A (4 n_x^2 n_y^2 / k_n + (n_x^2 + n_y^2 - 4 n_x^2 n_y^2) / k_s) to the compliance
    of shear in the plane x, y.
    """
    t, case = build.topology, build.case
    faces = build.assembly.pair_faces[kind]
    stiffness = rows_of(build.core, f"{kind}.stiffness")
    k_n, k_s = stiffness.normal[:, None], stiffness.shear[:, None]
    area = build.arrays[f"{kind}.area"][: len(faces), None]
    rock = [case.materials[case.groups[name].material] for name in build.group_names]
    young = np.array([m.young_modulus for m in rock])
    shear = young / (2 + 2 * np.array([m.poisson_ratio for m in rock]))
    young, shear = (of[t.face_group[faces]].mean(axis=1)[:, None] for of in (young, shear))

    def of_pairs(
        faces: NDArray, k_n: Floats, k_s: Floats, area: Floats, young: Floats, shear: Floats
    ) -> Floats:
        nodes = t.face_nodes[faces[:, 0]]
        x = t.node_position[np.where(nodes < 0, nodes[:, 2:3], nodes)]
        normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
        square = (normal / lengths(normal)[:, None]) ** 2
        first, second = (square[:, [plane[side] for plane in PLANES]] for side in (0, 1))
        both = 4 * first * second
        along = young * area * (square**2 / k_n + square * (1 - square) / k_s)
        across = shear * area * (both / k_n + (first + second - both) / k_s)
        return np.concatenate([along, across], axis=1)

    return in_pieces(of_pairs, faces, k_n, k_s, area, young, shear)


def coarse_beams(build: Build) -> Iterator[str]:
    """Warn of bodies that are beams of tets less than three deep: they bend too little."""
    t = build.topology
    pairs = np.concatenate([t.face_block[build.assembly.pair_faces[kind]] for kind in KINDS])
    block_body = components(len(t.block_group), *pairs.T)
    body = block_body[t.element_block["tet4"]]
    volume = build.assembly.element_volume["tet4"]
    count = np.bincount(body, minlength=len(t.block_group))
    whole = np.bincount(body, volume, len(t.block_group))
    node_body = block_body[t.node_block]
    held = build.arrays["support.row"][: len(t.node_block)] >= 0
    told: set[str] = set()
    order = np.argsort(node_body, kind="stable")
    begin = np.searchsorted(node_body[order], np.arange(len(count) + 1))
    for number in np.flatnonzero(count >= 6 * BEAM):
        nodes = order[begin[number] : begin[number + 1]]
        _, first = np.unique(t.node_place[nodes], return_index=True)
        if held[nodes[first]].mean() > HELD:
            continue
        x = t.node_position[nodes[first]]
        _, axes = np.linalg.eigh(np.cov(x.T))
        high, wide, long = np.sort(np.ptp(x @ axes, axis=0))
        if wide < 1.5 * high:  # the axes may be diagonals of a square section
            high = wide = np.sqrt(whole[number] / long)
        cell = np.cbrt(6 * whole[number] / count[number])  # edge of a box divided into six tets
        group = build.group_names[t.block_group[number]]
        if long >= BEAM * wide and high < DEEP * cell and group not in told:
            told.add(group)
            yield (
                f"group {group}: a beam of tets {high / cell:.1f} deep bends too little: by a "
                "quarter with three, by almost half with two. Use at least four, or hexahedra with "
                "elements.hexahedra: one-point"
            )
