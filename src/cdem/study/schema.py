"""The parts of a study: variation of parameters, search, results and plots."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from cdem.case.types import MOST_SEEDS, Name, Part, Quantity
from cdem.study.criterion import Criterion

Number = Annotated[float, Quantity("1")]
Positive = Annotated[float, Quantity("1", above=0)]
CRITICAL_RESULTS = ("value", "stable", "failed", "trials", "steps")
COLUMNS = ("run", "status", "wall_time", "error")
"""Columns of every table; a study cannot use their names."""
MOST_RUNS = 1_000_000
KINDS = ("values", "grid", "uniform", "normal", "lognormal", "triangular")


class Grid(Part):
    """Equally spaced values."""

    first: Number = Field(description="First value")
    last: Number = Field(description="Last value")
    count: int = Field(ge=2, le=MOST_RUNS, description="Number of values")


def _rising(low: float | None, high: float | None) -> None:
    if low is not None and high is not None and low >= high:
        raise ValueError(f"low {low:g} must be below high {high:g}")


class Uniform(Part):
    """A uniform distribution between two limits."""

    low: Number = Field(description="Lowest value")
    high: Number = Field(description="Highest value")

    @model_validator(mode="after")
    def _ordered(self) -> Uniform:
        _rising(low=self.low, high=self.high)
        return self


class Triangular(Part):
    """A triangular distribution: its density rises from the lowest value to the mode, then falls."""

    low: Number = Field(description="Lowest value")
    mode: Number = Field(description="Most likely value")
    high: Number = Field(description="Highest value")

    @model_validator(mode="after")
    def _ordered(self) -> Triangular:
        _rising(low=self.low, high=self.high)
        if not self.low <= self.mode <= self.high:
            raise ValueError(f"mode {self.mode:g} must lie between low and high")
        return self


class Normal(Part):
    """The normal distribution, optionally truncated."""

    mean: Number = Field(description="Mean before truncation")
    deviation: Positive = Field(description="Standard deviation before truncation")
    low: Number | None = Field(None, description="Lower truncation limit")
    high: Number | None = Field(None, description="Upper truncation limit")

    @model_validator(mode="after")
    def _ordered(self) -> Normal:
        _rising(low=self.low, high=self.high)
        return self


class Lognormal(Normal):
    """The lognormal distribution, optionally truncated."""

    mean: Positive = Field(description="Mean of the value itself, before truncation")
    deviation: Positive = Field(
        description="Standard deviation of the value itself, before truncation"
    )

    @model_validator(mode="after")
    def _has_values(self) -> Lognormal:
        if self.high is not None and self.high <= 0:
            raise ValueError(f"high {self.high:g} must be above 0")
        return self


class Parameter(Part):
    """Variation of one parameter. A plain list gives its values."""

    values: list[Any] | None = Field(None, min_length=1, description="These values")
    grid: Grid | None = Field(None, description="Equally spaced values")
    uniform: Uniform | None = Field(None, description="Uniform distribution between low and high")
    normal: Normal | None = Field(None, description="Normal distribution")
    lognormal: Lognormal | None = Field(None, description="Lognormal distribution")
    triangular: Triangular | None = Field(None, description="Triangular distribution")
    unit: Name | None = Field(
        None, description="Unit of all numbers here; default: as in the case (SI, degrees)"
    )
    label: Name | None = Field(None, description="Label in plots")

    @model_validator(mode="before")
    @classmethod
    def _list_of_values(cls, data: Any) -> Any:
        return {"values": data} if isinstance(data, list) else data

    @model_validator(mode="after")
    def _one_kind(self) -> Parameter:
        given = [kind for kind in KINDS if getattr(self, kind) is not None]
        if len(given) != 1:
            raise ValueError(
                f"give exactly one of {', '.join(KINDS)}; got {' and '.join(given) or 'none'}"
            )
        return self

    @property
    def kind(self) -> str:
        """Its member of `KINDS`."""
        return next(kind for kind in KINDS if getattr(self, kind) is not None)

    @property
    def is_drawn(self) -> bool:
        """Whether it has a distribution."""
        return self.kind not in ("values", "grid")

    @property
    def count(self) -> int:
        """Number of listed values; 0 for a distribution."""
        return len(self.values) if self.values else self.grid.count if self.grid else 0


class Sampling(Part):
    """Sampling of the distributions."""

    method: Literal["latin-hypercube", "monte-carlo"] = Field(
        "latin-hypercube",
        description="One value in each of COUNT equally likely parts, or independent values",
    )
    count: int = Field(ge=1, le=MOST_RUNS, description="Number of draws")
    seed: int = Field(1, ge=0, le=MOST_SEEDS, description="Seed of the random values")


class CriticalSearch(Part):
    """Find the value at which each case fails, like `cdem critical`."""

    parameter: Name | None = Field(None, description="Path of the value to vary")
    factor: bool = Field(
        False,
        description="Vary the factor of safety of all strengths, kept as joints slip, instead",
    )
    between: list[Any] = Field(
        min_length=2, max_length=2, description="A value that rests and one that fails; or formulas"
    )
    tolerance: Positive = Field(0.01, description="Width of the bracket to reach")
    criterion: Criterion = Field(Criterion(), description="Criterion of failure")

    @model_validator(mode="after")
    def _one_target(self) -> CriticalSearch:
        if (self.parameter is None) == (not self.factor):
            raise ValueError("give either parameter or factor: true")
        return self


class Plot(Part):
    """A picture of one result over parameters."""

    lines: Name | None = Field(None, description="Draw this result as lines over x")
    map: Name | None = Field(None, description="Draw this result as colours over x and y")
    tornado: Name | None = Field(
        None, description="Draw how much each parameter changes this result"
    )
    x: Name | None = Field(None, description="Parameter on the horizontal axis")
    y: Name | None = Field(None, description="Parameter on the vertical axis (map)")
    by: Name | None = Field(None, description="A line for each value of this parameter (lines)")
    beside: Name | None = Field(None, description="Another result, in thin lines (lines)")
    title: str = Field("", description="Title; by default none")
    label: Name | None = Field(None, description="Label of the result")

    @model_validator(mode="after")
    def _one_kind(self) -> Plot:
        given = [kind for kind in ("lines", "map", "tornado") if getattr(self, kind)]
        if len(given) != 1:
            raise ValueError(
                f"give exactly one of lines, map, tornado; got {' and '.join(given) or 'none'}"
            )
        allowed = {"lines": {"x", "by", "beside"}, "map": {"x", "y"}, "tornado": set()}[self.kind]
        for field in ("x", "y", "by", "beside"):
            if getattr(self, field) is not None and field not in allowed:
                raise ValueError(f"{field} has no effect for {self.kind}; remove it")
        for field in {"lines": ("x",), "map": ("x", "y"), "tornado": ()}[self.kind]:
            if getattr(self, field) is None:
                raise ValueError(f"{self.kind} needs {field}, the name of a parameter")
        return self

    @property
    def kind(self) -> str:
        """Kind of plot."""
        return next(kind for kind in ("lines", "map", "tornado") if getattr(self, kind))

    @property
    def result(self) -> str:
        """The result in the plot."""
        return getattr(self, self.kind)


def run_count(study: StudyParts) -> int:
    """Number of runs of a study, from its parameters and draws."""
    counts = [p.count for p in study.parameters.values() if not p.is_drawn]
    if study.combine == "together":
        combined = min(counts, default=1)
    elif study.combine == "product":
        combined = math.prod(counts)
    else:
        combined = 1 + sum(count - 1 for count in counts)
    return combined * (study.sampling.count if study.sampling else 1)


class StudyParts(Part):
    """All parts of a study."""

    study: Literal[1] = Field(1, description="Version of the study format")
    title: str = Field("", description="One line for reports")
    case: Name = Field(description="Case file, relative to the study file")
    parameters: dict[str, Parameter] = Field(
        min_length=1,
        description="Parameters: a path in the case, as for cdem run --set, or a name without a "
        "dot "
        "for use in formulas",
    )
    combine: Literal["product", "together", "one-at-a-time"] = Field(
        "product",
        description="Combination of lists and grids: all pairs; the first of each with the first "
        "of the "
        "others and so on; or one at a time while the others keep their first value",
    )
    sampling: Sampling | None = Field(None, description="Sampling of the distributions")
    set: dict[str, Any] = Field(
        {}, description="Values of the case in all runs: {path: value}; formulas begin with ="
    )
    critical: CriticalSearch | None = Field(
        None, description="Find the critical value of each case; default: run each case"
    )
    keep: bool = Field(False, description="Keep the result folder of each run")
    results: dict[str, Name] = Field(
        {},
        description="Columns of the table: {name: path in summary.json, histories.COLUMN (its last "
        "value), one of value, stable, failed, trials, steps of a critical search, or a formula with "
        "parameters and earlier results}; default: all available numbers",
    )
    plots: list[Plot] = Field([], description="Pictures of the table")
