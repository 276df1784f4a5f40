"""The picture of an outcrop: its points in the colours of the sets of their facets."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.joints.survey import plane_text
from cdem.outcrop.survey import OutcropSurvey
from cdem.output.figures import pyplot

Floats = NDArray[np.float64]

MOST_POINTS = 300_000
"""Most points to draw; of more, evenly chosen ones are drawn."""
PLUNGE = 20.0
"""Downward view [deg]."""
WIDTH, TALLEST = 9.0, 10.0
"""Largest size of the outcrop in the picture [inch]."""
WIDER = 1.45
"""Diameter of a dot, as a multiple of the resolution: dots cover the faces behind them."""


def draw(outcrop: OutcropSurvey, path: Path) -> Path:
    """Draw the facets on the cloud, seen from the side from which most of it can be seen.

    Raises:
        CdemError: matplotlib is not installed.
    """
    plt = pyplot()
    found = outcrop.found
    every = max(1, len(found.points) // MOST_POINTS)
    frame = view_of(outcrop)
    flat = found.points[::every] @ frame.T
    colors = _colors(outcrop, frame)[::every]
    low, high = flat.min(axis=0), flat.max(axis=0)
    wide, tall = np.maximum(high - low, 1e-9)[:2]
    scale = min(WIDTH / wide, TALLEST / tall)
    figure, axes = plt.subplots(figsize=(max(5.0, scale * wide + 0.4), scale * tall + 1.2))
    order = np.argsort(flat[:, 2])  # the nearest last
    dot = 72 * scale * found.resolution * WIDER * float(np.sqrt(every))
    axes.scatter(*flat[order, :2].T, c=colors[order], s=max(dot**2, 0.4), lw=0, rasterized=True)
    axes.set_aspect("equal")
    axes.set_axis_off()
    _bar(axes, low, high)
    for k, e in enumerate(outcrop.exposures):
        s = outcrop.survey.fit.sets[k]
        label = f"{e.name}  {plane_text(s.dip, s.dip_direction)}, {e.facets} facets"
        axes.plot([], [], "s", color=f"C{k}", label=label)
    if (outcrop.set_of < 0).any():
        axes.plot([], [], "s", color="0.55", label="facets of no set")
    axes.plot([], [], "s", color="0.85", label="no facet")
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=3)
    azimuth = np.degrees(np.arctan2(-frame[2, 0], -frame[2, 1])) % 360
    axes.set_title(f"{outcrop.survey.source}: view towards {azimuth:03.0f}", fontsize=10)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a layout for a flat outcrop
        figure.savefig(path, dpi=110, bbox_inches="tight")
    plt.close(figure)
    return path


def view_of(outcrop: OutcropSurvey) -> Floats:
    """Axes of the picture as rows: to the right, up, and towards the eye.

    The eye looks a little down, from the side to which the surface of the cloud leans: its higher
    parts lie farther back. A face without a lean is seen from the south or west.
    """
    x = outcrop.found.points
    away = x[:: max(1, len(x) // MOST_POINTS)] - x.mean(axis=0)
    cov = away.T @ away
    across = np.linalg.eigh(cov[:2, :2])[1][:, 0]  # the thin side in plan
    lean = cov[:2, 2] @ across
    if abs(lean) < 0.05 * cov[2, 2]:
        lean = 1.0 if across @ [0.6, 0.8] > 0 else -1.0
    to_eye = -across * np.sign(lean)
    right = np.array([-to_eye[1], to_eye[0], 0.0])
    plunge = np.radians(PLUNGE)
    eye = np.array([*(np.cos(plunge) * to_eye), np.sin(plunge)])
    return np.array([right, np.cross(eye, right), eye])


def _colors(outcrop: OutcropSurvey, frame: Floats) -> Floats:
    """Red, green, blue of each point: its set, lighter where its facet faces the light."""
    from matplotlib.colors import to_rgb

    out = np.full((len(outcrop.found.points), 3), 0.85)
    light = np.array([-0.4, 0.6, 0.7]) @ frame
    facets = outcrop.found.facets
    for k, members in enumerate(facets.members):
        color = to_rgb("0.55") if outcrop.set_of[k] < 0 else to_rgb(f"C{outcrop.set_of[k]}")
        normal = facets.normals[k] * (1 if facets.normals[k] @ frame[2] >= 0 else -1)
        bright = 0.72 + 0.38 * max(0.0, float(normal @ light) / float(np.linalg.norm(light)))
        out[members] = np.minimum(1.0, np.array(color) * bright + max(0.0, bright - 0.85) * 0.5)
    return out


def _bar(axes: Any, low: Floats, high: Floats) -> None:
    """A scale of a round length below the outcrop."""
    wide = high[0] - low[0]
    power = 10.0 ** np.floor(np.log10(max(wide / 4, 1e-9)))
    length = power * max(m for m in (1, 2, 5) if m * power <= wide / 4)
    y = low[1] - 0.03 * (high[1] - low[1])
    axes.plot([low[0], low[0] + length], [y, y], color="black", lw=2, solid_capstyle="butt")
    place = (low[0] + length / 2, y)
    style = {"xytext": (0, -4), "textcoords": "offset points", "ha": "center", "va": "top"}
    axes.annotate(f"{length:g} m", place, fontsize=8, **style)
