"""Heights between and beyond what was measured."""

import numpy as np
import pytest
from shared.slopes import PLANE, SOMEWHERE, contours_of

from cdem.errors import BackendError, CaseError
from cdem.terrain.heights import Grid, Lines, Smooth, extra

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")


def test_beyond_the_outermost_contours_the_plane_goes_on():
    lines, heights = contours_of(PLANE)
    found = Lines(
        [np.column_stack([xy, [z] * 4]) for xy, z in zip(lines, heights, strict=True)], 5.0
    )
    far = np.array([[400.0, 300.0], [-300.0, 10.0]])
    assert np.abs(found(far) - PLANE(far)).max() < 1e-6


def test_lines_millions_of_spacings_long_are_refused():
    with pytest.raises(CaseError, match=r"2e\+09 m long, with up to 1e\+09 m between .* units"):
        Lines([np.array([[0.0, 0, 0], [1e9, 0, 1]]), np.array([[0.0, 1, 0], [1e9, 1, 1]])], 1.0)


def test_smoothing_keeps_a_plane_and_rounds_an_edge():
    assert np.abs(Smooth(PLANE, 7.0)(SOMEWHERE) - PLANE(SOMEWHERE)).max() < 1e-10
    x = np.arange(-50.0, 51.0)
    step = Grid(-50.0, -50.0, (1.0, 1.0), np.tile(np.where(x > 0, 10.0, 0.0), (101, 1)))
    z = Smooth(step, 5.0)(np.array([[-30.0, 0.0], [0.5, 0.0], [30.0, 0.0]]))
    assert z == pytest.approx([0.0, 5.0, 10.0], abs=1e-9)


def test_a_missing_library_is_named_with_its_cure():
    with pytest.raises(BackendError, match=r"needs no_such_library: pip install 'cdem\[terrain\]'"):
        extra("no_such_library.part")
