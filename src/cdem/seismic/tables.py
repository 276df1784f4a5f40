"""Measures of motions as lines of text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cdem.seismic.measures import Measures, highest_frequency, measures
from cdem.seismic.processing import GRAVITY, Processed

HEAD = (
    f"{'PGA [g]':>9}{'PGV [m/s]':>11}{'PGD [m]':>9}{'Arias [m/s]':>13}{'D5-95 [s]':>11}"
    f"{'left [m/s]':>12}{'[m]':>10}"
)
"""Names of the columns of `row`."""
WIDTH = 28
"""Width of the names of rows."""


def row(found: Measures) -> str:
    """Measures in the columns of `HEAD`."""
    return (
        f"{found.pga / GRAVITY:>9.4f}{found.pgv:>11.4f}{found.pgd:>9.4f}{found.arias:>13.4f}"
        f"{found.duration:>11.3f}{found.last_velocity:>12.2g}{found.last_displacement:>10.2g}"
    )


def step_lines(steps: Iterable[tuple[str, Processed]]) -> list[str]:
    """A table of the steps of processing: measures after each."""
    rows = [f"{name:<{WIDTH}}{row(measures(record))}" for name, record in steps]
    return [f"{'':<{WIDTH}}{HEAD}", *rows]


def record_lines(name: str, steps: Sequence[tuple[str, Processed]]) -> list[str]:
    """Lines on a record: its samples, the highest frequency that matters, and measures."""
    record = steps[-1][1]
    top = highest_frequency(record.velocity, record.step)
    return [
        f"record {name}: {len(record.velocity):,} samples every {record.step:g} s, "
        f"{record.duration:g} s; 99 % of the energy of its velocity below {top:.3g} Hz",
        *(f"  {line}" for line in step_lines(steps)),
    ]
