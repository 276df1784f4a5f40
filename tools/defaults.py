"""Measure what the defaults of a case do, and what else would: the tables of docs/defaults.md.

`python tools/defaults.py rest` tries the ways to rest, `tolerance` when rest is reached, `motion`
the step and the damping of contacts, `sliding` a block that slides.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))
from scenes import case, irregular_tets

import cdem

STRONG = {"friction_angle": 30, "cohesion": 1e9, "tensile_strength": 1e9}
WEAK = {"friction_angle": 30, "cohesion": 2e5, "tensile_strength": 1e5}
FRICTION = {"default": {"friction_angle": 30}}
FIXED = {"fix": ["x", "y", "z"]}
DOWN = {"gravity": [0, 0, -9.81]}
BASE = {"box": {"min": [-99, -99, -0.001], "max": [99, 99, 0.001]}, **FIXED}
ROOT = {"box": {"min": [-0.01, -99, -99], "max": [0.01, 99, 99]}, **FIXED}
SPLIT = {"split": {"a": "elements"}}


def box(group, size, at=(0, 0, 0), divisions=(1, 1, 1), shape="hex8", **more):
    """A block of a case."""
    size = {"size": list(size), "divisions": list(divisions), "shape": shape}
    return {"group": group, "box": size, "translate": list(at), **more}


BED = box("bed", [12, 6, 1], (-3, -3, -1))


def tilted(degrees):
    """Gravity along a slope."""
    angle = np.radians(degrees)
    return {"gravity": [9.81 * np.sin(angle), 0, -9.81 * np.cos(angle)]}


def resting(folder):
    """Scenes that come to rest: name, blocks, groups, and the rest of the case."""
    on_base, a = {**DOWN, "supports": [BASE]}, {"a": {}}
    column, bedded = [1, 1, 5], {"a": {}, "bed": FIXED}
    yield "column of bonded tets", [box("a", column, divisions=(3, 3, 15), shape="tet4")], a, {
        "interfaces": {"default": STRONG}, "model": SPLIT, "loads": on_base}  # fmt: skip
    yield "column of tets", [box("a", column, divisions=(3, 3, 15), shape="tet4")], a, {
        "loads": on_base}  # fmt: skip
    yield "cantilever", [box("a", [8, 1, 1], divisions=(32, 4, 4))], a, {
        "loads": {**DOWN, "supports": [ROOT]}}  # fmt: skip
    yield "block on an incline", [box("a", [1, 1, 1], divisions=(2, 2, 2)), BED], bedded, {
        "interfaces": FRICTION, "loads": tilted(20)}  # fmt: skip
    cubes = [box("a", [1, 1, 1], (i + 0.5 * (j % 2), 0, j)) for j in range(8) for i in range(6)]
    yield "wall of cubes", [*cubes, BED], bedded, {"interfaces": FRICTION, "loads": DOWN}
    rocks = {
        "rock": {"density": 2500, "young_modulus": 1e7, "poisson_ratio": 0.3},
        "stiff": {"density": 2500, "young_modulus": 5e10, "poisson_ratio": 0.2},
    }
    yield (
        "soft on stiff",
        [box("a", [1, 1, 1], divisions=(3, 3, 3)), BED],
        {"a": {}, "bed": FIXED | {"material": "stiff"}},
        {"materials": rocks, "interfaces": FRICTION, "loads": DOWN},
    )
    stack = [box("a", [1, 1, 1], (0.1 * k, 0, k)) for k in range(5)]
    yield "leaning stack", [*stack, BED], bedded, {"interfaces": FRICTION, "loads": DOWN}
    mesh = irregular_tets(folder / "m.vtk", [4, 4, 4], [4, 4, 4])
    yield "irregular bonded tets", [], {"default": {}}, {
        "model": {**mesh, "split": {"default": "elements"}}, "loads": on_base,
        "interfaces": {"default": STRONG}}  # fmt: skip
    layers = [
        box("a", [2, 2, 1], (0, 0, k), (n, n, 2), shape)
        for k, (n, shape) in enumerate([(4, "hex8"), (3, "hex8"), (4, "tet4")])
    ]
    yield "layers of other meshes", layers, a, {"interfaces": FRICTION, "loads": on_base}


def moving():
    """Scenes in motion: name, blocks, groups, duration, and the rest of the case."""
    cube, down = [1, 1, 1], {"interfaces": FRICTION, "loads": DOWN}
    yield (
        "cube drops flat",
        [BED, box("a", cube, (0, 0, 0.001))],
        {"velocity": [0, 0, -1]},
        0.1,
        down,
    )
    corner = box("a", cube, (0, 0, 0.4), rotate={"axis": [1, -1, 0], "angle": 50})
    yield "cube drops on a corner", [BED, corner], {"velocity": [0, 0, -5]}, 0.3, down
    slides = {"interfaces": {"default": {"friction_angle": 21}}, "loads": tilted(37)}
    for shape in ("hex8", "tet4"):
        block = box("a", cube, divisions=(2, 2, 2), shape=shape)
        yield f"block slides, {shape}", [BED, block], {}, 0.5, slides
    slender = box("a", [1, 1, 4], divisions=(2, 2, 8))
    yield "slender block topples", [BED, slender], {}, 1.0, down | {"loads": tilted(18)}
    bar = [box("a", [8, 1, 1], divisions=(24, 3, 3), shape="tet4")]
    yield "wave in a bonded bar", bar, {"velocity": [1, 0, 0]}, 0.02, {
        "interfaces": {"default": STRONG}, "model": SPLIT, "loads": {"supports": [ROOT]}}  # fmt: skip
    soft = {"rock": {"young_modulus": 1e9}, "model": SPLIT, "loads": DOWN}
    breaks = box("a", cube, (0, 0, 0.002), (3, 3, 3), "tet4")
    yield "bonded cube breaks", [BED, breaks], {"velocity": [0.2, 0.1, -2]}, 0.02, soft | {
        "interfaces": {"default": WEAK}}  # fmt: skip
    loose = box("a", [1, 1, 2], (0, 0, 0.002), (3, 3, 6), "tet4")
    yield "loose column falls apart", [BED, loose], {}, 0.1, soft | {"interfaces": FRICTION}
    stack = [box("a", cube, (0, 0, k)) for k in range(5)]
    yield "stack on a shaken bed", [BED, *stack], {}, 0.5, {"interfaces": FRICTION, "loads": DOWN | {
        "velocities": [{"group": "bed", "velocity": [0.3, 0, 0],
                        "history": [[0, 0], [0.1, 1], [0.2, -1], [0.3, 1], [0.4, 0]]}]}}  # fmt: skip


def settle(blocks, groups, more, **stage):
    """Displacements at rest, how the stage ended, and the simulation."""
    stage = {"name": "rest", "mode": "static", **stage}
    sim = cdem.Simulation(case(blocks, groups, defaults=True, stages=[stage], **more), threads=1)
    return sim.run(), sim.fields["displacement"].copy(), sim


def rest(folder):
    """Steps to rest by each way, and how far it ends from where `local` does."""
    for name, blocks, groups, more in resting(folder):
        first, words = None, []
        for way in ("local", "adaptive", "kinetic"):
            end, u, sim = settle(blocks, groups, dict(more), relax=way, max_steps=60000)
            first = u if first is None else first
            apart = np.abs(u - first).max() / np.abs(first).max()
            words.append(f"{way} {end} {sim.step_count:,} ({apart:.1e})")
        print(f"{name:26s}", "; ".join(words), flush=True)


def tolerance(folder):
    """How far from rest each tolerance stops."""
    for name, blocks, groups, more in resting(folder):
        first, words = None, []
        for limit in (1e-8, 1e-6, 1e-5, 1e-4, 1e-3):
            _, u, sim = settle(blocks, groups, dict(more), tolerance=limit, max_steps=20000)
            first = u if first is None else first
            apart = np.abs(u - first).max() / np.abs(first).max()
            words.append(f"{limit:.0e}: {apart:.1e} {sim.step_count:,}")
        print(f"{name:26s}", "; ".join(words), flush=True)


def motion(_folder):
    """Where a body is, and the closing error, at other steps and contact damping."""
    for name, blocks, group, duration, more in moving():
        beds = {"bed": {} if "velocities" in more["loads"] else FIXED} if BED in blocks else {}
        words = []
        for safety, damping in ((0.8, {}), (0.4, {}), (0.8, {"contact": 0})):
            stage = {"name": "run", "mode": "dynamic", "duration": duration, "damping": damping}
            whole = case(blocks, {"a": group} | beds, defaults=True, stages=[stage],
                         time={"safety": safety}, **more)  # fmt: skip
            sim = cdem.Simulation(whole, threads=1)
            sim.run()
            some = sim.build.nodes_of("a")
            mass = sim.build.arrays["node.mass"][some]
            u = np.linalg.norm(mass @ sim.fields["displacement"][some]) / mass.sum()
            words.append(f"{safety} {damping or ''}: {u:.5f} m, {sim.energies['error']:.0e}")
        print(f"{name:26s}", "; ".join(words), flush=True)


def sliding(_folder):
    """Error of the acceleration of a sliding block, and range of its normal force."""
    exact = tilted(37)["gravity"][0] + tilted(37)["gravity"][2] * np.tan(np.radians(21))
    bed = box("bed", [20, 4, 1], (-1, -1, -1), (20, 4, 1))
    for defaults in (False, True):
        for damping in ({"contact": 0}, {"contact": 0.1}):
            for shape, n in (("hex8", 2), ("tet4", 3)):
                block = box("a", [2, 2, 2], divisions=(n, n, n), shape=shape)
                stages = [
                    {"name": "settle", "mode": "static"},
                    {"name": "slide", "mode": "dynamic", "duration": 0.6, "damping": damping,
                     "set": {"interfaces.default.friction_angle": 21}},
                ]  # fmt: skip
                sim = cdem.Simulation(
                    case([bed, block], {"a": {}, "bed": FIXED}, defaults=defaults, stages=stages,
                         interfaces={"default": {"friction_angle": 60}},
                         rock={"young_modulus": 5e9}, loads=tilted(37)),
                    threads=1,
                )  # fmt: skip
                forces: list[float] = []

                def look(sim=sim, forces=forces) -> bool:
                    if sim.stage_index == 1 and sim.stage is not None:
                        forces.append(sim.contacts["force_n"].sum())
                    return False

                sim.run(should_stop=look)
                some = sim.build.nodes_of("a")
                mass = sim.build.arrays["node.mass"][some]
                rate = mass @ sim.fields["velocity"][some, 0] / mass.sum() / 0.6
                weight = -mass.sum() * tilted(37)["gravity"][2]
                low, high = min(forces) / weight, max(forces) / weight
                print(f"{'defaults' if defaults else 'plain'} {damping} {shape}: {100 * (rate / exact - 1):+.2f} %, "
                      f"{low:.1f} to {high:.1f}", flush=True)  # fmt: skip


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        for word in sys.argv[1:]:
            {"rest": rest, "tolerance": tolerance, "motion": motion, "sliding": sliding}[word](
                Path(place)
            )
