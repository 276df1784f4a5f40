"""Ranges of colours."""

import pytest

from cdem.output.painter import signed_span


@pytest.mark.parametrize(
    "low, high, span",
    [
        (-3, 2, (-3, 3)),
        (-1, 8, (-8, 8)),
        (-8, 0.1, (-8, 0)),
        (-0.1, 8, (0, 8)),
        (-8, -0.1, (-8, 0)),
        (-8, -5, (-8, -5)),
        (0, 0, (0, 1e-12)),
        (5, 5, (0, 10)),
    ],
)
def test_the_range_of_values_with_a_sign(low, high, span):
    assert signed_span(low, high) == pytest.approx(span)
