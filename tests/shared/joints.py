"""Sets of joints and a jointed case that several tests share."""

import numpy as np

import cdem
from cdem.case.bodies_schema import Model
from cdem.joints.directions import fisher, pole
from cdem.mesh.blocks import build_topology


def model_of(sets, **more):
    """The model part of a case with joints."""
    return Model.model_validate({"mesh": "any", "joints": sets, **more})


SETS = [
    {"name": "a", "dip": 30, "dip_direction": 100, "spacing": 2, "origin": [5, 5, 5]},
    {"name": "b", "dip": 75, "dip_direction": 20, "spacing": 3, "origin": [5, 5, 5]},
    {"name": "c", "normal": [1, 0.1, 0.2], "spacing": 2.5, "origin": [5, 5, 5]},
]


def block_volumes(made, sets):
    """Topology of a mesh, and volume of each of its blocks [m3]."""
    t = build_topology(made, {}, [s["name"] for s in sets])
    x = t.node_position[t.element_nodes["tet4"]]
    return t, np.bincount(t.element_block["tet4"], np.linalg.det(x[:, 1:] - x[:, :1]) / 6)


def jointed_case(changes):
    """A cube of 10 m; values at two-part paths are replaced."""
    data = {
        "model": {"blocks": [{"group": "rock", "box": {"size": [10, 10, 10]}}]},
        "materials": {"m": {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.2}},
        "groups": {"rock": {"material": "m"}},
        "interfaces": {"default": {"friction_angle": 30}},
        "stages": [{"name": "run", "mode": "dynamic", "duration": 1}],
    }
    for path, value in changes.items():
        part, key = path.split(".")
        data[part][key] = value
    return cdem.Case.from_dict(data)


def drawn_joints(sets, uniform=0, seed=4):
    """Unit normals of joints drawn from Fisher sets, and of some without any order.

    Args:
        sets: Dip, dip direction [deg], kappa and number of joints of each.
        uniform: Number of joints without order.
        seed: Another one draws others.
    """
    random = np.random.default_rng(seed)
    drawn = [
        fisher(pole(dip, direction), kappa, random)
        for dip, direction, kappa, count in sets
        for _ in range(count)
    ]
    others = random.normal(size=(uniform, 3))
    others /= np.linalg.norm(others, axis=1)[:, None]
    return np.concatenate([np.array(drawn).reshape(-1, 3), others])
