"""One slope: a short case as a user writes it, and its factor of safety by a closed form."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from cdem.case.case import Case

GRAVITY = 9.81  # [m/s2]
Points = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Slope:
    """A slope.

    Attributes:
        name: Words for the table.
        height: [m].
        case: The case, as `Case.from_dict` takes it.
        factor: Factor of safety, or the two edges of the published interval.
        within: Largest error that passes.
        quick: Whether it is run by default.
        mesh: Mesh of the case, or None if the case makes its blocks.
        second: The factor by a second method of `second.py`, or None.
    """

    name: str
    height: float
    case: dict[str, Any]
    factor: float | tuple[float, float]
    within: float = 0.015
    quick: bool = False
    mesh: meshio.Mesh | None = None
    second: float | None = None

    def load(self, folder: Path) -> Case:
        """The case, with its mesh written to a folder."""
        data = deepcopy(self.case)
        if self.mesh is not None:
            data["model"]["mesh"] = str(folder / "slope.msh")
            meshio.write(folder / "slope.msh", self.mesh, "gmsh22", binary=False)
        return Case.from_dict(data)

    def nearest(self, found: float) -> float:
        """The factor of safety, or the value in its interval nearest to the one found."""
        low, high = np.broadcast_to(self.factor, 2)
        return float(np.clip(found, low, high))


def section(profile: Points, width: float) -> dict[str, Any]:
    """A convex profile of points (x, z), extruded along y from 0."""
    return {"vertices": [[x, y, z] for y in (0.0, width) for x, z in profile]}


def sides(width: float) -> dict[str, Any]:
    """A support of all nodes across the section: plane strain, one block wide."""
    far = 1e4
    return {"box": {"min": [-far, -0.01, -far], "max": [far, width + 0.01, far]}, "fix": ["y"]}


def below(z: float) -> dict[str, Any]:
    """A support of all nodes up to this height."""
    far = 1e4
    return {"box": {"min": [-far, -far, -far], "max": [far, far, z]}, "fix": ["x", "y", "z"]}


def rock(unit_weight: float, modulus: float = 10e9) -> dict[str, Any]:
    """Elastic rock of a unit weight [N/m3]."""
    return {"density": unit_weight / GRAVITY, "young_modulus": modulus, "poisson_ratio": 0.25}


def static(
    title: str, model: dict[str, Any], pairs: list[dict[str, Any]], supports: list[dict[str, Any]],
    material: dict[str, Any], **more: Any,
) -> dict[str, Any]:  # fmt: skip
    """A case of one static stage; groups that `more` does not name are of the one material."""
    named = {block["group"]: {"material": "rock"} for block in model.get("blocks", [])}
    materials = {"rock": material} if material else {}
    loads = {"gravity": [0, 0, -GRAVITY], "supports": supports} | more.pop("loads", {})
    return {
        "title": title,
        "model": model,
        "materials": materials,
        "groups": named | more.pop("groups", {}),
        "interfaces": {"default": {"friction_angle": 30}, "pairs": pairs}
        | more.pop("interfaces", {}),
        "loads": loads,
        "stages": [{"name": "rest", "mode": "static"}],
    } | more
