"""Long runs with all their output: memory must stay flat, and the energy closed.

`small`: a block slides on a floor that is shaken for 10 million steps. `landslide`: the template, let
run for 100,000 steps.
"""

from __future__ import annotations

import argparse
import ctypes
import subprocess
import sys
import tempfile
from pathlib import Path

from ruamel.yaml import YAML

from cdem.run.simulation import Simulation

SMALL = """
cdem: 1
model:
  blocks:
    - {group: floor, box: {size: [4, 2, 1], divisions: [4, 2, 1]}}
    - {group: block, box: {size: [1, 1, 1]}, translate: [1.5, 0.5, 1]}
materials:
  rock: {density: 2600, young_modulus: 1 GPa, poisson_ratio: 0.25}
groups:
  floor: {material: rock}
  block: {material: rock}
interfaces:
  default: {friction_angle: 30}
loads:
  gravity: [0, 0, -9.81]
stages:
  - {name: shake, mode: dynamic, duration: 1000, damping: {contact: 0.2}}
output: {every: 20}
"""
SHAKE = {"group": "floor", "velocity": [3, 0.3, 0]}
"""Of this speed at most, once forth and back in a second: the block slides most of the time."""
STEPS = {"small": 10_000_000, "landslide": 100_000}
ENERGY = 0.01
"""Largest closing error allowed, of the largest term."""
LOOKS = 100
"""At the memory in a run."""
GROWTH = 0.02
"""Largest growth allowed of the memory of the process over the second half of a run."""


def give_back() -> None:
    """Give back what HDF5 keeps for later use, and what lies free in the heap."""
    libraries = {line.split()[-1] for line in Path("/proc/self/maps").read_text().splitlines()}
    for path in libraries:
        if Path(path).name.startswith("libhdf5-"):
            ctypes.CDLL(path).H5garbage_collect()
    ctypes.CDLL(None).malloc_trim(0)


def memory() -> float:
    """Memory of this process [MB], without what it does not use."""
    give_back()
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1e3


def case_of(name: str, folder: Path) -> Path:
    """Write the case of a run that lasts longer than its steps."""
    path = folder / f"{name}.yaml"
    yaml = YAML(typ="safe")
    if name == "small":
        case = yaml.load(SMALL)
        speed = [[0.0, 0.0], *([0.25 + 0.5 * k, (-1.0) ** k] for k in range(2000))]
        case["loads"]["velocities"] = [{**SHAKE, "history": speed}]
    else:
        subprocess.run([sys.executable, "-m", "cdem", "new", name, str(folder)], check=True)
        case = yaml.load(path.read_text())
        case["stages"][-1]["duration"] = 1000
    yaml.dump(case, path.open("w"))
    return path


class Watch:
    """Looks at a run now and then, and stops it after a number of steps.

    Args:
        simulation: It has not begun.
        steps: Of the last stage.
    """

    def __init__(self, simulation: Simulation, steps: int) -> None:
        self.simulation, self.steps = simulation, steps
        self.worst = self.early = self.late = 0.0
        self.looks = 0

    def __call__(self) -> bool:
        """Note memory [MB] and closing error; whether the run is to stop."""
        stage = self.simulation.stage
        done = self.simulation.step_count - stage.start_step
        if stage.mode == "static":
            return False
        self.worst = max(self.worst, abs(self.simulation.energies["error"]))
        if done >= self.looks * self.steps / LOOKS:
            self.looks += 1
            if done < self.steps / 2:
                self.early = max(self.early, memory())
            else:
                self.late = max(self.late, memory())
        return done >= self.steps


def soak(name: str, steps: int, folder: Path) -> bool:
    """Run, say what was seen, and whether it is right."""
    simulation = Simulation(case_of(name, folder), output=folder / "results")
    watch = Watch(simulation, steps)
    status = simulation.run(should_stop=watch)
    growth = watch.late / watch.early - 1
    print(
        f"{name}: {status} after {simulation.step_count:,} steps, {simulation.time:.4g} s; memory "
        f"{watch.early:.1f} MB in the first half, {watch.late:.1f} MB in the second; "
        f"largest closing error {watch.worst:.2e}"
    )
    return status == "stopped" and growth <= GROWTH and watch.worst <= ENERGY


def main() -> None:
    """Run what the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", choices=STEPS)
    parser.add_argument("--steps", type=int, help="of the last stage")
    wants = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        right = soak(wants.name, wants.steps or STEPS[wants.name], Path(place).resolve())
    sys.exit(not right)


if __name__ == "__main__":
    main()
