"""Small scenes whose results are pinned, and the hash of a result.

`python tests/regression/golden_scenes.py` prints every scene's hash and time; with `--write` it
renews golden.json. A renewed golden.json needs a line in CHANGELOG.md that says why, and names it
in "reason".
"""

from __future__ import annotations

import hashlib
import json
import sys
import time
from collections.abc import Callable
from functools import partial
from importlib.resources import files
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent))
sys.path.insert(0, str(Path(__file__).parent))
from scenes import case
from staged_scenes import STAGED, digest_of_state, run_stages

import cdem

GOLDEN = Path(__file__).parent / "golden.json"
WEIGHT = {"gravity": [0, 0, -9.81]}
SOFT = {"young_modulus": "0.1 GPa"}
STRONG = {"friction_angle": 30, "cohesion": 1e9, "tensile_strength": 1e9}
SCENES: dict[str, Callable[[int], cdem.Simulation]] = {}


def scene(build: Callable[[int], cdem.Simulation]) -> Callable[[int], cdem.Simulation]:
    """Enter a scene into the list; it gives a finished simulation for a number of threads."""
    SCENES[build.__name__] = build
    return build


def box(group, size, at=(0, 0, 0), divisions=None, shape="hex8", **more):
    """A block for `case`."""
    entry = {"size": list(size), "shape": shape}
    if divisions:
        entry["divisions"] = list(divisions)
    return {"group": group, "box": entry, "translate": list(at), **more}


def finish(data: cdem.Case, steps: int, threads: int) -> cdem.Simulation:
    """Step through the first stage."""
    sim = cdem.Simulation(data, threads=threads)
    sim.step(steps)
    return sim


FIXED = {"fix": ["x", "y", "z"]}


@scene
def elastic(threads):
    """A bar of many elements, lumped masses, swings."""
    bar = box("bar", [4, 0.5, 0.5], divisions=[16, 3, 3])
    stages = [{"name": "run", "mode": "dynamic", "duration": 1, "damping": {"stiffness": 0.05}}]
    return finish(
        case([bar], {"bar": {"velocity": [0, 0, 1]}}, rock=SOFT, loads=WEIGHT, stages=stages),
        300,
        threads,
    )


@scene
def bonded(threads):
    """Tets that are blocks of their own and hold."""
    bar = box("bar", [2, 1, 1], divisions=[12, 6, 6], shape="tet4")
    return finish(
        case(
            [bar],
            {"bar": {"velocity": [1, 0, 0]}},
            interfaces={"default": STRONG},
            rock=SOFT,
            loads=WEIGHT,
            model={"split": {"bar": "elements"}},
        ),
        200,
        threads,
    )


def thrown(threads, strength, steps, shape="tet4", divisions=(3, 3, 3), **more):
    """A bonded cube that hits a fixed bed."""
    strengths = {"friction_angle": 30, "cohesion": strength, "tensile_strength": strength}
    return finish(
        case(
            [
                box("body", [1, 1, 1], [0, 0, 0.002], divisions, shape),
                box("bed", [4, 4, 1], [-1.2, -1.3, -1]),
            ],
            {"body": {"velocity": [0.2, 0.1, -3]}, "bed": FIXED},
            interfaces={"default": strengths},
            rock=SOFT,
            loads=WEIGHT,
            stages=[
                {
                    "name": "fall",
                    "mode": "dynamic",
                    "duration": 1,
                    "damping": {"contact": 0.1, "stiffness": 0.1},
                }
            ],
            model={"split": {"body": "elements"}},
            **more,
        ),
        steps,
        threads,
    )


@scene
def breaking(threads):
    """A cube of bonded tets breaks on a bed."""
    sim = thrown(threads, 5e4, 400)
    assert sum(sim.broken.values()) > 10
    return sim


@scene
def defaults(threads):
    """The same with the defaults of the program: lumped masses until the last bond breaks."""
    sim = thrown(threads, 5e4, 400, defaults=True)
    assert sum(sim.broken.values()) > 10
    lumped = sim.core.rebuilt()["node.lumped"]
    assert lumped.any() and not lumped.all()
    return sim


@scene
def rubble(threads):
    """Tets without bonds fall apart and tumble on each other."""
    sim = thrown(threads, 0, 600)
    assert len(sim.contacts["kind"]) > 20
    return sim


@scene
def wall(threads):
    """Cubes in running bond settle under their weight."""
    stones = [
        box("wall", [1, 1, 1], [x + 0.5 * (row % 2), 0, row]) for row in range(4) for x in range(4)
    ]
    ground = box("ground", [8, 3, 1], [-1, -1, -1])
    sim = finish(
        case(
            [*stones, ground],
            {"wall": {}, "ground": FIXED},
            interfaces={"default": {"friction_angle": 35}},
            rock=SOFT,
            loads=WEIGHT,
            stages=[
                {"name": "rest", "mode": "dynamic", "duration": 1, "damping": {"contact": 0.2}}
            ],
        ),
        400,
        threads,
    )
    assert len(sim.contacts["kind"]) > 50
    return sim


@scene
def landslide(threads):
    """The template: a meshed body slides on its bed. Both stages, cut short."""
    folder = files("cdem") / "templates"
    data = cdem.Case.load(str(folder / "landslide.yaml"))
    data.set("interfaces.bed.friction_angle", "12 deg")
    data.stages[0].max_steps = 100
    data.stages[1].duration = 1.0
    sim = cdem.Simulation(data, threads=threads)
    assert sim.run() == "finished" and sum(sim.broken.values()) > 10
    return sim


@scene
def static(threads):
    """Two blocks come to rest on a bed by kinetic relaxation."""
    blocks = [box("a", [1, 1, 1], [0, 0, 1], [2, 2, 2]), box("a", [1.2, 1, 1], [0.1, 0.1, 0])]
    bed = box("bed", [3, 3, 0.5], [-1, -1, -0.5], [2, 2, 1])
    stages = [{"name": "rest", "mode": "static", "relax": "kinetic", "max_steps": 400}]
    sim = cdem.Simulation(
        case(
            [*blocks, bed],
            {"a": {}, "bed": FIXED},
            interfaces={"default": {"friction_angle": 30}},
            rock=SOFT,
            loads=WEIGHT,
            stages=stages,
        ),
        threads=threads,
    )
    sim.run()
    return sim


@scene
def adaptive(threads):
    """A bonded column under its weight, adaptive relaxation with scaled masses."""
    column = box("a", [1, 1, 3], [0, 0, 0], [2, 2, 6], "tet4")
    foot = box("foot", [1, 1, 0.5], [0, 0, -0.5], [2, 2, 1])
    stages = [{"name": "rest", "mode": "static", "relax": "adaptive", "max_steps": 300}]
    sim = cdem.Simulation(
        case(
            [column, foot],
            {"a": {}, "foot": FIXED},
            interfaces={"default": STRONG},
            rock=SOFT,
            loads=WEIGHT,
            stages=stages,
            model={"split": {"a": "elements"}},
        ),
        threads=threads,
    )
    sim.run()
    return sim


@scene
def solved(threads):
    """Bonded tets on a bed with a joint are solved for; then a part is dug out, and solved again."""
    column = box("a", [2, 1, 3], [0, 0, 0], [4, 2, 6], "tet4")
    beside = box("b", [1, 1, 3], [2, 0, 0], [1, 1, 3])
    foot = box("foot", [4, 2, 0.5], [-0.5, -0.5, -0.5], [3, 2, 1])
    joint = {"between": ["a", "foot"], "friction_angle": 40}
    rest = {"mode": "static", "relax": "solve", "tolerance": 1e-6, "max_steps": 300}
    sim = cdem.Simulation(
        case(
            [column, beside, foot],
            {"a": {}, "b": {}, "foot": FIXED},
            interfaces={"default": STRONG, "pairs": [joint]},
            rock=SOFT,
            loads=WEIGHT,
            stages=[{"name": "rest", **rest}, {"name": "dig", **rest, "remove": ["b"]}],
            model={"split": {"a": "elements"}},
        ),
        threads=threads,
    )
    solutions = []
    while not sim.is_over:
        sim.run_stage(sim.case.stages[sim.stage_index].name)
        solutions.append(sim.ended_stage.solved)
    assert all(text.startswith("solved") for text in solutions), solutions
    return sim


SHAPES = ("tet4", "pyramid5", "wedge6", "hex8")
FORMULATIONS = ("corotational", "incremental", "paper-incremental", "paper-total")


@scene
def elements(threads):
    """All element shapes beside each other, all formulations and one-point hexahedra in turn."""
    blocks = [
        box("all", [1, 1, 1], [2 * k, 0, 0], [2, 2, 2], shape) for k, shape in enumerate(SHAPES)
    ]
    ways = [{"formulation": name} for name in FORMULATIONS] + [{"hexahedra": "one-point"}]
    sims = [
        finish(
            case(
                blocks,
                {"all": {"velocity": [0, 0, 1], "fix": []}},
                rock=SOFT,
                loads=WEIGHT,
                elements=way,
                stages=[
                    {
                        "name": "run",
                        "mode": "dynamic",
                        "duration": 1,
                        "damping": {"stiffness": 0.02 if "formulation" not in way else 0},
                    }
                ],
            ),
            60,
            threads,
        )
        for way in ways
    ]
    return sims


@scene
def edges(threads):
    """Crossed beams that touch at their edges alone, and slide."""
    turned = {"rotate": {"axis": [1, 0, 0], "angle": "45 deg"}}
    across = {"rotate": {"axis": [0, 1, 0], "angle": "45 deg"}}
    low = box("low", [4, 0.5, 0.5], [-2, 0, 0], [4, 1, 1], **turned)
    high = box("high", [0.5, 4, 0.5], [-0.4, -2, 1.062], [1, 4, 1], **across)
    sim = finish(
        case(
            [low, high],
            {"low": FIXED, "high": {"velocity": [0.3, 0.1, -0.5]}},
            interfaces={"default": {"friction_angle": 20}},
            rock=SOFT,
            loads=WEIGHT,
        ),
        300,
        threads,
    )
    assert (sim.contacts["kind"] == 1).any()
    return sim


@scene
def hand_over(threads):
    """Bonds of faces that do not conform break while the block above slides over a seam."""
    above = box("above", [1, 1, 0.5], [0.55, 0.1, 0], [2, 2, 1])
    below = [box("below", [1, 1.2, 0.5], [x, 0, -0.5], [1, 1, 1]) for x in (0, 1, 2)]
    sim = finish(
        case(
            [above, *below],
            {"above": {"velocity": [1.5, 0, 0]}, "below": FIXED},
            interfaces={
                "default": {"friction_angle": 20, "cohesion": 2e4, "tensile_strength": 1e4}
            },
            rock=SOFT,
            loads=WEIGHT,
        ),
        1200,
        threads,
    )
    assert sum(sim.broken.values()) > 0
    return sim


@scene
def driven(threads):
    """Supports and tractions that follow curves; a block of one element shares its mass matrix."""
    stages = [{"name": "run", "mode": "dynamic", "duration": 1, "damping": {"local": 0.1}}]
    return finish(
        case(
            [
                box("plate", [2, 2, 0.3], [0, 0, 0], [3, 3, 1]),
                box("block", [0.5, 0.5, 0.5], [0.7, 0.7, 0.3]),
            ],
            {"plate": {}, "block": {}},
            interfaces={"default": {"friction_angle": 25}},
            rock=SOFT,
            loads={
                **WEIGHT,
                "velocities": [
                    {
                        "group": "plate",
                        "velocity": [0.5, 0, 0],
                        "history": [[0, 0], [0.002, 1], [0.004, -1]],
                    }
                ],
            },
            stages=stages,
        ),
        300,
        threads,
    )


@scene
def bolted(threads):
    """A cube of bonded tets breaks while bolts hold it together: they slip, yield and are sheared."""
    bar = {"area": 5e-4, "young_modulus": 2e11, "yield_force": 6e3, "dowel": True,
           "grout": {"stiffness": 1e8, "strength": 3e3}}  # fmt: skip
    lines = [[[0.1, 0.2, 1.95], [1.8, 1.7, 0.1]], [[1.9, 0.9, 1.4], [0.3, 1.1, 0.6]]]
    bolts = [
        {"name": f"b{k}", "type": "bar", "points": points, "plate": True, "pretension": 2e3 * k}
        for k, points in enumerate(lines)
    ]
    pull = {"surface": {"group": "rock", "normal": [0, 0, 1]}, "traction": [0, 0, 4e5]}
    floor = {"surface": {"group": "rock", "normal": [0, 0, -1]}, "fix": ["x", "y", "z"]}
    sim = finish(
        case(
            [box("rock", [2, 2, 2], divisions=[3, 3, 3], shape="tet4")],
            {"rock": {}},
            interfaces={
                "default": {"friction_angle": 30, "cohesion": 2e5, "tensile_strength": 1e5}
            },
            rock={"young_modulus": "20 GPa"},
            loads=WEIGHT | {"supports": [floor], "tractions": [pull]},
            model={"split": {"rock": "elements"}},
            bolt_types={"bar": bar},
            bolts=bolts,
        ),
        400,
        threads,
    )
    state = sim.core.fields()
    assert state["bolts.grout_state"].any() and state["bolts.bar_state"].any()
    assert sum(sim.broken.values()) > 10
    return sim


for staged in STAGED:
    SCENES[staged] = partial(run_stages, staged)


def digest(name: str, threads: int) -> str:
    """Hash of a scene: of the whole state after several stages, else of results."""
    done = SCENES[name](threads)
    return digest_of_state(done) if name in STAGED else digest_of_results(done)


def digest_of_results(sim: cdem.Simulation | list[cdem.Simulation]) -> str:
    """Hash of the results of one or more simulations: values in a fixed order, without names."""
    whole = hashlib.sha256()
    for one in sim if isinstance(sim, list) else [sim]:
        contacts = one.contacts
        values = [one.fields["position"], one.fields["velocity"], contacts["kind"].astype(float)]
        values += [contacts["force_n"], contacts["force"]]
        values += [np.array([one.time, one.step_count, *one.broken.values()], float)]
        terms = ("kinetic", "strain", "contact", "friction", "damping", "fracture", "external")
        values += [np.array([one.energies[term] for term in terms])]
        for shape in SHAPES:
            values.append(np.array(one.core.stress()[shape]))
        for array in values:
            whole.update(np.ascontiguousarray(array, dtype=float).tobytes())
    return whole.hexdigest()[:32]


def main() -> None:
    """Print or renew the hashes, of the scenes that the command line names or of all."""
    found = {}
    for name in [name for name in SCENES if name in sys.argv] or SCENES:
        start = time.perf_counter()
        found[name] = digest(name, 1)
        print(f"{name:12s} {found[name]} {time.perf_counter() - start:6.2f} s", flush=True)
    if "--write" in sys.argv:
        reason = json.loads(GOLDEN.read_text())["reason"] if GOLDEN.exists() else ""
        GOLDEN.write_text(json.dumps({"reason": reason, "scenes": found}, indent=2) + "\n")


if __name__ == "__main__":
    main()
