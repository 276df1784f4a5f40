"""Damage the checkpoint of a run in many ways, and resume it.

A flipped bit must be noticed, and the run must go on from the checkpoint before, to the same bytes.
A file of another shape, even with a right checksum, must be refused in one line.
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from runs import CASE, command, differences, in_child, run_words
from state import State, add_option

REFUSED = ("is damaged", "another version of cdem", "belongs to another model")
RESUMED = 50  # of so many flipped bits one is resumed to the end


class Damages:
    """Trials on one stopped run.

    Args:
        folder: Where to work.
        seed: Of the random places.
        state: What was done before.
    """

    def __init__(self, folder: Path, seed: int, state: State) -> None:
        self.seed, self.state, self.random = seed, state, random.Random()
        self.case, self.said = folder / "case.yaml", folder / "stderr"
        self.whole, self.stopped, self.trial = (
            folder / "whole",
            folder / "stopped",
            folder / "trial",
        )
        self.case.write_text(CASE)
        status, said = in_child(lambda: command(*run_words(self.case, self.whole)), self.said)
        if status:
            sys.exit(f"the unbroken run failed: {said}")
        in_child(self._stop, self.said)

    def _stop(self) -> int:
        """Stop in the middle of the second stage."""
        from cdem.run.simulation import Simulation

        simulation = Simulation(self.case, threads=1, output=self.stopped)
        simulation.run_stage("rest")
        left = iter([False, False, True])
        simulation.run(should_stop=lambda: next(left))
        return 0

    def resume(self, damage: Callable[[Path], object]) -> tuple[int, str]:
        """Damage a copy of the stopped run, and resume it: exit status and what was said."""
        shutil.rmtree(self.trial, ignore_errors=True)
        shutil.copytree(self.stopped, self.trial)
        damage(self.trial / "checkpoint.h5")
        words = [word for word in run_words(self.case, self.trial) if word != "--quiet"]
        return in_child(lambda: command(*words, "--resume"), self.said)

    def flip(self, count: int) -> None:
        """Flip one bit after the other."""
        from cdem.run.checkpoint import DamagedError, read_checkpoint

        content = (self.stopped / "checkpoint.h5").read_bytes()
        found = self.state.known["flipped"]
        path = self.trial.with_name("flipped.h5")
        for number in range(found["done"], count):
            self.random.seed(f"bit {self.seed} {number}")
            damaged = bytearray(content)
            damaged[self.random.randrange(len(content))] ^= 1 << self.random.randrange(8)
            path.write_bytes(damaged)
            try:
                read_checkpoint(path)
                found["wrong"] += 1
            except DamagedError:
                found["noticed"] += 1
            if number % RESUMED == 0:
                status, said = self.resume(lambda one, bytes_=damaged: one.write_bytes(bytes_))
                same = status == 0 and not differences(self.whole, self.trial)
                same = same and "continuing from the previous one" in said
                found["resumed to the same bytes" if same else "wrong"] += 1
            found["done"] = number + 1
            self.state.keep()

    def bend(self, count: int) -> None:
        """Change structure under a right checksum, one array or attribute after the other."""
        found = self.state.known["bent"]
        for number in range(found["done"], count):
            self.random.seed(f"bend {self.seed} {number}")
            what: list[str] = []
            status, said = self.resume(lambda path, what=what: what.append(self._bend(path)))
            if status == 1 and "Traceback" not in said and any(one in said for one in REFUSED):
                found["refused"] += 1
            elif status == 0 and not differences(self.whole, self.trial):
                found["to the same bytes"] += 1
            else:
                found["wrong"] += 1
                print(f"{what[0]}: status {status}, {said.strip()[-300:]}")
            found["done"] = number + 1
            self.state.keep()

    def _bend(self, path: Path) -> str:
        """Change one thing in a checkpoint and give it a right checksum; says what."""
        from cdem.run.checkpoint import read_checkpoint, write_checkpoint

        arrays, text = read_checkpoint(path)
        attributes = json.loads(text)
        for name in ("checkpoint.h5", "checkpoint-before.h5"):
            path.with_name(name).unlink()
        said = self.random.choice([self._bend_array, self._bend_attribute])(arrays, attributes)
        write_checkpoint(path.parent, arrays, json.dumps(attributes))
        return said

    def _bend_array(self, arrays: dict, attributes: dict) -> str:
        name = self.random.choice([name for name in arrays if arrays[name].size])
        array = arrays[name]
        way = self.random.choice(["shorter", "longer", "gone", "type", "shape", "index", "extra"])
        if way == "shorter":
            arrays[name] = array[: self.random.randrange(len(array))]
        elif way == "longer":
            arrays[name] = np.concatenate([array, array[: self.random.randrange(1, 9)]])
        elif way == "gone":
            del arrays[name]
        elif way == "type":
            arrays[name] = array.astype(np.float32 if array.dtype == np.float64 else np.float64)
        elif way == "shape":
            arrays[name] = array[None]
        elif way == "extra":
            arrays["node.unheard_of"] = array
        else:  # an index out of range
            indices = sorted(n for n in arrays if n in INDICES and arrays[n].size)
            name = self.random.choice(indices)
            arrays[name] = arrays[name].copy()
            bad = self.random.choice([-(2**31) + 1, 2**31 - 1, -1000, 1_000_000])
            arrays[name][self.random.randrange(len(arrays[name]))] = bad
        return f"{name} {way}"

    def _bend_attribute(self, arrays: dict, attributes: dict) -> str:
        tree = self.random.choice([attributes, attributes["core"], attributes["stage"]])
        key = self.random.choice(sorted(tree))
        way = self.random.choice(["gone", "text", "list", "none"])
        if way == "gone":
            del tree[key]
        else:
            tree[key] = {"text": "junk", "list": [1], "none": None}[way]
        return f"attribute {key} {way}"


def indices_of(case: Path) -> set[str]:
    """Names of the stored arrays that hold indices."""
    from cdem.run.simulation import Simulation

    infos = Simulation(case, threads=1).core.describe()
    return {i["name"] for i in infos if i["origin"] == "stored" and any(i["refers_to"])}


INDICES: set[str] = set()


def main() -> None:
    """Damage as often as the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bits", type=int, default=5000, help="bits to flip")
    parser.add_argument("--bends", type=int, default=500, help="structures to change")
    parser.add_argument("--seed", type=int, default=1)
    add_option(parser)
    wants = parser.parse_args()
    fresh = {
        "flipped": {"done": 0, "noticed": 0, "resumed to the same bytes": 0, "wrong": 0},
        "bent": {"done": 0, "refused": 0, "to the same bytes": 0, "wrong": 0},
    }
    state = State(wants.state, [wants.bits, wants.bends, wants.seed], fresh)
    flipped, bent = state.known["flipped"], state.known["bent"]
    if flipped["done"] < wants.bits or bent["done"] < wants.bends:
        damage(state, wants.bits, wants.bends, wants.seed)
    print(f"flipped bits: {flipped}; structures: {bent} ({state.commits()})")
    sys.exit(flipped["wrong"] + bent["wrong"] > 0)


def damage(state: State, bits: int, bends: int, seed: int) -> None:
    """Do the damage that is left."""
    with tempfile.TemporaryDirectory() as place:
        damages = Damages(Path(place).resolve(), seed, state)
        told = damages.said.with_suffix(".json")

        def tell() -> int:
            told.write_text(json.dumps(sorted(indices_of(damages.case))))
            return 0

        in_child(tell, damages.said)
        INDICES.update(json.loads(told.read_text()))
        assert h5py and INDICES
        damages.flip(bits)
        damages.bend(bends)


if __name__ == "__main__":
    main()
