"""How well a run agrees with monitored displacements."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.fit.monitored import COMPONENTS, Monitored
from cdem.fit.sampled import Sampled

Floats = NDArray[np.float64]

FAR = 0.05
"""A point farther from the rock than this share of the size of all points is told."""
WORDS = {"dx": "east", "dy": "north", "dz": "up", "los": "line of sight"}


@dataclass
class Agreement:
    """A comparison.

    Attributes:
        monitored: Displacements that are compared.
        computed: The same of the run [m], shape (rows, 4).
        notes: Messages for the user.
    """

    monitored: Monitored
    computed: Floats
    notes: list[str]

    @property
    def residual(self) -> Floats:
        """Computed less monitored [m], shape (rows, 4); nan where not monitored."""
        return self.computed - self.monitored.moved

    def scores(self) -> dict[str, dict[str, float]]:
        """Measures of the agreement, for each component and for all together.

        - count: numbers that are compared; bias: mean residual [m]; rms: root mean square of the
          residuals [m]; rms_less_bias: the same without their mean; rms_monitored: of the monitored
          displacements;
        - factor: by which the computed displacements fit best; correlation: of Pearson;
        - skill: 1 less the sum of squared residuals over that of the monitored displacements: 1 for
          equal ones, 0 for a run that does not move;
        - chi2: mean square of the residuals over their deviations, where these are known.
        """
        found = {}
        for k, key in enumerate(COMPONENTS):
            if np.isfinite(self.monitored.moved[:, k]).any():
                found[key] = self._score([k])
        if len(found) > 1:
            found["all"] = self._score([COMPONENTS.index(key) for key in found])
        return found

    def _score(self, columns: list[int]) -> dict[str, float]:
        seen = self.monitored.moved[:, columns].ravel()
        computed, deviation = (
            one[:, columns].ravel() for one in (self.computed, self.monitored.deviation)
        )
        known = np.isfinite(seen) & np.isfinite(computed)
        seen, computed, deviation = seen[known], computed[known], deviation[known]
        residual = computed - seen
        with np.errstate(divide="ignore", invalid="ignore"):
            spread = seen.std() * computed.std()
            cross = ((seen - seen.mean()) * (computed - computed.mean())).mean()
            weighed = residual / deviation
            return {
                "count": int(known.sum()),
                "bias": float(residual.mean()),
                "rms": _rms(residual),
                "rms_less_bias": float(residual.std()),
                "rms_monitored": _rms(seen),
                "factor": float(np.float64(seen @ computed) / (computed @ computed)),
                "correlation": float(np.float64(cross) / spread),
                "skill": float(1 - np.float64(residual @ residual) / (seen @ seen)),
                "chi2": float((weighed**2).mean()),
            }

    def as_dict(self) -> dict[str, Any]:
        """Scores and notes, ready for JSON; nan is None."""
        scores = {
            key: {n: None if np.isnan(v) or np.isinf(v) else v for n, v in one.items()}
            for key, one in self.scores().items()
        }
        return {"monitored": str(self.monitored.path), "scores": scores, "notes": self.notes}

    def text(self) -> str:
        """The scores as text."""
        lines = [f"note: {note}" for note in self.notes]
        lines.append(
            "                  count    monitored     residual: mean          rms   skill  factor  "
            "correlation"
        )
        for key, s in self.scores().items():
            lines.append(
                f"  {WORDS.get(key, key):<14} {s['count']:6}  {s['rms_monitored']:9.4g} m  "
                f"{s['bias']:13.4g} m  {s['rms']:9.4g} m  {s['skill']:6.3f}  {s['factor']:6.3f}  "
                f"{s['correlation']:11.3f}"
            )
            if np.isfinite(s["chi2"]):
                lines.append(
                    f"                 mean squared residual over its variance: {s['chi2']:.3g} "
                    "(1: within the errors of measurement)"
                )
        return "\n".join(lines)


def compare(folder: Path, monitored: Monitored, los: Floats | None = None) -> Agreement:
    """Compare a run with monitored displacements.

    Args:
        folder: Result folder.
        monitored: The displacements.
        los: Unit vector from the ground to the satellite, east, north, up; None without any.

    Raises:
        CdemError: There is nothing to compare; gives the reason.
    """
    needs = np.isfinite(monitored.moved[:, 3]).any()
    if needs and los is None:
        raise CdemError(
            f"{monitored.path}: displacements along a line of sight need its direction, --los "
            "EAST,NORTH,UP from the ground to the satellite, e.g. --los 0.61,-0.11,0.78"
        )
    if los is not None and not needs:
        raise CdemError(f"{monitored.path}: has no displacements along a line of sight; no --los")
    sampled = Sampled(folder, monitored.at)
    notes = list(monitored.notes)
    here = np.isfinite(sampled.distance)
    _tell(notes, int((~here).sum()), "lie outside of the model in plan")
    end = float(sampled.times[-1])
    late = (monitored.time < 0) | (monitored.time > end * (1 + 1e-9))
    _tell(notes, int(late.sum()), f"have times outside of the run, 0 to {end:.6g} s")
    used = here & ~late
    if not used.any():
        raise CdemError(f"{monitored.path}: nothing to compare with {folder}: {'; '.join(notes)}")
    size = float(np.linalg.norm(np.ptp(monitored.at[used][:, :2], axis=0)))
    far = used & (sampled.distance > FAR * size) & (size > 0)
    if far.any():
        worst = int(np.argmax(np.where(far, sampled.distance, 0)))
        notes.append(
            f"{int(far.sum())} points lie off the rock of the model, {monitored.names[worst]} by "
            f"{sampled.distance[worst]:.3g} m; the nearest rock counts"
        )
    moved = sampled.at(monitored.time)
    along = moved @ los if los is not None else np.full(len(moved), np.nan)
    computed = np.column_stack([moved, along])
    return Agreement(monitored.only(used), computed[used], notes)


def _rms(values: Floats) -> float:
    return float(np.sqrt((values**2).mean()))


def _tell(notes: list[str], count: int, why: str) -> None:
    if count:
        notes.append(f"{count} rows {why}, and are left out")
