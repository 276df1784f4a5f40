"""Patches of the outer pair list."""

import numpy as np

from cdem.ranks.patches import first_patches, mothers_of, patches_of


def test_a_patch_is_the_faces_of_one_element():
    assert patches_of(np.array([7, 7, 7, 2, 9, 9])).tolist() == [0, 0, 0, 3, 4, 4]
    assert patches_of(np.zeros(0, int)).tolist() == []


def test_a_pair_has_a_mother_that_lists_it():
    first = np.array([0, 0, 1, 1, 1, 3, 3, 3, 3])  # of the slots of two faces
    assert mothers_of(first, np.array([0, 1, 2])).tolist() == [0, 1, 1]
    assert mothers_of(np.zeros(0, int), np.zeros(0, int)).tolist() == []


def test_a_movable_patch_finds_later_ones_and_those_that_cannot_move():
    movable = np.array([1, 0, 0, 1])  # two patches can move: 0 and 3
    vertex, face = np.array([0, 3, 0, 1, 3, 2]), np.array([3, 0, 1, 0, 2, 3])
    assert first_patches(vertex, face, movable).tolist() == [0, 0, 0, 0, 3, 3]
