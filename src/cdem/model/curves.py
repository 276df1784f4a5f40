"""Histories of loads and velocities as curves of the core."""

from __future__ import annotations

from collections.abc import Sequence

Curves = list[tuple[list[float], list[float]]]
"""Times [s] and factors of each curve."""


def constant() -> Curves:
    """The curves before any history is added: the first is 1 at all times."""
    return [([0.0], [1.0])]


def add_curve(history: Sequence[tuple[float, float]] | None, curves: Curves) -> int:
    """Index of a history's curve; without one, the constant."""
    if history is None:
        return 0
    curves.append(([float(t) for t, _ in history], [float(f) for _, f in history]))
    return len(curves) - 1
