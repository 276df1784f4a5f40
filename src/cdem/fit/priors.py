"""The parameters of a study in units of their prior: a number of 0 to 1, uniform before a fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.study.sampling import quantile
from cdem.study.schema import Parameter

Floats = NDArray[np.float64]

KNOTS = 4001


@dataclass(frozen=True)
class Prior:
    """Knowledge about a parameter before the fit.

    The distribution of the study; for a list or a grid all values from its least to its greatest
    are equally likely.

    Attributes:
        name: Name in the study.
        label: Name for plots, with its unit.
        shares: Shares of the distribution, 0 to 1, shape (knots,).
        values: Value below which each share lies, rising, shape (knots,).
    """

    name: str
    label: str
    shares: Floats
    values: Floats

    @classmethod
    def of(cls, name: str, label: str, parameter: Parameter, used: Floats) -> Prior:
        """The prior of a parameter.

        Args:
            name: Name in the study.
            label: Name for plots.
            parameter: Its variation in the study.
            used: Values in the runs; they bound the values of a list or a grid, and of a
                distribution without limits.
        """
        if not parameter.is_drawn:
            return cls(name, label, np.array([0.0, 1.0]), np.array([used.min(), used.max()]))
        shares = np.linspace(0, 1, KNOTS)
        inner = np.clip(shares, 0.5 / KNOTS, 1 - 0.5 / KNOTS)  # an end may be infinite
        values = np.array([quantile(parameter, float(u)) for u in inner])
        return cls(name, label, shares, np.maximum.accumulate(values))

    def value(self, share: Floats) -> Floats:
        """The value below which a share of the distribution lies."""
        return np.interp(share, self.shares, self.values)

    def share(self, value: Floats) -> Floats:
        """The share of the distribution below a value."""
        return np.interp(value, self.values, self.shares)
