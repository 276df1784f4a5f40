"""Blocks that nothing holds: neither supports nor bonds, contacts or modules, direct or through others."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.arrays import components
from cdem.model.build import Build


def unheld_blocks(build: Build, out: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether each block is held by nothing now; faces hold one another if they may touch.

    Args:
        build: The model, prepared.
        out: Whether each block is not in the model now: such a block needs no support.
    """
    t, core = build.topology, build.core.fields()
    pairs = [
        np.empty((0, 2), int),
        *build.assembly.pair_faces.values(),
        core["search.exposed_face"][_exposed_pairs(core)],
    ]
    by_modules = [module.joined_blocks() for module in build.modules.values()]
    joined = np.concatenate([t.face_block[np.concatenate(pairs)], *by_modules])
    joined = joined[~out[joined].any(axis=1)]
    held = out.copy()
    held[t.node_block[build.arrays["support.row"][: len(t.node_block)] >= 0]] = True
    body = components(len(held), *joined.T)
    holds = np.zeros(len(held), bool)
    holds[body[held]] = True
    return ~(held | holds[body])


def _exposed_pairs(core: Mapping[str, NDArray]) -> NDArray:
    """Pairs of exposed faces, one of each two elements at least, that the pair list names."""
    vertex_face = core["outer.vf_pairs"].reshape(2, -1)[1]
    slots = _pairs_of(core["outer.slot_first"], vertex_face[core["outer.slot_pairs"]])
    face = core["outer.ee_sides"][::2] // 4  # the first one at an edge
    edges = core["outer.ee_pairs"].reshape(2, -1)[:, : len(core["outer.ee_codes"])].T
    acting = _pairs_of(core["outer.acting_first"], core["outer.faces_acting_on"])
    return np.concatenate([slots // [4, 1], face[edges], acting])


def _pairs_of(first: NDArray, other: NDArray) -> NDArray:
    """Row and entry of every entry of ragged rows, shape (entries, 2)."""
    return np.column_stack([np.repeat(np.arange(len(first) - 1), np.diff(first)), other])
