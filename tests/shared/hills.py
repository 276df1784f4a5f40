"""A hill whose bodies are known: the frustum of a pyramid, and tetrahedra in its faces."""

from itertools import combinations

import numpy as np

from cdem.joints.directions import pole
from cdem.screening.bodies import Ground
from cdem.screening.planes import JointPlane
from cdem.terrain.heights import Grid

HEIGHT, TOP, SLOPE, FOOT = 60.0, 60.0, 65.0, 200.0  # [m] [m] [deg] [m]
HALF = TOP + HEIGHT / np.tan(np.radians(SLOPE))  # half the side of the foot [m]


def frustum(cell, slope=SLOPE):
    """Heights [m] of the hill and 20 m of flat ground around it."""
    half = TOP + HEIGHT / np.tan(np.radians(slope))
    count = round(2 * (half + 20) / cell) + 1
    x = (np.arange(count) - (count - 1) / 2) * cell
    away = np.maximum(np.abs(x[None]), np.abs(x[:, None]))
    rise = (half - away) * np.tan(np.radians(slope))
    return Grid(x[0], x[0], (cell, cell), FOOT + np.clip(rise, 0, HEIGHT))


def joint(name, dip, direction, friction, cohesion=0.0):
    """A set of joints; cohesion in [Pa]."""
    return JointPlane(name, pole(dip, direction), friction, cohesion)


def place_on_face(ground: Ground, toward):
    """The cell a third of the way up the middle of a face, and its point on the face itself."""
    away = (HALF - HEIGHT / 3 / np.tan(np.radians(SLOPE))) * np.array(toward, float)
    j = int(np.abs(ground.x - away[0]).argmin())
    i = int(np.abs(ground.y - away[1]).argmin())
    return (i, j), ground.point(i, j)


def tetrahedron(planes, point, toward):
    """Volume, areas of two planes, and corners of the body between them, a face and the top."""
    face = np.array([*(np.array(toward) * np.sin(np.radians(SLOPE))), np.cos(np.radians(SLOPE))])
    four = [(plane.normal, plane.normal @ point) for plane in planes]
    four += [(face, face @ point), (np.array([0, 0, 1.0]), FOOT + HEIGHT)]
    corners = {
        three: np.linalg.solve([four[k][0] for k in three], [four[k][1] for k in three])
        for three in combinations(range(4), 3)
    }
    points = np.array(list(corners.values()))
    volume = abs(np.linalg.det(points[1:] - points[0])) / 6
    areas = []
    for k in (0, 1):
        a, b, c = (p for three, p in corners.items() if k in three)
        areas.append(np.linalg.norm(np.cross(b - a, c - a)) / 2)
    return volume, areas, points


def on_ground(points):
    """Distance in height of points from the hill [m]."""
    away = np.maximum(np.abs(points[:, 0]), np.abs(points[:, 1]))
    rise = (HALF - away) * np.tan(np.radians(SLOPE))
    return points[:, 2] - FOOT - np.clip(rise, 0, HEIGHT)
