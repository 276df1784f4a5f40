"""The runs of a study: combinations of lists and grids, and random values of distributions."""

from __future__ import annotations

import math
import zlib
from itertools import product
from statistics import NormalDist
from typing import Any

import numpy as np

from cdem.errors import BackendError
from cdem.study.schema import Parameter, Sampling
from cdem.study.study import Study

Row = dict[str, Any]


def rows(study: Study, draws: list[Row]) -> list[Row]:
    """Value of each parameter for every run, in the parameters' order.

    Lists and grids are combined first; each combination is then run with all draws.

    Args:
        study: The study.
        draws: Values of the random parameters; one empty draw if there are none.
    """
    lists = {n: _listed(p) for n, p in study.parameters.items() if not p.is_drawn}
    combined = _combine(lists, study.combine)
    whole = [a | b for a in combined for b in draws]
    return [{name: row[name] for name in study.parameters} for row in whole]


def _listed(parameter: Parameter) -> list[Any]:
    if parameter.values is not None:
        return parameter.values
    grid = parameter.grid
    assert grid is not None
    # 12 digits: 0.3 rather than 0.30000000000000004 in the table
    return [float(f"{v:.12g}") for v in np.linspace(grid.first, grid.last, grid.count)]


def _combine(lists: dict[str, list[Any]], how: str) -> list[Row]:
    if not lists:
        return [{}]
    if how == "product":
        return [dict(zip(lists, values, strict=True)) for values in product(*lists.values())]
    if how == "together":
        return [
            dict(zip(lists, values, strict=True)) for values in zip(*lists.values(), strict=True)
        ]
    base = {name: values[0] for name, values in lists.items()}
    return [base, *(base | {n: value} for n, values in lists.items() for value in values[1:])]


def draw(parameters: dict[str, Parameter], sampling: Sampling) -> list[Row]:
    """Random values: equal for equal seed, count, parameter name and SciPy version.

    Latin hypercube: each of `count` equally likely parts of a distribution gets one value,
    and the parts of different parameters are combined in random order (McKay, Beckman & Conover
    1979).

    Raises:
        BackendError: Latin hypercubes need the extra `sweep`.
    """
    latin = _latin_hypercube() if sampling.method == "latin-hypercube" else None
    columns = {}
    for name, parameter in parameters.items():
        random = np.random.default_rng([sampling.seed, zlib.crc32(name.encode())])
        u = (
            latin(1, seed=random).random(sampling.count)[:, 0]
            if latin
            else random.random(sampling.count)
        )
        columns[name] = [quantile(parameter, float(x)) for x in u]
    return [{n: column[i] for n, column in columns.items()} for i in range(sampling.count)]


def _latin_hypercube() -> Any:
    try:
        from scipy.stats.qmc import LatinHypercube
    except ImportError as error:
        raise BackendError(
            "sampling: latin-hypercube needs SciPy: pip install 'cdem[sweep]', or write method: "
            f"monte-carlo ({error})"
        ) from None
    return LatinHypercube


def quantile(parameter: Parameter, u: float) -> float:
    """Quantile of a distribution: a fraction `u` of it lies below, 0 <= u < 1."""
    if parameter.uniform:
        low, high = parameter.uniform.low, parameter.uniform.high
        return low + u * (high - low)
    if parameter.triangular:
        t = parameter.triangular
        rise, fall, width = t.mode - t.low, t.high - t.mode, t.high - t.low
        if u * width < rise:
            return t.low + math.sqrt(u * width * rise)
        return t.high - math.sqrt((1 - u) * width * fall)
    if parameter.normal:
        n = parameter.normal
        return _cut(NormalDist(n.mean, n.deviation), u, n.low, n.high)
    g = parameter.lognormal
    assert g is not None
    spread = math.sqrt(math.log1p((g.deviation / g.mean) ** 2))
    of_log = NormalDist(math.log(g.mean) - 0.5 * spread**2, spread)
    lowest = math.log(g.low) if g.low is not None and g.low > 0 else None
    highest = math.log(g.high) if g.high is not None else None
    return math.exp(_cut(of_log, u, lowest, highest))


def _cut(whole: NormalDist, u: float, low: float | None, high: float | None) -> float:
    """Quantile of a normal distribution between two limits."""
    least = 0.0 if low is None else whole.cdf(low)
    most = 1.0 if high is None else whole.cdf(high)
    tiny = 1e-16  # the quantile may be infinite at the ends
    value = whole.inv_cdf(min(max(least + u * (most - least), tiny), 1 - tiny))
    return min(max(value, -math.inf if low is None else low), math.inf if high is None else high)
