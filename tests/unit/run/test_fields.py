"""Fields of a run: pieces, and the surface with its sets of joints."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import simulate
from shared.joints import SETS, jointed_case

import cdem
from cdem.joints import joints
from cdem.output.render import snapshot
from cdem.run.fields import pieces_of


@pytest.mark.parametrize(("kind", "divisions"), [("quads", [1, 1, 1]), ("overlaps", [2, 1, 1])])
def test_blocks_hang_together_by_one_point(kind, divisions):
    upper = {"size": [2, 1, 1], "divisions": divisions}
    blocks = [
        {"group": "a", "box": {"size": [2, 1, 1]}},
        {"group": "b", "box": upper, "translate": [0, 0, 1]},
    ]
    bond = {"friction_angle": 0, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
    sim = simulate(blocks, {"a": {}, "b": {}}, interfaces={"default": bond})
    bonds = sim.core.fields()[f"{kind}.bond"]
    first = bonds[:1].copy()
    bonds[:] = 0
    assert len(set(pieces_of(sim))) == 2
    bonds[:1] = first
    assert len(set(pieces_of(sim))) == 1


def test_surfaces_that_are_drawn_know_the_set():
    sim = cdem.Simulation(jointed_case({"model.joints": SETS}), threads=1)
    surface = snapshot(sim)
    faces = surface.faces.reshape(-1, 4)[:, 1:]
    for number, joint in enumerate(SETS, start=1):
        x = surface.points[faces[surface.cell_data["joint"] == number]]
        normal = joint.get("normal") or joints.pole(joint["dip"], joint["dip_direction"])
        along = (x - joint["origin"]) @ normal / np.linalg.norm(normal) / joint["spacing"]
        assert len(x) > 10 and np.abs(along - np.round(along)).max() < 1e-9
    assert set(surface.cell_data["joint"]) == {0, 1, 2, 3}
