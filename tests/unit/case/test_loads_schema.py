"""Loads and supports: what is refused."""

import pytest


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "  gravity: [0, 0, -9.81]",
            "  pore_pressure: 1",
            "loads.pore_pressure: unknown key; possible are gravity, tractions, surfaces, blasts, velocities, supports",
        ),
        (
            "normal: [1, 0, 0]",
            "normel: [1, 0, 0]",
            "loads.tractions.0.surface.normel: unknown key; did you mean normal?",
        ),
        (
            "history: [[0, 0], [1, 1]]",
            "history: [[1, 0], [1, 1]]",
            "loads.tractions.0: history: times must increase",
        ),
        (
            "history: [[0, 0], [1, 1]]",
            "history: []",
            "loads.tractions.0.history: needs at least 1 entry, got 0",
        ),
        (
            "normal: [1, 0, 0]}, traction",
            "normal: [0, 0, 0]}, traction",
            "normal must not be [0, 0, 0]",
        ),
        (
            "{surface: lid, ",
            "{",
            "loads.velocities.0: give exactly one of group, surface, point, box; got none of them",
        ),
    ],
)
def test_mistakes_are_answered(complaint, old, new, message):
    assert message in complaint(old, new)
