"""Kill a run at every call that changes its folder, or let that call fail; then resume it.

`python tools/torture/faults.py` tries every call; `--every 20` one of twenty. Needs a C compiler.
"""

from __future__ import annotations

import argparse
import ctypes
import errno
import json
import os
import shutil
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path

HERE = Path(__file__).parent
HOWS = {"kill": 0, "EIO": errno.EIO, "ENOSPC": errno.ENOSPC}
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


def build_shim(folder: Path) -> Path:
    """Compile the shim."""
    shim = folder / "faults.so"
    command = [os.environ.get("CC", "cc"), "-shared", "-fPIC", "-O1", "-o", str(shim)]
    subprocess.run([*command, str(HERE / "faults.c"), "-ldl"], check=True)
    return shim


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
            same = same and without_times(told) == without_times(other_told)
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


class Trial:
    """One fault after the other, each in a fresh result folder.

    Args:
        folder: Where to work.
        shim: The loaded shim.
    """

    def __init__(self, folder: Path, shim: ctypes.CDLL) -> None:
        self.case, self.whole, self.broken = folder / "case.yaml", folder / "whole", folder / "broken"
        self.said, self._shim = folder / "stderr", shim
        self.case.write_text(CASE)
        self.calls = self._count()

    def _run(self, folder: Path, *more: str) -> int:
        return command("run", str(self.case), "-o", str(folder), "--threads", "1", "--quiet", *more)

    def _count(self) -> int:
        """Calls of a run that nothing breaks."""
        told = self.said.with_suffix(".count")

        def work() -> int:
            self._shim.faults_arm(str(self.whole).encode(), 0, 0)
            status = self._run(self.whole)
            calls = self._shim.faults_count()
            self._shim.faults_arm(b"", 0, 0)
            told.write_text(str(calls))
            return status

        status, said = in_child(work, self.said)
        if status:
            sys.exit(f"the unbroken run failed: {said}")
        return int(told.read_text())

    def fault(self, number: int, how: str) -> tuple[str, str]:
        """Break a run at a call; what became of it ("same", "lost" or "wrong"), and why."""
        shutil.rmtree(self.broken, ignore_errors=True)

        def work() -> int:
            self._shim.faults_arm(str(self.broken).encode(), number, HOWS[how])
            return self._run(self.broken)

        status, said = in_child(work, self.said)
        if how == "kill" and status != -9:
            return "wrong", f"was not killed, but ended with {status}: {said}"
        if how != "kill" and (status != 1 or "Traceback" in said or said.count("\n") > 2):
            return "wrong", f"ended with {status} and said: {said}"
        status, trouble = in_child(lambda: opens(self.broken), self.said)
        if status:
            return "wrong", trouble
        status, said = in_child(lambda: self._run(self.broken, "--resume"), self.said)
        if status == 1 and "no checkpoint to resume from" in said and said.count("\n") == 1:
            again = "--overwrite" if (self.broken / ".cdem-results").is_file() else "--quiet"
            if again == "--quiet":
                shutil.rmtree(self.broken, ignore_errors=True)
            status, trouble = in_child(lambda: self._run(self.broken, again), self.said)
            found = differences(self.whole, self.broken) if status == 0 else [trouble]
            return ("wrong", "; ".join(found[:4])) if found else ("lost", said.strip())
        found = differences(self.whole, self.broken) if status == 0 else [said]
        return ("wrong", "; ".join(found[:4])) if found else ("same", said)


def main() -> None:
    """Try the calls that the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--every", type=int, default=1, help="try one call of so many")
    parser.add_argument("--at", type=int, help="try this call only, and keep the folders")
    parser.add_argument("--how", choices=HOWS, action="append", help="by default all of them")
    wants = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place).resolve()
        if "CDEM_FAULTS" not in os.environ:
            shim = str(build_shim(folder))
            env = os.environ | {"LD_PRELOAD": shim, "CDEM_FAULTS": shim, "OMP_NUM_THREADS": "1"}
            sys.exit(subprocess.run([sys.executable, *sys.argv], env=env, check=False).returncode)
        import vtk  # noqa: F401  (once, not in every child)

        from cdem import cli  # noqa: F401
        from cdem.output import report  # noqa: F401
        from cdem.run import simulation  # noqa: F401

        trial = Trial(folder, ctypes.CDLL(os.environ["CDEM_FAULTS"]))
        counts = dict.fromkeys(("same", "lost", "wrong"), 0)
        for how in wants.how or HOWS:
            for number in range(1, trial.calls + 1, wants.every):
                result, why = trial.fault(number, how)
                counts[result] += 1
                if result == "wrong":
                    print(f"{how} at call {number}: {why}")
        print(
            f"{sum(counts.values())} faults at {trial.calls} calls: {counts['same']} runs resumed to "
            f"the same bytes, {counts['lost']} had no checkpoint yet and said so, "
            f"{counts['wrong']} wrong"
        )
    sys.exit(counts["wrong"] > 0)


if __name__ == "__main__":
    main()
