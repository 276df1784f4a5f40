"""Runs that are killed at the end or in the middle of a stage, and what they leave when they go on."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from cdem import Case, Simulation

FREE = {"wall_time", "version", "host", "date"}
"""Values that differ between two runs."""


def strip(value):
    """A nest of dicts and lists without values that differ between two runs."""
    if isinstance(value, dict):
        return {k: strip(v) for k, v in value.items() if k not in FREE}
    return [strip(v) for v in value] if isinstance(value, list) else value


def content(folder: Path) -> dict[str, object]:
    """All that a run has left but its log, and its checkpoints, which keep wall times."""
    found: dict[str, object] = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_dir() or name in ("run.log",) or name.startswith((".", "checkpoint")):
            continue
        found[name] = path.read_bytes()
    found["summary.json"] = strip(json.loads((folder / "summary.json").read_text()))
    return found


class StagesOf:
    """An unbroken run of a case, and copies of its folder at the stops of another."""

    def __init__(self, case: dict, place: Path) -> None:
        self.place = place
        self.case = place / "case.yaml"
        YAML().dump(case, self.case)
        self._read = Case.load(self.case)  # once: the text takes as long as a short run
        self.whole = self.run("whole")
        summary = self.whole["summary.json"]
        self.stages = [(stage["name"], stage["steps"]) for stage in summary["stages"]]

    def run(self, folder: str, **how) -> dict[str, object]:
        """Run to the end; what it left."""
        Simulation(self._read, output=self.place / folder, threads=1, **how).run()
        return content(self.place / folder)

    def differing(self, stop: Callable[[], None]) -> list[str]:
        """Names of files of a run that stops and goes on which are not those of the unbroken run."""
        shutil.rmtree(self.place / "broken", ignore_errors=True)
        stop()
        got = self.run("broken", resume=True)
        return [n for n in self.whole | got if self.whole.get(n) != got.get(n)]

    def stop_at_end(self, stage: str) -> None:
        """Leave the folder that a kill behind the end of a stage leaves."""
        simulation = Simulation(self._read, output=self.place / "broken", threads=1)
        simulation.run_stage(stage)
        simulation.close()

    def stops(self) -> Iterator[tuple[str, Callable[[], None]]]:
        """Run once, and stop in the middle and at the end of each stage.

        Yields:
            Where it stopped, and a function that leaves the folder that a kill there leaves.
        """
        simulation = Simulation(self._read, output=self.place / "stopped", threads=1)
        leave = partial(shutil.copytree, self.place / "stopped", self.place / "broken")
        for stage, steps in self.stages:
            stopped_at = simulation.step_count + steps // 2
            with pytest.MonkeyPatch.context() as patch:  # the loop comes back after few steps
                patch.setattr("cdem.run.simulation.CHUNK_SECONDS", 0.0)
                simulation.run(should_stop=lambda at=stopped_at: simulation.step_count >= at)
            yield f"within {stage}", leave
            simulation.run_stage(stage)
            yield f"at the end of {stage}", leave
