"""Bring cases to rest by `adaptive` and by `solve`: the tables of docs/theory/rest.md.

`python tools/solved_rests.py` compares the rests of cases of the repository, `python
tools/solved_rests.py slopes 150` counts how slopes of brittle joints end, `python
tools/solved_rests.py bonded 24 12 12 3` times bonded tets so many cells long, wide and high, in
turns, and `python tools/solved_rests.py bolted` solves for bolts across a soft joint. All run on one
thread.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np

import cdem
from cdem.errors import CdemError
from cdem.run import stages
from cdem.run.kept import bring_back, keep

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "src/cdem"
CASES = [
    *(PACKAGE / "templates" / f"{name}.yaml" for name in ("slope", "foliated", "landslide")),
    *(
        PACKAGE / "verification" / name / "case.yaml"
        for name in ("cantilever", "bonded_bar", "infinite_slope", "plane_sliding", "water_wedge")
    ),
    ROOT / "tests/faults/newcomer/roadcut.yaml",
    ROOT / "tests/faults/field2/elastic_column_one_stage.yaml",
    ROOT / "examples/jiweishan/valley.yaml",
    ROOT / "examples/jointed_slope/jointed_slope.yaml",
]
WAYS = ("adaptive", "solve")
TOLERANCE = 1e-7
MOST = 20_000
"""Steps of a slope that does not come to rest."""
PARTS = 40
"""In which gravity is put on where this is slow."""

Rest = dict[str, Any]


def first_rest(path: Path, way: str) -> Rest:
    """Of the first stage of a case: steps, processor time [s], displacements, stresses, reactions."""
    case = cdem.Case.load(str(path))
    case.stages[0].__dict__.update(relax=way, tolerance=TOLERANCE)
    sim = cdem.Simulation(case, threads=1)
    begin = time.process_time()
    end = sim.run_stage(case.stages[0].name)
    spent = time.process_time() - begin
    stress = np.concatenate([np.array(rows).reshape(-1) for rows in sim.core.stress().values()])
    return {
        "end": f"{sim.step_count:,}" + ("" if end == "converged" else f" ({end})"),
        "seconds": spent,
        "elements": len(stress) // 6,
        "fields": (sim.fields["displacement"].copy(), stress, sim.fields["reaction"].sum(axis=0)),
    }


def compare_cases() -> None:
    """Print a row for each case."""
    for path in CASES:
        relaxed, solved = (first_rest(path, way) for way in WAYS)
        apart = [
            f"{np.abs(b - a).max() / np.abs(a).max():.0e}"
            for a, b in zip(relaxed["fields"], solved["fields"], strict=True)
        ]
        name = path.stem if path.stem != "case" else path.parent.name
        words = [name, f"{relaxed['elements']:,}"]
        for found in (relaxed, solved):
            words += [found["end"], f"{found['seconds']:.2f}"]
        print("|", " | ".join(words + apart), "|", flush=True)


def slope(rng: np.random.Generator) -> Rest:
    """A cut of 5 to 20 m in rock with one or two sets of brittle joints."""
    height = float(rng.choice([5, 10, 20]))
    long, wide = 1.5 * height, 0.4 * height
    lean = height / np.tan(np.radians(rng.uniform(60, 90)))
    section = [[0, 0], [-lean, height], [-long, height], [-long, 0]]
    dips = [rng.uniform(25, 65)] + ([rng.uniform(60, 88)] if rng.random() < 0.7 else [])
    cohesion = float(rng.choice([0.1, 0.2, 0.5, 1, 2])) * 7650 * height
    joint = {
        "friction_angle": float(rng.uniform(15, 40)),
        "cohesion": cohesion,
        "tensile_strength": cohesion * float(rng.choice([0.1, 0.5, 1])),
    }
    sets = [
        {"name": f"s{k}", "dip": float(dip), "dip_direction": 90.0 if k == 0 else 270.0,
         "spacing": height / int(rng.integers(2, 5)), "origin": [-1.0, 0.0, 0.3 * height]}
        for k, dip in enumerate(dips)
    ]  # fmt: skip
    far = [1e3, 1e3, 1e3]
    held = [
        {"box": {"min": [-1e3, -1e3, -1], "max": [*far[:2], 0.01]}, "fix": ["x", "y", "z"]},
        {"box": {"min": [-1e3, -1e3, -1], "max": [0.01 - long, *far[1:]]}, "fix": ["x", "y", "z"]},
    ]
    young = float(rng.choice([50e6, 1e9, 20e9]))
    corners = [[float(x), y, float(z)] for y in (0.0, wide) for x, z in section]
    return {
        "model": {
            "blocks": [{"group": "rock", "polyhedron": {"vertices": corners}}],
            "joints": sets,
        },
        "materials": {"rock": {"density": 2600, "young_modulus": young, "poisson_ratio": 0.25}},
        "groups": {"rock": {"material": "rock"}},
        "interfaces": {
            "default": {"friction_angle": joint["friction_angle"]},
            "pairs": [{"name": s["name"], "joint": s["name"], **joint} for s in sets],
        },
        "loads": {"gravity": [0, 0, -9.81], "supports": [one | {"group": "rock"} for one in held]},
    }


def stands(case: Rest, way: str, parts: int = 1) -> bool:
    """Whether it comes to rest, with gravity put on in so many parts."""
    case = deepcopy(case)
    case["stages"] = [
        {"name": f"part {k}", "mode": "static", "relax": way, "max_steps": MOST,
         "set": {"loads.gravity": [0, 0, -9.81 * k / parts]}}
        for k in range(1, parts + 1)
    ]  # fmt: skip
    try:
        return cdem.Simulation(cdem.Case(**case), threads=1).run() == "converged"
    except CdemError:
        return False


def compare_slopes(count: int) -> None:
    """Count how slopes end: by each way, and by small parts of gravity where the ways differ."""
    rng, ends = np.random.default_rng(2), Counter[str]()
    for _ in range(count):
        case = slope(rng)
        found = [stands(case, way) for way in WAYS]
        words = [
            f"{way} {'stands' if ok else 'slides'}" for way, ok in zip(WAYS, found, strict=True)
        ]
        if found[0] != found[1]:
            words.append(f"{PARTS} parts {'stands' if stands(case, WAYS[0], PARTS) else 'slides'}")
        ends[", ".join(words)] += 1
    for words, times in ends.items():
        print(f"{times:4d} {words}")


def bonded(cells: list[int]) -> cdem.Case:
    """Bonded tets on a base, under gravity that leans."""
    box = {"size": [40, 20, 20], "divisions": cells, "shape": "tet4"}
    base = {"surface": {"group": "rock", "normal": [0, 0, -1]}, "fix": ["x", "y", "z"]}
    strong = {"friction_angle": 40, "cohesion": "5 MPa", "tensile_strength": "3 MPa"}
    return cdem.Case(
        model={"blocks": [{"group": "rock", "box": box}], "split": {"rock": "elements"}},
        materials={"rock": {"density": 2600, "young_modulus": "10 GPa", "poisson_ratio": 0.25}},
        groups={"rock": {"material": "rock"}},
        interfaces={"default": strong},
        loads={"gravity": [3, 0, -9.81], "supports": [base]},
        stages=[{"name": "settle", "mode": "static"}],
        output={"frames": False},
    )


def time_bonded(cells: list[int], turns: int) -> None:
    """Print steps and times from the start of the stage to rest, one way after the other."""
    sim = cdem.Simulation(bonded(cells), threads=1)
    start = keep(sim)
    for _ in range(turns):
        for way in WAYS:
            bring_back(sim, start)
            sim.stage_index, sim.case.stages[0].__dict__["relax"] = 0, way
            before = sim.step_count, time.process_time(), time.perf_counter()
            stage, outcome = stages.begin(sim), ""
            while outcome != "converged":
                outcome = stages.advance(sim, stage, MOST, np.inf)[0]
            steps, spent, wall = np.subtract(
                (sim.step_count, time.process_time(), time.perf_counter()), before
            )
            print(f"{way}: {steps:.0f} steps, {spent:.2f} s of processor, {wall:.2f} s", flush=True)


def bolted(stiffness: str, across: int) -> cdem.Case:
    """Two slabs of bonded tets, a joint between them, and bolts across it in a square."""
    slab = {"size": [20, 20, 5], "divisions": [10, 10, 3], "shape": "tet4"}
    strong = {"friction_angle": 40, "cohesion": "5 MPa", "tensile_strength": "3 MPa"}
    soft = {"between": ["low", "up"], "stiffness_n": stiffness, "stiffness_s": stiffness}
    places = [(x, y) for x in np.linspace(1, 19, across) for y in np.linspace(1, 19, across)]
    bar = {"area": 1e-3, "young_modulus": 2e11, "yield_force": 5e6, "dowel": True,
           "grout": {"stiffness": 1e9, "strength": 1e6}}  # fmt: skip
    bolts = [
        {"name": f"b{k}", "type": "bar", "points": [[x, y, 10.0], [x, y, 3.0]], "plate": True,
         "pretension": 1e5}
        for k, (x, y) in enumerate(places)
    ]  # fmt: skip
    base = {"surface": {"group": "low", "normal": [0, 0, -1]}, "fix": ["x", "y", "z"]}
    return cdem.Case(
        model={
            "blocks": [
                {"group": "low", "box": slab},
                {"group": "up", "box": slab, "translate": [0, 0, 5]},
            ],
            "split": {"low": "elements", "up": "elements"},
        },
        materials={"rock": {"density": 2600, "young_modulus": "10 GPa", "poisson_ratio": 0.25}},
        groups={"low": {"material": "rock"}, "up": {"material": "rock"}},
        interfaces={"default": strong, "pairs": [strong | soft]},
        loads={"gravity": [3, 0, -9.81], "supports": [base]},
        bolt_types={"bar": bar},
        bolts=bolts,
        stages=[{"name": "settle", "mode": "static"}],
    )


def solve_bolted() -> None:
    """Print how stages with bolts come to rest."""
    for stiffness in ("10 GPa/m", "0.1 GPa/m", "10 MPa/m"):
        for across in (6, 12, 20):
            sim = cdem.Simulation(bolted(stiffness, across), threads=1)
            begin = time.process_time()
            sim.run()
            spent, told = time.process_time() - begin, sim.ended_stage and sim.ended_stage.solved
            print(f"{stiffness}, {across**2} bolts: {sim.step_count} steps, {spent:.1f} s; {told}")


def main() -> None:
    """Choose by the command line."""
    what, *numbers = sys.argv[1:] or ["cases"]
    if what == "bonded":
        time_bonded([int(n) for n in numbers[:3]], int(numbers[3]))
    elif what == "bolted":
        solve_bolted()
    elif what == "slopes":
        compare_slopes(int(numbers[0]))
    else:
        compare_cases()


if __name__ == "__main__":
    main()
