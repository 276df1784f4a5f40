"""Rows of a moving surface: one for each thing, in the order in which they come."""

from __future__ import annotations

import numpy as np
import pytest
from shared.moving import surface

from cdem.case.shown_fields import MISES
from cdem.errors import CdemError
from cdem.output.moving_surface import NEVER, MovingSurface


def moving(frames=4):
    found = MovingSurface()
    for frame in range(frames):
        found.add(surface(frame))
    return found


def test_faces_come_and_go_and_come_again():
    faces = moving().faces
    assert faces.born.tolist() == [0, 0, 1, 3]
    assert faces.goes.tolist() == [2, NEVER, NEVER, NEVER]
    assert faces.element.tolist() == [1, 0, 2, 1]  # rows of elements 11, 10, 12, 11
    assert faces.nodes.tolist() == [[0, 1, 4, -1], [0, 1, 2, 3], [3, 4, 5, -1], [0, 1, 4, -1]]


def test_new_frames_only_add_to_the_rows():
    some, all_ = moving(2), moving()
    for name in ("nodes", "element", "born"):
        before, after = getattr(some.faces, name), getattr(all_.faces, name)
        assert (after[: len(before)] == before).all()
    assert all_.nodes.number[: len(some.nodes)].tolist() == some.nodes.number.tolist()


def test_fields_and_their_ranges():
    found = moving()
    assert {f.name: f.kind for f in found.fields.values()} == {
        "displacement": "amount", "damage": "amount", "group": "label", "block": "scattered",
        "piece": "scattered"
    }  # fmt: skip
    assert found.fields["group"].labels == ("bed", "body")
    assert found.most["displacement"] == pytest.approx(np.linalg.norm([18.3, 0.3, -3 + 0.6]), 0.05)
    assert found.lowest.tolist() == [0, 0, -3]
    assert moving(1).fields.keys() == found.fields.keys()


def test_stress_is_carried_by_its_element():
    found, stress = MovingSurface(), np.zeros((13, 6))
    stress[11, 0] = 3e6
    found.add(surface(0), stress)
    assert found.fields[MISES].unit == "Pa" and found.most[MISES] == pytest.approx(3e6)


def test_places_that_are_not_finite_stay_where_they_were():
    found = moving(1)
    lost = surface(1)
    lost.points[0] = np.nan
    found.add(lost)
    assert np.isfinite(found.highest).all()
    assert found.last[0].tolist() == surface(0).points[0].tolist()


def test_frames_of_an_older_cdem_are_told():
    old = surface(0)
    del old.cell_data["face"]
    with pytest.raises(CdemError, match=r"an older cdem wrote these frames.*run the case again"):
        MovingSurface().add(old)
