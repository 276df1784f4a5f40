"""The result folder of a run: what is written when, and how a resumed run goes on with it."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from cdem._version import __version__
from cdem.case.output_fields import CARRIED, OUTPUT_FIELDS
from cdem.errors import CdemError
from cdem.run.checkpoint import read_checkpoint, write_checkpoint, write_json_atomic
from cdem.run.energy_terms import ENERGY_TERMS
from cdem.run.fields import surface_of, values_of
from cdem.run.histories import tracks
from cdem.run.state import RunState
from cdem.run.writers import FrameWriter, HistoryWriter, SurfaceWriter
from cdem.run.written_files import check_replaceable, mark, remove_written

RESULT_FILES = {"case.yaml", "run.log", "summary.json", "checkpoint.h5"}
"""A folder that holds one of these is read as a result folder; `--overwrite` asks for more."""


def _guard(folder: Path, case_folder: Path, *, overwrite: bool, resume: bool) -> None:
    """Stop before anything is computed if the folder must not be written to."""
    if folder.exists() and not folder.is_dir():
        raise CdemError(f"{folder}: is a file; name another folder with -o")
    inside = {path.name for path in folder.iterdir()} if folder.exists() else set()
    if resume:
        if "checkpoint.h5" not in inside:
            raise CdemError(f"{folder}: no checkpoint to resume from; run without --resume")
    elif inside and not overwrite:
        raise CdemError(
            f"{folder}: exists already; use --overwrite to replace it, --resume to go on, or -o "
            "for another folder"
        )
    elif inside:
        check_replaceable(folder, case_folder)


class Results:
    """Writes the result folder of one simulation.

    Args:
        folder: The result folder.
        case_folder: Where the case lies: never overwritten.
        overwrite: Replace the results in an existing folder.
        resume: Go on in an existing one.

    Raises:
        CdemError: The folder exists and neither was asked for, it holds other things than results, or
            there is nothing to resume.
    """

    def __init__(self, folder: Path, case_folder: Path, *, overwrite: bool, resume: bool) -> None:
        self.folder = folder
        _guard(folder, case_folder, overwrite=overwrite, resume=resume)
        self.overwrite = overwrite
        self.rows = 0
        self.frames = 0
        self.tracks: list[tuple[str, Any]] = []
        self._history: HistoryWriter
        self._volume: FrameWriter | None = None
        self._surface: SurfaceWriter | None = None

    # ------------------------------------------------------------------ opening

    def open(self, sim: RunState) -> None:
        """Create the folder; nothing is written before the model has been built."""
        self.folder.mkdir(parents=True, exist_ok=True)
        if self.overwrite:
            remove_written(self.folder)
        mark(self.folder)
        (self.folder / "case.yaml").write_text(sim.case.dump())
        (self.folder / "run.log").write_text("")
        self.log(sim.audit.text())
        self._open_series(sim, None, None)

    def reopen(self, sim: RunState, attributes: dict[str, Any]) -> None:
        """Go on with the files of an interrupted run, cut back to its checkpoint."""
        self.rows, self.frames = int(attributes["rows"]), int(attributes["frames"])
        self._open_series(sim, self.frames, self.rows)
        self.log(f"resumed at step {sim.step_count}, t = {sim.time:.6g} s")

    def _open_series(self, sim: RunState, frames: int | None, rows: int | None) -> None:
        t = sim.build.topology
        self.tracks = tracks(sim)
        columns = [
            "time [s]", "step",
            *(term.column for term in ENERGY_TERMS),
            "energy error", "unbalance ratio", "broken tension", "broken shear",
        ]  # fmt: skip
        columns += [name for name, _ in self.tracks]
        self._history = HistoryWriter(self.folder / "histories.csv", columns, keep_rows=rows)
        if not sim.case.output.frames:
            return
        static = values_of(sim, (f for f in OUTPUT_FIELDS if f.frames == "always"))
        self._volume = FrameWriter(
            self.folder / "frames.vtkhdf", t.element_nodes, static, resume_steps=frames
        )
        self._volume.name_groups(sim.build.group_names)
        self._surface = SurfaceWriter(self.folder / "surface.vtkhdf", resume_steps=frames)

    # ------------------------------------------------------------------ writing

    def log(self, text: str) -> None:
        """Add a line to run.log."""
        with (self.folder / "run.log").open("a") as file:
            file.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')} {text}\n")

    def record(self, sim: RunState, frame: bool) -> None:
        """Write a history row, and a frame of the fields with it if asked."""
        e = sim.energies
        broken = sim.broken
        row = [sim.time, sim.step_count]
        row += [e[term.name] for term in ENERGY_TERMS]
        row += [e["error"], sim.core.unbalance_ratio(), broken["tension"], broken["shear"]]
        row += [value() for _, value in self.tracks]
        self._history.append(row)
        self.rows += 1
        if frame and self._volume is not None and self._surface is not None:
            self._record_frame(sim, self._volume, self._surface)

    def _record_frame(self, sim: RunState, volume: FrameWriter, surface: SurfaceWriter) -> None:
        wanted = sim.case.output.fields
        kept = [f for f in OUTPUT_FIELDS if f.frames == "chosen" and f.name in wanted]
        shown = [f for f in CARRIED if f.surface == "always" or f.name in wanted]
        values = values_of(sim, [f for f in OUTPUT_FIELDS if f in kept or f in shown])
        nodes, elements = (
            {f.name: values[f.name] for f in kept if f.on == on} for on in ("nodes", "elements")
        )
        volume.append(sim.time, sim.motion[:, :3], nodes, elements)
        surface.append(sim.time, *surface_of(sim, {f.name: values[f.name] for f in shown}))
        if surface.frames == 1:
            surface.name_groups(sim.build.group_names)
        self.frames += 1

    def checkpoint(self, sim: RunState) -> None:
        """Write the checkpoint."""
        arrays = dict(sim.core.fields())
        arrays["simulation.reference"] = sim.reference
        attributes = sim.attributes() | {"rows": self.rows, "frames": self.frames}
        write_checkpoint(self.folder / "checkpoint.h5", arrays, attributes)

    def read_checkpoint(self, sim: RunState) -> tuple[dict[str, NDArray], dict[str, Any]]:
        """Read the checkpoint and make sure that it belongs to the same model."""
        arrays, attributes = read_checkpoint(self.folder / "checkpoint.h5")
        nodes = len(sim.build.topology.node_position)
        if arrays["simulation.reference"].shape != (nodes, 3):
            raise CdemError(
                f"{self.folder / 'checkpoint.h5'}: belongs to another model "
                f"({len(arrays['simulation.reference'])} nodes, this one has {nodes}); "
                "resume with the case that was run"
            )
        if attributes.get("nodes") != sim.build.fingerprint:
            raise CdemError(
                f"{self.folder / 'checkpoint.h5'}: belongs to another model, with other elements or "
                "groups, or whose nodes begin at other places or are numbered otherwise; resume with "
                f"the case, the mesh and the cdem that were run ({attributes['version']}; this is {__version__})"
            )
        return arrays, attributes

    def finish(self, sim: RunState, status: str) -> None:
        """Write the summary; the report is made from the folder alone."""
        write_json_atomic(self.folder / "summary.json", sim.summary(status))
        self.log(f"{status} at step {sim.step_count}, t = {sim.time:.6g} s")

    def fail(self, sim: RunState) -> None:
        """Record where a run failed."""
        write_json_atomic(self.folder / "summary.json", sim.summary("failed"))
        self.log(f"failed at step {sim.step_count}, t = {sim.time:.6g} s")
