"""Planes, contours and a slab on a slope that tests of the terrain share."""

import math

import numpy as np

from cdem.terrain.heights import Plane

PLANE = Plane(dip=25.0, dip_direction=200.0, through=(10.0, -5.0, 120.0))


SOMEWHERE = np.random.default_rng(1).uniform([-40, -30], [70, 60], (200, 2))


SQUARE = [[30, 30], [70, 30], [70, 70], [30, 70]]


def contours_of(plane, spacing=10.0):
    """Contour lines of a plane, cut off by a disc."""
    fall = math.tan(math.radians(plane.dip))
    azimuth = math.radians(plane.dip_direction)
    down = np.array([math.sin(azimuth), math.cos(azimuth)])
    across = np.array([-down[1], down[0]])
    lines = []
    for z in np.arange(60, 181, spacing):
        start = np.array(plane.through[:2]) + down * (plane.through[2] - z) / fall
        lines.append([(start + across * s).tolist() for s in (-120, -30, 40, 120)])
    return lines, np.arange(60, 181, spacing)


def slope(**changes):
    """A slab 10 m thick on a slope of 30 deg to the east."""
    data = {
        "terrain": {"plane": {"dip": 30, "dip_direction": 90, "through": [0, 0, 100]}},
        "extent": {"x": [0, 100], "y": [0, 100], "base": 0},
        "surface": {"plane": {"dip": 30, "dip_direction": 90, "through": [0, 0, 90]}},
        "bodies": [{"group": "slab", "outline": SQUARE}],
        "sizes": {"body": 10, "far": 40},
    }
    return data | changes
