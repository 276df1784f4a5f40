"""Verification: problems with a known answer, run on the user's own machine.

A problem is a folder with ``problem.py`` (the theory as a small function, and ``run(study)`` that
checks what cdem computes against it), the case files it needs, and a page ``README.md``.
"""

from __future__ import annotations

import difflib
import importlib.util
import math
import re
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from cdem.case.case import Case
from cdem.errors import CaseError, CdemError
from cdem.run.simulation import Simulation

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from cdem.output.reader import Surface

SHIPPED = Path(__file__).parent

INFLUENCES = {
    "indentation": (["contact.indentation={}"], (0.002, 0.01, 0.05)),
    "k h / E": (
        ["interfaces.default.stiffness_n={} E/h", "interfaces.default.stiffness_s={} E/h"],
        (1, 10, 100),
    ),
    "share of the stable step": (["time.safety={}"], (0.2, 0.4, 0.8)),
}
"""Settings that should not affect a strength, and values to try."""


@dataclass
class Check:
    """One number against its theory.

    Attributes:
        quantity: Name of the quantity.
        theory: Exact value.
        ours: Value from cdem.
        within: Largest error that passes.
        absolute: Whether errors are differences, or parts of the theory.
        unit: Of theory, paper and ours.
        paper: Value of Feng et al. (2014), or None.
    """

    quantity: str
    theory: float
    ours: float
    within: float
    absolute: bool = False
    unit: str = ""
    paper: float | None = None

    @property
    def error(self) -> float:
        """Ours less theory, relative to the theory unless `absolute`."""
        difference = self.ours - self.theory
        return difference if self.absolute else difference / abs(self.theory)

    @property
    def passed(self) -> bool:
        """Whether the error is small enough; not a number never is."""
        return abs(self.error) <= self.within

    def texts(self) -> tuple[str, ...]:
        """Quantity, theory, paper, ours, error, tolerance and verdict, to be printed."""
        unit = f" {self.unit}" if self.unit else ""
        paper = "" if self.paper is None else f"{self.paper:.6g}"
        if self.absolute:
            error, within = f"{self.error:+.2g}", f"{self.within:.2g}"
        else:
            error, within = f"{100 * self.error:+.2g} %", f"{100 * self.within:.2g} %"
        verdict = "pass" if self.passed else "MISS"
        theory, ours = f"{self.theory:.6g}{unit}", f"{self.ours:.6g}{unit}"
        return self.quantity, theory, paper, ours, error, within, verdict


HEADINGS = ("quantity", "theory", "paper", "ours", "error", "within", "verdict")


@dataclass
class Curve:
    """A plot for the manual: lines and, named with a leading dot, single points."""

    title: str
    x_label: str
    y_label: str
    lines: dict[str, tuple[ArrayLike, ArrayLike]]
    log: bool = False


@dataclass
class Picture:
    """Surfaces of one run, to be drawn side by side in the manual."""

    title: str
    surfaces: list[Surface]
    field: str = "displacement"


class Study:
    """Tools for the ``run`` of a problem: its cases in; checks, curves and pictures out.

    Attributes:
        full: Whether all variants and finer meshes are wanted, not just the quick ones.
        threads: Threads of the core; None for all.
        checks: Checks so far.
        exhibits: Curves and pictures so far.
    """

    def __init__(self, folder: Path, *, full: bool = False, threads: int | None = None) -> None:
        self._folder = folder
        self.full = full
        self.threads = threads
        self.checks: list[Check] = []
        self.exhibits: list[Curve | Picture] = []

    def case(self, *settings: str, file: str = "case.yaml") -> Case:
        """Load a case of the problem's folder; settings are as for ``cdem run --set``."""
        return Case.load(self._folder / file, settings)

    def simulate(self, *settings: str, file: str = "case.yaml") -> Simulation:
        """A simulation of such a case."""
        return Simulation(self.case(*settings, file=file), threads=self.threads)

    def check(
        self,
        quantity: str,
        *,
        theory: float,
        ours: float,
        within: float,
        absolute: bool = False,
        unit: str = "",
        paper: float | None = None,
    ) -> None:
        """Compare a number with its theory; see `Check`."""
        self.checks.append(
            Check(quantity, float(theory), float(ours), within, absolute, unit, paper)
        )

    def influences(
        self,
        quantity: str,
        measure: Callable[..., float],
        *,
        theory: float,
        within: float,
        absolute: bool = False,
        unit: str = "",
    ) -> None:
        """Check that indentation, contact stiffness and time step hardly matter; show the errors.

        Args:
            quantity: Name of the quantity.
            measure: Gives it for settings of the case, as `simulate` takes them.
            theory: Its value, for any settings.
            within: Largest error that passes; see `Check`, as for the others.
            absolute: Whether errors are differences.
            unit: Of theory and measure.
        """
        for what, (settings, values) in INFLUENCES.items():
            for value in values:
                self.check(f"{quantity}, {what} {value:g}", theory=theory, within=within, unit=unit,
                           ours=measure(*(text.format(value) for text in settings)),
                           absolute=absolute)  # fmt: skip
            errors = [abs(check.error) for check in self.checks[-len(values) :]]
            self.curve(f"Error against {what}", f"{what} [1]",
                       f"error [{unit if absolute else 1}]",
                       {".cdem": (values, errors), "allowed": (values, [within] * len(values))},
                       log=True)  # fmt: skip

    def curve(
        self,
        title: str,
        x_label: str,
        y_label: str,
        lines: dict[str, tuple[ArrayLike, ArrayLike]],
        *,
        log: bool = False,
    ) -> None:
        """Show lines in the manual; see `Curve`."""
        self.exhibits.append(Curve(title, x_label, y_label, lines, log))

    def picture(self, title: str, *surfaces: Surface, field: str = "displacement") -> None:
        """Show surfaces, taken with `cdem.output.render.snapshot`, in the manual."""
        self.exhibits.append(Picture(title, list(surfaces), field))


@dataclass
class Outcome:
    """Results of a problem.

    Attributes:
        problem: The problem.
        checks: Its comparisons.
        exhibits: Its curves and pictures.
        failure: Why it could not be finished, or nothing.
        wall_time: [s].
    """

    problem: Problem
    checks: list[Check] = field(default_factory=list)
    exhibits: list[Curve | Picture] = field(default_factory=list)
    failure: str = ""
    wall_time: float = 0.0

    @property
    def passed(self) -> bool:
        """Whether it was finished, with at least one comparison, and missed nothing."""
        return not self.failure and bool(self.checks) and all(c.passed for c in self.checks)

    def as_dict(self) -> dict[str, Any]:
        """Everything but the exhibits, ready for JSON."""
        return {
            "problem": self.problem.name,
            "title": self.problem.title,
            "passed": self.passed,
            "failure": self.failure,
            "wall_time": self.wall_time,
            "checks": [
                vars(c) | {"error": c.error if math.isfinite(c.error) else None, "passed": c.passed}
                for c in self.checks
            ],
        }


@dataclass
class Problem:
    """A folder with ``problem.py``, ``README.md`` and case files.

    Raises:
        CaseError: There is no such folder, or it has no ``problem.py``.
    """

    folder: Path

    def __post_init__(self) -> None:
        if not (self.folder / "problem.py").is_file():
            raise CaseError(
                f"{self.folder}: has no problem.py; a problem is a folder with problem.py, case "
                "files and README.md"
            )

    @property
    def name(self) -> str:
        """Name of the folder."""
        return self.folder.resolve().name

    @property
    def page(self) -> str:
        """The page that explains it, as Markdown."""
        path = self.folder / "README.md"
        return path.read_text() if path.is_file() else f"# {self.title}\n"

    @cached_property
    def module(self) -> ModuleType:
        """Its ``problem.py``."""
        path = self.folder / "problem.py"
        spec = importlib.util.spec_from_file_location(f"cdem_verification_{self.name}", path)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        try:
            spec.loader.exec_module(module)
        except Exception as error:  # of a user's own problem
            raise CaseError(
                f"{path}: cannot be imported: {type(error).__name__}: {error}"
            ) from None
        for wanted in ("run", "theory"):
            if not callable(getattr(module, wanted, None)):
                raise CaseError(f"{path}: has no function {wanted}")
        return module

    @property
    def title(self) -> str:
        """First line of the text at the top of ``problem.py``."""
        return (self.module.__doc__ or self.name).strip().splitlines()[0].rstrip(".")

    @property
    def quick(self) -> bool:
        """Whether it belongs to the set that is run by default."""
        return bool(getattr(self.module, "QUICK", True))

    @property
    def paper(self) -> str:
        """Figures and tables of Feng et al. (2014) that it is of, or nothing."""
        return str(getattr(self.module, "PAPER", ""))

    def run(self, *, full: bool = False, threads: int | None = None) -> Outcome:
        """Run it; an error inside is a failure of the outcome, not an exception."""
        study = Study(self.folder, full=full, threads=threads)
        failure, began = "", time.perf_counter()
        try:
            self.module.run(study)
        except CdemError as error:
            failure = str(error)
        except Exception as error:  # one broken problem must not hide the answers of the others
            failure = f"{_place(error, self.folder)}: {type(error).__name__}: {error}"
        else:
            failure = "" if study.checks else "checks nothing"
        return Outcome(self, study.checks, study.exhibits, failure, time.perf_counter() - began)


def problems_of_paper() -> list[Problem]:
    """The shipped problems of Feng et al. (2014), in the order of its figures."""
    found = [problem for problem in problems() if problem.paper]
    return sorted(found, key=lambda problem: int(re.findall(r"\d+", problem.paper)[0]))


def problems(names: Iterable[str] = ()) -> list[Problem]:
    """Find problems.

    Args:
        names: Names of shipped problems or paths of folders; default all shipped problems.

    Raises:
        CaseError: A name is neither.
    """
    shipped = sorted(path.parent.name for path in SHIPPED.glob("*/problem.py"))
    found = []
    for name in list(names) or shipped:
        if name in shipped:
            found.append(Problem(SHIPPED / name))
        elif Path(name).is_dir():
            found.append(Problem(Path(name)))
        else:
            close = difflib.get_close_matches(name, shipped, n=1)
            hint = f"; did you mean {close[0]}?" if close else ""
            raise CaseError(f"no problem or folder {name!r}{hint} There are: {', '.join(shipped)}")
    return found


def break_factor(simulation: Simulation, every: int = 1) -> float:
    """Step until the first bond breaks; the factor on the first traction's history then.

    Args:
        simulation: Of a case whose first traction grows with a history.
        every: Steps between looks.

    Returns:
        The factor, or infinity if the history ends with all bonds intact.
    """
    history = simulation.case.loads.tractions[0].history
    assert history is not None
    times, factors = zip(*history, strict=True)
    while sum(simulation.broken.values()) == 0:
        if simulation.time > times[-1]:
            return math.inf
        simulation.step(every)
    return float(np.interp(simulation.time, times, factors))


def _place(error: Exception, folder: Path) -> str:
    """File and line of a problem at which an exception came up."""
    place, trace = str(folder), error.__traceback__
    while trace is not None:
        if Path(trace.tb_frame.f_code.co_filename).parent == folder:
            place = f"{trace.tb_frame.f_code.co_filename}:{trace.tb_lineno}"
        trace = trace.tb_next
    return place
