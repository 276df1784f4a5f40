"""The nodes, elements and blocks of a group of a running model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from cdem.model.build import Build


@dataclass(frozen=True)
class Group:
    """Ids of a group's parts, for rows of fields; read-only.

    Attributes:
        nodes: Rows of `Simulation.fields`.
        elements: In the order of the frames: tets, pyramids, wedges, hexahedra.
        blocks: Rows of `Simulation.rigid_motion`.
    """

    nodes: NDArray[np.intp]
    elements: NDArray[np.intp]
    blocks: NDArray[np.intp]


def groups_of(build: Build) -> dict[str, Group]:
    """The groups of a model by their names."""
    t = build.topology
    of_elements = np.concatenate(list(t.element_group.values()))
    of_nodes = t.block_group[t.node_block]
    groups = {}
    for index, name in enumerate(build.group_names):
        parts = [np.flatnonzero(of == index) for of in (of_nodes, of_elements, t.block_group)]
        for ids in parts:
            ids.flags.writeable = False
        groups[name] = Group(*parts)
    return groups
