"""The parts of a study: how parameters vary, what is sought, what is drawn."""

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
"""Columns of every table, whose names a study cannot use for others."""
MOST_RUNS = 1_000_000
KINDS = ("values", "grid", "uniform", "normal", "lognormal", "triangular")


class Grid(Part):
    """Values at equal distances."""

    first: Number = Field(description="First value")
    last: Number = Field(description="Last value")
    count: int = Field(ge=2, le=MOST_RUNS, description="Number of values")


def _rising(low: float | None, high: float | None) -> None:
    if low is not None and high is not None and low >= high:
        raise ValueError(f"low {low:g} must be below high {high:g}")


class Uniform(Part):
    """Every value between two limits is as likely as any other."""

    low: Number = Field(description="Lowest value")
    high: Number = Field(description="Highest value")

    @model_validator(mode="after")
    def _ordered(self) -> Uniform:
        _rising(low=self.low, high=self.high)
        return self


class Triangular(Part):
    """A density that rises from the lowest value to the mode and falls to the highest value."""

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
    """The normal distribution, cut off at limits if there are any."""

    mean: Number = Field(description="Mean before it is cut off")
    deviation: Positive = Field(description="Standard deviation before it is cut off")
    low: Number | None = Field(None, description="No value is below this")
    high: Number | None = Field(None, description="No value is above this")

    @model_validator(mode="after")
    def _ordered(self) -> Normal:
        _rising(low=self.low, high=self.high)
        return self


class Lognormal(Normal):
    """The distribution of a value whose logarithm is normal, cut off at limits if there are any."""

    mean: Positive = Field(description="Mean of the value itself, before it is cut off")
    deviation: Positive = Field(
        description="Standard deviation of the value itself, before it is cut off"
    )

    @model_validator(mode="after")
    def _has_values(self) -> Lognormal:
        if self.high is not None and self.high <= 0:
            raise ValueError(f"high {self.high:g} must be above 0")
        return self


class Parameter(Part):
    """How one parameter varies. A plain list stands for its values."""

    values: list[Any] | None = Field(None, min_length=1, description="These values")
    grid: Grid | None = Field(None, description="Values at equal distances")
    uniform: Uniform | None = Field(None, description="Drawn evenly between low and high")
    normal: Normal | None = Field(None, description="Drawn from a normal distribution")
    lognormal: Lognormal | None = Field(None, description="Drawn from a lognormal distribution")
    triangular: Triangular | None = Field(None, description="Drawn from a triangular distribution")
    unit: Name | None = Field(
        None, description="Unit of all numbers here; by default that of the case (SI, degrees)"
    )
    label: Name | None = Field(None, description="What plots call it")

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
        """Which of `KINDS` it is."""
        return next(kind for kind in KINDS if getattr(self, kind) is not None)

    @property
    def is_drawn(self) -> bool:
        """Whether its values are drawn from a distribution."""
        return self.kind not in ("values", "grid")

    @property
    def count(self) -> int:
        """How many values are listed; 0 of a distribution."""
        return len(self.values) if self.values else self.grid.count if self.grid else 0


class Sampling(Part):
    """How values are drawn from distributions."""

    method: Literal["latin-hypercube", "monte-carlo"] = Field(
        "latin-hypercube",
        description="One value in each of COUNT equally likely parts, or independent values",
    )
    count: int = Field(ge=1, le=MOST_RUNS, description="Number of draws")
    seed: int = Field(1, ge=0, le=MOST_SEEDS, description="Another seed draws other values")


class CriticalSearch(Part):
    """Find the value at which each case fails, as `cdem critical` does."""

    parameter: Name | None = Field(None, description="Path of the value to vary")
    factor: bool = Field(False, description="Vary the factor of safety on all strengths instead")
    between: list[Any] = Field(
        min_length=2, max_length=2, description="A value that rests and one that fails; or formulas"
    )
    tolerance: Positive = Field(0.01, description="Width of the bracket to reach")
    criterion: Criterion = Field(Criterion(), description="What counts as failed")

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
    x: Name | None = Field(None, description="Parameter on the axis to the right")
    y: Name | None = Field(None, description="Parameter on the axis upwards (map)")
    by: Name | None = Field(None, description="A line for each value of this parameter (lines)")
    beside: Name | None = Field(None, description="A result drawn thin for comparison (lines)")
    title: str = Field("", description="Title; by default none")
    label: Name | None = Field(None, description="What the picture calls the result")

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
                raise ValueError(f"{field} has no meaning for {self.kind}; remove it")
        for field in {"lines": ("x",), "map": ("x", "y"), "tornado": ()}[self.kind]:
            if getattr(self, field) is None:
                raise ValueError(f"{self.kind} needs {field}, the name of a parameter")
        return self

    @property
    def kind(self) -> str:
        """Which kind of plot it is."""
        return next(kind for kind in ("lines", "map", "tornado") if getattr(self, kind))

    @property
    def result(self) -> str:
        """The result that it shows."""
        return getattr(self, self.kind)


def run_count(study: StudyParts) -> int:
    """How many runs the parameters and draws of a study make."""
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
        description="What varies: a path in the case, as for cdem run --set, or a name without a dot "
        "for use in formulas",
    )
    combine: Literal["product", "together", "one-at-a-time"] = Field(
        "product",
        description="How lists and grids combine: all pairs, the first of each with the first of the "
        "others and so on, or each alone while the others keep their first value",
    )
    sampling: Sampling | None = Field(None, description="How values are drawn from distributions")
    set: dict[str, Any] = Field(
        {}, description="Values of the case in all runs: {path: value}; formulas begin with ="
    )
    critical: CriticalSearch | None = Field(
        None, description="Find the critical value of each case; by default each case is run"
    )
    keep: bool = Field(False, description="Also keep the result folder of each run")
    results: dict[str, Name] = Field(
        {},
        description="Columns of the table: {name: path in summary.json, histories.COLUMN (its last "
        "value), one of value, stable, failed, trials, steps of a critical search, or a formula with "
        "parameters and results named before}; by default all numbers there are",
    )
    plots: list[Plot] = Field([], description="Pictures of the table")
