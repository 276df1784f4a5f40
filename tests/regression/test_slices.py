"""Kinds of rows are complete: a state that is cut into parts by them, with numbers of rows of its own
in each, is whole again when it is put together.
"""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
import json

from golden_scenes import GOLDEN, SCENES, digest_of_results
from staged_scenes import STAGED, digest_of_state

PARTS = 3
LONGEST = ("landslide", "leaving", "flowing", "rubble", "defaults")
PINNED = json.loads(GOLDEN.read_text())["scenes"]


def rows_of(info, array, counts):
    """View of an array that has one row for each of its kind."""
    count = counts[info["rows"]]
    if info["layout"] == "columns":
        return array.reshape(info["numbers"], -1)[:, :count].T
    return array.reshape(count, info["numbers"])


def kinds_of(info):
    """Kind of rows that each number of a row means, or ""."""
    named = info["refers_to"]
    if len([kind for kind in named if kind]) == 1 and named[0]:
        return [named[0]] * info["numbers"]
    return list(named[: info["numbers"]]) + [""] * (info["numbers"] - len(named))


class Cut:
    """Rows of every kind dealt to parts; a part numbers the rows that it has, or that these mean."""

    def __init__(self, counts, described, seed):
        random = np.random.default_rng(seed)
        self.counts = counts
        self.part = {kind: random.integers(0, PARTS, count) for kind, count in counts.items()}
        self.known = [
            {kind: np.flatnonzero(of == p) for kind, of in self.part.items()} for p in range(PARTS)
        ]
        for info, array in described:
            rows = rows_of(info, array, counts)
            for number, kind in enumerate(kinds_of(info)):
                if not kind:
                    continue
                for p, known in enumerate(self.known):
                    index = plain(info, rows[self.part[info["rows"]] == p, number])
                    known[kind] = np.union1d(known[kind], index[index >= 0])

    def slice(self, info, array, p):
        """The rows of a part, which speak of rows by the numbers of the part."""
        rows = rows_of(info, array, self.counts)[self.part[info["rows"]] == p].copy()
        for number, kind in enumerate(kinds_of(info)):
            if kind:
                to_local = np.full(self.counts[kind], -2)
                to_local[self.known[p][kind]] = np.arange(len(self.known[p][kind]))
                rows[:, number] = renumbered(info, rows[:, number], to_local)
        return rows

    def put(self, info, array, p, rows):
        """Put the rows of a part into a whole array."""
        rows = rows.copy()
        for number, kind in enumerate(kinds_of(info)):
            if kind:
                rows[:, number] = renumbered(info, rows[:, number], self.known[p][kind])
        rows_of(info, array, self.counts)[self.part[info["rows"]] == p] = rows


def plain(info, index):
    """Rows that indices mean, without the sign of an opposite."""
    return np.where(index < 0, ~index, index) if info["opposite"] else index


def renumbered(info, index, number):
    """The same indices by other numbers of rows; -1 stays."""
    row = plain(info, index)
    new = np.where(row < 0, row, number[np.maximum(row, 0)] if len(number) else -1)
    return np.where((index < 0) & info["opposite"], ~new, new)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n in LONGEST)) for n in SCENES]
)
def test_parts_by_kinds_of_rows_make_the_same_state(name):
    done = SCENES[name](1)
    for sim in done if isinstance(done, list) else [done]:
        counts = {kind["name"]: kind["count"] for kind in sim.core.describe_rows()}
        arrays = {"given": sim.core.model(), "stored": sim.core.fields()}
        described = [
            (info, arrays[info["origin"]][info["name"]])
            for info in sim.core.describe()
            if info["origin"] in arrays and info["rows"] and info["layout"] != "starts"
        ]
        described = [(info, array) for info, array in described if len(array) and info["numbers"]]
        assert {"elements", "blocks"} <= {kind for info, _ in described for kind in kinds_of(info)}
        cut = Cut(counts, described, seed=1)
        for info, array in described:
            before, parts = array.copy(), [cut.slice(info, array, p) for p in range(PARTS)]
            into = array if info["origin"] == "stored" else array.copy()
            rows_of(info, into, counts)[:] = 0
            for p, rows in enumerate(parts):
                cut.put(info, into, p, rows)
            assert np.array_equal(into, before, equal_nan=before.dtype.kind == "f"), info["name"]
    found = digest_of_state(done) if name in STAGED else digest_of_results(done)
    assert found == PINNED[name]
