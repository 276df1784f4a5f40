"""Slopes that slide on one plane: dry, with water, anchored, shaken, long, or with rock bridges."""

from __future__ import annotations

from typing import Any

import numpy as np

from cdem.verification.slopes.second import area as area_of
from cdem.verification.slopes.second import moving
from cdem.verification.slopes.slope import (
    GRAVITY,
    Slope,
    below,
    rock,
    section,
    sides,
    static,
)

WATER = 1000 * GRAVITY  # [N/m3]


def tan(angle: float) -> float:
    """Tangent of an angle [deg]."""
    return float(np.tan(np.radians(angle)))


def sliding(
    weight: float, dip: float, friction: float, cohesion: float = 0.0, area: float = 0.0, *,
    push: float = 0.0, lift: float = 0.0, shaken: float = 0.0,
    pull: float = 0.0, plunge: float = 0.0,
) -> float:  # fmt: skip
    """Factor of safety of a body on a plane (Hoek & Bray 1981, chapter 7).

    Args:
        weight: Of the body.
        dip: Of the plane [deg].
        friction: Angle [deg].
        cohesion: On the area.
        area: Of the plane.
        push: Horizontal force of water in a crack behind the body.
        lift: Force of water on the plane, normal to it.
        shaken: Horizontal acceleration as a part of gravity.
        pull: Force of anchors on the body, into the slope.
        plunge: Of the anchors, downwards [deg].
    """
    b, a = np.radians([dip, dip + plunge])
    driving = weight * (np.sin(b) + shaken * np.cos(b)) + push * np.cos(b) - pull * np.cos(a)
    normal = weight * (np.cos(b) - shaken * np.sin(b)) - push * np.sin(b) - lift + pull * np.sin(a)
    return float((cohesion * area + normal * tan(friction)) / driving)


def joint(name: str, friction: float, cohesion: float = 0.0, **more: Any) -> dict[str, Any]:
    """The interface of a set of joints of the same name."""
    held = {"cohesion": cohesion} if cohesion else {}
    return {"name": name, "joint": name, "friction_angle": friction} | held | more


def cut(
    name: str, height: float, face: float, dip: float, friction: float, cohesion: float = 0.0, *,
    unit: float = 26e3, quick: bool = False,
) -> Slope:  # fmt: skip
    """A plane that daylights at a tenth of the height in a face, up to the flat top."""
    foot, width = 0.1 * height, height / 4
    rise = height - foot
    start = -foot / tan(face)
    back = 1.2 * (start - rise / tan(dip))
    profile = [(back, 0.0), (0.0, 0.0), (-height / tan(face), height), (back, height)]
    model = {
        "blocks": [{"group": "rock", "polyhedron": section(profile, width)}],
        "joints": [{"name": "plane", "dip": dip, "dip_direction": 90, "origin": [start, 0, foot]}],
    }
    case = static(name, model, [joint("plane", friction, cohesion)],
                  [below(0.01), sides(width)], rock(unit))  # fmt: skip
    weight = unit * rise**2 / 2 * (1 / tan(dip) - 1 / tan(face))
    area = rise / np.sin(np.radians(dip))
    body = [(start, foot), (-height / tan(face), height), (start - rise / tan(dip), height)]
    second = moving([0.0, -unit * area_of(body)], dip, friction, held=cohesion * area)
    return Slope(name, height, case, sliding(weight, dip, friction, cohesion, area), quick=quick,
                 second=second)  # fmt: skip


def cracked(
    name: str, filled: float, *, height: float = 60.0, face: float = 50.0, dip: float = 35.0,
    friction: float = 35.0, cohesion: float = 100e3, crack: float = 14.0, unit: float = 26e3,
    pull: float = 0.0, plunge: float = 10.0, quick: bool = False,
) -> Slope:  # fmt: skip
    """A plane from the toe to a tension crack behind the crest, filled to a part with water.

    The bed reaches from the plane down to the level of a tenth of the height below the toe.
    """
    width, deep, foot = height / 6, -0.1 * height, height - crack
    wall = -foot / tan(dip)  # place of the crack
    crest = -height / tan(face)
    bed = [(wall, deep), (0.0, deep), (0.0, 0.0), (wall, foot)]
    slide = [(0.0, 0.0), (wall, foot), (wall, height), (crest, height)]
    back = [(1.15 * wall, deep), (wall, deep), (wall, height), (1.15 * wall, height)]
    model = {"blocks": [{"group": group, "polyhedron": section(profile, width)}
             for group, profile in (("bed", bed), ("slide", slide), ("back", back))]}  # fmt: skip
    pairs: list[dict[str, Any]] = [
        {"name": "plane", "between": ["bed", "slide"], "friction_angle": friction}
        | ({"cohesion": cohesion} if cohesion else {}),
        {"name": "crack", "between": ["back", "slide"], "friction_angle": 0},
    ]
    fixed = {"material": "rock", "fix": ["x", "y", "z"]}
    more: dict[str, Any] = {
        "groups": {"bed": fixed, "back": fixed},
        "interfaces": {"default": {"friction_angle": 0}},
    }
    head = filled * crack
    if filled:
        more["water"] = {"fields": [
            {"interface": "crack", "level": foot + head, "aperture": height},
            {"interface": "plane", "formula": f"{WATER * head} * z / {foot}", "wet": "always"},
        ]}  # fmt: skip
    if pull:
        more |= anchor(pull * width, plunge, height, width, face, dip)
    case = static(name, model, pairs, [sides(width)], rock(unit), **more)
    area = foot / np.sin(np.radians(dip))
    weight = unit * (height**2 * (1 / tan(dip) - 1 / tan(face)) - crack**2 / tan(dip)) / 2
    factor = sliding(weight, dip, friction, cohesion, area, push=WATER * head**2 / 2,
                     lift=WATER * head * area / 2, pull=pull, plunge=plunge)  # fmt: skip
    a = np.radians(plunge)
    load = [WATER * head**2 / 2 - pull * np.cos(a), -unit * area_of(slide) - pull * np.sin(a)]
    second = moving(load, dip, friction, held=cohesion * area, lift=WATER * head * area / 2)
    return Slope(name, height, case, factor, quick=quick, second=second)


def anchor(
    force: float, plunge: float, height: float, width: float, face: float, dip: float
) -> dict[str, Any]:
    """One anchor from mid-height of the face into the bed, locked at its yield force [N]."""
    z = 0.4 * height
    head = np.array([-z / tan(face), width / 2, z])
    a = np.radians(plunge)
    way = np.array([-np.cos(a), 0.0, -np.sin(a)])
    reach = (head[2] + head[0] * tan(dip)) / (np.sin(a) - np.cos(a) * tan(dip))  # to the plane
    toe = head + (abs(reach) + 0.1 * height) * way
    strand = {"area": "1000 mm2", "young_modulus": "195 GPa", "yield_force": force,
              "compressive_force": 0}  # fmt: skip
    return {"bolt_types": {"strand": strand},
            "bolts": [{"name": "anchor", "type": "strand", "points": [head.tolist(), toe.tolist()],
                       "plate": True, "anchor": True, "pretension": force}]}  # fmt: skip


def long_slope(name: str, *, wet: bool, quick: bool = False) -> Slope:
    """A slice of a long slope of soil, 5 m thick, at 20 degrees (Skempton & DeLory 1957)."""
    dip, thick, length, unit, friction, cohesion = 20.0, 5.0, 20.0, 20e3, 30.0, 5e3
    fall = length * tan(dip)
    profile = [(0.0, -thick), (length, -thick - fall), (length, thick - fall), (0.0, thick)]
    model = {
        "blocks": [{"group": "soil", "polyhedron": section(profile, 4.0)}],
        "joints": [{"name": "plane", "dip": dip, "dip_direction": 90}],
    }
    b = np.radians(dip)
    down = {"group": "soil", "normal": [-np.sin(b), 0, -np.cos(b)]}
    more: dict[str, Any] = {}
    if wet:
        table = {"point": [0, 0, thick], "dip": dip, "dip_direction": 90}
        more["water"] = {"fields": [{"interface": "plane", "plane": table, "seepage": "parallel",
                                     "wet": "always"}]}  # fmt: skip
    case = static(name, model, [joint("plane", friction, cohesion)],
                  [{"surface": down, "fix": ["x", "y", "z"]}, sides(4.0)],
                  rock(unit, 200e6), **more)  # fmt: skip
    pressure = WATER * thick * np.cos(b) ** 2 if wet else 0.0
    normal = unit * thick * np.cos(b) ** 2 - pressure
    factor = (cohesion + normal * tan(friction)) / (unit * thick * np.sin(b) * np.cos(b))
    along = length / np.cos(b)
    second = moving([0.0, -unit * area_of(profile) / 2], dip, friction, held=cohesion * along,
                    lift=pressure * along)  # fmt: skip
    return Slope(name, thick, case, float(factor), quick=quick, second=second)


def shaken(name: str, height: float, part: float, quick: bool = False) -> Slope:
    """A plane under gravity turned by a horizontal acceleration."""
    made = cut(name, height, 65.0, 35.0, 40.0, 120e3)
    made.case["loads"]["gravity"] = [part * GRAVITY, 0, -GRAVITY]
    rise = 0.9 * height
    weight = 26e3 * rise**2 / 2 * (1 / tan(35.0) - 1 / tan(65.0))
    area = rise / np.sin(np.radians(35.0))
    factor = sliding(weight, 35.0, 40.0, 120e3, area, shaken=part)
    second = moving([part * weight, -weight], 35.0, 40.0, held=120e3 * area)
    return Slope(name, height, made.case, factor, quick=quick, second=second)


def through_tets(name: str) -> Slope:
    """A plane that daylights in an upright face and passes points of a mesh of tets closely."""
    height, foot, width, dip, friction, cohesion = 40.0, 4.0, 20.0, 35.0, 33.0, 60e3
    size, far = [60.0, width, height], 1e4
    box = {"size": size, "divisions": [12, 4, 8], "shape": "tet4"}
    plane = {"name": "plane", "dip": dip, "dip_direction": 90, "origin": [size[0], 0, foot]}
    model = {"blocks": [{"group": "rock", "box": box}], "joints": [plane]}
    back = {"box": {"min": [-far] * 3, "max": [0.01, far, far]}, "fix": ["x"]}
    case = static(name, model, [joint("plane", friction, cohesion)],
                  [below(0.01), back, sides(width)], rock(26e3))  # fmt: skip
    rise = height - foot
    area, body = rise / np.sin(np.radians(dip)), 26e3 * rise**2 / 2 / tan(dip)
    second = moving([0.0, -body], dip, friction, held=cohesion * area)
    return Slope(name, height, case, sliding(body, dip, friction, cohesion, area), second=second)


def planes() -> list[Slope]:
    """All of them."""
    return [
        cut("plane, dry, friction alone", 5, 60.0, 35.0, 40.0, quick=True),
        cut("plane, dry, cohesion", 20, 70.0, 40.0, 30.0, 25e3, quick=True),
        cut("plane, dry, cohesion, high", 300, 50.0, 32.0, 28.0, 400e3),
        shaken("plane, 0.15 g sideways", 40, 0.15, quick=True),
        cracked("plane, tension crack, dry", 0.0, quick=True),
        cracked("plane, tension crack half full", 0.5),
        cracked("plane, tension crack full", 1.0),
        cracked("plane, tension crack full, anchored", 1.0, pull=3e6),
        through_tets("plane through a mesh of tets"),
        long_slope("long slope, dry", wet=False, quick=True),
        long_slope("long slope, seepage", wet=True, quick=True),
    ]
