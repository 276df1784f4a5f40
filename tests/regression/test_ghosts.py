"""Ghosts of a rank are like the rows of their owners, as far as they act on own nodes."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from golden_scenes import SCENES as GOLDEN
from golden_scenes import digest_of_results, thrown
from shared.ranks import on_ranks

from cdem.ranks import parts
from cdem.ranks.kinds import PAIRS, Table, counts_of
from cdem.ranks.merge import _Local
from cdem.ranks.shared_core import SharedCore

MOTION = [0, 1, 2, 4, 5, 6]
"""Numbers of a row of motion, without pads."""
PATH = [0, 1, 2, 4, 5, 6, 7]
"""Numbers of a predicted path; owners alone ask whether a node leaves it."""
AT_SAMPLES = "stored"
"""Energy of intact pairs: of the last sample, or of a step since at which another one of its lane
was broken, and ranks have other lanes."""


class Look:
    """The part of a rank, and the whole that has just been put together.

    Attributes:
        wrong: What differs, by name.
        seen: Ghosts compared, by name.
    """

    def __init__(self, core):
        self.kept, self.model = core._slice, core._whole.model()
        self.part, self.whole = core._part.fields(), core._whole.fields()
        self.local, self.counts = _Local(self.kept, self.part), counts_of(core._whole)
        self.infos = {info["name"]: info for info in self.kept.infos}
        self.wrong: Counter[str] = Counter()
        self.seen: Counter[str] = Counter()
        self.is_own = np.zeros(self.counts["nodes"], bool)
        self.is_own[self.kept.keep["nodes"][self.kept.own["nodes"]]] = True
        self.exposed = self.whole["search.exposed_face"].astype(np.int64)
        self._motion()
        for kind in PAIRS:
            self._pairs(kind)
        self._springs()
        self._edges()

    def compare(self, name, found, expected):
        """Count ghosts, and those that differ."""
        self.seen[name] += len(expected)
        if len(found) != len(expected):
            self.wrong[name] += abs(len(found) - len(expected))
        else:
            differs = (found != expected) & ~((found != found) & (expected != expected))
            self.wrong[name] += int(differs.any(axis=tuple(range(1, differs.ndim))).sum())

    def _motion(self):
        ghosts = ~self.kept.own["nodes"]
        rows = self.part["node.motion"].reshape(-1, 8)[ghosts]
        whole = self.whole["node.motion"].reshape(-1, 8)[self.kept.keep["nodes"][ghosts]]
        self.compare("motion", rows[:, MOTION], whole[:, MOTION])

    def _with_own_nodes(self, faces):
        """Whether faces have an own node."""
        nodes = self.model["face.nodes"].reshape(-1, 4)[faces]
        return ((nodes >= 0) & self.is_own[nodes]).any(axis=-1)

    def _pairs(self, kind):
        """Bonded pairs at own nodes."""
        faces = self.model[f"{kind}.faces"].reshape(-1, 2)
        rows, acts = self.kept.keep[kind], self._with_own_nodes(faces).any(axis=1)
        self.compare(f"{kind} at own nodes", rows[acts[rows]], acts.nonzero()[0])
        ghosts = ~self.kept.own[kind] & acts[rows]
        for name, info in self.infos.items():
            if info["rows"] != kind or name.endswith(AT_SAMPLES):
                continue
            if len(self.part[name]) and not any(info["refers_to"]):
                found = Table(info, self.part[name], len(rows)).rows()[ghosts]
                whole = Table(info, self.whole[name], self.counts[kind]).rows()
                self.compare(name, found, whole[rows[ghosts]])

    def _springs(self):
        """Contacts of vertices of ghosts, at own nodes."""
        names = [n for n, i in self.infos.items() if i["rows"] == "slots" and i["layout"] == "rows"]
        names = [n for n in names if n.startswith("spring") and not any(self.infos[n]["refers_to"])]
        face, slot = self.local.whole["exposed"], self.local.whole["slots"]
        slots = (4 * self.exposed[:, None] + np.arange(4)).ravel()
        here = self._acting_springs(self.part["spring.target"], face, slot)
        there = self._acting_springs(self.whole["spring.target"], self.exposed, slots)
        self.compare("springs", slot[here], slots[there])
        if len(here) == len(there):
            target = self.part["spring.target"][here], self.whole["spring.target"][there]
            self.compare("spring.target", face[target[0]], self.exposed[target[1]])
            for name in names:
                numbers = self.infos[name]["numbers"]
                if numbers and len(self.part[name]):
                    found, whole = (s[name].reshape(-1, numbers) for s in (self.part, self.whole))
                    self.compare(name, found[here], whole[there])

    def _acting_springs(self, target, face, slot):
        """Slots of ghosts in contact at own nodes."""
        node = self.model["face.nodes"][slot]
        acts = (target >= 0) & ~np.isin(slot // 4, self._own_faces)
        acts[acts] = self.is_own[node[acts]] | self._with_own_nodes(face[target[acts]])
        return acts.nonzero()[0]

    @property
    def _own_faces(self):
        return self.kept.keep["faces"][self.kept.own["faces"]]

    def _edges(self):
        """Contacts of edges of ghosts, at own nodes."""
        whole = {"slots": (4 * self.exposed[:, None] + np.arange(4)).ravel()}
        whole |= {"exposed": self.exposed, "edges": np.arange(self.counts["edges"])}
        here = self._acting_edges(self.part, self.local.whole)
        self.compare("edge contacts", here, self._acting_edges(self.whole, whole))

    def _acting_edges(self, state, whole):
        """Side, face, edge, state and reaction of contacts, in an order of all ranks."""
        contact = state["edge.contact"].reshape(-1, 4)
        side, edge = whole["slots"][contact[:, 0]], whole["edges"][contact[:, 2]]
        ends = self.model["edge.nodes"].reshape(-1, 2)
        ends = np.hstack([ends[self.model["face.edges"][side]], ends[edge]])
        acts = self.is_own[ends].any(axis=1) & ~np.isin(side // 4, self._own_faces)
        numbers = np.column_stack([
            side, whole["exposed"][contact[:, 1]], edge,
            state["edge.state"].reshape(-1, 8), state["edge.reaction"].reshape(-1, 8),
        ])[acts]  # fmt: skip
        return numbers[np.lexsort(numbers.T[::-1])]


SCENES = {
    "rubble": lambda: thrown(1, 0, 500, divisions=(5, 2, 2)),
    "breaking": lambda: thrown(1, 5e4, 300, divisions=(6, 2, 2)),
    "cubes": lambda: thrown(1, 2e4, 500, "hex8", divisions=(6, 2, 2)),
}


@pytest.mark.parametrize(("name", "count"), [("rubble", 2), ("breaking", 3), ("cubes", 3)])
def test_ghosts_are_like_their_owners(name, count, monkeypatch):
    """Each time that ghosts are found anew, which is often as the fences are narrow."""
    looks, put_together = [], SharedCore._put_together

    def looked_at(core):
        put_together(core)
        looks.append(Look(core))

    expected = digest_of_results(SCENES[name]())
    monkeypatch.setattr(parts, "ROOM", 0.003)
    monkeypatch.setattr(parts, "SKIN", 0)
    monkeypatch.setattr(parts, "SWEPT_STEPS", 200)
    monkeypatch.setattr(SharedCore, "_put_together", looked_at)
    assert on_ranks(count, lambda _: digest_of_results(SCENES[name]())) == [expected] * count
    wrong, seen = (sum((getattr(o, n) for o in looks), Counter()) for n in ("wrong", "seen"))
    assert not +wrong
    assert len(looks) > 10 * count / 2
    bonded = {"rubble": [], "breaking": ["triangles.bond"], "cubes": ["quads.bond"]}[name]
    assert all(seen[ghosts] > 50 for ghosts in ["motion", "spring.state", *bonded])
    assert seen["edge contacts"] > 50 or name == "cubes"


def test_paths_of_ghosts_are_those_of_their_owners():
    """A rank lacks elements at the outer ghosts of a block: it cannot predict them by itself."""

    def look():
        core = GOLDEN["elastic"](1).core
        part, whole = core._part.fields(), core.whole().fields()
        kept, place = core._slice, np.full(core._counts["nodes"], -1)
        place[whole["outer.predicted_nodes"]] = np.arange(len(whole["outer.predicted_nodes"]))
        ghosts = ~kept.own["nodes"][part["outer.predicted_nodes"]]
        nodes = kept.keep["nodes"][part["outer.predicted_nodes"][ghosts]]
        found = part["outer.predicted"].reshape(-1, 8)[ghosts][:, PATH]
        assert len(found) > 20 and (place[nodes] >= 0).all()
        assert (found == whole["outer.predicted"].reshape(-1, 8)[place[nodes]][:, PATH]).all()

    on_ranks(3, lambda _: look())
