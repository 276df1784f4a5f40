"""Joints of finite size in a model: number of discs, area of joints and of rock bridges."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any

import numpy as np

from cdem.mesh.arrays import lengths
from cdem.model.build import Build


def disc_areas(build: Build) -> dict[str, dict[str, Any]]:
    """For each set of discs: number of discs, number that meet a block, areas of joint and bridges [m2]."""
    found = {}
    for joint in build.case.model.joints:
        if joint.name not in build.mesh.discs:
            continue
        discs, met = build.mesh.discs[joint.name]
        found[joint.name] = {
            "discs": discs,
            "met": met,
            "joint_area": _area(build, joint.name),
            "bridge_area": _area(build, str(joint.bridges)),
        }
    return found


def _area(build: Build, surface: str) -> float:
    """Area of a surface with a face on both sides [m2]."""
    both = 0.0
    for faces in build.mesh.surfaces[surface]:
        x = build.mesh.points[faces]
        both += float(lengths(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])).sum()) / 2
    return both / 2


def disc_lines(discs: dict[str, dict[str, Any]]) -> list[str]:
    """The same as lines of text."""
    return [
        f"  joint set {name}: {of['discs']:,} discs, {of['met']:,} of them meet blocks; joint "
        f"{of['joint_area']:.6g} m2, rock bridges {of['bridge_area']:.6g} m2"
        for name, of in discs.items()
    ]


def weak_bridges(build: Build, bonded: Collection[str | None]) -> Iterator[str]:
    """Warnings of rock bridges that are not bonded."""
    for name, of in disc_areas(build).items():
        (joint,) = (j for j in build.case.model.joints if j.name == name)
        if of["bridge_area"] > 0 and joint.bridges not in bonded:
            yield (
                f"the rock bridges of joint set {name} have no strength: give the interface of their "
                f"groups, or a pair with joint: {joint.bridges}, cohesion and tensile_strength"
            )
