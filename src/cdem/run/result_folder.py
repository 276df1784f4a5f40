"""The result folder of a run: its files, and how a resumed run continues them."""

from __future__ import annotations

import contextlib
import json
import os
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from cdem.case.output_fields import CARRIED, OUTPUT_FIELDS, OutputField
from cdem.errors import CdemError, DiskError
from cdem.rows import rows_of
from cdem.run.bolt_fields import bolt_lines
from cdem.run.checkpoint import (
    CHECKPOINT,
    CHECKPOINT_BEFORE,
    DamagedError,
    has_checkpoint,
    read_checkpoint,
    write_checkpoint,
)
from cdem.run.energy_terms import terms_of
from cdem.run.fields import surface_of, values_of
from cdem.run.folder_lock import FolderLock
from cdem.run.frame_files import FrameFiles, SurfaceFiles
from cdem.run.histories import Track, tracks
from cdem.run.history_file import HistoryFile
from cdem.run.law_fields import wanted_fields
from cdem.run.record_files import write_records
from cdem.run.state import Attributes, RunState
from cdem.run.written_files import BEGUN, check_replaceable, refuse_links, remove_written
from cdem.whole_files import disk_error, write_json, write_text

RESULT_FILES = {"case.yaml", "run.log", "summary.json", CHECKPOINT, CHECKPOINT_BEFORE}
"""A folder with one of these is a result folder; `--overwrite` checks more."""


def _guard(folder: Path, case_folder: Path, *, overwrite: bool, resume: bool) -> None:
    """Raise an error before any computation if the folder must not be written to."""
    if folder.exists() and not folder.is_dir():
        raise CdemError(f"{folder}: is a file; name another folder with -o")
    inside = _inside(folder) if folder.exists() else set()
    if resume:
        if not has_checkpoint(folder):
            raise CdemError(f"{folder}: no checkpoint to resume from; run without --resume")
        refuse_links(folder)
    elif inside and not overwrite:
        raise _exists(folder)
    elif inside:
        check_replaceable(folder, case_folder)
    elif folder.exists():
        refuse_links(folder)


def _inside(folder: Path) -> set[str]:
    """Names in a folder, without the marks of a run that has begun."""
    return {path.name for path in folder.iterdir()} - BEGUN


def _exists(folder: Path) -> CdemError:
    return CdemError(
        f"{folder}: exists already; use --overwrite to replace it, --resume to continue it, or -o "
        "for another folder"
    )


def read_one(path: Path) -> tuple[Path, dict[str, NDArray], Attributes]:
    """A checkpoint: its path, arrays and attributes.

    Raises:
        DamagedError: It has changed since it was written.
        ValidationError: Its attributes are not those of this cdem.
    """
    arrays, text = read_checkpoint(path)
    return path, arrays, Attributes.model_validate_json(text)


def row_of(sim: RunState, histories: Sequence[Track]) -> list[float]:
    """A row of histories.csv."""
    e, broken = sim.energies, sim.broken
    row: list[float] = [sim.time, sim.step_count]
    row += [e[term.name] for term in terms_of(sim.case)]
    row += [e["error"], sim.core.unbalance_ratio(), broken["tension"], broken["shear"]]
    return row + [value for track in histories for value in track.values()]


class Results:
    """Writes the result folder of one simulation.

    Args:
        folder: The result folder.
        case_folder: Folder of the case: never overwritten.
        overwrite: Replace the results in an existing folder.
        resume: Continue an existing one.

    Attributes:
        notes: Messages for the user about the run that is continued.

    Raises:
        CdemError: The folder exists and neither was asked for, it holds other files than results,
            another run writes into it, or there is nothing to resume.
    """

    def __init__(self, folder: Path, case_folder: Path, *, overwrite: bool, resume: bool) -> None:
        self.folder = folder
        _guard(folder, case_folder, overwrite=overwrite, resume=resume)
        self._lock = FolderLock(folder)
        if folder.exists():
            self._lock.take()
        self._new = not (overwrite or resume)
        self.frames = 0
        self._shows_stop = False
        self.notes: list[str] = []
        self.tracks: list[Track] = []
        self._history: HistoryFile
        self._volume: FrameFiles | None = None
        self._surface: SurfaceFiles | None = None
        self._bolts: SurfaceFiles | None = None
        self._checkpoint: os.stat_result | None = None

    # ------------------------------------------------------------------ opening

    def open(self, sim: RunState) -> None:
        """Create the folder; nothing is written before the model has been built."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._lock.take()
        if not self._new:
            remove_written(self.folder)
        elif _inside(self.folder):
            raise _exists(self.folder)  # made by another run while this one built its model
        write_text(self.folder / "case.yaml", sim.given_case.dump())
        sim.record_digests = write_records(self.folder, sim.given_case)
        self.log(sim.audit.text())
        self._open_series(sim, None, None)

    def reopen(self, sim: RunState, attributes: Attributes) -> None:
        """Continue the files of an interrupted run, cut back to its checkpoint."""
        self.frames = attributes.frames
        self._open_series(sim, self.frames, attributes.row_sums)
        write_text(self.folder / "case.yaml", sim.given_case.dump())
        for note in self.notes:
            self.log(f"warning: {note}")
        self.log(f"resumed at step {sim.step_count}, t = {sim.time:.6g} s")

    def hold(self) -> None:
        """Take the lock of the folder again after `release`, unless another run has written there.

        Raises:
            CdemError: Another run writes, or has written.
        """
        self._lock.take()
        if self._checkpoint is not None and _identity(self._stat()) != _identity(self._checkpoint):
            raise CdemError(
                f"{self.folder}: another run has written here since; open it again with resume"
            )

    def release(self) -> None:
        """Let another run write into the folder; the files are listed first."""
        with contextlib.suppress(DiskError):  # all data of the run are on the disk already
            for series in self._series():
                series.sync()
        self._lock.release()

    def _open_series(self, sim: RunState, frames: int | None, rows: str | None) -> None:
        self.tracks = tracks(sim)
        columns = [
            "time [s]", "step",
            *(term.column for term in terms_of(sim.case)),
            "energy error", "unbalance ratio", "broken tension", "broken shear",
        ]  # fmt: skip
        columns += [name for track in self.tracks for name in track.names]
        self._history = HistoryFile(self.folder / "histories.csv", columns, rows)
        if self._history.lost:
            self.notes.append(
                f"histories.csv: {self._history.lost} rows are lost (damaged or missing); the run "
                f"continues "
                "without them. To get them back, run the case again in another folder (-o)"
            )
        if not sim.case.output.frames:
            return
        static = values_of(sim, (f for f in OUTPUT_FIELDS if f.frames == "always"))
        cells, names = sim.build.topology.element_nodes, sim.build.group_names
        self._volume = FrameFiles(self.folder / "frames.vtkhdf", cells, static, names, frames)
        self._surface = SurfaceFiles(self.folder / "surface.vtkhdf", names, frames)
        if sim.build.bolts.bolts:
            self._bolts = SurfaceFiles(self.folder / "bolts.vtkhdf", names, frames)
        for series in self._series():
            if series.lost:
                self.notes.append(
                    f"{series.path.name}: frames {_ranges(series.lost)} are lost (damaged or missing); "
                    f"move those files out of {series.folder.name}/ to read the others. To get "
                    f"them back, "
                    "run the case again in another folder (-o)"
                )

    def _series(self) -> list[FrameFiles | SurfaceFiles]:
        """The series of frames being written."""
        return [s for s in (self._volume, self._surface, self._bolts) if s is not None]

    # ------------------------------------------------------------------ writing

    def log(self, text: str) -> None:
        """Add a line to run.log."""
        path = self.folder / "run.log"
        try:
            with path.open("a") as file:
                file.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')} {text}\n")
        except OSError as error:
            raise disk_error(path, error) from error

    def record(self, sim: RunState, frame: bool) -> None:
        """Write a history row and, if asked, a frame of the fields."""
        self.write(sim, row_of(sim, self.tracks), frame)

    def write(self, sim: RunState, row: list[float], frame: bool) -> None:
        """The same with a row that is made already."""
        self._drop_stop()
        self._history.append(row)
        if frame and self._volume is not None and self._surface is not None:
            self._record_frame(sim, self._volume, self._surface)

    def show_stop(self, sim: RunState) -> None:
        """Write a frame of a stopped run, after its checkpoint; a resumed run drops it."""
        if self._volume is None or self._surface is None or self._volume.last_time == sim.time:
            return
        self._record_frame(sim, self._volume, self._surface)
        for series in self._series():
            series.sync()
        self._shows_stop = True

    def _drop_stop(self) -> None:
        """Remove the frame of `show_stop`."""
        if self._shows_stop:
            for series in self._series():
                series.drop_last()
            self.frames -= 1
            self._shows_stop = False

    def _record_frame(self, sim: RunState, volume: FrameFiles, surface: SurfaceFiles) -> None:
        wanted = wanted_fields(sim.case)
        kept = _kept_in_frames(sim)
        shown = [f for f in CARRIED if f.surface == "always" or f.name in wanted]
        values = values_of(sim, [f for f in OUTPUT_FIELDS if f in kept or f in shown])
        nodes, elements = (
            {f.name: values[f.name] for f in kept if f.on == on} for on in ("nodes", "elements")
        )
        volume.append(
            self.frames, sim.time, rows_of(sim.core, "node.motion").position, nodes, elements
        )
        polygons = surface_of(sim, {f.name: values[f.name] for f in shown})
        surface.append(self.frames, sim.time, *polygons)
        if self._bolts is not None:
            self._bolts.append(self.frames, sim.time, *bolt_lines(sim))
        self.frames += 1

    def checkpoint(self, sim: RunState) -> None:
        """Write the checkpoint, after all files that it relies on are on the disk."""
        self._drop_stop()
        self._history.sync()
        for series in self._series():
            series.sync()
        arrays = dict(sim.core.fields())
        arrays |= sim.kept
        attributes = sim.attributes(self._history.sums, self._history.rows, self.frames)
        write_checkpoint(self.folder, arrays, attributes.model_dump_json())
        self._checkpoint = self._stat()

    def read_checkpoint(self) -> tuple[Path, dict[str, NDArray], Attributes]:
        """Read the last intact checkpoint: its path, arrays and attributes.

        Raises:
            CdemError: There is none.
        """
        said = []
        for name in (CHECKPOINT, CHECKPOINT_BEFORE):
            path = self.folder / name
            try:
                found = read_one(path)
            except DamagedError as error:
                said.append(str(error))
                continue
            except ValidationError as error:
                first = error.errors()[0]
                place = ".".join(map(str, first["loc"]))
                said.append(
                    f"{path}: is damaged, or of another version of cdem ({place}: {first['msg']})"
                )
                continue
            self.notes += [f"{why}; continuing from the previous one, {path}" for why in said]
            self._checkpoint = self._stat()
            return found
        raise CdemError(f"{'; '.join(said)}; run the case again with --overwrite")

    def _stat(self) -> os.stat_result | None:
        path = self.folder / CHECKPOINT
        return path.stat() if path.is_file() else None

    def ended(self, sim: RunState) -> str | None:
        """The status in a summary of exactly this state, if the run was complete."""
        try:
            summary = json.loads((self.folder / "summary.json").read_text())
        except (OSError, ValueError):
            return None
        same = summary.get("steps") == sim.step_count
        status = summary.get("status")
        return status if same and status not in ("stopped", "failed") else None

    def finish(self, sim: RunState, status: str) -> None:
        """Write the summary; the report is made from the folder alone."""
        write_json(self.folder / "summary.json", sim.summary(status))
        self.log(f"{status} at step {sim.step_count}, t = {sim.time:.6g} s")

    def fail(self, sim: RunState) -> None:
        """Record the state of a failed run."""
        with np.errstate(all="ignore"):  # numbers may be huge
            summary = sim.summary("failed")
        write_json(self.folder / "summary.json", summary)
        self.log(f"failed at step {sim.step_count}, t = {sim.time:.6g} s")


def _kept_in_frames(sim: RunState) -> list[OutputField]:
    """Changing fields in each frame of the volume."""
    case = sim.case
    wanted = wanted_fields(case)
    leave = case.model.domain is not None or any(s.remove or s.add for s in case.stages)
    return [
        f
        for f in OUTPUT_FIELDS
        if (f.frames == "chosen" and f.name in wanted) or (f.frames == "leaving" and leave)
    ]


def _identity(stat: os.stat_result | None) -> tuple[int, ...]:
    return (0, 0) if stat is None else (stat.st_ino, stat.st_mtime_ns)


def _ranges(numbers: Sequence[int]) -> str:
    """Numbers in order; successive ones as a range."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][1] + 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ", ".join(str(a) if a == b else f"{a} to {b}" for a, b in parts)
