"""The result of a rockfall: every run, every passage of a line, and the text of their statistics."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.rockfall.fall import FAILED, LEFT, OVER, THROUGH
from cdem.rockfall.run import Runs
from cdem.rockfall.schema import Barrier
from cdem.rockfall.statistics import LEVELS, Quantile, quantile_of, share_of
from cdem.rockfall.tracks import PASSAGE, Track, passages
from cdem.rockfall.worker import TRACK, place
from cdem.whole_files import write_json, write_text

Floats = NDArray[np.float64]
RUN = {
    "run": "", "folder": "", "status": "", "shape": "", "volume": "m3", "mass": "kg",
    "start_x": "m", "start_y": "m", "start_z": "m", "stop_x": "m", "stop_y": "m", "stop_z": "m",
    "time": "s", "reach": "m", "drop": "m", "shadow_angle": "deg", "path": "m",
    "velocity_max": "m/s", "energy_max": "J", "height_max": "m", "modulus": "Pa", "steps": "",
}  # fmt: skip
"""Columns of runs.csv, with units."""
MEASURES = {
    "height": ("height of the centre above the ground", "m", 1.0),
    "top": ("height of the top above the ground", "m", 1.0),
    "velocity": ("velocity", "m/s", 1.0),
    "energy": ("kinetic energy", "kJ", 1e-3),
    "energy_rotation": ("of which rotation", "kJ", 1e-3),
}
"""Measures of a barrier in the text: title, unit, and factor from SI."""


@dataclass(frozen=True)
class AtBarrier:
    """Passages of one line.

    Attributes:
        barrier: The line.
        run: Run of each passage.
        passage: Number of each passage within its run, from 1.
        values: Columns `PASSAGE`.
        runs: Number of all runs with a track.
    """

    barrier: Barrier
    run: NDArray[np.int64]
    passage: NDArray[np.int64]
    values: dict[str, Floats]
    runs: int

    @property
    def first(self) -> dict[str, Floats]:
        """The first passage of each run that passes."""
        return {name: column[self.passage == 1] for name, column in self.values.items()}

    @property
    def reached(self) -> int:
        """Number of runs that pass."""
        return int((self.passage == 1).sum())

    def quantiles(self, name: str) -> list[Quantile]:
        """Quantiles of the first passages; none without any."""
        return [quantile_of(self.first[name], p) for p in LEVELS] if self.reached else []

    def above(self) -> dict[str, int]:
        """How many first passages exceed the height, the energy, or one of the two."""
        first, b = self.first, self.barrier
        over: dict[str, Any] = {
            "height": None if b.height is None else first["top"] > b.height,
            "energy": None if b.energy is None else first["energy"] > b.energy,
        }
        found = {name: int(flags.sum()) for name, flags in over.items() if flags is not None}
        if len(found) == 2:
            found["either"] = int(np.logical_or.reduce(list(over.values())).sum())
        return found

    def as_dict(self) -> dict[str, Any]:
        """Counts and quantiles, for JSON."""
        return {
            "name": self.barrier.name,
            "line": self.barrier.line,
            "passages": len(self.run),
            "runs": self.reached,
            "share": self.reached / max(self.runs, 1),
            "share_band": share_of(self.reached, self.runs) if self.runs else None,
            "above": self.above(),
            "quantiles": {
                name: [quantile_dict(q) for q in self.quantiles(name)]
                for name in ("height", "bottom", "top", "velocity", "spin", "energy_translation",
                             "energy_rotation", "energy")
            },
        }  # fmt: skip


class Result:
    """All that the tracks of a rockfall tell.

    Args:
        runs: The runs; those without a result are left out.
    """

    def __init__(self, runs: Runs) -> None:
        self.runs = runs
        self.numbers: list[int] = []
        self.tracks: list[Track] = []
        self.rows: list[dict[str, Any]] = []
        for run in runs.done:
            assert run.result is not None
            track = Track(np.load(place(run.task) / TRACK), run.result["mass"])
            self.numbers.append(run.result["number"])
            self.tracks.append(track)
            self.rows.append(self._row(run.result, track))
        self.barriers = [self._at(barrier) for barrier in runs.rockfall.barriers]

    def _row(self, result: Mapping[str, Any], track: Track) -> dict[str, Any]:
        begin, end = track.places[0], track.places[-1]
        reach, drop = float(np.hypot(*(end - begin)[:2])), float(begin[2] - end[2])
        above = track["z"] - self.runs.ground.height(track.places[:, :2])
        row = {
            "run": result["number"], "folder": f"runs/{result['name']}",
            **{key: result[key] for key in ("status", "shape", "volume", "mass")},
            **{f"start_{k}": float(v) for k, v in zip("xyz", begin, strict=True)},
            **{f"stop_{k}": float(v) for k, v in zip("xyz", end, strict=True)},
            "time": float(track["time"][-1]), "reach": reach, "drop": drop,
            "shadow_angle": float(np.degrees(np.arctan2(drop, reach))),
            "path": float(np.linalg.norm(np.diff(track.places, axis=0), axis=1).sum()),
            "velocity_max": float(track.speed.max()), "energy_max": float(track.energy.max()),
            "height_max": float(np.nanmax(above)),
            "modulus": result["modulus"], "steps": result["steps"],
        }  # fmt: skip
        return {name: row[name] for name in RUN}

    def _at(self, barrier: Barrier) -> AtBarrier:
        line = np.array(barrier.line)
        found = [passages(track, line, self.runs.ground) for track in self.tracks]
        counts = [len(one["time"]) for one in found]
        number = [np.arange(1, n + 1) for n in counts] or [np.zeros(0, int)]
        columns = {
            name: np.concatenate([one[name] for one in found]) if found else np.zeros(0)
            for name in PASSAGE
        }
        run = np.repeat(np.array(self.numbers, np.int64), counts)
        return AtBarrier(barrier, run, np.concatenate(number), columns, len(self.tracks))

    @property
    def statuses(self) -> dict[str, int]:
        """Number of runs by how they ended."""
        return dict(Counter(row["status"] for row in self.rows))

    @property
    def doubts(self) -> list[str]:
        """One line for each reason to doubt the statistics."""
        count = self.statuses
        said = []
        if n := count.get(LEFT, 0):
            said.append(
                f"{n} of {len(self.rows)} blocks left the terrain; their stops and whatever comes "
                "after are unknown: use a larger extent"
            )
        if n := count.get(OVER, 0):
            said.append(
                f"{n} blocks still moved after {self.runs.rockfall.duration:g} s: raise duration"
            )
        if n := count.get(THROUGH, 0) + count.get(FAILED, 0):
            said.append(
                f"{n} runs failed in spite of stiffer contacts; runs.csv names them: their tracks "
                "are counted up to the failure"
            )
        return said

    def as_dict(self) -> dict[str, Any]:
        """All results except tracks and passages, for JSON."""
        return {
            "title": self.runs.rockfall.title,
            "crs": self.runs.rockfall.system,
            "runs": len(self.rows),
            "waiting": self.runs.waiting,
            "statuses": self.statuses,
            "physics": self.runs.runs[0].task["physics"],
            "doubts": self.doubts,
            "reach": [quantile_dict(q) for q in self._quantiles("reach")],
            "shadow_angle_least": min((row["shadow_angle"] for row in self.rows), default=None),
            "barriers": [barrier.as_dict() for barrier in self.barriers],
        }

    def _quantiles(self, name: str) -> list[Quantile]:
        values = np.array([row[name] for row in self.rows])
        return [quantile_of(values, p) for p in LEVELS] if len(values) else []

    def write(self, folder: Path) -> list[Path]:
        """Write runs.csv, barriers.csv and result.json."""
        names = [f"{n} [{u}]" if u else n for n, u in RUN.items()]
        write_text(folder / "runs.csv", _csv(names, [row.values() for row in self.rows]))
        shapes = {row["run"]: (row["shape"], row["volume"]) for row in self.rows}
        head = ["barrier", "run", "passage", *(f"{n} [{u}]" for n, u in PASSAGE.items())]
        lines = [
            [b.barrier.name, int(run), int(k), *(float(c[i]) for c in b.values.values()),
             *shapes[int(run)]]
            for b in self.barriers
            for i, (run, k) in enumerate(zip(b.run, b.passage, strict=True))
        ]  # fmt: skip
        write_text(folder / "barriers.csv", _csv([*head, "shape", "volume [m3]"], lines))
        write_json(folder / "result.json", self.as_dict())
        return [folder / name for name in ("runs.csv", "barriers.csv", "result.json")]

    def text(self) -> str:
        """Tables of the runs and barriers."""
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        physics = self.runs.runs[0].task["physics"]
        ends = ", ".join(f"{n} {status}" for status, n in sorted(self.statuses.items()))
        yield f"{len(self.rows)} runs: {ends or 'none has ended'}"
        yield (
            f"contacts: {physics['modulus'] / 1e6:.3g} MPa over the radius of the block; a sample "
            f"each {physics['sample']:g} s"
        )
        if self.rows:
            angles = [row["shadow_angle"] for row in self.rows]
            yield _line("reach [m]", self._quantiles("reach"), 1.0)
            yield f"  smallest angle from start to stop: {min(angles):.1f} deg"
        for b in self.barriers:
            yield from _barrier_lines(b)
        if self.barriers and self.rows:
            yield (
                "quantiles are of first passages; in brackets the band that holds the true "
                "quantile of these runs' distribution with 95 %; ?: too few passages"
            )


def quantile_dict(q: Quantile) -> dict[str, float | None]:
    """A quantile, for JSON."""
    return {"level": q.level, "value": q.value, "low": q.low, "high": q.high}


def _barrier_lines(b: AtBarrier) -> Iterator[str]:
    if not b.runs:
        return
    low, high = share_of(b.reached, b.runs)
    yield (
        f"barrier {b.barrier.name}: {b.reached} of {b.runs} runs pass, "
        f"{100 * b.reached / b.runs:.3g} % ({100 * low:.3g} to {100 * high:.3g} %); "
        f"{len(b.run)} passages"
    )
    for name, (title, unit, scale) in MEASURES.items():
        if b.reached:
            yield _line(f"{title} [{unit}]", b.quantiles(name), scale)
    limits = {
        "height": f"higher than {b.barrier.height or 0:g} m",
        "energy": f"with more than {(b.barrier.energy or 0) / 1e3:g} kJ",
        "either": "with one of the two",
    }
    for name, n in b.above().items():
        low, high = share_of(n, b.runs)
        yield (
            f"  {limits[name]}: {n} of {b.runs} runs, {100 * n / b.runs:.3g} % "
            f"({100 * low:.3g} to {100 * high:.3g} %)"
        )


def _line(title: str, found: Sequence[Quantile], scale: float) -> str:
    parts = ", ".join(f"{100 * q.level:g} %: {q.text(scale)}" for q in found)
    return f"  {title}: {parts}"


def _csv(head: Sequence[str], rows: Sequence[Any]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows([repr(v) if isinstance(v, float) else v for v in row] for row in rows)
    return text.getvalue()
