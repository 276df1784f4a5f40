"""The grain-size curve of the pieces at the end."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

QUANTILES = (10, 50, 90)
COLUMNS = {"diameter": "m", "passing": "%"}
"""Columns of grain_sizes.csv with their units."""


@dataclass
class GrainSizes:
    """Fraction of the volume in pieces up to a diameter.

    Attributes:
        diameter: Diameter of a sphere of the volume of each piece, in increasing order [m].
        passing: Fraction of the volume in pieces up to it [%].
        elements: The same curve for the elements, diameters and passing: pieces cannot be finer.
    """

    diameter: Floats
    passing: Floats
    elements: tuple[Floats, Floats]

    @classmethod
    def of(cls, pieces: Floats, elements: Floats) -> GrainSizes:
        """From the volumes of pieces and of elements [m3]."""
        return cls(*_curve(pieces), _curve(elements))

    @property
    def element(self) -> float:
        """Diameter of a sphere with the volume of the median element [m]."""
        return float(np.median(self.elements[0]))

    def size(self, percent: float) -> float:
        """Diameter at which the passing volume reaches this percentage [m]."""
        number = int(np.searchsorted(self.passing, percent * (1 - 1e-12)))
        return float(self.diameter[min(number, len(self.diameter) - 1)])

    @property
    def sizes(self) -> dict[str, float]:
        """d10, d50 and d90 [m]."""
        return {f"d{q}": self.size(q) for q in QUANTILES}

    def columns(self) -> dict[str, Floats]:
        """Columns `COLUMNS`."""
        return {"diameter": self.diameter, "passing": self.passing}

    def draw(self, folder: Path, plt: Any) -> Path:
        """Draw grain_sizes.png with a pyplot."""
        figure, axes = plt.subplots(figsize=(6.4, 3.8))
        axes.semilogx(*_steps(*self.elements), color="0.6", lw=1, label="elements: none finer")
        axes.semilogx(*_steps(self.diameter, self.passing), lw=1.6, label="pieces")
        for name, size in self.sizes.items():
            axes.plot(size, float(name[1:]), "C3o", ms=4)
            axes.annotate(f" {name} = {size:.3g} m", (size, float(name[1:])), va="top", fontsize=8)
        axes.set(
            xlabel="diameter of a sphere of the same volume [m]", ylabel="passing [% of volume]"
        )
        axes.set(ylim=(0, 100))
        for each in (axes.xaxis.set_major_formatter, axes.xaxis.set_minor_formatter):
            each(lambda size, _: f"{size:g}")
        axes.grid(which="both", color="0.9", lw=0.6)
        axes.legend(frameon=False, fontsize=8, loc="upper left")
        path = folder / "grain_sizes.png"
        figure.savefig(path, bbox_inches="tight")
        plt.close(figure)
        return path


def _curve(volume: Floats) -> tuple[Floats, Floats]:
    """Diameters in increasing order [m], and the fraction of the volume up to each [%]."""
    volume = np.sort(volume)
    return np.cbrt(6 * volume / np.pi), 100 * np.cumsum(volume) / volume.sum()


def _steps(diameter: Floats, passing: Floats) -> tuple[Floats, Floats]:
    """The curve as a line that rises at each diameter."""
    return np.repeat(diameter, 2), np.append(0.0, np.repeat(passing, 2)[:-1])
