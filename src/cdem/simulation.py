"""A simulation: a case turned into a model, run stage by stage, recorded, stopped and resumed."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem import __version__, stages
from cdem._native import core as native
from cdem._native import name as native_name
from cdem.audit import Audit
from cdem.build import Build, build
from cdem.errors import CaseError, CdemError, UnstableError
from cdem.results import Results

if TYPE_CHECKING:
    from cdem.case import Case

CHUNK_SECONDS = 0.25
"""The loop comes back about this often to look for signals and report progress [s of wall time]."""
CHECK_INTERVAL = 20
"""Steps between checks of the run's health and, in static stages, of the unbalance ratio."""


@dataclass
class Progress:
    """Where a run is.

    Attributes:
        stage: Name of the running stage.
        time: Simulated time [s].
        end_time: Time at which the stage ends [s], or None for a static stage.
        step: Steps done.
        dt: Time step [s].
        unbalance_ratio: Out-of-balance over applied forces.
        energy_error: Closing error of the energy ledger.
        broken: Broken semi-springs.
        steps_per_second: Speed over the last report.
        time_left: Estimate of the stage's remaining wall time [s], or None.
        fraction: Part of the stage that is done, or None.
        note: What a user should know now, or nothing.
    """

    stage: str
    time: float
    end_time: float | None
    step: int
    dt: float
    unbalance_ratio: float
    energy_error: float
    broken: int
    steps_per_second: float
    time_left: float | None
    fraction: float | None
    note: str


class Simulation:
    """One run of a case.

    Args:
        case: A `Case`, or the path of a case file.
        threads: Threads of the core; None for all cores.
        output: Result folder, or None to record nothing.
        overwrite: Replace what an existing result folder holds.
        resume: Go on from the checkpoint in the result folder.
        device: "cpu".

    Raises:
        CaseError: The case or its files are wrong.

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
    ) -> None:
        from cdem.case import Case

        if device != "cpu":
            raise CdemError(f"device {device!r}: only cpu can run cases; leave --device out")
        self.case = case if isinstance(case, Case) else Case.load(case)
        self.threads = threads or os.cpu_count() or 1
        native.set_threads(self.threads)
        self.results: Results | None = None
        if output is not None:
            self.results = Results(Path(output), overwrite=overwrite, resume=resume)
        self.build: Build = build(self.case)
        self.core = self.build.core
        self.stage_index = 0
        self.stage: stages.StageState | None = None
        self.finished_stages: list[dict[str, Any]] = []
        self.reference = self.build.start_position
        self.wall_time = 0.0
        if self.case.stages:  # so that it can be stepped before any stage begins
            self.core.set_damping(*stages.damping_of(self.case.stages[0]))
            self.core.set_lumped(stages.is_lumped(self.case.stages[0]))
        if resume:
            self._restore()
        else:
            self.core.prepare()
            self.overlap = self.core.adopt_overlaps()
        self.audit = Audit(self)
        if self.results and not resume:
            self.results.open(self)

    # ------------------------------------------------------------------ looking

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.core.scalars()["time"])

    @property
    def step_count(self) -> int:
        """Steps done."""
        return int(self.core.scalars()["step"])

    @property
    def fields(self) -> dict[str, NDArray[np.float64]]:
        """Fields on nodes: views or fresh arrays.

        "position", "velocity" [m, m/s] are views, shape (nodes, 3); "displacement" [m] is counted
        from the last reset; "force" [N] is the last unbalanced force, "reaction" [N] that of
        supports; "mass" [kg].
        """
        state = self.core.fields()
        motion = state["node.motion"].reshape(-1, 8)
        return {
            "position": motion[:, :3],
            "velocity": motion[:, 4:7],
            "displacement": motion[:, :3] - self.reference,
            "force": self.core.node_force().reshape(-1, 4)[:, :3],
            "reaction": state["node.reaction"].reshape(-1, 4)[:, :3],
            "mass": self.build.arrays["node.mass"],
        }

    @property
    def contacts(self) -> dict[str, NDArray]:
        """Contacts that act now, one row each.

        Semi-springs, then semi-edges: "kind" (0 spring, 1 edge), "mother_face", "target_face" (face
        ids), "force_n" [N, compression positive], "force" [N, on the mother, shape (contacts, 3)].
        """
        s = self.core.fields()
        exposed = s["search.exposed_face"]
        target = s["spring.target"]
        slots = np.flatnonzero(target >= 0)
        edges = s["edge.contact"].reshape(-1, 4)
        return {
            "kind": np.repeat([0, 1], [len(slots), len(edges)]),
            "mother_face": exposed[np.concatenate([slots, edges[:, 0]]) // 4],
            "target_face": exposed[np.concatenate([target[slots], edges[:, 1]])],
            "force_n": np.concatenate(
                [
                    s["spring.state"].reshape(-1, 8)[slots, 0],
                    s["edge.state"].reshape(-1, 8)[:, 0],
                ]
            ),
            "force": np.concatenate(
                [
                    s["spring.reaction"].reshape(-1, 8)[slots, :3],
                    s["edge.reaction"].reshape(-1, 8)[:, :3],
                ]
            ),
        }

    @property
    def energies(self) -> dict[str, float]:
        """Energy ledger at the last sampled step [J], and its closing "error" (a fraction)."""
        return self.core.energies()

    @property
    def broken(self) -> dict[str, int]:
        """Bond points broken so far, by cause: "tension" and "shear"."""
        s = self.core.fields()
        sums = {}
        for cause in ("tension", "shear"):
            total = 0.0
            for kind in ("triangles", "quads", "overlaps"):
                count = self.build.assembly.counts[f"{kind}.count"]
                total += float(s[f"{kind}.broken_{cause}"][:count].sum())
            sums[cause] = int(total)
        return sums

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
            "converged" (the last stage was static and reached its tolerance), "finished" or
            "stopped".

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

    def advance(self, stage: stages.StageState, steps: int, until: float = np.inf) -> str:
        """Run towards the next event of a stage, at most `steps` steps; returns the outcome."""
        return self._guard(partial(stages.advance, self, stage, steps, until))

    def step(self, count: int = 1) -> None:
        """Do a number of steps with the present settings, recording nothing and ending no stage."""
        self._guard(partial(self.core.run, count, check_interval=CHECK_INTERVAL))

    def _run_stage(self, progress, should_stop, until: float = np.inf) -> str:
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

    def _end_stage(self, stage: stages.StageState, status: str) -> None:
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

    def _record(self, frame: bool = True) -> None:
        if self.core.scalars()["step"] > 0:
            self.core.keep_energy_scale()
        if self.results:
            self.results.record(self, frame)

    def _progress(self, stage: stages.StageState, speed: float, note: str) -> Progress:
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
                f"{when}a loaded contact of block {block} (group {group}) sank too deep to be "
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
                f"anew in another folder (-o)"
            )
        self.core.restore(arrays, attributes["core"])
        self.overlap = tuple(attributes["overlap"])
        self.stage_index = int(attributes["stage_index"])
        self.finished_stages = list(attributes["finished_stages"])
        self.wall_time = float(attributes["wall_time"])
        for done in range(self.stage_index + (attributes["stage"] is not None)):
            stages.apply_settings(self, done)
        if attributes["stage"] is not None:
            self.stage = stages.StageState(**attributes["stage"])
        self.core.prepare()
        self.results.reopen(self, attributes)

    def attributes(self) -> dict[str, Any]:
        """What a checkpoint keeps besides arrays."""
        return {
            "version": __version__,
            "nodes": self.build.fingerprint,
            "core": self.core.scalars(),
            "overlap": list(self.overlap),
            "stage_index": self.stage_index,
            "stage": None if self.stage is None else vars(self.stage),
            "finished_stages": self.finished_stages,
            "wall_time": self.wall_time,
        }

    def summary(self, status: str) -> dict[str, Any]:
        """What summary.json says."""
        fields = self.fields
        counts = self.audit.counts
        energies = dict(self.energies) if self.step_count else {}
        groups = {}
        for name in self.build.group_names:
            nodes = self.build.nodes_of(name)
            mass = fields["mass"][nodes]
            mean = {
                key: (mass @ fields[key][nodes] / mass.sum()).tolist()
                for key in ("position", "displacement", "velocity")
            }
            distance = np.linalg.norm(fields["displacement"][nodes], axis=1)
            groups[name] = {
                "mass": float(mass.sum()),
                "centroid": mean["position"],
                "displacement": mean["displacement"],
                "velocity": mean["velocity"],
                "max_displacement": float(distance.max()),
            }
        return {
            "status": status,
            "title": self.case.title,
            "version": __version__,
            "device": f"cpu ({native_name})",
            "threads": self.threads,
            "counts": counts,
            "steps": self.step_count,
            "time": self.time,
            "wall_time": self.wall_time,
            "time_step": float(self.core.scalars()["dt"]),
            "unbalance_ratio": self.core.unbalance_ratio() if self.step_count else None,
            "refreshes": int(self.core.scalars()["rebuilds"]),
            "energies": energies,
            "broken": self.broken,
            "stages": self.finished_stages,
            "groups": groups,
        }


__all__ = ["CaseError", "Progress", "Simulation"]
