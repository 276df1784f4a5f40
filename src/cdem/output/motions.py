"""Motions of a run: measures, spectra, Newmark slip and ratios of its histories."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError, CdemError
from cdem.output.blast_peaks import HEADS as PEAK_HEADS
from cdem.output.blast_peaks import Peak, blast_peaks, peak_lines
from cdem.output.reader import read_histories, read_summary
from cdem.output.record_pictures import draw_motion
from cdem.seismic.measures import (
    PERIODS,
    Measures,
    fourier_amplitude,
    largest,
    measures,
    newmark_slip,
    rotated_spectrum,
    spectrum,
)
from cdem.seismic.processing import GRAVITY, Processed, integral
from cdem.seismic.tables import HEAD, row
from cdem.whole_files import write_text

Floats = NDArray[np.float64]
FOLDER = "motions"
"""Folder of the tables and pictures in a result folder."""
LEAST_ROWS = 20
"""Fewest rows of a stage that can be measured."""
YIELDS = 7
"""Accelerations between the ends of a range."""
COLUMN = re.compile(r"(.+)(?:\.(velocity|acceleration)|(\.v_base|\.v_up|\.v_down))_([xyz]) \[.*\]")
"""Columns with a motion; each velocity of a boundary is a motion of its own, `base.v_up`."""
STILL = 1e-3
"""Part of the largest velocity below which a motion along an axis is left out [1]."""
SILENT = 1e-2
"""Part of the largest amplitude below which a spectral ratio has no meaning [1]."""


@dataclass
class Motion:
    """Motion of a history along the axes that it has.

    Attributes:
        name: Of the history.
        parts: Motion along each axis.
    """

    name: str
    parts: dict[str, Processed]

    def spectra(self) -> dict[str, Floats]:
        """Pseudo-spectral acceleration at 5 % [m/s2] by axis, and of rotated horizontal components."""
        found = {a: spectrum(p.acceleration, p.step) for a, p in self.parts.items()}
        if {"x", "y"} <= self.parts.keys():
            x, y = self.parts["x"], self.parts["y"]
            turned = rotated_spectrum(x.acceleration, y.acceleration, x.step)
            found |= dict(zip(("RotD50", "RotD100"), turned, strict=True))
        return found


@dataclass
class Motions:
    """Measures of the motions of a run.

    Attributes:
        motions: Motions of the histories.
        to: History that spectral ratios refer to, or None.
        yields: Yield accelerations of Newmark's block [m/s2].
        peaks: Peak velocities of points near blasts.
    """

    motions: list[Motion]
    to: Motion | None
    yields: list[float]
    peaks: list[Peak]

    def measured(self) -> Iterable[tuple[str, str, Measures]]:
        """History, axis and measures."""
        for motion in self.motions:
            for axis, part in motion.parts.items():
                yield motion.name, axis, measures(part)

    def slips(self) -> Iterable[tuple[str, str, str, list[float]]]:
        """History, horizontal axis, sense, and the slip at each yield acceleration [m]."""
        for motion in self.motions:
            for axis in [axis for axis in "xy" if axis in motion.parts]:
                part = motion.parts[axis]
                for sense, sign in (("+", 1), ("-", -1)):
                    slips = [
                        newmark_slip(sign * part.acceleration, part.step, y) for y in self.yields
                    ]
                    yield motion.name, axis, sense, slips

    def lines(self) -> list[str]:
        """The measures as text."""
        rows = [f"{f'{name} {axis}':<20}{row(found)}" for name, axis, found in self.measured()]
        out = [f"{'':<20}{HEAD}", *rows]
        if self.yields:
            heads = "".join(f"{y / GRAVITY:>10.3g} g" for y in self.yields)
            out += ["", f"{'Newmark slip [m] at':<20}{heads}"]
            for name, axis, sense, slips in self.slips():
                numbers = "".join(f"{slip:>12.4g}" for slip in slips)
                out.append(f"{f'{name} {sense}{axis}':<20}{numbers}")
        return out + peak_lines(self.peaks)

    def write(self, folder: Path) -> list[Path]:
        """Write the tables; returns the files."""
        (folder / FOLDER).mkdir(exist_ok=True)
        rows = [[name, axis, *found] for name, axis, found in self.measured()]
        units = (
            "PGA [m/s2]", "PGV [m/s]", "PGD [m]", "Arias [m/s]", "CAV [m/s]", "D5-95 [s]",
            "last velocity [m/s]", "last displacement [m]",
        )  # fmt: skip
        paths = [_write(folder, "measures", ["history", "axis", *units], rows)]
        for motion in self.motions:
            spectra = motion.spectra()
            heads = ["period [s]", *(f"Sa {name} [m/s2]" for name in spectra)]
            table = np.column_stack([PERIODS, *spectra.values()]).tolist()
            paths.append(_write(folder, f"{motion.name}-spectrum", heads, table))
            f, amplitudes = amplitudes_of(motion)
            heads = ["frequency [Hz]", *(f"amplitude {a} [m/s]" for a in amplitudes)]
            table = np.column_stack([f, *amplitudes.values()]).tolist()
            paths.append(_write(folder, f"{motion.name}-fourier", heads, table))
            if self.to is not None and motion is not self.to:
                f, ratio = ratios_of(motion, self.to)
                heads = ["frequency [Hz]", *(f"ratio {a} [1]" for a in ratio)]
                table = np.column_stack([f, *ratio.values()]).tolist()
                paths.append(_write(folder, f"{motion.name}-over-{self.to.name}", heads, table))
        if self.yields:
            heads = ["history", "axis", "sense", *(f"slip at {y!r} m/s2 [m]" for y in self.yields)]
            rows = [[name, axis, sense, *slips] for name, axis, sense, slips in self.slips()]
            paths.append(_write(folder, "newmark", heads, rows))
        if self.peaks:
            count = max(len(peak.values()) for peak in self.peaks)
            heads = ["history", "nearest charge", *PEAK_HEADS[:count]]
            rows = [[p.name, p.hole, *p.values()] for p in self.peaks]
            rows = [row + [""] * (len(heads) - len(row)) for row in rows]
            paths.append(_write(folder, "ppv", heads, rows))
        return paths

    def draw(self, folder: Path) -> list[Path]:
        """Draw the motions; returns the pictures."""
        paths = []
        for motion in self.motions:
            parts = motion.parts.items()
            moved = {a: (p.times, p.acceleration / GRAVITY) for a, p in parts}
            spectra = {a: (PERIODS, s / GRAVITY) for a, s in motion.spectra().items()}
            f, amplitudes = amplitudes_of(motion)
            panels = [
                {"x": "time [s]", "y": "acceleration [g]", "log": False, "curves": moved},
                {"x": "period [s]", "y": "Sa, 5 % [g]", "log": True, "curves": spectra},
                {"x": "frequency [Hz]", "y": "Fourier amplitude [m/s]", "log": True,
                 "curves": {a: (f[1:], x[1:]) for a, x in amplitudes.items()}},
            ]  # fmt: skip
            if self.to is not None and motion is not self.to:
                f, ratio = ratios_of(motion, self.to)
                curves = {a: (f[1:], x[1:]) for a, x in ratio.items()}
                label = f"over {self.to.name}"
                panels.append({"x": "frequency [Hz]", "y": label, "log": True, "curves": curves})
            path = folder / FOLDER / f"{motion.name}.png"
            paths.append(draw_motion(path, motion.name, panels))
        return paths


def amplitudes_of(motion: Motion) -> tuple[Floats, dict[str, Floats]]:
    """Frequencies [Hz], and Fourier amplitude of the acceleration along each axis [m/s]."""
    found = {a: fourier_amplitude(p.acceleration, p.step) for a, p in motion.parts.items()}
    return next(iter(found.values()))[0], {a: amplitude for a, (_, amplitude) in found.items()}


def ratios_of(motion: Motion, other: Motion) -> tuple[Floats, dict[str, Floats]]:
    """Frequencies [Hz], and Fourier amplitude of a motion over that of another along common axes."""
    f, own = amplitudes_of(motion)
    _, of_other = amplitudes_of(other)
    ratios = {}
    for axis in own.keys() & of_other.keys():
        loud = of_other[axis] > SILENT * of_other[axis].max()
        ratios[axis] = np.full(len(f), np.nan)
        ratios[axis][loud] = own[axis][loud] / of_other[axis][loud]
    return f, dict(sorted(ratios.items()))


def measure(folder: Path, *, to: str | None, yields: Sequence[float], stage: str | None) -> Motions:
    """Measure the motions of a run.

    Args:
        folder: The result folder.
        to: History that spectral ratios refer to, or None.
        yields: Yield accelerations of Newmark's block [m/s2].
        stage: A dynamic stage; None for the last one.

    Raises:
        CdemError: There is no such stage or history, or none can be measured.
    """
    columns = read_histories(folder)
    stage, begin, end = _times(folder, stage)
    time = columns["time [s]"]
    rows = np.flatnonzero((time >= begin) & (time <= end))
    rows = rows[np.diff(time[rows], prepend=-np.inf) > 0]
    if len(rows) < LEAST_ROWS:
        raise CdemError(
            f"{folder}: the stage has {len(rows)} rows of histories, fewer than {LEAST_ROWS}; give "
            "histories a shorter time between rows (every)"
        )
    motions = _loud(list(_motions(columns, rows)))
    if not motions:
        raise CdemError(
            f"{folder}: no history has a velocity or an acceleration other than 0; add one to "
            "quantities in histories"
        )
    names = [motion.name for motion in motions]
    if to is not None and to not in names:
        close = difflib.get_close_matches(to, names, n=1)
        hint = f"did you mean {close[0]}?" if close else f"the run has: {', '.join(names)}"
        raise CaseError(f"--to {to}: no history of this name with a motion; {hint}")
    other = None if to is None else motions[names.index(to)]
    return Motions(motions, other, list(yields), blast_peaks(folder, columns, rows, stage))


def _loud(motions: list[Motion]) -> list[Motion]:
    """Motions without the axes along which next to nothing moves, compared with all others."""
    peaks = [largest(part.velocity) for motion in motions for part in motion.parts.values()]
    least = STILL * max(peaks, default=0.0)
    for motion in motions:
        motion.parts = {
            axis: part for axis, part in motion.parts.items() if largest(part.velocity) > least
        }
    return [motion for motion in motions if motion.parts]


def _times(folder: Path, stage: str | None) -> tuple[str, float, float]:
    """Name, begin and end of a dynamic stage [s]."""
    found = {s["name"]: s for s in read_summary(folder)["stages"] if s["mode"] == "dynamic"}
    if not found:
        raise CdemError(f"{folder}: no dynamic stage has ended; motions are those of such a stage")
    if stage is not None and stage not in found:
        raise CaseError(
            f"--stage {stage}: the run has ended these dynamic stages: {', '.join(found)}"
        )
    one = found[stage or list(found)[-1]]
    return one["name"], one["begin"], one["begin"] + one["time"]


def _motions(columns: dict[str, Floats], rows: NDArray[np.intp]) -> Iterable[Motion]:
    """Motions of the histories that have some, at even times."""
    found: dict[str, dict[str, dict[str, Floats]]] = {}
    for column, values in columns.items():
        match = COLUMN.fullmatch(column)
        if match:
            name, kind, axis = match[1] + (match[3] or ""), match[2] or "velocity", match[4]
            found.setdefault(name, {}).setdefault(axis, {})[kind] = values[rows]
    time = columns["time [s]"][rows]
    step = float(np.median(np.diff(time)))
    even = time[0] + step * np.arange(int((time[-1] - time[0]) / step * (1 + 1e-9)) + 1)
    for name, axes in found.items():
        yield Motion(name, {a: _processed(kinds, time, even) for a, kinds in sorted(axes.items())})


def _processed(kinds: dict[str, Floats], time: Floats, even: Floats) -> Processed:
    """A motion at even times: linear between rows; its acceleration is the mean between two."""
    step = float(even[1] - even[0])
    if "velocity" in kinds:
        velocity = np.interp(even, time, kinds["velocity"])
        acceleration = np.diff(velocity, prepend=velocity[0]) / step
    else:
        acceleration = np.interp(even, time, kinds["acceleration"])
        velocity = integral(acceleration, step)
    return Processed(step, acceleration, velocity, integral(velocity, step))


def accelerations(text: str | None) -> list[float]:
    """Yield accelerations [m/s2] of a text such as ``0.2g``, or ``0.1g..0.4g`` for several.

    Raises:
        CaseError: It is no such text.
    """
    if text is None:
        return []
    found = [re.fullmatch(r"\s*([0-9.]+)\s*g\s*", end) for end in text.split("..")]
    try:
        ends = [float(match[1]) * GRAVITY for match in found if match]
    except ValueError:
        ends = []
    if len(ends) != len(found) or not 1 <= len(ends) <= 2 or not 0 < ends[0] <= ends[-1]:
        raise CaseError(f"--yield {text}: write one acceleration, 0.2g, or a range, 0.1g..0.4g")
    return ends if len(ends) == 1 else np.linspace(ends[0], ends[1], YIELDS).tolist()


def _write(folder: Path, name: str, heads: list[str], rows: list[list]) -> Path:
    path = folder / FOLDER / f"{name}.csv"
    lines = [",".join(heads), *(",".join(map(_cell, one)) for one in rows), ""]
    write_text(path, "\n".join(lines))
    return path


def _cell(value: object) -> str:
    """A cell of a table; text with a comma in quotes."""
    text = f"{value:.9g}" if isinstance(value, float) else str(value)
    return f'"{text}"' if "," in text else text
