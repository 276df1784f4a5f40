"""Runs in forked processes, and whether two result folders hold the same."""

from __future__ import annotations

import json
import os
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

OF_THE_MACHINE = ("wall_time", "date", "host")
CASE = """
title: two blocks fall on a third and break
model:
  blocks:
    - {group: floor, box: {size: [2, 2, 1], divisions: [2, 2, 1]}}
    - {group: wall, box: {size: [1, 1, 1], divisions: [2, 1, 2]}, translate: [0.5, 0.5, 1.001]}
  split: {wall: elements}
materials:
  rock: {density: 2600, young_modulus: 1 GPa, poisson_ratio: 0.25}
groups:
  floor: {material: rock, fix: [x, y, z]}
  wall: {material: rock, velocity: [0.2, 0, -2]}
interfaces:
  default: {friction_angle: 30, stiffness_n: 10 E/h, stiffness_s: 10 E/h}
  pairs:
    - {between: [wall, wall], friction_angle: 30, cohesion: 0.1 MPa, tensile_strength: 0.05 MPa}
loads:
  gravity: [0, 0, -9.81]
stages:
  - {name: rest, mode: static, relax: local, max_steps: 40}
  - {name: fall, mode: dynamic, duration: 6 ms, damping: {contact: 0}}
  - {name: last, mode: dynamic, duration: 2 ms, damping: {contact: 0},
     set: {interfaces.default.friction_angle: 20}}
elements: {mass: exact}
output: {every: 20 ms, checkpoint_every: 1e-9}
histories: [{name: top, group: wall, quantities: [velocity, energy]}]
"""


def run_words(case: Path, folder: Path) -> list[str]:
    """Words of a run into a folder."""
    return ["run", str(case), "-o", str(folder), "--threads", "1", "--quiet"]


def in_child(work: Callable[[], int], said: Path) -> tuple[int, str]:
    """Do a piece of work in a forked process: its exit status, or -9, and what it wrote to stderr."""
    child = os.fork()
    if child == 0:
        status = 70
        with said.open("w") as file:
            os.dup2(file.fileno(), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            try:
                status = work()
            except BaseException:
                traceback.print_exc()
            sys.stderr.flush()
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), said.read_text()


def command(*words: str) -> int:
    """Run cdem in this process, without the pictures of the report, which take seconds each."""
    from cdem import cli
    from cdem.output import report

    report.plot, report.render = lambda folder: [], lambda folder: []
    sys.argv = ["cdem", *words]
    try:
        cli.main()
    except SystemExit as ended:
        return int(ended.code or 0)
    return 0


def opens(folder: Path) -> int:
    """Read every series that is there as VTK does, and every frame; 0 if all of it can be read."""
    import vtk

    vtk.vtkObject.GlobalWarningDisplayOff()
    paths = [*folder.glob("*.vtkhdf"), *folder.glob("*/frame-*.vtkhdf")]
    for path in paths:
        reader = vtk.vtkHDFReader()
        reader.SetFileName(str(path))
        reader.UpdateInformation()
        for step in range(max(reader.GetNumberOfSteps(), 1)):
            reader.SetStep(step)
            reader.Update()
            grid = reader.GetOutputDataObject(0)
            if grid is None or grid.GetNumberOfCells() == 0:
                print(f"{path}: step {step} cannot be read", file=sys.stderr)
                return 1
            low, high = grid.GetBounds()[:2]
            if not high > low:  # NaN where a file is missing
                print(f"{path}: step {step} has no points", file=sys.stderr)
                return 1
    return 0


def differences(one: Path, other: Path) -> list[str]:
    """Names of the results that differ, but for times of the machine."""
    names = {p.relative_to(one) for p in one.rglob("*") if p.is_file()}
    others = {p.relative_to(other) for p in other.rglob("*") if p.is_file()}
    found = [f"{name} is in one only" for name in sorted(names ^ others)]
    for name in sorted(names & others):
        same = SAME.get(name.name, lambda a, b: a.read_bytes() == b.read_bytes())
        if not same(one / name, other / name):
            found.append(f"{name} differs")
    return found


def same_checkpoints(one: Path, other: Path) -> bool:
    """Whether two checkpoints hold the same."""
    from cdem.run.checkpoint import read_checkpoint

    (a, told), (b, other_told) = read_checkpoint(one), read_checkpoint(other)
    same = a.keys() == b.keys() and all(a[name].tobytes() == b[name].tobytes() for name in a)
    return same and without_times(json.loads(told)) == without_times(json.loads(other_told))


def is_checkpoint(_: Path, other: Path) -> bool:
    """Whether a checkpoint can be read; which one was before depends on where the run broke."""
    from cdem.run.checkpoint import read_checkpoint

    return bool(read_checkpoint(other))


def same_summaries(one: Path, other: Path) -> bool:
    """Whether two summaries hold the same."""
    a, b = (without_times(json.loads(path.read_text())) for path in (one, other))
    return a == b


def without_times(tree: object) -> object:
    """A tree of results without times of the machine."""
    if isinstance(tree, dict):
        return {k: without_times(v) for k, v in tree.items() if k not in OF_THE_MACHINE}
    return [without_times(v) for v in tree] if isinstance(tree, list) else tree


SAME: dict[str, Callable[[Path, Path], bool]] = {
    "checkpoint.h5": same_checkpoints,
    "checkpoint-before.h5": is_checkpoint,
    "summary.json": same_summaries,
    "report.html": lambda _, other: other.read_text().rstrip().endswith("</html>"),
    "run.log": lambda *_: True,
    ".cdem-results": lambda *_: True,
    ".cdem-lock": lambda *_: True,
}
"""How files are compared that hold times of the machine; all others byte by byte."""
