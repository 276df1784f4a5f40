"""Kill a run (SIGKILL) at random moments, up to three times in a row, and resume it."""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from runs import CASE, command, differences, in_child, opens, run_words
from state import State, add_option


class Kills:
    """Runs into one folder, each killed.

    Args:
        folder: Where to work.
        case: A case file, or None for one of its own.
    """

    def __init__(self, folder: Path, case: Path | None) -> None:
        self.random = random.Random()
        self.case, self.said = case or folder / "case.yaml", folder / "stderr"
        self.whole, self.broken = folder / "whole", folder / "broken"
        if case is None:
            self.case.write_text(CASE)
        begun = time.perf_counter()
        status, said = in_child(lambda: self._run(self.whole), self.said)
        self.duration = time.perf_counter() - begun
        if status:
            sys.exit(f"the unbroken run failed: {said}")

    def _run(self, folder: Path) -> int:
        begun = (folder / ".cdem-results").is_file()
        return command(*run_words(self.case, folder), *["--resume"] * begun)

    def _kill(self) -> bool:
        """Run or resume, and kill it at a random moment; whether it still ran."""
        child = os.fork()
        if child == 0:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
            os._exit(self._run(self.broken))
        time.sleep(self.random.uniform(0.0, self.duration))
        os.kill(child, signal.SIGKILL)
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL

    def trial(self, seed: str) -> tuple[str, str]:
        """Kill, look and resume: "same", "lost" or "wrong", and why; the seed is of the moments."""
        self.random.seed(seed)
        shutil.rmtree(self.broken, ignore_errors=True)
        for _ in range(self.random.randint(1, 3)):
            alive = self._kill()
            status, trouble = in_child(lambda: opens(self.broken), self.said)
            if status:
                return "wrong", trouble
            if not alive:
                break
        status, said = in_child(lambda: self._run(self.broken), self.said)
        if status == 1 and "no checkpoint to resume from" in said and said.count("\n") == 1:
            words = [*run_words(self.case, self.broken), "--overwrite"]
            status, said = in_child(lambda: command(*words), self.said)
            found = differences(self.whole, self.broken) if status == 0 else [said]
            return ("wrong", "; ".join(found[:4])) if found else ("lost", "")
        found = differences(self.whole, self.broken) if status == 0 else [said]
        return ("wrong", "; ".join(found[:4])) if found else ("same", "")


def main() -> None:
    """Kill as often as the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100, help="runs to kill")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--case", type=Path, help="a case file, with a small checkpoint_every")
    add_option(parser)
    wants = parser.parse_args()
    state = State(
        wants.state,
        [wants.count, wants.seed, *([str(wants.case)] if wants.case else [])],
        dict.fromkeys(("same", "lost", "wrong"), 0),
    )
    if sum(state.known.values()) < wants.count:
        kill(state, wants.count, wants.seed, wants.case)
    counts = state.known
    print(
        f"{wants.count} killed runs: {counts['same']} resumed to the same bytes, {counts['lost']} had "
        f"no checkpoint yet and said so, {counts['wrong']} wrong ({state.commits()})"
    )
    sys.exit(counts["wrong"] > 0)


def kill(state: State, count: int, seed: int, case: Path | None) -> None:
    """Kill the runs that are left."""
    os.environ["OMP_NUM_THREADS"] = "1"  # a forked process has the threads of its parent's only
    import vtk  # noqa: F401  (once, not in every child)

    from cdem import cli  # noqa: F401
    from cdem.output import report  # noqa: F401
    from cdem.run import simulation  # noqa: F401

    with tempfile.TemporaryDirectory() as place:
        kills = Kills(Path(place).resolve(), case and case.resolve())
        for number in range(sum(state.known.values()), count):
            result, why = kills.trial(f"{seed} {number}")
            state.known[result] += 1
            state.keep()
            if result == "wrong":
                print(f"run {number}: {why}")


if __name__ == "__main__":
    main()
