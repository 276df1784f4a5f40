"""A simulation: a case turned into a model, run stage by stage, recorded, stopped and resumed."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from cdem._native import core as native
from cdem._version import __version__
from cdem.case.case import Case
from cdem.errors import CdemError, UnstableError
from cdem.model.audit import Audit
from cdem.run import stages
from cdem.run.progress import Progress
from cdem.run.rest import Departure
from cdem.run.result_folder import Results
from cdem.run.state import RunState, StageState

CHUNK_SECONDS = 0.25
"""The loop comes back about this often to look for signals and report progress [s of wall time]."""
CHECK_INTERVAL = 20
"""Steps between checks of the run's health and, in static stages, of the unbalance ratio."""


class Simulation(RunState):
    """One run of a case.

    Args:
        case: A `Case`, or the path of a case file.
        threads: Threads of the core; None for all cores.
        output: Result folder, or None to record nothing.
        overwrite: Replace what an existing result folder holds.
        resume: Go on from the checkpoint in the result folder.
        device: "cpu".
        strict: Refuse a model that `cdem check` warns of, before anything is written.

    Raises:
        CaseError: The case or its files are wrong, or strict and there are warnings.

    Example:
        >>> import cdem
        >>> case = cdem.Case.from_dict({
        ...     "cdem": 1,
        ...     "model": {"blocks": [{"group": "cube", "box": {"size": [1, 1, 1]}}]},
        ...     "materials": {"rock": {"density": 2700, "young_modulus": "10 GPa",
        ...                            "poisson_ratio": 0.25}},
        ...     "groups": {"cube": {"material": "rock"}},
        ...     "interfaces": {"default": {"friction_angle": 30}},
        ...     "stages": [{"name": "fall", "mode": "dynamic", "duration": 0.1}],
        ... })
        >>> simulation = cdem.Simulation(case)
        >>> simulation.run()
        'finished'
        >>> round(float(simulation.fields["velocity"][:, 2].mean()), 3)
        -0.981
    """

    def __init__(
        self,
        case: Case | str | Path,
        *,
        threads: int | None = None,
        output: str | Path | None = None,
        overwrite: bool = False,
        resume: bool = False,
        device: str = "cpu",
        strict: bool = False,
    ) -> None:
        if device != "cpu":
            raise CdemError(f"device {device!r}: only cpu can run cases; leave --device out")
        case = case if isinstance(case, Case) else Case.load(case)
        threads = threads or os.cpu_count() or 1
        native.set_threads(threads)
        self.results: Results | None = None
        if output is not None:
            self.results = Results(
                Path(output), case.path_of("."), overwrite=overwrite, resume=resume
            )
        super().__init__(case, threads)
        if self.case.stages:  # so that it can be stepped before any stage begins
            self.core.set_damping(*stages.damping_of(self.case.stages[0]))
            self.core.set_lumped(stages.is_lumped(self.case.stages[0]))
        if resume:
            self._restore()
        else:
            self.core.prepare()
            self.overlap = self.core.adopt_overlaps()
        self.audit = Audit(self.build, self.overlap, self.threads)
        if strict:
            self.audit.refuse_warnings()
        if self.results and not resume:
            self.results.open(self)

    # ------------------------------------------------------------------ running

    def run(
        self,
        progress: Callable[[Progress], None] | None = None,
        should_stop: Callable[[], bool] | None = None,
    ) -> str:
        """Run all stages that are left.

        Args:
            progress: Called a few times per second.
            should_stop: Asked as often; True stops the run with a checkpoint.

        Returns:
            How the last stage ended: "converged" (it was static and reached its tolerance), "at
            rest" (it had `until: rest`), "finished", or "stopped".

        Raises:
            UnstableError: The computation failed; the last checkpoint is kept.
        """
        status = "finished"
        while self.stage_index < len(self.case.stages):
            status = self._run_stage(progress, should_stop)
            if status == "stopped":
                break
        if self.results:
            self.results.finish(self, status)
        return status

    def run_stage(self, name: str) -> str:
        """Run up to the end of the named stage; returns its status."""
        names = [stage.name for stage in self.case.stages]
        if name not in names[self.stage_index :]:
            raise CdemError(f"no stage {name!r} is left to run; the case has: {', '.join(names)}")
        status = "finished"
        while self.stage_index <= names.index(name):
            status = self._run_stage(None, None)
        return status

    def run_until(self, time: float) -> str:
        """Run stages up to the first step at or after a simulated time [s]; returns the status.

        The time counts from the start of the first stage. The rest can be run afterwards, and gives
        the same bits as an unbroken run.
        """
        status = "finished"
        while self.stage_index < len(self.case.stages) and self.time < time:
            status = self._run_stage(None, None, until=time)
        return status

    def advance(self, stage: StageState, steps: int, until: float = np.inf) -> str:
        """Run towards the next event of a stage, at most `steps` steps; returns the outcome."""
        self.check_case()
        return self._guard(partial(stages.advance, self, stage, steps, until))

    def step(self, count: int = 1) -> None:
        """Do a number of steps with the present settings, recording nothing and ending no stage."""
        self.check_case()
        self._guard(partial(self.core.run, count, check_interval=CHECK_INTERVAL))

    def _run_stage(
        self,
        progress: Callable[[Progress], None] | None,
        should_stop: Callable[[], bool] | None,
        until: float = np.inf,
    ) -> str:
        if self.stage is None:
            self.stage = stages.begin(self)
            self._record()
        stage = self.stage
        speed, began, note = 0.0, time.perf_counter(), ""
        while True:
            steps = max(CHECK_INTERVAL, int(speed * CHUNK_SECONDS))
            before, clock = self.step_count, time.perf_counter()
            outcome = self.advance(stage, steps, until)
            now = time.perf_counter()
            done = self.step_count - before
            speed = done / max(now - clock, 1e-9)
            self.wall_time += now - clock
            stage.wall_time += now - clock
            if stages.record_is_due(self, stage, outcome):
                self._log_departures()
                self._record(frame=stages.frame_is_due(self, stage, outcome))
            status = stages.status(self, stage, outcome)
            known, note = (
                note,
                stage.note(self.step_count - stage.start_step, self.core.unbalance_ratio()),
            )
            if progress:
                progress(self._progress(stage, speed, note))
            if note and not known and self.results:
                self.results.log(f"{stage.name}: {note}")
            if status is not None:
                self._end_stage(stage, status)
                return status
            if should_stop and should_stop():
                self.checkpoint()
                return "stopped"
            if self.time >= until:
                return "running"
            if self.results and now - began > self.case.output.checkpoint_every:
                began = now
                self.checkpoint()

    def _end_stage(self, stage: StageState, status: str) -> None:
        self.finished_stages.append(
            {
                "name": stage.name,
                "mode": stage.mode,
                "status": status,
                "steps": self.step_count - stage.start_step,
                "time": self.time - stage.start_time,
                "wall_time": stage.wall_time,
            }
        )
        self.stage_index += 1
        self.stage = None
        self.checkpoint()

    def _log_departures(self) -> None:
        for departure in self.look_for_departures():
            if self.results:
                self.results.log(f"warning: {departure.text()}")

    def _record(self, frame: bool = True) -> None:
        if self.core.scalars()["step"] > 0:
            self.core.keep_energy_scale()
        if self.results:
            self.results.record(self, frame)

    def _progress(self, stage: StageState, speed: float, note: str) -> Progress:
        end = stage.end_time
        fraction = left = None
        if end is not None:
            # a stage shorter than the resolution of the time is over when it begins
            length = end - stage.start_time
            fraction = (self.time - stage.start_time) / length if length > 0 else 1.0
            if fraction > 0:
                left = stage.wall_time * (1 - fraction) / fraction
        return Progress(
            stage=stage.name,
            time=self.time,
            end_time=end,
            step=self.step_count,
            dt=float(self.core.scalars()["dt"]),
            unbalance_ratio=self.core.unbalance_ratio(),
            energy_error=self.energies["error"],
            broken=sum(self.broken.values()),
            steps_per_second=speed,
            time_left=left,
            fraction=fraction,
            note=note,
        )

    def _guard(self, advance: Callable[[], tuple[str, int, float]]) -> str:
        """Turn a failed outcome of the core into an error that says what, where and when."""
        failure = ""
        try:
            outcome, culprit, value = advance()
        except RuntimeError as error:  # the core cannot go on: no room left for contacts
            outcome, culprit, value, failure = "full", -1, 0.0, str(error)
        if outcome in ("steps_done", "time_reached", "converged"):
            return outcome
        topology, names = self.build.topology, self.build.group_names
        when = f"step {self.step_count}, t = {self.time:.6g} s: "
        kept = ""
        if self.results:
            self.results.fail(self)
            kept = " The last good checkpoint is kept; look at it with cdem info and cdem render."
        if failure:
            raise UnstableError(f"{when}{failure}. A smaller time.safety may help too.{kept}")
        dt = float(self.core.scalars()["dt"])
        smaller = "time.safety" if self.case.time.step == "auto" else "time.step"
        if outcome == "lost_contact":
            face = int(self.core.fields()["search.exposed_face"][culprit])
            block = int(topology.face_block[face])
            group = names[topology.block_group[block]]
            raise UnstableError(
                f"{when}a loaded contact of block {block} (group {group}) penetrated too deep to be "
                f"followed. Raise stiffness_n of its interface, or lower the impact speed.{kept}"
            )
        if outcome == "missed_contact":
            raise UnstableError(
                f"{when}the all-pairs search of contact.check found {int(value)} contact(s) that the "
                f"lists had missed. Please report this case.{kept}"
            )
        block = int(topology.node_block[culprit])
        group = names[topology.block_group[block]]
        where = f"node {culprit} of block {block} (group {group})"
        if outcome == "not_finite":
            raise UnstableError(
                f"{when}{where} has no finite position or velocity any more; dt = {dt:.3g} s. "
                f"Use a smaller {smaller}, or look for a bad element there.{kept}"
            )
        if block in self.fallen and any(d.group == group for d in self.departures):
            raise UnstableError(
                f"{when}{where} fell past the edge of the model and now falls at {value:.3g} m/s, "
                "faster than the P wave of the rock. Make the ground larger, or end the stage before "
                f"that (until: rest).{kept}"
            )
        raise UnstableError(
            f"{when}{where} moves at {value:.3g} m/s, faster than the P wave of the rock; "
            f"dt = {dt:.3g} s. Use a smaller {smaller} or a lower stiffness_n.{kept}"
        )

    # ------------------------------------------------------------------ keeping

    def checkpoint(self) -> None:
        """Write everything that is needed to go on bit for bit, if there is a result folder."""
        if self.results:
            self.results.checkpoint(self)

    def _restore(self) -> None:
        assert self.results is not None
        arrays, attributes = self.results.read_checkpoint(self)
        self.reference = arrays.pop("simulation.reference")
        kept = set(arrays) | set(attributes["core"])
        if other := sorted(kept ^ (set(self.core.fields()) | set(self.core.scalars()))):
            raise CdemError(
                f"{self.results.folder}: its checkpoint was written by another version of cdem "
                f"({attributes['version']}; this is {__version__}) and holds other fields "
                f"({', '.join(other[:3])}, ...). Go on with the cdem that wrote it, or run the case "
                f"again in another folder (-o)"
            )
        self.core.restore(arrays, attributes["core"])
        self.overlap = tuple(attributes["overlap"])
        self.stage_index = int(attributes["stage_index"])
        self.finished_stages = list(attributes["finished_stages"])
        self.wall_time = float(attributes["wall_time"])
        for done in range(self.stage_index + (attributes["stage"] is not None)):
            stages.apply_settings(self, done)
        if attributes["stage"] is not None:
            self.stage = StageState.from_dict(attributes["stage"])
        self.departures = [Departure(**kept) for kept in attributes["departures"]]
        self.core.prepare()
        self.results.reopen(self, attributes)
