"""The line that shows how far a run is."""

from __future__ import annotations

from cdem.run.progress import Progress, describe


def test_the_progress_line_says_it_all():
    progress = Progress(
        "slide",
        0.5,
        2.0,
        12345,
        1e-5,
        "bonds of rock at 1, 2, 3 (63 %)",
        3e-3,
        1e-4,
        42,
        1500.0,
        3725.0,
        0.25,
        "a word",
    )
    assert describe(progress) == (
        "slide: t 0.5 of 2 s, step 12,345, dt 1e-05 s by bonds of rock "
        "at 1, 2, 3 (63 %), unbalance 0.003, energy error 1.0e-04, "
        "broken 42, 1,500 steps/s, 1:02:05 left, a word"
    )
