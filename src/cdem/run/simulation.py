"""A simulation: a case turned into a model, run stage by stage, recorded, stopped and resumed."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.case.case import Case
from cdem.case.stored import renewed
from cdem.errors import CdemError, DiskError, UnstableError
from cdem.model.audit import Audit
from cdem.model.backfill import nodes_of_groups
from cdem.model.overlaps import adopt_overlaps
from cdem.run import failures, restored, shown, stages
from cdem.run.actions import Act, Action
from cdem.run.behaviour import NoRest, look
from cdem.run.changes import compare
from cdem.run.checkpoint import has_checkpoint
from cdem.run.fast_weakening import FastWeakening, fast_weakenings
from cdem.run.flow_recorder import PREFIX, FlowRecorder
from cdem.run.law_fields import large_strains, yielded_counts
from cdem.run.notebook import watched
from cdem.run.progress import Progress
from cdem.run.record_files import check_records, with_kept_records
from cdem.run.stage_state import StageState
from cdem.run.state import Attributes, RunState, Setting

if TYPE_CHECKING:
    from cdem._core import Core
    from cdem.mesh.mesh import Mesh
    from cdem.ranks.exchange import Exchange
    from cdem.run.result_folder import Results
    from cdem.run.shared_results import SharedResults

CHUNK_SECONDS = 0.25
"""The loop returns about this often to check for signals and report progress [s of wall time]."""
CHECK_INTERVAL = 20
"""Steps between checks of the run's health and, in static stages, of the unbalance ratio."""


class Simulation(RunState):
    """One run of a case.

    Args:
        case: A `Case`, or the path of a case file.
        threads: Threads of the core; None for all cores.
        output: Result folder, or None to record nothing.
        overwrite: Replace the contents of an existing result folder.
        resume: Continue from the checkpoint in the result folder.
        force: Continue although the case has changed in a way that is normally refused.
        strict: Treat warnings of `cdem check` as errors, before anything is written.
        exchange: How this rank talks with the others that share the model; None for one alone.
            All ranks make the same simulation and call the same functions.
        more: Bodies that the caller has made, beside those of the case; a result folder does not
            keep them, so there is no output with them, and no joints.

    Raises:
        CaseError: The case or its files are wrong, or differ from the run to resume, or
            strict and there are warnings.
        CdemError: The result folder is in use or unusable.

    Example:
        >>> import cdem
        >>> case = cdem.Case.from_dict({
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
        case: Case | dict[str, Any] | str | Path,
        *,
        threads: int | None = None,
        output: str | Path | None = None,
        overwrite: bool = False,
        resume: bool = False,
        force: bool = False,
        strict: bool = False,
        exchange: Exchange | None = None,
        more: Mesh | None = None,
    ) -> None:
        if more is not None and output is not None:
            raise ValueError("a result folder does not keep more bodies; give no output with them")
        if isinstance(case, dict):
            case = Case.from_dict(case)
        case = case if isinstance(case, Case) else Case.load(case)
        threads = threads or os.cpu_count() or 1
        native.set_threads(threads)
        threads = native.max_threads()  # one, if the core has no OpenMP
        self.results: Results | SharedResults | None = None
        self._exchange = exchange if exchange is not None and exchange.count > 1 else None
        self._fast_weakening: dict[str, FastWeakening] = {}
        self._no_rest: NoRest | None = None
        self._actions: list[Action] = []
        if output is not None:
            self.results = self._open(Path(output), case, overwrite=overwrite, resume=resume)
        try:
            digests: dict[str, str] = {}
            if self.results and resume:
                case, digests = with_kept_records(self.results.folder, case)
            super().__init__(case, threads, more)
            self.record_digests = digests
            self.flow = FlowRecorder(self) if self.case.output.maps else None
            self._begin(resume=resume, force=force, strict=strict)
        except BaseException:
            if self.results:
                self.results.release()
            raise

    def _begin(self, *, resume: bool, force: bool, strict: bool) -> None:
        """Bring the core to the initial or restored state of the run."""
        if self.case.stages:  # allows steps before any stage begins
            self.core.set_damping(*stages.damping_of(self.case.stages[0]))
            self.core.change_rock_damping(*stages.rock_damping_of(self.case.stages[0]))
            self.core.set_lumped(stages.is_lumped(self.case.stages[0]))
        if resume:
            self._restore(force=force)
        else:
            self.core.prepare()
            self._hold_back()
            self.overlap = adopt_overlaps(self.build)
        if self._exchange:
            from cdem.ranks.shared_core import SharedCore

            self.core = self.build.core = cast("Core", SharedCore(self.core, self._exchange))
        self.audit = Audit(self.build, self.overlap, self.threads)
        if strict:
            self.audit.refuse_warnings()
        if self.results:  # now: the files may change or go while the run goes on
            self.inputs = self.given_case.digests()
        if self.results and not resume:
            self.results.open(self)

    def _open(
        self, folder: Path, case: Case, *, overwrite: bool, resume: bool
    ) -> Results | SharedResults:
        """The result folder; needs HDF5 and locks, `cdem check` needs neither."""
        from cdem.run.result_folder import Results
        from cdem.run.shared_results import SharedResults

        make = partial(Results, folder, case.path_of("."), overwrite=overwrite, resume=resume)
        return SharedResults(self._exchange, folder, make) if self._exchange else make()

    def _hold_back(self) -> None:
        """Take groups that a later stage adds out of the core."""
        if names := self.case.absent(0):
            comes = nodes_of_groups(self.build.topology, names)
            self.core.take_out(comes.astype(np.int8))
            self.core.find_applied()

    # ------------------------------------------------------------------ running

    def run(
        self,
        progress: Callable[[Progress], None] | None = None,
        should_stop: Callable[[], bool] | None = None,
    ) -> str:
        """Run all remaining stages.

        Args:
            progress: Called a few times per second; by default a notebook shows a line.
            should_stop: Called as often; True stops the run with a checkpoint.

        Returns:
            How the last stage ended: "converged" (it was static and reached its tolerance),
            "moving", "creeping", "chattering" or "undecided" (it was static and found no rest),
            "at rest" (it had `until: rest`), "ended" (by an action), "finished", or "stopped".

        Raises:
            UnstableError: The computation failed; the last checkpoint is kept.
        """
        if self.results:
            self.results.hold()
        try:
            with watched(progress) as show:
                return self._run(show, should_stop)
        except DiskError as error:
            raise self._with_advice(error) from error
        finally:
            if self.results:
                self.results.release()

    def _run(
        self,
        progress: Callable[[Progress], None] | None,
        should_stop: Callable[[], bool] | None,
    ) -> str:
        status = self.finished_stages[-1]["status"] if self.finished_stages else "finished"
        if self.is_over and self.results and (said := self.results.ended(self)):
            return said  # a resumed run that was complete
        while not self.is_over:
            status = self._run_stage(progress, should_stop)
            if status == "stopped":
                break
        if self.results:
            self.results.finish(self, status)
        return status

    def _with_advice(self, error: DiskError) -> DiskError:
        """Extend the error of a full disk by the state of the results and advice."""
        kept = "run the case again"
        if self.results and has_checkpoint(self.results.folder):
            kept = "the last checkpoint is intact: continue from it with --resume"
        return DiskError(f"{error}. Free disk space, for example; {kept}")

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

        The time counts from the start of the first stage. The rest can be run afterwards, with
        the same bits as an unbroken run.
        """
        status = "finished"
        while self.stage_index < len(self.case.stages) and self.time < time:
            status = self._run_stage(None, None, until=time)
        return status

    def set(self, path: str, value: Any) -> None:
        """Change a value now, in the middle of the run, like the `set` of a stage at its beginning.

        It holds until a later stage sets it. A result folder records it: `run.log`, `summary.json`,
        and the checkpoint; a resumed run keeps it.

        Args:
            path: As in a stage's `set`: ``"interfaces.bed.friction_angle"``, ``"loads.gravity"``.
            value: In SI, or with a unit: ``"10 kPa"``.

        Raises:
            CaseError: The value does not exist, is not allowed, or is fixed at the start.
        """
        self.check_case()
        self.case.try_setting(path, value)
        setting = Setting(self.begun, self.time, path, value)
        stages.change_value(self, setting)
        if self.step_count:
            self.core.renew_step()
        if self.stage is not None:
            self.stage.watch_anew()
        self.settings.append(setting)
        if self.results:
            self.results.log(f"t = {self.time:.6g} s: {path} set to {value}")

    def every(self, interval: float, action: Act) -> None:
        """Call a function with this simulation at each multiple of an interval during the run.

        The call comes at the first step at or after that time; steps and results do not depend
        on it. Use it to look, to write files of one's own, to `set` values, or to end a stage.

        Args:
            interval: Of simulated time [s].
            action: Takes the simulation. Where it returns True, the stage ends as "ended".

        Raises:
            CdemError: The interval is not above 0.

        Example:
            >>> def slow(simulation):
            ...     return abs(simulation.fields["velocity"]).max() < 1e-3
            >>> simulation.every(0.1, slow)
        """
        action_of = Action(float(interval), action)
        action_of.skip_to(self.time)
        self._actions.append(action_of)

    def advance(self, stage: StageState, steps: int, until: float = np.inf) -> str:
        """Run towards the next event of a stage, at most `steps` steps; returns the outcome."""
        self.check_case()
        if self.flow:
            until = min(until, self.flow.due)
        return self._guard(partial(stages.advance, self, stage, steps, until))

    def tell(self, text: str) -> None:
        """Write a line into run.log, if there is a result folder."""
        if self.results:
            self.results.log(text)

    def summary(self, status: str) -> dict[str, Any]:
        """The content of summary.json."""
        of_laws = {
            "yielded": yielded_counts(self),
            "fast_weakening": [worst.text() for worst in self._fast_weakening.values()],
            "large_strains": [strain.text() for strain in large_strains(self)],
        }
        return super().summary(status) | of_laws

    def _repr_html_(self) -> str:
        """Display in a notebook: the state of the simulation."""
        return shown.table(self, self.results.folder if self.results else None)

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
        stage = self.stage or self._begin_stage()
        speed, began, note = 0.0, time.perf_counter(), ""
        while True:
            steps = self._agreed(max(CHECK_INTERVAL, int(speed * CHUNK_SECONDS)))
            before, clock = self.step_count, time.perf_counter()
            outcome = self.advance(stage, steps, min([until, *(a.due for a in self._actions)]))
            now = time.perf_counter()
            done = self.step_count - before
            speed = done / max(now - clock, 1e-9)
            self.wall_time += now - clock
            stage.wall_time += now - clock
            status = self._look(stage, outcome)
            known, note = (
                note,
                stage.note(self.step_count - stage.start_step, self.core.unbalance_ratio()),
            )
            self._show(progress, stage, speed, note)
            if note and not known and self.results:
                self.results.log(f"{stage.name}: {note}")
            if status is not None:
                self._end_stage(stage, status)
                return status
            if self._agreed(bool(should_stop and should_stop())):
                self.checkpoint()
                if self.results:
                    self.results.show_stop(self)
                return "stopped"
            if self.time >= until:
                return "running"
            if self.results and self._agreed(now - began > self.case.output.checkpoint_every):
                began = now
                self.checkpoint()

    def _show(
        self,
        progress: Callable[[Progress], None] | None,
        stage: StageState,
        speed: float,
        note: str,
    ) -> None:
        """Call the progress function; ranks look together at what the first one shows."""
        if self._agreed(progress is not None):
            now = shown.progress(self, stage, speed, note)
            if progress:
                progress(now)

    def _agreed(self, number: int) -> int:
        """The number that the first rank has: time and signals are not the same on all."""
        if self._exchange is None:
            return number
        return int(self._exchange.share(np.array([number]))[0])

    def _look(self, stage: StageState, outcome: str) -> str | None:
        """Do all tasks that are due: follow, act, record, check; returns the stage's end, or None."""
        self._look_at_flow()
        ended = any([action.call(self) for action in self._actions])
        if self._actions:  # they may look at a clock
            ended = bool(self._agreed(ended))
        if stages.record_is_due(self, stage, outcome) or ended:
            self._log_departures()
            stages.look_for_rest(self, stage)
            self._no_rest = look(self, stage, outcome)
            last = ended or self._no_rest is not None
            self._record(frame=last or stages.frame_is_due(self, stage, outcome))
            if self._check(stage):
                outcome = "steps_done"  # rest is sought anew
            self._look_at_weakening()
            if self._no_rest is not None:
                return self._no_rest.status
        return stages.status(self, stage, outcome) or ("ended" if ended else None)

    def _begin_stage(self) -> StageState:
        self.stage, self.ended_stage = stages.begin(self), None
        if self.flow:
            self.flow.begin(self, self.stage)
        self._record()
        return self.stage

    def _look_at_flow(self) -> None:
        """Record the largest values at each place, if this is requested and due."""
        if self.flow and self.time >= self.flow.due:
            self.flow.look(self)
            if self.flow.ended and self.results:
                self.results.log(f"warning: {self.flow.ended}")

    def _end_stage(self, stage: StageState, status: str) -> None:
        row = {
            "name": stage.name,
            "mode": stage.mode,
            "status": status,
            "begin": stage.start_time,
            "steps": self.step_count - stage.start_step,
            "time": self.time - stage.start_time,
            "wall_time": stage.wall_time,
        }
        if stage.handed_over:
            row["handed_over"] = True
        if self._no_rest is not None:
            row |= self._no_rest.as_dict()
            self._no_rest = None
        self.finished_stages.append(row)
        if self.results:
            for strain in large_strains(self):
                self.results.log(f"warning: {strain.text()}")
        if self.flow and stage.mode == "dynamic":
            self.flow.look(self)
        self.stage_index += 1
        self.stage, self.ended_stage = None, stage
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

    def _check(self, stage: StageState) -> bool:
        """End a run whose results are no longer trustworthy; or hand the stage over, and say so."""
        stages.refuse_curves_over(self)
        if self.watch_energy(stage):
            return True
        if why := failures.of_strain(self):
            raise self._failed(why)
        return False

    def watch_energy(self, stage: StageState) -> str:
        """Hand a stage over to local damping where its energy balance does not close.

        Returns:
            What was said of it in the log, or nothing.

        Raises:
            UnstableError: The balance does not close, and the stage cannot be handed over.
        """
        if self.core.scalars()["step"] > 0:
            self.core.keep_energy_scale()
        if not (why := failures.of_energy(self)):
            return ""
        if not stages.may_hand_over(self, stage):
            raise self._failed(why)
        said = stages.balance_lost(self, stage)
        self.tell(f"{stage.name}: {said}")
        self._guard(partial(stages.relax_locally, self, stage))
        return said

    def _look_at_weakening(self) -> None:
        """Warn once of an interface whose friction falls too fast for the step."""
        for worst in fast_weakenings(self):
            known = self._fast_weakening.get(worst.interface)
            if known is None and self.results:
                self.results.log(f"warning: {worst.text()}")
            if known is None or worst.ratio > known.ratio:
                self._fast_weakening[worst.interface] = worst

    def _failed(self, why: str) -> UnstableError:
        """The error with place and cause of the failure; the result folder records it too."""
        kept = ""
        if self.results:
            self.results.fail(self)
            if has_checkpoint(self.results.folder):
                kept = (
                    " The last good checkpoint is kept; look at it with cdem info and cdem render."
                )
        return UnstableError(f"step {self.step_count}, t = {self.time:.6g} s: {why}{kept}")

    def _guard(self, advance: Callable[[], tuple[str, int, float]]) -> str:
        """Turn a failed outcome of the core into an error with cause, place and time."""
        try:
            outcome, culprit, value = advance()
        except RuntimeError as error:  # the core has no room left for contacts
            if self._exchange:  # maybe on this rank alone: the others do not help to tell more
                raise
            raise self._failed(f"{error}. A smaller time.safety may help too.") from None
        if outcome in ("steps_done", "time_reached", "converged"):
            return outcome
        raise self._failed(failures.of_outcome(self, outcome, culprit, value))

    # ------------------------------------------------------------------ keeping

    def close(self) -> None:
        """Let another run write into the result folder; `run` does so when it ends."""
        if self.results:
            self.results.release()

    def checkpoint(self) -> None:
        """Write all data to continue bit for bit, if there is a result folder."""
        if self.results:
            self.results.checkpoint(self)
            if self.flow:
                from cdem.ranks.first import on_first

                write = partial(self.flow.write, self.results.folder, self.time)
                on_first(self._exchange, write) if self._exchange else write()

    @property
    def kept(self) -> dict[str, NDArray[np.float64]]:
        """Arrays in a checkpoint besides those of the core."""
        return super().kept | (self.flow.arrays if self.flow else {})

    def _restore(self, *, force: bool) -> None:
        assert self.results is not None
        path, arrays, attributes = self.results.read_checkpoint()
        restored.check_model(self, path, arrays, attributes, force=force)
        fault = restored.wrong_stage(attributes) or restored.wrong_looks(attributes)
        if fault := fault or restored.wrong_numbers(self, attributes):
            raise CdemError(f"{path}: is damaged ({fault}); run the case again with --overwrite")
        begun = attributes.stage_index + (attributes.stage is not None)
        try:
            changes = compare(
                renewed(attributes.case), self.given_case.model_dump(mode="json"), begun
            )
        except (TypeError, ValueError, KeyError, AttributeError) as error:
            raise CdemError(
                f"{path}: is damaged (its case is invalid); run the case again with --overwrite"
            ) from error
        self.results.notes += changes.check(self.case, force=force)
        check_records(self.results.folder, attributes.records, self.record_digests)
        self._restore_core(path, arrays, attributes)
        self.overlap = attributes.overlap
        self.stage_index, self.stage = attributes.stage_index, attributes.stage
        self.ended_stage, self.finished_stages = attributes.ended_stage, attributes.finished_stages
        self.wall_time, self.departures = attributes.wall_time, attributes.departures
        stages.change_end(self, longer=changes.longer)
        self.settings = attributes.settings
        self.rows_before = attributes.rows_before
        self.begins = restored.begins(attributes)
        stages.catch_up(self)
        self.core.prepare()
        if not self.is_over or self.results.ended(self) is None:
            self.results.reopen(self, attributes)

    def _restore_core(self, path: Path, arrays: dict[str, NDArray], attributes: Attributes) -> None:
        """Give the arrays of a checkpoint to the core, if they are valid."""
        followed = {n: arrays.pop(n) for n in list(arrays) if n.startswith(PREFIX)}
        own = {name: arrays.pop(name) for name in super().kept if name in arrays}
        own.setdefault("simulation.watched", self.watched)  # older checkpoints lack it, and looks
        fault = restored.wrong_kept(own, super().kept)
        fault = fault or restored.wrong_type(self.core, arrays)
        fault = fault or restored.wrong_state(arrays)
        fault = fault or (self.flow.restore(followed) if self.flow else "")
        if not fault:
            self.core.restore(arrays, attributes.core)
            fault = restored.wrong_array(self.core)
        if fault:
            raise CdemError(f"{path}: is damaged ({fault}); run the case again with --overwrite")
        self.reference = own["simulation.reference"]
        self.watched = own["simulation.watched"]
        self.build.born = own.get("simulation.born", self.build.born)
        kept = self.build.boundaries.kept
        self.build.boundaries.kept = own.get("simulation.kept_reaction", kept)
