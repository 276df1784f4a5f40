"""Peak velocities of points over their distances from the charges of blasts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdem.case.reader import load_case_data
from cdem.mesh.arrays import lengths
from cdem.output.reader import read_summary

Floats = NDArray[np.float64]
HEADS = ("distance [m]", "PPV [m/s]", "charge [kg]", "R/sqrt(Q) [m/kg^0.5]")


@dataclass(frozen=True)
class Peak:
    """Largest velocity of a point, and the nearest charge.

    Attributes:
        name: Of the history.
        hole: Of the charge.
        distance: From the charge [m].
        ppv: Largest length of the velocity [m/s].
        charge: Mass of the explosive, or None [kg].
    """

    name: str
    hole: str
    distance: float
    ppv: float
    charge: float | None

    def values(self) -> list[float]:
        """Values of `HEADS`; without a mass only the first two."""
        known = [self.distance, self.ppv]
        if self.charge is not None:
            known += [self.charge, self.distance / self.charge**0.5]
        return known


def blast_peaks(
    folder: Path, columns: Mapping[str, Floats], rows: NDArray[np.intp], stage: str
) -> list[Peak]:
    """Peaks of all points with velocity in a stage, the nearest first; none without a blast in it.

    Args:
        folder: The result folder.
        columns: Of its histories.
        rows: Rows of the stage.
        stage: Its name.
    """
    charges = [c for c in read_summary(folder).get("charges", []) if c["stage"] == stage]
    if not charges:
        return []
    case, _ = load_case_data(folder / "case.yaml")  # as data: its mesh may be missing
    found = []
    for entry in case["histories"]:
        names = [f"{entry['name']}.velocity_{axis} [m/s]" for axis in "xyz"]
        if entry.get("point") is None or names[0] not in columns:
            continue
        velocity = np.column_stack([columns[name][rows] for name in names])
        away = [distance(entry["point"], charge) for charge in charges]
        near = charges[int(np.argmin(away))]
        ppv = float(lengths(velocity).max())
        found.append(Peak(entry["name"], near["hole"], min(away), ppv, near["mass"]))
    return sorted(found, key=lambda peak: peak.distance)


def distance(point: ArrayLike, charge: Mapping[str, Any]) -> float:
    """Distance of a point from the line between the ends of a charge [m]."""
    low, high = np.array(charge["ends"], float)
    x, along = np.asarray(point, float) - low, high - low
    part = np.clip(x @ along / (along @ along), 0, 1) if along.any() else 0.0
    return float(np.linalg.norm(x - part * along))


def peak_lines(peaks: list[Peak]) -> list[str]:
    """The peaks as text."""
    if not peaks:
        return []
    count = max(len(peak.values()) for peak in peaks)
    heads = "".join(f"{head:>{len(head) + 2}}" for head in HEADS[:count])
    lines = ["", f"{'':<20}{heads}  nearest charge"]
    for peak in peaks:
        values = peak.values()
        cells = [f"{x:.4g}" for x in values] + [""] * (count - len(values))
        numbers = "".join(f"{x:>{len(h) + 2}}" for h, x in zip(HEADS, cells, strict=False))
        lines.append(f"{peak.name:<20}{numbers}  {peak.hole}")
    return lines
