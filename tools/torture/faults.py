"""Kill a run at every call that changes its folder, or let that call fail; then resume it.

`python tools/torture/faults.py` tries every call; `--every 20` one of twenty. Needs a C compiler.
"""

from __future__ import annotations

import argparse
import ctypes
import errno
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from runs import CASE, command, differences, in_child, opens, run_words
from state import State, add_option

HERE = Path(__file__).parent
HOWS = {"kill": 0, "EIO": errno.EIO, "ENOSPC": errno.ENOSPC}


def build_shim(folder: Path) -> Path:
    """Compile the shim."""
    shim = folder / "faults.so"
    command = [os.environ.get("CC", "cc"), "-shared", "-fPIC", "-O1", "-o", str(shim)]
    subprocess.run([*command, str(HERE / "faults.c"), "-ldl"], check=True)
    return shim


class Trial:
    """One fault after the other, each in a fresh result folder.

    Args:
        folder: Where to work.
        shim: The loaded shim.
    """

    def __init__(self, folder: Path, shim: ctypes.CDLL) -> None:
        self.case, self.whole, self.broken = (
            folder / "case.yaml",
            folder / "whole",
            folder / "broken",
        )
        self.said, self._shim = folder / "stderr", shim
        self.case.write_text(CASE)
        self.calls = self._count()

    def _run(self, folder: Path, *more: str) -> int:
        return command(*run_words(self.case, folder), *more)

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
        if how != "kill" and status == 0 and not differences(self.whole, self.broken):
            return "same", said  # nothing needed the call, e.g. making a folder that there is
        if wrong := self._wrong_end(how, status, said):
            return "wrong", wrong
        status, trouble = in_child(lambda: opens(self.broken), self.said)
        if status:
            return "wrong", trouble
        status, said = in_child(lambda: self._run(self.broken, "--resume"), self.said)
        result = "same"
        if status == 1 and "no checkpoint to resume from" in said and said.count("\n") == 1:
            result, (status, said) = "lost", self._run_again()
        found = differences(self.whole, self.broken) if status == 0 else [said]
        return ("wrong", "; ".join(found[:4])) if found else (result, said)

    def _wrong_end(self, how: str, status: int, said: str) -> str:
        """What is wrong with how a run ended in which a call failed, or nothing."""
        if how == "kill":
            return "" if status == -9 else f"was not killed, but ended with {status}: {said}"
        whole = status == 0 and said.startswith("no report.html: ")  # --resume writes it again
        told = (status == 1 or whole) and "Traceback" not in said and said.count("\n") <= 2
        return "" if told else f"ended with {status} and said: {said}"

    def _run_again(self) -> tuple[int, str]:
        """Run into a folder of which nothing can be resumed."""
        if (self.broken / ".cdem-results").is_file():
            return in_child(lambda: self._run(self.broken, "--overwrite"), self.said)
        shutil.rmtree(self.broken, ignore_errors=True)
        return in_child(lambda: self._run(self.broken), self.said)


def main() -> None:
    """Try the calls that the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--every", type=int, default=1, help="try one call of so many")
    parser.add_argument("--how", choices=HOWS, action="append", help="by default all of them")
    add_option(parser)
    wants = parser.parse_args()
    hows = wants.how or list(HOWS)
    fresh = {"calls": 0, "done": dict.fromkeys(hows, 0), "same": 0, "lost": 0, "wrong": 0}
    state = State(wants.state, [wants.every, hows], fresh)
    if not state.known["calls"] or min(state.known["done"].values()) < state.known["calls"]:
        break_runs(state, wants.every)
    known = state.known
    print(
        f"{known['same'] + known['lost'] + known['wrong']} faults ({', '.join(hows)}) at "
        f"{known['calls']} calls: {known['same']} runs resumed to the same bytes, {known['lost']} had "
        f"no checkpoint yet and said so, {known['wrong']} wrong ({state.commits()})"
    )
    sys.exit(known["wrong"] > 0)


def break_runs(state: State, every: int) -> None:
    """Try the calls that are left."""
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
        known = state.known
        known["calls"] = trial.calls
        for how, done in known["done"].items():
            for number in range(done + 1, trial.calls + 1, every):
                result, why = trial.fault(number, how)
                known[result] += 1
                known["done"][how] = min(number - 1 + every, trial.calls)
                state.keep()
                if result == "wrong":
                    print(f"{how} at call {number}: {why}")


if __name__ == "__main__":
    main()
