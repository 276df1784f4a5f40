"""Cases of the benchmark: bars of tets, rubble, a wall of cubes, and a cube in tension."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np

from cdem.case.case import Case
from cdem.mesh.primitives import box
from cdem.run.simulation import Simulation

ROCK = {"density": 2500, "young_modulus": "10 GPa", "poisson_ratio": 0.25}
CUBE = 6
"""Cells along the cube in tension for its Young's modulus."""
COLUMNS = 20
"""Cubes in a row of the wall."""


def start(data: dict[str, Any], threads: int) -> tuple[Simulation, float]:
    """A simulation of a case after 20 steps, without frames, and its build time [s].

    Raises:
        CaseError: The case is wrong.
    """
    data = data | {"output": {"frames": False}}
    began = time.perf_counter()
    sim = Simulation(Case.from_dict(data), threads=threads)
    built = time.perf_counter() - began
    sim.step(20)
    return sim, built


def plain(case: dict[str, Any]) -> dict[str, Any]:
    """A variant of a case with exact masses, and bonds and contacts of 10 E/h without compensation."""
    interface = {"stiffness_n": "10 E/h", "stiffness_s": "10 E/h"}
    default = interface | case["interfaces"]["default"]
    blocks = [_alike(block) for block in case["model"].get("blocks", [])]
    stages = [_undamped(stage) if stage["mode"] == "dynamic" else stage for stage in case["stages"]]
    return case | {
        "model": case["model"] | {"blocks": blocks},
        "interfaces": {"default": default},
        "elements": {"mass": "exact"},
        "stages": stages,
    }


def _alike(block: dict[str, Any]) -> dict[str, Any]:
    """A box whose cells of tets are all divided along the same diagonal."""
    tets = block["box"].get("shape") == "tet4"
    return block | {"box": block["box"] | ({"cells": "alike"} if tets else {})}


def _undamped(stage: dict[str, Any]) -> dict[str, Any]:
    """A stage without contact damping, unless it gives one."""
    return stage | {"damping": {"contact": 0} | stage.get("damping", {})}


def bar(m: int, shape: str, **more: Any) -> dict[str, Any]:
    """A bar of 8 m x m x m cells of 1 m, fixed at its left end, with an initial speed of 1 mm/s.

    Args:
        m: Cells across it.
        shape: Shape of its elements: "hex8", "wedge6", "pyramid5" or "tet4".
        more: Further keys of `model`, of its `group` and of its `interface`, and of the case
            itself.
    """
    return {
        "model": {
            "blocks": [
                {"group": "bar", "box": {"size": [8 * m, m, m], "divisions": [8 * m, m, m],
                                         "shape": shape}},
            ],
            **more.pop("model", {}),
        },
        "materials": {"rock": ROCK},
        "groups": {"bar": {"material": "rock", "velocity": [1e-3, 0, 0], **more.pop("group", {})}},
        "interfaces": {"default": {"friction_angle": 30, **more.pop("interface", {})}},
        "loads": {"supports": [{"surface": {"group": "bar", "normal": [-1, 0, 0]},
                                "fix": ["x", "y", "z"]}]},
        "stages": [{"name": "run", "mode": "dynamic", "duration": 1e3}],
        **more,
    }  # fmt: skip


def breakable(strength: str) -> dict[str, Any]:
    """Keys for a `bar` with every element a block of its own, bonded to the others.

    Args:
        strength: Cohesion and tensile strength of the interfaces, with its unit.
    """
    return {
        "model": {"split": {"bar": "elements"}},
        "interface": {"cohesion": strength, "tensile_strength": strength},
    }


def mixed(m: int) -> dict[str, Any]:
    """A quarter each of the bar in hexahedra, wedges, pyramids and tets, bonded to each other."""
    case = bar(m, "hex8", interface={"cohesion": "1 GPa", "tensile_strength": "1 GPa"})
    case["model"]["blocks"] = [
        {"group": "bar", "translate": [2 * m * i, 0, 0],
         "box": {"size": [2 * m, m, m], "divisions": [2 * m, m, m], "shape": shape}}
        for i, shape in enumerate(("hex8", "wedge6", "pyramid5", "tet4"))
    ]  # fmt: skip
    return case


def _shaken(folder: Path, size: list[int]) -> str:
    """A mesh file of a box of tets whose inner corners are moved by up to a quarter of a cell."""
    import meshio

    whole = box("bar", [float(n) for n in size], size, shape="tet4")
    points, inner = whole.points, np.ones(whole.points.shape, bool)
    inner &= (points > 1e-9) & (points < np.array(size) - 1e-9)
    points = points + inner * np.random.default_rng(1).uniform(-0.25, 0.25, points.shape)
    path = folder / f"{size[0]}.vtk"
    meshio.write_points_cells(path, points, [("tetra", whole.cells["tet4"])])
    return str(path)


def irregular(m: int, folder: Path) -> dict[str, Any]:
    """The bonded bar of a mesh with moved inner corners, written into a folder."""
    case = bar(m, "tet4", **breakable("1 GPa"))
    mesh = _shaken(folder, [8 * m, m, m])
    case["model"] = {"mesh": mesh, "split": {"default": "elements"}}
    case["groups"] = {"default": case["groups"]["bar"]}
    case["loads"]["supports"][0]["surface"]["group"] = "default"
    return case


def pulled() -> dict[str, Any]:
    """A cube of bonded tets, group "bar", in tension of 0.1 MPa along x."""
    size = [CUBE] * 3
    return _pull(
        "bar",
        {"blocks": [{"group": "bar", "box": {"size": size, "divisions": size, "shape": "tet4"}}]},
    )


def pulled_irregular(folder: Path) -> dict[str, Any]:
    """The same with moved inner corners, its mesh written into a folder; group "default"."""
    return _pull("default", {"mesh": _shaken(folder, [CUBE] * 3)})


def _pull(group: str, model: dict[str, Any]) -> dict[str, Any]:
    """Apply tension along x to the bonded tets of the only group of a model."""
    return {
        "model": {"split": {group: "elements"}, **model},
        "materials": {"rock": ROCK},
        "groups": {group: {"material": "rock"}},
        "interfaces": {"default": {"friction_angle": 30, **breakable("1 GPa")["interface"]}},
        "loads": {"tractions": [
            {"surface": {"group": group, "normal": [n, 0, 0]}, "traction": [n * 1e5, 0, 0]}
            for n in (-1, 1)
        ]},
        "stages": [{"name": "pull", "mode": "static", "relax": "adaptive"}],
    }  # fmt: skip


def rubble(m: int, speed: float = 1.0) -> dict[str, Any]:
    """The bonded bar with every bond broken, above a plate; it slides and tumbles.

    Args:
        m: Cells across it.
        speed: Speed of its motion, relative to 21 m/s (rms).
    """
    case = bar(
        m,
        "tet4",
        model={"split": {"bar": "elements"}},
        group={
            "velocity": [2 * speed, 0, -speed],
            "angular_velocity": [0.5 * speed, speed, 2 * speed],
        },
        interface={"cohesion": "10 Pa", "tensile_strength": "10 Pa"},  # all break at once
    )
    case["model"]["blocks"].append(
        {"group": "plate", "box": {"size": [20 * m, 6 * m, 1]}, "translate": [-4 * m, -3 * m, -1]}
    )
    case["groups"]["plate"] = {"material": "rock", "fix": ["x", "y", "z"]}
    case["loads"] = {"gravity": [0, 0, -9.81]}
    return case


def wall(rows: int) -> dict[str, Any]:
    """A running-bond wall of cubes of one element on a floor."""
    blocks: list[dict[str, Any]] = [
        {"group": "cubes", "box": {"size": [1, 1, 1]}, "translate": [i + 0.5 * (j % 2), 0, j]}
        for j in range(rows)
        for i in range(COLUMNS)
    ]
    blocks.append(
        {"group": "floor", "box": {"size": [COLUMNS + 4, 3, 1]}, "translate": [-2, -1, -1]}
    )
    return {
        "model": {"blocks": blocks},
        "materials": {"rock": ROCK},
        "groups": {"cubes": {"material": "rock"},
                   "floor": {"material": "rock", "fix": ["x", "y", "z"]}},
        "interfaces": {"default": {"friction_angle": 30}},
        "loads": {"gravity": [0, 0, -9.81]},
        "stages": [{"name": "rest", "mode": "dynamic", "duration": 1e3}],
    }  # fmt: skip
