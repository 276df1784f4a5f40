"""A small surface that moves: faces come, go, and come again."""

from __future__ import annotations

import numpy as np

from cdem.output.reader import Surface

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [0, 1, 2.0]])
POLYGONS = {7: [0, 1, 2, 3], 3: [0, 1, 4, -1], 9: [3, 4, 5, -1]}
"""By number of the face: numbers of its nodes; the first is a quadrilateral."""
SHOWN = [[7, 3], [7, 3, 9], [7, 9], [7, 9, 3]]
"""Faces of each frame."""


def place(frame: int) -> np.ndarray:
    """Positions of the nodes in a frame [m]."""
    return CORNERS * (1 + 0.1 * frame) + [2.0 * frame**2, 0, -frame]


def surface(frame: int) -> Surface:
    """The surface in a frame; element 10 + k has the k-th face."""
    faces = SHOWN[frame]
    numbers = np.array([POLYGONS[f] for f in faces])
    used = np.unique(numbers[numbers >= 0])
    polygons = np.where(numbers < 0, -1, np.searchsorted(used, numbers))
    element = 10 + np.array([list(POLYGONS).index(f) for f in faces])
    return Surface(
        0.5 * frame,
        place(frame)[used],
        polygons,
        {"node": used, "displacement": (place(frame) - place(0))[used]},
        {"face": np.array(faces), "element": element, "block": element - 10, "piece": element,
         "group": (element == 12).astype(int), "joint": np.zeros(len(faces), int),
         "damage": (element - 10) / 2.0},
        ["bed", "body"],
    )  # fmt: skip
