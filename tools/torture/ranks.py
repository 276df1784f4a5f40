"""Kill one of two ranks (SIGKILL) at random moments, up to three times in a row, and resume.

The run goes on on one, two or three ranks, and must leave what an unbroken run on one rank leaves.
Needs Linux, mpi4py and mpiexec.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from runs import CASE, command, differences, in_child, opens, run_words
from state import State, add_option

END = 20.0
"""All ranks end so long after one is killed [s]."""
LONGER = CASE.replace("duration: 6 ms", "duration: 40 ms").replace("every: 20 ms", "every: 10 ms")
RANK = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from runs import command
sys.exit(command(*sys.argv[1:]))
"""


class Ranks:
    """Runs into one folder, each killed.

    Args:
        folder: Where to work.
    """

    def __init__(self, folder: Path) -> None:
        self.random = random.Random()
        self.case, self.said = folder / "case.yaml", folder / "stderr"
        self.whole, self.broken = folder / "whole", folder / "broken"
        self.case.write_text(LONGER)
        status, said = in_child(lambda: command(*self._words(self.whole)), self.said)
        begun = time.perf_counter()
        other, more = self._wait(self._start(2, self.broken))
        self.duration = time.perf_counter() - begun
        if status or other:
            sys.exit(f"an unbroken run failed: {said}{more}")
        if found := differences(self.whole, self.broken):
            sys.exit(f"two ranks leave other results: {'; '.join(found)}")

    def _words(self, folder: Path) -> list[str]:
        begun = (folder / ".cdem-results").is_file()
        return [*run_words(self.case, folder), *["--resume"] * begun]

    def _start(self, count: int, folder: Path, *more: str) -> subprocess.Popen[bytes]:
        mpiexec = shutil.which(
            "mpiexec", path=f"{Path(sys.executable).parent}:{os.environ['PATH']}"
        )
        if mpiexec is None:
            sys.exit("needs mpiexec: pip install mpi4py mpich")
        words = [mpiexec, "-n", str(count), sys.executable, "-c", RANK, *self._words(folder), *more]
        with self.said.open("w") as said:
            return subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=said)

    def _wait(self, run: subprocess.Popen[bytes], most: float | None = None) -> tuple[int, str]:
        """Exit status of a run, and what it said."""
        return run.wait(most), self.said.read_text()

    def _kill(self) -> tuple[bool, str]:
        """Run or resume on two ranks, and kill one; whether it still ran, and what went wrong."""
        run = self._start(2, self.broken)
        time.sleep(self.random.uniform(0.0, self.duration))
        while not (victims := ranks_of(run.pid)) and run.poll() is None:
            time.sleep(0.01)
        if victims:
            os.kill(self.random.choice(victims), signal.SIGKILL)
        try:
            status, _ = self._wait(run, END)
        except subprocess.TimeoutExpired:
            for rank in ranks_of(run.pid):
                os.kill(rank, signal.SIGKILL)
            run.kill()
            run.wait()
            return True, f"a rank still ran {END:.0f} s after the other was killed"
        return status != 0, ""

    def trial(self, seed: str) -> tuple[str, str]:
        """Kill, look and resume: "same", "lost" or "wrong", and why; the seed is of the moments."""
        self.random.seed(seed)
        shutil.rmtree(self.broken, ignore_errors=True)
        for _ in range(self.random.randint(1, 3)):
            alive, trouble = self._kill()
            if not trouble and in_child(lambda: opens(self.broken), self.said)[0]:
                trouble = self.said.read_text()
            if trouble:
                return "wrong", trouble
            if not alive:
                break
        count, result = self.random.randint(1, 3), "same"
        status, said = self._wait(self._start(count, self.broken))
        if status == 1 and "no checkpoint to resume from" in said and said.count("\n") == 1:
            result = "lost"
            shutil.rmtree(self.broken)
            status, said = self._wait(self._start(count, self.broken))
        found = differences(self.whole, self.broken) if status == 0 else [said]
        return ("wrong", f"{count} ranks: {'; '.join(found[:4])}") if found else (result, "")


def ranks_of(launcher: int) -> list[int]:
    """Processes of ranks that a launcher, or its helper, has started."""
    parents = {}
    for place in Path("/proc").glob("[0-9]*"):
        try:
            _, _, rest = (place / "stat").read_text().rpartition(")")
            words = (place / "cmdline").read_bytes()
        except OSError:
            continue
        state, parent = rest.split()[:2]
        if state != "Z":
            parents[int(place.name)] = int(parent), words.startswith(sys.executable.encode())
    below = {launcher}
    while more := {pid for pid, (parent, _) in parents.items() if parent in below} - below:
        below |= more
    return sorted(pid for pid in below - {launcher} if parents[pid][1])


def main() -> None:
    """Kill as often as the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=50, help="runs of which a rank is killed")
    parser.add_argument("--seed", type=int, default=1)
    add_option(parser)
    wants = parser.parse_args()
    fresh = dict.fromkeys(("same", "lost", "wrong"), 0)
    state = State(wants.state, [wants.count, wants.seed], fresh)
    counts = state.known
    if sum(counts.values()) < wants.count:
        kill(state, wants.count, wants.seed)
    print(
        f"{wants.count} runs of two ranks, one killed: {counts['same']} resumed to the same bytes, "
        f"{counts['lost']} had no checkpoint yet and said so, {counts['wrong']} wrong "
        f"({state.commits()})"
    )
    sys.exit(counts["wrong"] > 0)


def kill(state: State, count: int, seed: int) -> None:
    """Kill ranks of the runs that are left."""
    os.environ["OMP_NUM_THREADS"] = "1"
    import vtk  # noqa: F401  (once, not in every child)

    from cdem import cli  # noqa: F401
    from cdem.output import report  # noqa: F401
    from cdem.run import simulation  # noqa: F401

    with tempfile.TemporaryDirectory() as place:
        ranks = Ranks(Path(place).resolve())
        for number in range(sum(state.known.values()), count):
            result, why = ranks.trial(f"{seed} {number}")
            state.known[result] += 1
            state.keep()
            if result == "wrong":
                print(f"run {number}: {why}", flush=True)


if __name__ == "__main__":
    main()
