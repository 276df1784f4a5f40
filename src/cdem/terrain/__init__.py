"""From terrain to a mesh: ground, a sliding surface with bodies outlined in plan, or layers.

Example:
    >>> from cdem.terrain import Landslide, make_mesh, write
    >>> landslide = Landslide(
    ...     terrain={"plane": {"dip": 30, "dip_direction": 90, "through": [0, 0, 100]}},
    ...     extent={"x": [0, 100], "y": [0, 100], "base": 0},
    ...     surface={"plane": {"dip": 30, "dip_direction": 90, "through": [0, 0, 90]}},
    ...     bodies=[{"group": "slab", "outline": [[30, 30], [70, 30], [70, 70], [30, 70]]}],
    ...     sizes={"body": 10, "far": 30},
    ... )
    >>> solid = make_mesh(landslide)
    >>> round(measure(solid)["groups"]["slab"]["volume"], 6)
    16000.0
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cdem.terrain.landslide import Landslide
    from cdem.terrain.report import measure, text, write
    from cdem.terrain.solid import Solid

# Module of each public name, imported at first use: processes that read a file need none.
_HOMES = {
    "Landslide": "cdem.terrain.landslide",
    "Solid": "cdem.terrain.solid",
    "measure": "cdem.terrain.report",
    "text": "cdem.terrain.report",
    "write": "cdem.terrain.report",
}

__all__ = ["Landslide", "Solid", "make_mesh", "measure", "text", "write"]


def make_mesh(landslide: Landslide) -> Solid:
    """Mesh a landslide: bodies or layers, and bedrock, conforming, coarser away from them.

    Raises:
        CaseError: Terrain, surface and outlines do not fit together.
        MeshError: The space cannot be filled with tets.
        BackendError: The extra `terrain` is not installed.
    """
    from cdem.terrain.layers import make_layers
    from cdem.terrain.plan import make_plan
    from cdem.terrain.solid import make_solid

    make = make_layers if landslide.layers else make_solid
    return make(landslide, make_plan(landslide))


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'cdem.terrain' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value
