"""Spacing and P32 of planes whose distance is known."""

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.joints.directions import line, poles
from cdem.joints.measured import Measured
from cdem.joints.scanlines import frequencies, terzaghi, total_length


def hole(dip, trend, plunge, gap, count):
    """Parallel planes that dip east, met by one line at a distance `gap`."""
    dips, directions = np.full(count, float(dip)), np.full(count, 90.0)
    lines = line(np.full(count, float(trend)), np.full(count, float(plunge)))
    at = gap * np.arange(count)
    return Measured(dips, directions, scanline=[""] * count, lines=lines, position=at)


def one_set(measured, dip, length=None):
    mean = poles(np.array([float(dip)]), np.array([90.0]))
    return frequencies(measured, mean, np.ones((len(measured.dip), 1)), length)[0]


@pytest.mark.parametrize(
    ("dip", "trend", "plunge", "sine"),
    [(0, 0, 90, 1), (60, 0, 90, 0.5), (90, 90, 0, 1), (90, 60, 0, np.cos(np.radians(30)))],
)
def test_spacing_is_the_gap_times_the_sine(dip, trend, plunge, sine):
    measured = hole(dip, trend, plunge, 2.5, 11)
    assert terzaghi(measured) == pytest.approx(np.full(11, 1 / sine))
    found = one_set(measured, dip)
    assert found.spacing == pytest.approx(2.5 * sine) and not found.blind
    assert found.p32 == pytest.approx(1 / found.spacing) and found.count == pytest.approx(11)
    assert one_set(measured, dip, 55.0).spacing == pytest.approx(sine * 5)  # 11 on 55 m


def test_planes_along_the_line_are_told():
    measured = hole(85, 0, 90, 1.0, 5)
    assert terzaghi(measured) == pytest.approx(np.full(5, 5.0)) and one_set(measured, 85).blind


def test_several_lines_add_up():
    one, two = hole(0, 0, 90, 1.0, 5), hole(0, 0, 90, 2.0, 6)
    parts = {
        k: np.concatenate([getattr(one, k), getattr(two, k)]) for k in ("dip", "dip_direction")
    }
    both = Measured(
        **parts,
        scanline=["A"] * 5 + ["B"] * 6,
        lines=np.concatenate([one.lines, two.lines]),
        position=np.concatenate([one.position, two.position]),
    )
    assert total_length(both, None) == pytest.approx(5 + 12)
    assert one_set(both, 0).spacing == pytest.approx(17 / 11)


def test_without_length_there_is_no_spacing():
    measured = hole(0, 0, 90, 1.0, 5)
    measured.position = None
    mean = np.array([[0.0, 0, 1]])
    assert frequencies(measured, mean, np.ones((5, 1)), None) is None
    measured.position = np.zeros(5)
    with pytest.raises(CaseError, match="at one position only"):
        frequencies(measured, mean, np.ones((5, 1)), None)
    assert terzaghi(Measured(measured.dip, measured.dip_direction)) is None
