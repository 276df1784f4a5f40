"""Flat arrays of the core as tables of rows, and lists by their starts."""

import numpy as np

from cdem.ranks.kinds import Table, flat_of, items_of, lengths_of, numbers_of, renumbered, starts_of

COLUMNS = {"name": "triangles.bond", "rows": "triangles", "numbers": 2, "layout": "columns",
           "refers_to": ["", "", "", ""], "origin": "stored"}  # fmt: skip


def test_columns_are_padded_as_the_core_does():
    rows = np.array([[1.0, 2.0], [3.0, 4.0]])
    flat = flat_of(COLUMNS, rows)
    assert flat.tolist() == [1, 3, 1, 1, 1, 1, 1, 1, 2, 4, 1, 1, 1, 1, 1, 1]
    assert (Table(COLUMNS, flat, 2).rows() == rows).all()
    given = flat_of(COLUMNS | {"origin": "given"}, rows)
    assert given.tolist() == [1, 3, 3, 3, 3, 3, 3, 3, 2, 4, 4, 4, 4, 4, 4, 4]
    assert flat_of(COLUMNS | {"name": "tet4.energy"}, rows)[2:8].tolist() == [0] * 6
    assert flat_of(COLUMNS, rows[:0]).tolist() == [1] * 16  # a table without rows has pads


def test_numbers_of_a_row_refer_to_one_kind_or_to_one_each():
    def kinds(numbers, *refers_to):
        return Table({"numbers": numbers, "refers_to": refers_to}, np.zeros(0), 0).kinds()

    assert kinds(3, "nodes", "", "", "") == ["nodes"] * 3
    assert kinds(2, "nodes", "exposed", "", "") == ["nodes", "exposed"]
    assert kinds(6, "", "", "", "") == [""] * 6


def test_items_of_lists_follow_the_lists():
    items, place = items_of(np.array([0, 2, 2, 5], np.int32), np.array([2, 1, 0]))
    assert items.tolist() == [2, 3, 4, 0, 1] and place.tolist() == [0, 0, 0, 2, 2]
    assert starts_of(np.array([2, 0, 3])).tolist() == [0, 2, 2, 5]
    assert lengths_of(np.array([0, 2, 2, 5], np.int32)).tolist() == [2, 0, 3]


def test_indices_get_other_numbers():
    number = numbers_of(np.array([1, 3]), 4)
    assert number.tolist() == [-1, 0, -1, 1]
    index = np.array([3, -1, 2, 1])
    assert renumbered(index, number, opposite=False).tolist() == [1, -1, -1, 0]
    assert renumbered(np.array([3, ~3, 2, ~2]), number, opposite=True).tolist() == [1, ~1, -1, -1]
    assert renumbered(index, numbers_of(np.zeros(0, int), 0), opposite=False).tolist() == [-1] * 4
