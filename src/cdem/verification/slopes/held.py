"""A case with a stage before its last one in which its strengths are held, and joints that keep theirs."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

STRONG = 1000.0
"""Factor of cohesion and tensile strength while the weight comes on."""
ROUGH = 75.0
"""Friction angle of joints meanwhile [deg]."""


def held(case: dict[str, Any]) -> dict[str, Any]:
    """Take the weight with held strengths; joints keep their cohesion after slip.

    Trials of `cdem critical` then start from the elastic rest, and joints are perfectly plastic,
    as closed forms assume.
    """
    case = deepcopy(case)
    strong, own = {}, {}

    def hold(path: str, part: dict[str, Any], key: str, value: float) -> None:
        if part.get(key):
            own[f"{path}.{key}"], strong[f"{path}.{key}"] = part[key], value

    for pair in [case["interfaces"]["default"], *case["interfaces"]["pairs"]]:
        path = f"interfaces.{pair.get('name', 'default')}"
        if pair.get("cohesion"):
            pair |= {"law": "residual", "residual_cohesion": pair["cohesion"]}
        for key in ("cohesion", "residual_cohesion", "tensile_strength"):
            hold(path, pair, key, STRONG * pair.get(key, 0.0))
        hold(path, pair, "friction_angle", ROUGH)
    for name, material in case["materials"].items():
        if material.get("law") == "mohr-coulomb":
            for key in ("cohesion", "tensile_strength"):
                hold(f"materials.{name}", material, key, 30 * material.get(key, 0.0))
            hold(f"materials.{name}", material, "friction_angle", 50.0)
    rest = case["stages"][0]
    case["stages"] = [{"name": "load", "mode": "static", "set": strong}, {**rest, "set": own}]
    return case
