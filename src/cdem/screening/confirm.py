"""The worst bodies of a screening, computed: factors of safety by `cdem critical`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cdem.case.source import Source
from cdem.errors import MeshError
from cdem.screening.cases import BETWEEN, FAR, GRAVITY, write_case
from cdem.screening.fos_map import FosMap
from cdem.study.criterion import Criterion
from cdem.study.schema import CriticalSearch
from cdem.study.study import Study
from cdem.study.sweep import SweepProgress, run_studies

TOLERANCE = 0.01
"""Width of the bracket, relative to the factor of the closed form."""


@dataclass(frozen=True)
class Confirmed:
    """A computed body.

    Attributes:
        number: Number of the body in the list, from 1.
        closed: Factor of safety by the closed form.
        computed: Factor by `cdem critical`; nan if there is none.
        why: Why there is no computed factor, or nothing.
    """

    number: int
    closed: float
    computed: float
    why: str

    def text(self) -> str:
        """Both numbers in one line."""
        if self.why:
            return f"  {self.number:3}  closed form {self.closed:.3f}, not computed: {self.why}"
        apart = 100 * (self.computed / self.closed - 1)
        return (
            f"  {self.number:3}  closed form {self.closed:.3f}, computed {self.computed:.3f} "
            f"({apart:+.1f} %)"
        )


def confirm(
    found: FosMap,
    count: int,
    folder: Path,
    *,
    system: str | None = None,
    workers: int | None = None,
    progress: Callable[[SweepProgress], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> list[Confirmed]:
    """Write a case for each of the worst bodies, and find its factor of safety by strength reduction.

    Args:
        found: The bodies.
        count: Number of bodies.
        folder: Folder of cases, meshes and results; finished results of the same cases are used.
        system: Map projection of the ground, EPSG code or WKT; None for none.
        workers: Local processes, each of one thread; None for one per core.
        progress: Called a few times per second.
        should_stop: Called as often; True ends it with the results so far.

    Raises:
        BackendError: A worker lacks something.
    """
    folder.mkdir(parents=True, exist_ok=True)
    studies: dict[int, tuple[Study, Path]] = {}
    refused: dict[int, str] = {}
    density = found.limits.unit_weight / GRAVITY
    for number, body in enumerate(found.bodies[:count], 1):
        if not 0 < body.factor < np.inf:
            refused[number] = "it lifts off, whatever its strength"
            continue
        try:
            path = write_case(body, number, found, folder, system)
        except MeshError as error:
            refused[number] = str(error)
            continue
        studies[number] = (_study(path, body.factor, density), folder / "runs" / path.stem)
    tables = run_studies(
        list(studies.values()), workers=workers, progress=progress, should_stop=should_stop
    )
    out = []
    for number, body in enumerate(found.bodies[:count], 1):
        computed, why = np.nan, refused.get(number, "")
        if number in studies:
            table = tables[list(studies).index(number)]
            computed = float(table.column("value")[0])
            why = table.runs[0].why or ("stopped" if np.isnan(computed) else "")
        out.append(Confirmed(number, body.factor, computed, why))
    return out


def _study(path: Path, factor: float, density: float) -> Study:
    """The search for the factor of a case, near that of the closed form."""
    search = CriticalSearch(
        factor=True,
        between=[part * factor for part in BETWEEN],
        tolerance=TOLERANCE * factor,
        criterion=Criterion(far=FAR),
    )
    data = {
        "case": path.name,
        "parameters": {"materials.rock.density": [density]},
        "critical": search.model_dump(),
    }
    return Study.of(data, Source(file=str(path.parent / "study.yaml")))
