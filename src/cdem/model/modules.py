"""The modules of a model: actions on nodes beyond the basic method."""

from __future__ import annotations

from cdem.case.case import Case
from cdem.mesh.topology import Topology
from cdem.model.bolts import BoltModel
from cdem.model.columns import ColumnModel
from cdem.model.module import Module
from cdem.model.surface import SurfaceModel
from cdem.model.water import WaterModel

MODULES: tuple[type[Module], ...] = (BoltModel, WaterModel, SurfaceModel, ColumnModel)
"""Every module once, as in `core/model/modules.hpp`."""


def modules_of(case: Case, t: Topology, names: list[str]) -> dict[str, Module]:
    """All modules of a case, by name, see `Module.of`."""
    return {kind.name: kind.of(case, t, names) for kind in MODULES}
