"""Which bodies that move count as a failure."""

from types import SimpleNamespace

import numpy as np
import pytest

from cdem.run.moving import Body
from cdem.study.criterion import Criterion

BUILD = SimpleNamespace(
    topology=SimpleNamespace(
        element_nodes={"hex8": np.zeros((3, 8), int)}, element_block={"hex8": np.array([0, 0, 1])}
    ),
    assembly=SimpleNamespace(element_volume={"hex8": np.array([3.0, 4.0, 0.5])}),
)


def body(block, volume, *, whole):
    """A body of a block, or of a part of it."""
    return Body(
        1, volume, 0.0, ["rock"], 0.0, [0.0] * 3, [], whole=whole, members=np.array([block])
    )


@pytest.mark.parametrize(("moves", "counts"), [
    (body(0, 7.0, whole=True), True),
    (body(0, 0.9, whole=False), True),  # of a block of 7 m3
    (body(1, 0.5, whole=True), False),
    (body(1, 0.3, whole=False), False),  # of a block of 0.5 m3
])  # fmt: skip
def test_a_part_counts_if_its_block_is_no_chip(moves, counts):
    assert Criterion(ignore_below=1.0).counts(SimpleNamespace(build=BUILD), moves) is counts


def test_of_another_group_only_a_part_of_a_large_block_counts():
    """Such a block cannot be taken out: it may be the slope."""
    seen = [
        Criterion(ignore_below=1.0, group="other").counts(SimpleNamespace(build=BUILD), moves)
        for moves in (
            body(0, 7.0, whole=True),
            body(0, 0.9, whole=False),
            body(1, 0.3, whole=False),
        )
    ]
    assert seen == [False, True, False]
