"""Bring forty scenes of loose blocks to rest: the table of loose blocks in docs/defaults.md.

`python tools/loose_blocks.py adaptive local` runs them by each way, on one thread, and prints steps,
processor time, closing error, and how far the ways end from the last one. Names of scenes after
`--` run these alone.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))
from scenes import case

import cdem
from cdem.errors import CdemError

Scene = dict[str, Any]
STONE = {"density": 2500, "young_modulus": 10e9, "poisson_ratio": 0.25}
GROUPS = {"a": {}, "bed": {"material": "stiff", "fix": ["x", "y", "z"]}}
MOST = 300_000
"""Steps of a stage."""
LINTEL = {"openings": [(1.6, 2.4, 0, 1.2)], "lintels": [(1.2, 2.8, 6)]}
WINDOWS = {
    "openings": [(1.6, 2.4, 0.6, 1.2), (4.4, 5.2, 0.6, 1.2)],
    "lintels": [(1.2, 2.8, 6), (4.0, 5.6, 6)],
}


def box(size, at, group="a", divisions=(1, 1, 1), shape="hex8", **more):
    """A block of a case."""
    size, at = ([round(float(v), 7) for v in row] for row in (size, at))
    form = {"size": size, "divisions": list(divisions), "shape": shape}
    return {"group": group, "box": form, "translate": at, **more}


def bed(size=(12, 4), at=(-3, -1.5), divisions=(1, 1, 1)):
    """A fixed slab with its top at height 0."""
    return box((*size, 0.5), (*at, -0.5), "bed", divisions)


def scene(blocks, soft=1.0, friction=35, stiffness=None, damping=0.0) -> Scene:
    """Arguments of a case; `soft` is E of the blocks over that of the bed."""
    joint = {} if stiffness is None else {"stiffness_n": stiffness, "stiffness_s": stiffness}
    return {
        "blocks": blocks,
        "rock": STONE | {"young_modulus": 10e9 * soft},
        "materials": {"stiff": STONE},
        "interfaces": {"default": {"friction_angle": friction} | joint},
        "damping": {"contact": damping},
    }


def stack(count, lean=0.0, gap=0.0, divisions=(1, 1, 1), shape="hex8", beds=(1, 1, 1), **more):
    """Cubes of 1 m on each other."""
    places = [(lean * k, 0, k + gap * (k + 1)) for k in range(count)]
    cubes = [box((1, 1, 1), at, divisions=divisions, shape=shape) for at in places]
    return scene([*cubes, bed(divisions=beds)], **more)


def spans(length, row, openings, lintels, height=0.2):
    """Left and right ends of the blocks of a course [m]."""
    ends = [0.0, *np.arange(0.5 if row % 2 else 1, length + 1e-9) * 0.4]
    ends += [length * 0.4] if ends[-1] < length * 0.4 - 1e-9 else []
    found = list(pairwise(ends))
    cuts = [(a, b) for a, b, low, high in openings if low < (row + 1) * height - 1e-9
            and high > row * height + 1e-9]  # fmt: skip
    beams = [(a, b) for a, b, at in lintels if at == row]
    for a, b in cuts + beams:
        pieces = [(s, min(e, a)) for s, e in found] + [(max(s, b), e) for s, e in found]
        found = [(s, e) for s, e in dict.fromkeys(pieces) if e - s > 0.05]
    return found + beams


def wall(length, rows, rough=0.0, gap=0.0, apart=0.0, beds=(1, 1, 1), seed=1, shape="hex8",
         divisions=(1, 1, 1), openings=(), lintels=(), **more):  # fmt: skip
    """Running bond of blocks of 0.4 x 0.3 x 0.2 m.

    Rough blocks are smaller than their place by up to so much on each axis, and anywhere in it;
    with a gap each bed is open by 0.1 to 1 of it; `apart` opens the head joints [m].
    """
    rng, blocks = np.random.default_rng(seed), []
    for row in range(rows):
        for start, end in spans(length, row, openings, lintels):
            cut = rng.uniform(0.1, 1, 3) * rough + np.array([apart, 0, 0])
            shift = rng.uniform(0, 1, 3) * cut
            lift = (row + rng.uniform(0.1, 1)) * gap
            at = np.array([start, 0, row * 0.2 + lift]) + shift
            blocks.append(
                box(np.array([end - start, 0.3, 0.2]) - cut, at, divisions=divisions, shape=shape)
            )
    return scene([*blocks, bed((length * 0.4 + 2, 2.3), (-1, -1), beds)], **more)


def arch(count, ratio, gap=0.0, pier=0.0):
    """Half a ring of voussoirs, mean radius 2.5 m, on the bed or on piers."""
    radius, ends, blocks = 2.5, np.pi * np.arange(count + 1) / count, []
    inner, outer = radius * (1 - ratio / 2), radius * (1 + ratio / 2)
    for start, end in zip(ends[:-1] + gap / radius / 2, ends[1:] - gap / radius / 2, strict=True):
        ring = [(inner, start), (outer, start), (outer, end), (inner, end)]
        corners = [
            [round(float(v), 7) for v in (r * np.cos(f), y, r * np.sin(f) + pier)]
            for y in (0, 1)
            for r, f in ring
        ]
        blocks.append({"group": "a", "polyhedron": {"vertices": corners}})
    wide = ratio * radius + 0.8
    for side in (-1, 1):
        left = side * (radius + 0.3) - wide / 2
        blocks += [box((wide, 1, 0.5), (left, 0, 0.5 * k)) for k in range(round(pier / 0.5))]
    return scene([*blocks, bed((12, 2), (-6, -0.5))], friction=40)


def portal():
    """A lintel above two piers of four blocks, 0.5 mm apart."""
    piers = [box((0.6, 0.5, 0.5), (x, 0, 0.5 * k)) for x in (0, 2) for k in range(4)]
    return scene([*piers, box((2.6, 0.5, 0.4), (0, 0, 2.0005)), bed()])


def scree(across, down, layers, slope=28, seed=3):
    """Stones of six to ten corners, 0.3 to 0.5 m, one above another on a fixed slope."""
    rng, stones = np.random.default_rng(seed), []
    c, s = np.cos(np.radians(slope)), np.sin(np.radians(slope))
    tilt = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    for x, y, z in np.ndindex(down, across, layers):
        ways = rng.normal(size=(rng.integers(6, 11), 3))
        ways /= np.linalg.norm(ways, axis=1)[:, None]
        centre = 0.5 * np.array([x, y, z]) + 0.26 + 0.02 * rng.uniform(-1, 1, 3)
        corners = (centre + rng.uniform(0.16, 0.24) * ways) @ tilt.T
        stones.append({"group": "a", "polyhedron": {"vertices": np.round(corners, 7).tolist()}})
    plate = [(x, y, z) for z in (-0.5, 0) for x, y in ((-1, -1), (9, -1), (9, 4), (-1, 4))]
    floor = np.round(np.array(plate) @ tilt.T, 7).tolist()
    return scene([*stones, {"group": "bed", "polyhedron": {"vertices": floor}}], friction=38)


def scenes() -> dict[str, Callable[[], Scene]]:
    """All scenes by their names."""
    found: dict[str, Callable[[], Scene]] = {}

    def add(name, make, *args, **more):
        found[name] = lambda: make(*args, **more)

    for count in (2, 5, 10, 20):
        add(f"stack of {count}", stack, count)
    add("leaning stack of 5", stack, 5, lean=0.1)
    for count, gap in ((5, 0.1), (10, 1), (20, 0.3)):
        add(f"stack of {count}, gaps of {gap} mm", stack, count, gap=gap / 1000)
    for length, rows in ((4, 2), (6, 8), (10, 10), (20, 10), (25, 20)):
        add(f"wall {length} x {rows}", wall, length, rows)
    for gap in (0.1, 1):
        add(f"wall 6 x 8, beds open by {gap} mm", wall, 6, 8, gap=gap / 1000)
    for rough in (0.1, 0.3, 1):
        add(f"rough wall 6 x 8, {rough} mm", wall, 6, 8, rough=rough / 1000)
    add("the same, friction 20", wall, 6, 8, rough=1e-3, friction=20, seed=4)
    add("rough wall 10 x 10, 0.5 mm", wall, 10, 10, rough=5e-4)
    add("rough wall 20 x 10, 1 mm", wall, 20, 10, rough=1e-3)
    add("rough wall 25 x 20, 1 mm", wall, 25, 20, rough=1e-3)
    add("wall with a door and lintel", wall, 10, 10, **LINTEL)
    add("the same, rough by 0.5 mm", wall, 10, 10, rough=5e-4, **LINTEL)
    add("rough wall with two windows", wall, 16, 10, rough=1e-3, **WINDOWS)
    add("lintel 0.5 mm above two piers", portal)
    add("arch of 13, t/R 0.15", arch, 13, 0.15)
    add("arch of 13, joints open by 0.3 mm", arch, 13, 0.2, gap=3e-4)
    add("arch of 25, t/R 0.2", arch, 25, 0.2)
    add("arch of 13 on piers", arch, 13, 0.2, pier=1.5)
    for soft in (1e-2, 1e-3, 1e-4):
        add(f"soft cube, {soft:g} of the bed", stack, 1, soft=soft, divisions=(2, 2, 2))
        add(f"soft wall 6 x 4, {soft:g}", wall, 6, 4, soft=soft)
    add("the same of tets", wall, 6, 4, soft=1e-4, shape="tet4")
    add("soft rough wall 6 x 4, 0.001", wall, 6, 4, soft=1e-3, rough=5e-4)
    add("stack of 5 of tets, gaps of 1 mm", stack, 5, gap=1e-3, divisions=(2, 2, 2), shape="tet4")
    add("rough wall 6 x 4 of tets", wall, 6, 4, rough=5e-4, divisions=(2, 1, 1), shape="tet4")
    add("scree of 96 stones on 28 degrees", scree, 4, 8, 3)
    many = (24, 8, 1)
    add("wall 6 x 8 on 192 faces", wall, 6, 8, beds=many)
    add("the same, rough", wall, 6, 8, beds=many, rough=5e-4)
    add("the same, contact damping 0.1", wall, 6, 8, beds=many, damping=0.1)
    add("wall 2 x 3, 1 mm apart, 10 E/h", wall, 2, 3, apart=1e-3, beds=(8, 4, 1), soft=0.08,
        friction=20, stiffness="10 E/h")  # fmt: skip
    cube = [box((1, 1, 1), (0, 0, 1e-4)), bed((4, 4), (-1.5, -1.5), (8, 4, 1))]
    add("cube 0.1 mm above 32 faces, 10 E/h", scene, cube, stiffness="10 E/h")
    return found


def settle(made: Scene, way: str):
    """How a scene ends by a way to rest; the simulation; processor time [s]."""
    stage = {"name": "rest", "mode": "static", "relax": way, "max_steps": MOST}
    more = dict(made)
    stage["damping"] = more.pop("damping")
    begun = time.process_time()
    sim = cdem.Simulation(
        case(more.pop("blocks"), GROUPS, stages=[stage], defaults=True,
             loads={"gravity": [0, 0, -9.81]}, **more),
        threads=1,
    )  # fmt: skip
    try:
        end = sim.run()
    except CdemError as error:
        end = str(error)[:60]
    if sim.ended_stage and sim.ended_stage.handed_over:
        end = "handed over"
    return end, sim, time.process_time() - begun


def main() -> None:
    """Print a row for each scene."""
    arguments = sys.argv[1:]
    split = arguments.index("--") if "--" in arguments else len(arguments)
    ways, only = arguments[:split] or ["adaptive", "local"], arguments[split + 1 :]
    for name, make in scenes().items():
        if only and name not in only:
            continue
        found = [settle(make(), way) for way in ways]
        last, words = found[-1][1].fields["displacement"].copy(), []
        for end, sim, seconds in found:
            u, error = sim.fields["displacement"], sim.energies["error"]
            far, apart = np.abs(u).max(), np.abs(u - last).max() / np.abs(last).max()
            steps = f"{sim.step_count:,}" + ("" if end == "converged" else f" ({end})")
            words.append(
                f"{steps} | {seconds:.1f} | {100 * error:.1g} | {1e3 * far:.3g} | {100 * apart:.1g}"
            )
        blocks = len(found[0][1].build.topology.block_group) - 1
        print(f"| {name} | {blocks} |", " | ".join(words), "|", flush=True)


if __name__ == "__main__":
    main()
