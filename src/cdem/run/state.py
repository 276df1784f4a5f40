"""State of a run: the model, its motion, and what a checkpoint keeps."""

from __future__ import annotations

import platform
from dataclasses import asdict, dataclass, fields
from datetime import datetime
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, NonNegativeInt, field_validator

from cdem._native import device, digests
from cdem._native import name as native_name
from cdem._version import __version__
from cdem.case.case import Case
from cdem.case.untouched import Untouched
from cdem.errors import CaseError
from cdem.mesh.mesh import Mesh
from cdem.model.audit import Audit
from cdem.model.build import Build, build
from cdem.model.domain import leaving, outside
from cdem.named import Named
from cdem.rows import rows_of
from cdem.run.changes import differences
from cdem.run.groups import Group, groups_of
from cdem.run.rest import Departure, Motion, Quiet, fallen, middles, rigid_motion
from cdem.run.stage_state import StageState


@dataclass
class Setting:
    """A value set by a script in the middle of a run.

    Attributes:
        begun: Number of stages begun at that time.
        time: [s].
        path: Path in the case.
        value: The given value.
    """

    begun: int
    time: float
    path: str
    value: Any


@dataclass
class RowBefore:
    """Motion of the nodes of a history at its last row.

    Attributes:
        time: [s].
        velocity: [m/s].
        acceleration: [m/s2].
    """

    time: float
    velocity: list[float]
    acceleration: list[float]


class Attributes(BaseModel):
    """Data in a checkpoint besides arrays.

    Attributes:
        version: Version of cdem.
        own_laws: SHA-256 of the headers of own laws, by name.
        case: The given case.
        nodes: Fingerprint of the model.
        core: Scalars of the core.
        overlap, stage_index, stage, ended_stage, finished_stages, wall_time,
        departures, settings: As in `RunState`.
        records: SHA-256 of the files of processed records, by name.
        rows_before: Motion at the last row of histories with accelerations, by name.
        rows: Rows of the histories.
        row_sums: Their checksums, as in `HistoryFile`.
        frames: Frames recorded.
    """

    model_config = ConfigDict(strict=True, ser_json_inf_nan="constants")

    version: str
    own_laws: dict[str, str]
    case: dict[str, Any]
    nodes: str
    core: dict[str, bool | int | float]
    overlap: tuple[float, int, int]
    stage_index: NonNegativeInt
    stage: StageState | None
    ended_stage: StageState | None
    finished_stages: list[dict[str, Any]]
    wall_time: float
    departures: list[Departure]
    settings: list[Setting] = Field(default_factory=list)
    records: dict[str, str] = Field(default_factory=dict)  # older checkpoints lack it
    rows_before: dict[str, RowBefore] = Field(default_factory=dict)  # and this
    rows: NonNegativeInt
    row_sums: str
    frames: NonNegativeInt

    @field_validator("stage", "ended_stage", mode="before")
    @classmethod
    def _is_whole(cls, stage: Any) -> Any:
        """Refuse a stage with a missing value: it would continue with a default."""
        if isinstance(stage, dict):
            quiet = stage.get("quiet")
            for kept, kind in ((stage, StageState), (quiet, Quiet)):
                names = {one.name for one in fields(kind)}
                late = {
                    "frame_every",
                    "solved",
                    "handed_over",
                    "first_look",
                    "ways",
                    "ratios",
                    "wait",
                }  # older checkpoints lack them
                if not isinstance(kept, dict) or kept.keys() | late != names | late:
                    raise ValueError(f"not the values of a {kind.__name__}")
        return stage


class RunState:
    """A model and the progress of its run, for inspection and records.

    Attributes:
        case: The case, with the settings of its stages so far. The model is made from it: a later
            change would have no effect, so it stops the run.
        given_case: The original case.
        threads: Threads of the core.
        build: The model.
        core: The compiled core, holding model and state.
        audit: The report on the model.
        overlap: Overlap of the blocks at the start: depth [m], number of vertices, a face.
        stage_index: The running stage or the next one.
        stage: The running stage, or None between stages.
        ended_stage: The last stage that ended, until another begins.
        finished_stages: A row of the summary for each stage that has ended.
        reference: Positions from which displacements count [m], shape (nodes, 3).
        departures: The first block of each group that fell past the edge of the model, and the
            first that left its domain.
        wall_time: Wall time spent in stages [s].
        settings: Values set by a script during the run.
        begins: Start times of the stages begun, by name [s].
        record_digests: SHA-256 of the files of processed records in the result folder, by name.
        rows_before: Motion at the last row of histories with accelerations, by name.
        watched: Positions at the first look at the running static stage [m], shape (nodes, 3).
    """

    audit: Audit

    def __init__(self, case: Case, threads: int, more: Mesh | None = None) -> None:
        self.case = case.model_copy(deep=True)  # stages change the copy, not the caller's case
        self.given_case = case.model_copy(deep=True)
        self.keep_case()
        self.threads = threads
        self.build: Build = build(self.case, more)
        self.core = self.build.core
        self.overlap = (0.0, 0, -1)
        self.stage_index = 0
        self.stage: StageState | None = None
        self.ended_stage: StageState | None = None
        self.finished_stages: list[dict[str, Any]] = []
        self.reference = self.build.start_position
        self.departures: list[Departure] = []
        self.wall_time = 0.0
        self.settings: list[Setting] = []
        self.begins: dict[str, float] = {}
        self.watched = self.build.start_position
        self.record_digests: dict[str, str] = {}
        self.rows_before: dict[str, RowBefore] = {}
        self.inputs: dict[str, str] = {}  # digests of the case and its files, where they are kept

    def __repr__(self) -> str:
        counts = self.audit.counts
        stage = f"stage {self.stage.name}, " if self.stage else ""
        return (
            f"<{type(self).__name__} {self.case.title!r}: blocks {counts['blocks']:,}, elements "
            f"{counts['elements']:,}; {stage}step {self.step_count:,}, t {self.time:.4g} s>"
        )

    def tell(self, text: str) -> None:
        """Take a line for the log of a run; here there is none."""

    def keep_case(self) -> None:
        """Store the case as the core has it now."""
        self._case = self.case.model_copy(deep=True)
        self._untouched = Untouched(self.case)

    def check_case(self) -> None:
        """Refuse to continue with a case that was changed after the core was made.

        Raises:
            CaseError: It was changed; names the place.
        """
        if self._untouched.holds():
            return
        if self.case != self._case:
            now, was = (case.model_dump(mode="json") for case in (self.case, self._case))
            raise CaseError(
                f"simulation.case.{next(differences(was, now))[0]}: was changed after the model was "
                "made, which has no effect. Use simulation.set(path, value), or give a stage "
                "a 'set'"
            )

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.core.scalars()["time"])

    @property
    def step_count(self) -> int:
        """Steps done."""
        return int(self.core.scalars()["step"])

    @property
    def motion(self) -> NDArray[np.float64]:
        """The core's rows of position and velocity, each and a pad; a view of shape (nodes, 8).

        Read-only where ranks share the model.
        """
        return rows_of(self.core, "node.motion").numbers

    @property
    def fields(self) -> dict[str, NDArray[np.float64]]:
        """Fields on nodes, read-only: views of the core, which change during the run, or new
        arrays.

        "position", "velocity" [m, m/s] are views, shape (nodes, 3); "displacement" [m] is counted
        from the last reset; "force" [N] is the last unbalanced force, "reaction" [N] the force of
        supports; "mass" [kg]. To move nodes on purpose, write into `motion`.
        """
        motion = rows_of(self.core, "node.motion")
        found = {
            "position": motion.position,
            "velocity": motion.velocity,
            "displacement": motion.position - self.reference,
            "force": rows_of(self.core, "node.force").force,
            "reaction": rows_of(self.core, "node.reaction").force,
            "mass": self.core.array("node.mass")[0],
        }
        for values in found.values():
            values.flags.writeable = False
        return Named("field", found)

    @cached_property
    def groups(self) -> dict[str, Group]:
        """Nodes, elements and blocks of each group, by its name."""
        return Named("group", groups_of(self.build))

    @property
    def contacts(self) -> dict[str, NDArray]:
        """Active contacts, one row each.

        Semi-springs, then semi-edges: "kind" (0 spring, 1 edge), "mother_face", "target_face" (face
        ids), "force_n" [N, compression positive], "force" [N, on the mother, shape (contacts, 3)].
        """
        core, s = self.core, self.core.fields()
        exposed, target = s["search.exposed_face"], s["spring.target"]
        slots = np.flatnonzero(target >= 0)
        springs, edges = rows_of(core, "spring.state"), rows_of(core, "edge.state")
        on_vertices, on_sides = rows_of(core, "spring.reaction"), rows_of(core, "edge.reaction")
        crossing = rows_of(core, "edge.contact")
        found = {
            "kind": np.repeat([0, 1], [len(slots), len(crossing.target)]),
            "mother_face": exposed[np.concatenate([slots, crossing.mother_side]) // 4],
            "target_face": exposed[np.concatenate([target[slots], crossing.target])],
            "force_n": np.concatenate([springs.force_n[slots], edges.force_n]),
            "force": np.concatenate([on_vertices.force[slots], on_sides.force]),
        }
        return Named("column", found)

    @property
    def rigid_motion(self) -> Motion:
        """Speeds and kinetic energy of the blocks as rigid bodies."""
        fields = self.fields
        return rigid_motion(
            self.build.topology.block_first_node,
            fields["mass"],
            fields["position"],
            fields["velocity"],
        )

    @property
    def out(self) -> NDArray[np.bool_]:
        """Whether each block was removed or has left the domain."""
        first, flags = self.build.topology.block_first_node[:-1], self.core.array("node.out")[0]
        return flags[first] != 0 if len(flags) else np.zeros(len(first), bool)

    @property
    def fallen(self) -> NDArray[np.intp]:
        """Blocks that have fallen past the edge of the model and keep falling."""
        first, gravity = self.build.topology.block_first_node, self.case.loads.gravity
        position = rows_of(self.core, "node.motion").position
        below = fallen(first, self.build.start_position, position, gravity)
        return below[~self.out[below]]

    @property
    def motion_of_rest(self) -> Motion:
        """The rigid motion of the blocks still in the model."""
        gone = np.concatenate([self.fallen, np.flatnonzero(self.out)])
        return self.rigid_motion.without(gone)

    def take_out(self) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Remove bodies that have left the domain since the last check.

        Returns:
            Their blocks, and the speeds with which they left [m/s].
        """
        domain, t = self.case.model.domain, self.build.topology
        if domain is None:
            return np.zeros(0, np.intp), np.zeros(0)
        fields = self.fields
        middle = middles(t.block_first_node, fields["mass"], fields["position"])
        if not outside(domain, middle).any():
            return np.zeros(0, np.intp), np.zeros(0)
        body = self.core.fields()["node.body"][t.block_first_node[:-1]]
        blocks = leaving(domain, middle, body, self.out)
        if not len(blocks):
            return blocks, np.zeros(0)
        speeds = self.rigid_motion.speed[blocks]
        leaves = np.zeros(len(t.block_group), np.int8)
        leaves[blocks] = 1
        self.core.take_out(leaves[t.node_block])  # they stop there
        return blocks, speeds

    def look_for_departures(self) -> list[Departure]:
        """Remove bodies outside the domain, and note blocks that fell below the model since the
        last check.

        Returns:
            The first block of each group that had none before.
        """
        t, found, position = self.build.topology, [], rows_of(self.core, "node.motion").position
        known = {(departure.group, departure.out) for departure in self.departures}
        gone, below = self.take_out(), self.fallen
        falls = below, self.rigid_motion.speed[below] if len(below) else np.zeros(0)
        for out, (blocks, speeds) in ((True, gone), (False, falls)):
            for block, speed in zip(blocks, speeds, strict=True):
                group = self.build.group_names[t.block_group[block]]
                if (group, out) not in known:
                    nodes = slice(*t.block_first_node[block : block + 2])
                    place = position[nodes].mean(axis=0).tolist()
                    found.append(Departure(group, int(block), self.time, place, float(speed), out))
                    known.add((group, out))
        self.departures += found
        return found

    @property
    def taken_out(self) -> dict[str, dict[str, float]]:
        """Number and mass [kg] of the removed blocks, for each group that lost any."""
        t, out = self.build.topology, self.out
        mass = np.add.reduceat(self.fields["mass"], t.block_first_node[:-1])
        lost = {}
        for index, name in enumerate(self.build.group_names):
            if name not in self.awaited and (these := out & (t.block_group == index)).any():
                lost[name] = {
                    "blocks": int(these.sum()),
                    "mass": float(mass[these].sum()),
                    "dug_out": name in self.dug_out,
                }
        return lost

    @property
    def dug_out(self) -> list[str]:
        """Groups removed by stages so far."""
        stages = self.case.stages[: self.begun]
        removed = {name for stage in stages for name in stage.remove}
        return sorted(removed & set(self.case.absent(self.begun)))

    @property
    def awaited(self) -> list[str]:
        """Groups not yet added."""
        return sorted(set(self.case.absent(self.begun)) - set(self.dug_out))

    @property
    def begun(self) -> int:
        """Number of stages begun."""
        return self.stage_index + (self.stage is not None)

    @property
    def is_over(self) -> bool:
        """Whether all stages have ended."""
        return self.stage_index >= len(self.case.stages)

    @property
    def energies(self) -> dict[str, float]:
        """Energy ledger at the last sampled step [J], and its closing "error" (a fraction)."""
        return Named("energy", self.core.energies())

    @property
    def broken(self) -> dict[str, int]:
        """Bond points broken so far, by cause: "tension" and "shear"."""
        tension, shear = self.core.broken()
        return {"tension": tension, "shear": shear}

    # ------------------------------------------------------------------ keeping

    @property
    def kept(self) -> dict[str, NDArray[np.float64]]:
        """Arrays in a checkpoint besides those of the core, shape (nodes, 3)."""
        adds = any(stage.add for stage in self.case.stages)
        born = {"simulation.born": self.build.born} if adds else {}
        bears = (
            {"simulation.kept_reaction": self.build.boundaries.kept} if self.case.boundaries else {}
        )
        watched = {"simulation.reference": self.reference, "simulation.watched": self.watched}
        return watched | born | bears

    def attributes(self, row_sums: str, rows: int, frames: int) -> Attributes:
        """Data in a checkpoint besides arrays, after this many rows of histories and frames."""
        return Attributes(
            version=__version__,
            own_laws=digests,
            case=self.given_case.model_dump(mode="json"),
            nodes=self.build.fingerprint,
            core=self.core.scalars(),
            overlap=self.overlap,
            stage_index=self.stage_index,
            stage=self.stage,
            ended_stage=self.ended_stage,
            finished_stages=self.finished_stages,
            wall_time=self.wall_time,
            departures=self.departures,
            settings=self.settings,
            records=self.record_digests,
            rows_before=self.rows_before,
            rows=rows,
            row_sums=row_sums,
            frames=frames,
        )

    def summary(self, status: str) -> dict[str, Any]:
        """The content of summary.json."""
        fields = self.fields
        counts = self.audit.counts
        energies = dict(self.energies) if self.step_count else {}
        groups = {}
        speed = self.rigid_motion.speed
        for index, name in enumerate(self.build.group_names):
            nodes = self.build.nodes_of(name)
            mass = fields["mass"][nodes]
            mean = {
                key: ((mass[:, None] * fields[key][nodes]).sum(axis=0) / mass.sum()).tolist()
                for key in ("position", "displacement", "velocity")
            }
            distance = np.linalg.norm(fields["displacement"][nodes], axis=1)
            groups[name] = {
                "mass": float(mass.sum()),
                "centroid": mean["position"],
                "displacement": mean["displacement"],
                "velocity": mean["velocity"],
                "max_displacement": float(distance.max()),
                "fastest_block": float(speed[self.build.topology.block_group == index].max()),
            }
        return {
            "status": status,
            "title": self.case.title,
            "version": __version__,
            "date": datetime.now().astimezone().isoformat(timespec="seconds"),
            "host": platform.node(),
            "inputs": self.inputs,
            "own_laws": digests,
            "device": f"{device} ({native_name})",
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
            "charges": [one.as_dict() for one in self.audit.charges],
            "groups": groups,
            "taken_out": self.taken_out,
            "departures": [departure.text() for departure in self.departures],
            "settings": [asdict(setting) for setting in self.settings],
        }
