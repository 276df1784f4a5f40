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

from cdem.run.checkpoint import has_checkpoint
from cdem.run.simulation import Simulation

sys.path.insert(0, str(Path(__file__).parent))
from state import State, add_option

SMALL = """
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
  default: {friction_angle: 30, stiffness_n: 10 E/h, stiffness_s: 10 E/h}
loads:
  gravity: [0, 0, -9.81]
stages:
  - {name: shake, mode: dynamic, duration: 1000, damping: {contact: 0.2}}
elements: {mass: exact}
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
"""Largest growth allowed of the memory of a process over its second half."""
LONG = 20
"""Looks from which on a process is judged; a run that was cut off has several."""


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
        subprocess.run(
            [sys.executable, "-m", "cdem", "new", name, str(folder), "--overwrite"], check=True
        )
        case = yaml.load(path.read_text())
        case["stages"][-1]["duration"] = 1000
    yaml.dump(case, path.open("w"))
    return path


class Watch:
    """Looks at a run now and then, and stops it after a number of steps.

    Args:
        simulation: It has not begun, or goes on from a checkpoint.
        steps: Of the last stage.
        state: What was seen before.
    """

    def __init__(self, simulation: Simulation, steps: int, state: State) -> None:
        self.simulation, self.steps, self.state = simulation, steps, state
        state.known["memories"].append([])

    def __call__(self) -> bool:
        """Note memory [MB] and closing error; whether the run is to stop."""
        stage, known = self.simulation.stage, self.state.known
        done = self.simulation.step_count - stage.start_step
        if stage.mode == "static":
            return False
        known["worst"] = max(known["worst"], abs(self.simulation.energies["error"]))
        looks = sum(map(len, known["memories"]))
        if done >= looks * self.steps / LOOKS:
            known["memories"][-1].append(memory())
            self.state.keep()
        return done >= self.steps


def soak(name: str, steps: int, folder: Path, state: State) -> None:
    """Run what is left."""
    folder.mkdir(parents=True, exist_ok=True)
    results = folder / "results"
    goes_on = has_checkpoint(results)
    case = case_of(name, folder)
    simulation = Simulation(case, output=results, resume=goes_on, overwrite=not goes_on)
    status = simulation.run(should_stop=Watch(simulation, steps, state))
    state.known |= {
        "end": f"{status} after {simulation.step_count:,} steps, {simulation.time:.4g} s",
        "right": status == "stopped",
    }
    state.keep()


def tell(name: str, state: State) -> bool:
    """Say what was seen, and whether it is right."""
    known = state.known
    halves = [
        (max(seen[: len(seen) // 2]), max(seen[len(seen) // 2 :]))
        for seen in known["memories"]
        if len(seen) >= LONG
    ]
    if not halves:
        print(
            f"{name}: no process was long enough to judge its memory; remove its state, and run again"
        )
        return False
    early, late = max(halves, key=lambda half: half[1] / half[0])
    print(
        f"{name}: {known['end']}; memory {early:.1f} MB in the first half, {late:.1f} MB in the "
        f"second, of {len(known['memories'])} processes; largest closing error "
        f"{known['worst']:.2e} ({state.commits()})"
    )
    return bool(known["right"] and late / early - 1 <= GROWTH and known["worst"] <= ENERGY)


def main() -> None:
    """Run what the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", choices=STEPS)
    parser.add_argument("--steps", type=int, help="of the last stage")
    add_option(parser)
    wants = parser.parse_args()
    steps = wants.steps or STEPS[wants.name]
    fresh = {"worst": 0.0, "memories": [], "end": "", "right": False}
    state = State(wants.state, [wants.name, steps], fresh)
    with tempfile.TemporaryDirectory() as place:
        folder = wants.state.with_suffix("") if wants.state else Path(place)
        if not state.known["end"]:
            soak(wants.name, steps, folder.resolve(), state)
    sys.exit(not tell(wants.name, state))


if __name__ == "__main__":
    main()
