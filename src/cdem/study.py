"""A study: which parameters of a case vary and how, what is done with each, and what is collected."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr, ValidationError, model_validator

from cdem.criterion import Criterion
from cdem.errors import CaseError
from cdem.fields import Name, Part, Quantity
from cdem.formula import Formula, is_formula, unknown
from cdem.read import Keys, Source, explain, load_case_data, plain

Number = Annotated[float, Quantity("1")]
Positive = Annotated[float, Quantity("1", above=0)]
CRITICAL_RESULTS = ("value", "stable", "failed", "trials", "steps")
COLUMNS = ("run", "status", "wall_time", "error")
"""Columns of every table, whose names a study cannot use for others."""
KINDS = ("values", "grid", "uniform", "normal", "lognormal", "triangular")


class Grid(Part):
    """Values at equal distances."""

    first: Number = Field(description="First value")
    last: Number = Field(description="Last value")
    count: int = Field(ge=2, description="Number of values")


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


class Sampling(Part):
    """How values are drawn from distributions."""

    method: Literal["latin-hypercube", "monte-carlo"] = Field(
        "latin-hypercube",
        description="One value in each of COUNT equally likely parts, or independent values",
    )
    count: int = Field(ge=1, description="Number of draws")
    seed: int = Field(1, ge=0, description="Another seed draws other values")


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


class Study(Part):
    """A whole study. Load one from a file, or build it here with the same names.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: what.
    """

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

    _source: Source = PrivateAttr(default_factory=Source)

    def __init__(self, _source: Source | None = None, **data: Any) -> None:
        source = _source or Source()
        try:
            super().__init__(**plain(data, source))
        except ValidationError as error:
            raise explain(error, source, Study) from None
        self._source = source
        problems = list(_contradictions(self))
        if problems:
            raise source.error(problems)

    @model_validator(mode="before")
    @classmethod
    def _list_of_results(cls, data: Any) -> Any:
        if isinstance(data, dict) and isinstance(data.get("results"), list):
            return data | {"results": {str(path): path for path in data["results"]}}
        return data

    @classmethod
    def load(cls, path: str | Path) -> Study:
        """Read a study file.

        Raises:
            CaseError: The file cannot be read or is wrong; one line for each problem.
        """
        data, source = load_case_data(Path(path), what="study")
        return cls(_source=source, **data)

    @property
    def case_file(self) -> Path:
        """The case file."""
        return self._source.folder / self.case

    @classmethod
    def schema(cls) -> dict[str, Any]:  # type: ignore[override]
        """Return the JSON schema of a study file, for editors."""
        whole = cls.model_json_schema() | {"title": "cdem study"}
        fields = whole["properties"]  # two of which may be lists for short
        parameter = fields["parameters"]["additionalProperties"]
        fields["parameters"]["additionalProperties"] = {"anyOf": [parameter, {"type": "array"}]}
        names = {"type": "array", "items": {"type": "string"}}
        fields["results"] = {"anyOf": [fields["results"], names]}
        return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | whole

    def error(self, keys: Keys, what: str) -> CaseError:
        """An error about one place of the study."""
        return self._source.error([(keys, what)])


def formulas(study: Study) -> Iterator[tuple[Keys, str]]:
    """Every formula that a run needs before it starts, and its place."""
    yield from _inside(study.set, ("set",))
    if study.critical:
        yield from _inside(study.critical.between, ("critical", "between"))


def _inside(value: Any, keys: Keys) -> Iterator[tuple[Keys, str]]:
    if is_formula(value):
        yield keys, value
    elif isinstance(value, dict | list):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _inside(item, (*keys, key))


def _contradictions(study: Study) -> Iterator[tuple[Keys, str]]:
    used: set[str] = set()
    for keys, text in formulas(study):
        yield from _formula(keys, text, study.parameters, used)
    known = [*study.parameters, *(CRITICAL_RESULTS if study.critical else ())]
    for name, text in study.results.items():
        if is_formula(text):
            yield from _formula(("results", name), text, known, used)
        elif study.critical and text not in CRITICAL_RESULTS:
            yield ("results", name), unknown(text, CRITICAL_RESULTS)
        if name in study.parameters:
            yield ("results", name), "is the name of a parameter, too"
        known.append(name)
    for field, names in (("parameters", study.parameters), ("results", study.results)):
        for name in set(names) & set(COLUMNS):
            yield (field, name), "is the name of a column of every table; choose another"
    yield from _parameters(study, used)
    yield from _plots(study)
    if study.critical:
        for i, value in enumerate(study.critical.between):
            if not is_formula(value) and not isinstance(value, int | float):
                yield ("critical", "between", i), f"must be a number or a formula, got '{value}'"
        sought = study.critical.parameter
        for field, names in (("parameters", study.parameters), ("set", study.set)):
            if sought in names:
                yield (
                    ("critical", "parameter"),
                    f"'{sought}' is also given by {field}; vary it once",
                )


def _formula(
    keys: Keys, text: str, known: Iterable[str], used: set[str]
) -> Iterator[tuple[Keys, str]]:
    try:
        names = Formula(text).names
    except ValueError as error:
        yield keys, str(error)
        return
    used |= names
    for name in sorted(names - set(known)):
        yield keys, f"'{text.strip()}': {unknown(name, known)}"


def _parameters(study: Study, used: set[str]) -> Iterator[tuple[Keys, str]]:
    lengths: dict[str, int] = {}
    for name, parameter in study.parameters.items():
        keys: Keys = ("parameters", name)
        if "." not in name and name not in used:
            yield keys, "is used by no formula, and a path in the case has a dot"
        if parameter.is_drawn and study.sampling is None:
            yield keys, "is drawn, so the study needs sampling: {count: 100}"
        if parameter.is_drawn and study.combine == "one-at-a-time":
            yield keys, "is drawn, which one-at-a-time does not go with; give values or a grid"
        if not parameter.is_drawn:
            lengths[name] = len(parameter.values) if parameter.values else parameter.grid.count  # type: ignore[union-attr]
        if name in study.set:
            yield ("set", name), "is a parameter, too"
    if study.combine == "together" and len(set(lengths.values())) > 1:
        counts = ", ".join(f"{name} {count}" for name, count in lengths.items())
        yield ("combine",), f"together needs as many values of each parameter; there are: {counts}"
    if study.sampling and not any(p.is_drawn for p in study.parameters.values()):
        yield ("sampling",), "no parameter has a distribution to draw from"


def _plots(study: Study) -> Iterator[tuple[Keys, str]]:
    for i, plot in enumerate(study.plots):
        for field in ("x", "y", "by"):
            name = getattr(plot, field)
            if name is not None and name not in study.parameters:
                yield ("plots", i, field), f"parameter {unknown(name, study.parameters)}"
        for field in (plot.kind, "beside"):
            name = getattr(plot, field)
            if name is not None and study.results and name not in study.results:
                yield ("plots", i, field), f"result {unknown(name, study.results)}"


def _rising(low: float | None, high: float | None) -> None:
    if low is not None and high is not None and low >= high:
        raise ValueError(f"low {low:g} must be below high {high:g}")
