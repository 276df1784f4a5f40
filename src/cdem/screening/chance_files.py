"""Files of the probability of failure: table of samples, map, tornado."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from cdem.output.figures import pyplot
from cdem.screening.fos_map import FosMap
from cdem.screening.probability import Probability
from cdem.screening.products import Map, Style, draw_maps
from cdem.study.plots import draw_bars, mark_correlations
from cdem.whole_files import write_text

STYLE = Style((0.0, 0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0), "YlOrRd", "probability of F < 1")


def map_of(chance: Probability) -> Map:
    """The map of the probability."""
    return ("fos_probability", chance.map, "share of samples in which a body has F < 1", "1")


def write_samples(chance: Probability, path: Path) -> Path:
    """Write drawn values and results of each sample as CSV; returns its path."""
    out = io.StringIO()
    rows = csv.writer(out, lineterminator="\n")
    names = [chance.uncertain.label(name) for name in chance.columns]
    rows.writerow(["sample", *names, "lowest_fos", "unstable_share", "worst_fos"])
    columns = [*chance.columns.values(), chance.lowest, chance.unstable, chance.worst]
    for number, values in enumerate(zip(*(c.tolist() for c in columns), strict=True), 1):
        rows.writerow([number, *(f"{value:.9g}" if np.isfinite(value) else "" for value in values)])
    write_text(path, out.getvalue())
    return path


def draw_chance(found: FosMap, chance: Probability, folder: Path) -> list[Path]:
    """Draw the map of the probability, and a tornado of its influences; returns their paths.

    Raises:
        CdemError: matplotlib is not installed.
    """
    title = f"bodies between joints, {chance.count:,} samples"
    paths = [draw_maps(found, [(title, chance.map)], folder / "probability.png", STYLE)]
    name = chance.target[0]
    bars = {
        chance.uncertain.label(key): (0.0, value)
        for key, value in chance.influence().items()
        if np.isfinite(value)
    }
    if bars:
        plt = pyplot()
        figure, axes = plt.subplots(figsize=(7.0, 1.4 + 0.4 * len(bars)))
        draw_bars(axes, bars)
        mark_correlations(axes, name)
        figure.tight_layout()
        paths.append(folder / "tornado.png")
        figure.savefig(paths[-1])
        plt.close(figure)
    return paths
