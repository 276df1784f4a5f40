"""Runs in forked processes, and whether two result folders hold the same."""

from __future__ import annotations

import json
import os
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

OF_THE_MACHINE = ("wall_time",)
CASE = """
cdem: 1
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
  default: {friction_angle: 30}
  pairs:
    - {between: [wall, wall], friction_angle: 30, cohesion: 0.1 MPa, tensile_strength: 0.05 MPa}
loads:
  gravity: [0, 0, -9.81]
stages:
  - {name: rest, mode: static, max_steps: 40}
  - {name: fall, mode: dynamic, duration: 6 ms}
  - {name: last, mode: dynamic, duration: 2 ms, set: {interfaces.default.friction_angle: 20}}
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
    from cdem.run.checkpoint import read_checkpoint

    names = {p.relative_to(one) for p in one.rglob("*") if p.is_file()}
    others = {p.relative_to(other) for p in other.rglob("*") if p.is_file()}
    found = [f"{name} is in one only" for name in sorted(names ^ others)]
    for name in sorted(names & others):
        if name.name == "checkpoint-before.h5":
            same = bool(read_checkpoint(other / name))  # which one depends on where the run broke
        elif name.name == "checkpoint.h5":
            (a, told), (b, other_told) = (read_checkpoint(p / name) for p in (one, other))
            same = a.keys() == b.keys() and all(a[k].tobytes() == b[k].tobytes() for k in a)
            same = same and without_times(json.loads(told)) == without_times(json.loads(other_told))
        elif name.name == "summary.json":
            texts = [json.loads((p / name).read_text()) for p in (one, other)]
            same = without_times(texts[0]) == without_times(texts[1])
        elif name.name == "report.html":
            same = (other / name).read_text().rstrip().endswith("</html>")
        else:
            passes = name.name in ("run.log", ".cdem-results", ".cdem-lock")
            same = passes or (one / name).read_bytes() == (other / name).read_bytes()
        if not same:
            found.append(f"{name} differs")
    return found


def without_times(tree: object) -> object:
    """A tree of results without times of the machine."""
    if isinstance(tree, dict):
        return {k: without_times(v) for k, v in tree.items() if k not in OF_THE_MACHINE}
    return [without_times(v) for v in tree] if isinstance(tree, list) else tree
