"""Pair lists hold what touches: all pairs found in contact, inner list and outer list, each in the next."""

from itertools import combinations_with_replacement

import numpy as np
import pytest
from scenes import simulate

from cdem.rows import rows_of

SHAPES = ("tet4", "pyramid5", "wedge6", "hex8")
DIVISIONS = {"tet4": [1, 1, 2], "pyramid5": [1, 1, 1], "wedge6": [1, 1, 2], "hex8": [2, 2, 1]}
STEPS = 300
EVERY = 6
"""Steps between two looks at the lists; the all-pairs search looks at every step."""


def tumbling(shapes, seed):
    """Two bodies of loose elements fly into each other above a bed, turning; every search is checked."""
    rng = np.random.default_rng(seed)
    bed = {"size": [6, 6, 1], "divisions": [3, 3, 1]}
    blocks = [{"group": "bed", "box": bed, "translate": [-3, -3, -1]}]
    groups = {"bed": {"fix": ["x", "y", "z"]}}
    for name, side, shape in zip(("left", "right"), (-1, 1), shapes, strict=True):
        axis = rng.normal(size=3)
        blocks.append(
            {
                "group": name,
                "box": {"size": [1, 1, 1], "divisions": DIVISIONS[shape], "shape": shape},
                "rotate": {"axis": list(axis / np.linalg.norm(axis)), "angle": rng.uniform(0, 1)},
                "translate": [0.7 * side - 0.5, rng.uniform(-0.7, -0.3), 0.45],
            }
        )
        groups[name] = {
            "velocity": [-side * rng.uniform(4, 8), rng.normal(0, 1), -3],
            "angular_velocity": list(rng.normal(0, 3, 3)),
        }
    stage = {"name": "tumble", "mode": "dynamic", "duration": 10, "damping": {"contact": 0.1}}
    return simulate(
        blocks,
        groups,
        rock={"young_modulus": "5 MPa"},
        interfaces={"default": {"friction_angle": 20}},
        model={"split": {"left": "elements", "right": "elements"}},
        loads={"gravity": [0, 0, -9.81]},
        contact={"check": True},
        stages=[stage],
    )


def pairs(a, b):
    """Pairs of two arrays' items, as a set."""
    return set(zip(a.tolist(), b.tolist(), strict=True))


def ragged(first, items):
    """Pairs (row, item) of a ragged list."""
    return pairs(np.repeat(np.arange(len(first) - 1), np.diff(first)), items)


class Lists:
    """Pairs that a simulation's lists hold now, as sets."""

    def __init__(self, sim):
        self.core, self.s, self.r = sim.core, sim.core.fields(), sim.core.rebuilt()
        self.face_edges = rows_of(sim.core, "face.edges").numbers

    def edges_of(self, side):
        """Edges of the mesh that sides of exposed faces are."""
        return self.face_edges[self.s["search.exposed_face"][side // 4], side % 4]

    def unordered(self, a, b):
        """Pairs of the edges that sides are, whichever comes first."""
        edges = self.edges_of(a), self.edges_of(b)
        return pairs(np.minimum(*edges), np.maximum(*edges))

    def vertex_faces(self):
        """Slot and exposed face: in contact, on the inner list, on the outer list.

        A contact that is held at a rim is found by no list: its vertex has left the face.
        """
        s, r = self.s, self.r
        target = s["spring.target"]
        slots = np.flatnonzero((target >= 0) & (s["spring.rim_action"] == 0))
        touching = pairs(slots, target[slots])
        inner = ragged(r["inner.first"], r["inner.candidate"])
        face = s["outer.vf_pairs"].reshape(2, -1)[1]
        outer = ragged(s["outer.slot_first"], face[s["outer.slot_pairs"]])
        return touching, inner, outer

    def edge_edges(self):
        """Two edges of the mesh: in contact, on the inner list, on the outer list."""
        contact = rows_of(self.core, "edge.contact")
        edges = self.edges_of(contact.mother_side), contact.target_edge
        touching = pairs(np.minimum(*edges), np.maximum(*edges))
        sides = rows_of(self.core, "inner.edge_sides").numbers.T
        first_side = rows_of(self.core, "outer.ee_sides").numbers[:, 0]
        listed = rows_of(self.core, "outer.ee_pairs").numbers.T
        outer = self.unordered(first_side[listed[0]], first_side[listed[1]])
        return touching, self.unordered(sides[0], sides[2]), outer

    def faces(self):
        """Faces in contact, and faces that are listed."""
        s, contact = self.s, rows_of(self.core, "edge.contact")
        target = s["spring.target"]
        slots = np.flatnonzero(target >= 0)
        faces = [target[slots], slots // 4, contact.target, contact.mother_side // 4]
        return set(np.concatenate(faces)), set(np.flatnonzero(s["outer.face_listed"]))


@pytest.mark.parametrize("shapes", list(combinations_with_replacement(SHAPES, 2)), ids="-".join)
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_contacts_are_on_the_inner_list_and_that_on_the_outer(shapes, seed):
    """A step raises if the lists hide a contact that a search of all pairs finds."""
    sim = tumbling(shapes, seed)
    springs = edges = 0
    for _ in range(STEPS // EVERY):
        sim.step(EVERY)
        lists = Lists(sim)
        touching, inner, outer = lists.vertex_faces()
        springs += len(touching)
        assert touching <= inner <= outer
        touching, inner, outer = lists.edge_edges()
        edges += len(touching)
        assert touching <= inner <= outer
        touching, listed = lists.faces()
        assert touching <= listed
    assert springs > 100 and edges > 100
    assert sim.core.scalars()["rebuilds"] > 5
