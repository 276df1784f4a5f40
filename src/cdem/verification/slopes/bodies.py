"""Slopes of several bodies: buttress, wall, steps, bridges, three joint sets, roof, toppling."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from cdem.verification.goodman_bray import problem as goodman_bray
from cdem.verification.slopes.planes import joint, tan
from cdem.verification.slopes.second import area, falling, moving, pushing, root, tension
from cdem.verification.slopes.slope import GRAVITY, Slope, below, rock, section, sides, static

UNIT = 26e3  # [N/m3]
FIXED = {"material": "rock", "fix": ["x", "y", "z"]}


def pair(one: str, other: str, friction: float, **more: Any) -> dict[str, Any]:
    """The interface of two groups."""
    return {"name": f"{one}_{other}", "between": [one, other], "friction_angle": friction} | more


def pushed(
    name: str, *, courses: int, friction: float, beside: float, quick: bool = False
) -> Slope:
    """A block on a plane of 40 degrees leans on a buttress, or on a wall of blocks, on the flat.

    Both slide at the limit, the block down the buttress too. With t = tan(phi) / F on the plane and
    the floor, and j on the side, the push E follows from the balance of the block and must equal
    the grip of the floor, t (W2 + E j):

        E = N (sin b - t cos b),  N (cos b + t sin b) + E j = W1.

    Args:
        name: Of the slope.
        courses: Of the wall, in running bond; 1: a buttress of one block.
        friction: Angle of plane and floor [deg].
        beside: Angle between block and buttress [deg].
        quick: Whether it is run by default.
    """
    dip, step, high, wide, width = 40.0, 1.0, 10.0, 14.0, 4.0
    length = (high - step) / tan(dip)
    bed = [
        (0.0, -2.0),
        (0.0, step),
        (-length - 2, step + (length + 2) * tan(dip)),
        (-length - 2, -2.0),
    ]
    active = [(0.0, step), (0.0, high), (-length, high)]
    blocks = [{"group": "bed", "polyhedron": section(bed, width)},
              {"group": "bed", "box": {"size": [wide + 6, width, 2]}, "translate": [0, 0, -2]},
              {"group": "block", "polyhedron": section(active, width)}]  # fmt: skip
    rise, half = high / courses, wide / 4
    for course in range(courses):
        ends = [0.0, wide] if courses == 1 else [0.0, wide / 2, wide]
        if course % 2:
            ends = [0.0, half, wide - half, wide]
        for left, right in pairwise(ends):
            box = {"size": [right - left, width, rise]}
            blocks.append({"group": "wall", "box": box, "translate": [left, 0, course * rise]})
    pairs = [
        pair("block", "bed", friction),
        pair("wall", "bed", friction),
        pair("block", "wall", beside),
    ]
    case = static(name, {"blocks": blocks}, pairs, [sides(width)], rock(UNIT), groups={"bed": FIXED},
                  interfaces={"default": {"friction_angle": friction}})  # fmt: skip
    weight, wall, b = UNIT * length * (high - step) / 2, UNIT * wide * high, np.radians(dip)

    def balance(factor: float) -> float:
        t, j = tan(friction) / factor, tan(beside) / factor
        per_normal = np.sin(b) - t * np.cos(b)
        push = weight * per_normal / (np.cos(b) + t * np.sin(b) + per_normal * j)
        return float(t * (wall + push * j) - push)

    second = pushing(UNIT * area(active), wall, dip, friction, beside)
    return Slope(name, high, case, root(balance), quick=quick, second=second)


def stepped(name: str, friction: float, cohesion: float, quick: bool = False) -> Slope:
    """A body on five treads of 25 degrees; the vertical risers between them stand open by 5 cm."""
    dip, going, riser, count, thick, width, gap = 25.0, 4.0, 1.5, 5, 6.0, 3.0, 0.05
    fall = going * tan(dip)
    top = count * (fall + riser) - riser + thick
    blocks, weight, load, treads = [], 0.0, 0.0, 0.0
    for n in range(count):
        right, low = -n * going, n * (fall + riser)
        foot = [(right, low), (right - going, low + fall)]
        body = [*foot, (right - going, low + fall + thick), (right, low + thick)]
        edge = right - gap
        bed = [(edge, -3.0), (right - going, -3.0), foot[1], (edge, low + gap * tan(dip))]
        blocks += [{"group": "slide", "polyhedron": section(body, width)},
                   {"group": "bed", "polyhedron": section(bed, width)}]  # fmt: skip
        weight += UNIT * going * thick
        load += UNIT * area(body)
        treads += float(np.linalg.norm(np.subtract(bed[2], bed[3])))
    strong = {"cohesion": 20e6, "tensile_strength": 20e6}
    held = {"cohesion": cohesion} if cohesion else {}
    pairs = [pair("slide", "bed", friction, **held), pair("slide", "slide", 45, **strong)]
    case = static(name, {"blocks": blocks}, pairs, [sides(width)], rock(UNIT),
                  groups={"bed": FIXED})  # fmt: skip
    b = np.radians(dip)
    factor = tan(friction) / tan(dip)
    factor += cohesion * count * (going - gap) / np.cos(b) / (weight * np.sin(b))
    second = moving([0.0, -load], dip, friction, held=cohesion * treads)
    return Slope(name, top, case, float(factor), quick=quick, second=second)


def three_sets(name: str, height: float) -> Slope:
    """Bedding out of the face and two sets across it, without cohesion: tan(phi) / tan(dip)."""
    dip, face, friction, width = 28.0, 60.0, 36.0, height / 3
    start = -0.1 * height / tan(face)
    back = 1.1 * (start - 0.9 * height / tan(dip))
    profile = [(back, 0.0), (0.0, 0.0), (-height / tan(face), height), (back, height)]
    origin = [start, 0, 0.1 * height]
    model = {
        "blocks": [{"group": "rock", "polyhedron": section(profile, width)}],
        "joints": [
            {"name": "bedding", "dip": dip, "dip_direction": 90, "origin": origin,
             "spacing": 0.3 * height},
            {"name": "cross", "dip": 90, "dip_direction": 90, "origin": [0.5 * back, 0, 0],
             "spacing": 0.37 * height},
            {"name": "side", "dip": 90, "dip_direction": 0, "origin": [0, 0.45 * width, 0]},
        ],
    }  # fmt: skip
    pairs = [joint("bedding", friction), joint("cross", friction), joint("side", friction)]
    rear = {"surface": {"group": "rock", "normal": [-1, 0, 0]}, "fix": ["x"]}
    case = static(name, model, pairs, [below(0.01), sides(width), rear], rock(UNIT))
    return Slope(name, height, case, tan(friction) / tan(dip),
                 second=moving([0.0, -1.0], dip, friction))  # fmt: skip


def bridged(name: str, part: float, quick: bool = False) -> Slope:
    """A plane of which a part is rock bridges; the rest has friction alone (Jennings 1970)."""
    dip, friction, bridge, length, thick, width, count = 40.0, 30.0, 400e3, 50.0, 10.0, 5.0, 5
    piece, b = length / count, np.radians(dip)
    blocks: list[dict[str, Any]] = [{"group": "slide", "box": {"size": [length, width, thick]}}]
    for n in range(count):
        for group, start, share in (("bridge", 0.0, part), ("joint", part, 1 - part)):
            blocks.append({"group": group, "box": {"size": [share * piece, width, 2]},
                           "translate": [(n + start) * piece, 0, -2]})  # fmt: skip
    turn = {"axis": [0, 1, 0], "angle": dip}
    pairs = [pair("slide", "bridge", friction, cohesion=bridge), pair("slide", "joint", friction)]
    case = static(name, {"blocks": blocks, "rotate": turn}, pairs, [sides(width)], rock(UNIT),
                  groups={"bridge": FIXED, "joint": FIXED})  # fmt: skip
    factor = tan(friction) / tan(dip) + part * bridge / (UNIT * thick * np.sin(b))
    bridges = sum(b["box"]["size"][0] for b in blocks if b["group"] == "bridge")
    second = moving([0.0, -UNIT * length * thick], dip, friction, held=bridge * bridges)
    return Slope(name, length * np.sin(b), case, float(factor), quick=quick, second=second)


def roof(name: str, quick: bool = False) -> Slope:
    """A wedge in a roof between two abutments, one pressed on with a constant force H; an anchor.

    Both faces lean by a from the vertical and slide at the limit: 2 H tan(phi_F - a) = W - T,
    tan(phi_F) = tan(phi) / F (after Brady & Brown 2004, chapter 9).
    """
    lean, friction, high, top, width = 20.0, 38.0, 5.0, 1.0, 2.0
    thrust, pull = 1.2e6, 250e3  # per metre of roof [N/m]
    low = top + high * tan(lean)
    wedge = [(-low, 0.0), (low, 0.0), (top, high), (-top, high)]
    right = [(low, 0.0), (low + 3, 0.0), (low + 3, high), (top, high)]
    left = [(-x, z) for x, z in right]
    blocks: list[dict[str, Any]]
    blocks = [{"group": g, "polyhedron": section(p, width)}
              for g, p in (("wedge", wedge), ("left", left), ("right", right))]  # fmt: skip
    blocks.append({"group": "roof", "box": {"size": [2 * low + 6, width, 4]},
                   "translate": [-low - 3, 0, high]})  # fmt: skip
    press = {"surface": {"group": "right", "normal": [1, 0, 0]},
             "traction": [-thrust / high, 0, 0]}  # fmt: skip
    bar = {"area": "500 mm2", "young_modulus": "200 GPa", "yield_force": pull * width}
    bolt = {"name": "anchor", "type": "bar", "plate": True, "anchor": True, "pretension": pull * width,
            "points": [[0.01, width / 2, 0], [0.01, width / 2, high + 3]]}  # fmt: skip
    pairs = [pair("wedge", "left", friction), pair("wedge", "right", friction)]
    case = static(name, {"blocks": blocks}, pairs, [sides(width)], rock(UNIT),
                  groups={"left": FIXED, "roof": FIXED,
                          "right": {"material": "rock", "fix": ["y", "z"]}},
                  interfaces={"default": {"friction_angle": 0}}, loads={"tractions": [press]},
                  bolt_types={"bar": bar}, bolts=[bolt])  # fmt: skip
    weight = UNIT * high * (top + low)
    angle = lean + np.degrees(np.arctan((weight - pull) / (2 * thrust)))
    return Slope(name, high, case, tan(friction) / tan(float(angle)), quick=quick,
                 second=falling(weight - pull, thrust, lean, friction))  # fmt: skip


def columns(name: str, friction: float, support: float = 0.0) -> Slope:
    """Goodman & Bray's 16 columns of 25 kN/m3, with a support at the toe along the base [N/m]."""
    g, blocks = goodman_bray, []
    width = 10.0
    for n, height in enumerate(g.heights()):
        at, foot = n * g.WIDTH, n * g.STEP
        group = "columns" if n else "toe"
        blocks += [
            {"group": group, "box": {"size": [g.WIDTH, width, float(height)]},
             "translate": [at, 0, foot]},
            {"group": "base", "box": {"size": [g.WIDTH, width, 5 + foot]},
             "translate": [at, 0, -5]},
        ]  # fmt: skip
    blocks.append({"group": "base", "box": {"size": [20, width, 5]}, "translate": [-20, 0, -5]})
    loads: dict[str, Any] = {"gravity": [-GRAVITY * np.sin(g.DIP), 0, -GRAVITY * np.cos(g.DIP)]}
    if support:
        loads["tractions"] = [{"surface": {"group": "toe", "normal": [-1, 0, 0]},
                               "traction": [support / float(g.heights()[0]), 0, 0]}]  # fmt: skip
    case = static(name, {"blocks": blocks}, [], [], rock(25e3, 100e9), groups={"base": FIXED},
                  interfaces={"default": {"friction_angle": friction}}, loads=loads)  # fmt: skip

    def balance(factor: float) -> float:
        t = tan(friction) / factor  # the support, unlike a column, does not rub
        return float(support / 25e3 - g.support(t) * (1 - t**2))

    return Slope(name, 92.5, case, root(balance, 0.5, 2.0), 0.05)


def flexural(name: str) -> Slope:
    """A slab that leans out of the slope by d and breaks at its foot, as a beam.

    Tensile strength / F = 6 M / b^2 - N / b, with M = W sin(d) L / 2 and N = W cos(d) (Aydan &
    Kawamoto 1992, for a single slab). Corner bonds of n cells bear 1 + 2 / n^2 of it.
    """
    lean, long, thick, width, strength, cells = np.radians(20.0), 10.0, 2.0, 1.0, 1.5e6, 20
    blocks: list[dict[str, Any]] = [
        {"group": "slab", "box": {"size": [thick, width, long], "divisions": [cells, 1, 6]}},
        {"group": "bed", "box": {"size": [thick, width, 2]}, "translate": [0, 0, -2]},
    ]
    bond = {"cohesion": 4 * strength, "tensile_strength": strength,
            "stiffness_n": "1 GPa/m", "stiffness_s": "1 GPa/m"}  # fmt: skip
    case = static(name, {"blocks": blocks}, [pair("slab", "bed", 35, **bond)], [sides(width)],
                  rock(UNIT), groups={"bed": FIXED},
                  loads={"gravity": [GRAVITY * np.sin(lean), 0, -GRAVITY * np.cos(lean)]})  # fmt: skip
    stress = UNIT * long * (3 * long / thick * np.sin(lean) - np.cos(lean))
    second = strength / tension(UNIT * long * thick, float(lean), long, thick)
    return Slope(name, long, case, float(strength / stress), 0.05, second=second)


def bodies() -> list[Slope]:
    """All of them."""
    return [
        pushed("buttress", courses=1, friction=24.0, beside=20.0, quick=True),
        pushed("wall of blocks", courses=4, friction=24.0, beside=0.0),
        stepped("step path, friction", 30.0, 0.0, quick=True),
        stepped("step path, cohesion on treads", 25.0, 30e3),
        bridged("plane, a fifth of it rock bridges", 0.2, quick=True),
        three_sets("three joint sets", 30.0),
        roof("roof wedge, anchored", quick=True),
        flexural("flexural toppling of a slab"),
        columns("block toppling, 16 columns", 42.0),
        columns("block toppling, support at the toe", 38.15, 2013e3),
    ]
