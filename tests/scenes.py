"""Small scenes that several tests share, built as cases the way a user would."""

from __future__ import annotations

import hashlib

import meshio
import numpy as np

import cdem
from cdem.mesh import primitives

ROCK = {"density": 2500, "young_modulus": "10 GPa", "poisson_ratio": 0.25}
PLAIN = {
    "interface": {"stiffness_n": "10 E/h", "stiffness_s": "10 E/h"},
    "elements": {"mass": "exact"},
    "static": {"relax": "local"},
    "dynamic": {"damping": {"contact": 0}},
    "tet4": {"cells": "alike"},
}
"""What closed forms need: exact masses, no stiffness that is made up for, no damping, equal cells."""


def turn(axis, degrees):
    """Rotation matrix, right-handed."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    a = np.radians(degrees)
    return np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * k @ k


def plain(data):
    """The data of a case with what `PLAIN` has where they say nothing."""

    def stage(entry):
        own = PLAIN[entry["mode"]]
        damping = own.get("damping", {}) | entry.get("damping", {})
        return own | entry | ({"damping": damping} if damping else {})

    def block(entry):
        box = entry.get("box")
        return entry | ({"box": PLAIN.get(box.get("shape"), {}) | box} if box else {})

    faces, blocks = data.get("interfaces", {}), data["model"].get("blocks", [])
    if "default" in faces:  # from which pairs take what they leave out
        faces = faces | {"default": PLAIN["interface"] | faces["default"]}
    else:
        faces = faces | {"pairs": [PLAIN["interface"] | pair for pair in faces.get("pairs", [])]}
    return data | {
        "model": data["model"] | {"blocks": [block(entry) for entry in blocks]},
        "interfaces": faces,
        "elements": PLAIN["elements"] | data.get("elements", {}),
        "stages": [stage(entry) for entry in data["stages"]],
    }


def case(blocks, groups, *, interfaces=None, rock=None, stages=None, defaults=False, **more):
    """A case of blocks in groups of one rock; a dynamic stage of 1 s unless told otherwise.

    It is plain (`PLAIN`), or has the defaults of the program.
    """
    data = {
        "model": {"blocks": blocks, **more.pop("model", {})},
        "materials": {"rock": ROCK | (rock or {}), **more.pop("materials", {})},
        "groups": {name: {"material": "rock", **entry} for name, entry in groups.items()},
        "interfaces": interfaces or {"default": {"friction_angle": 0}},
        "stages": stages or [{"name": "run", "mode": "dynamic", "duration": 1.0}],
        **more,
    }
    return cdem.Case.from_dict(data if defaults else plain(data))


def simulate(blocks, groups, **more):
    """A simulation on one thread, its first stage's damping set, ready to step."""
    return cdem.Simulation(case(blocks, groups, **more), threads=1)


def irregular_tets(path, size, divisions):
    """Write a box of tets whose inner points are shaken by almost half a cell; group "default"."""
    box = primitives.box("default", size, divisions, shape="tet4")
    points, cell = box.points, np.divide(size, divisions)
    inner = (points > 1e-9) & (points < np.asarray(size) - 1e-9)
    rng = np.random.default_rng(1)
    points = points + inner * rng.uniform(-0.25, 0.25, points.shape) * cell
    meshio.write_points_cells(path, points, [("tetra", box.cells["tet4"])], file_format="vtk")
    return {"mesh": str(path)}


def _cube(kind):
    """Corners of a cube of 0.6 m with a face, an edge or a vertex lowest, at height 0."""
    tip = np.degrees(np.arctan(np.sqrt(2)))
    turned = {
        "face": np.eye(3),
        "edge": turn([0, 1, 0], 45),
        "vertex": turn([0, 1, 0], tip) @ turn([0, 0, 1], 45),
    }[kind]
    corners = 0.6 * (np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T - 0.5)
    corners = corners @ turned.T
    corners[:, 2] -= corners[:, 2].min()
    return corners


def meeting_cubes(lower, upper, gap=0.0):
    """Two cubes that meet at the origin: the lower's topmost and the upper's lowest feature.

    Either feature is "face", "edge" or "vertex"; groups "lower" and "upper", a gap [m] apart.
    """
    below = _cube(lower) * [1, 1, -1]
    if lower == "edge":
        below = below @ turn([0, 0, 1], 90).T  # edges cross instead of lying along each other
    return [
        {"group": "lower", "polyhedron": {"vertices": below.tolist()}},
        {"group": "upper", "polyhedron": {"vertices": (_cube(upper) + [0, 0, gap]).tolist()}},
    ]


def momentum(sim):
    """Linear and angular momentum with the mass matrices that the core uses."""
    arrays, motion = sim.build.arrays, sim.fields
    v, x = motion["velocity"], motion["position"]
    p = arrays["node.mass"][:, None] * v
    for i in np.flatnonzero(arrays["node.mass_row_first"] >= 0):
        first, count = arrays["node.block_first"][i], arrays["node.block_count"][i]
        row = arrays["node.mass_row_first"][i]
        matrix = arrays["node.mass"][i] * arrays["mass.matrix"][row : row + count]
        p[i] = matrix @ v[first : first + count]
    return p.sum(axis=0), np.cross(x, p).sum(axis=0)


def mean_velocity(sim, group):
    """Velocity of a group's mass centre [m/s]."""
    nodes, fields = sim.build.nodes_of(group), sim.fields
    mass = fields["mass"][nodes]
    return mass @ fields["velocity"][nodes] / mass.sum()


def digest(sim):
    """Hash of everything that a checkpoint keeps."""
    whole = hashlib.sha256()
    for name, values in sorted(sim.core.fields().items()):
        whole.update(name.encode())
        whole.update(np.ascontiguousarray(values).tobytes())
    return whole.hexdigest()
