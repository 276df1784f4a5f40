"""The modules of a model: what acts on nodes and is no part of the method itself."""

from __future__ import annotations

from cdem.case.case import Case
from cdem.mesh.topology import Topology
from cdem.model.bolts import BoltModel
from cdem.model.module import Module
from cdem.model.surface import SurfaceModel
from cdem.model.water import WaterModel

MODULES: tuple[type[Module], ...] = (BoltModel, WaterModel, SurfaceModel)
"""Every module once, as in `core/model/modules.hpp`."""


def modules_of(case: Case, t: Topology, names: list[str]) -> dict[str, Module]:
    """Every module of a case, by its name, see `Module.of`."""
    return {kind.name: kind.of(case, t, names) for kind in MODULES}
