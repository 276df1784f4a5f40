"""Commands that compare runs with observations: compare, fit."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdem.cli.options import print_paths, reporting
from cdem.errors import CdemError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ROUNDED = 0.05
"""Largest difference of the length of a unit vector from 1."""


def compare(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Result folder of a run.")],
    monitored: Annotated[
        Path,
        typer.Argument(
            metavar="MONITORED",
            help="Table with x, y and dx, dy, dz or los; or a raster along a line of sight.",
        ),
    ],
    los: Annotated[
        str | None,
        typer.Option(
            metavar="E,N,U", help="Direction from the ground to the satellite: 0.61,-0.11,0.78."
        ),
    ] = None,
    unit: Annotated[
        str | None, typer.Option(help="Unit of a raster: mm, cm, m.", show_default="m")
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(metavar="DATE", help="Date of the start of the run, for a column date."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder; default DIR/compare.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the scores as JSON.")] = False,
) -> None:
    """Compare a run with monitored displacements: residuals, scores and a picture.

    Displacements count from the last reset of the run, in the coordinates of the case."""
    from cdem.fit import agreement_products
    from cdem.fit.agreement import compare as agree
    from cdem.fit.monitored import read_monitored

    found = agree(folder, read_monitored(monitored, unit, start), _direction(los))
    into = output or folder / "compare"
    into.mkdir(parents=True, exist_ok=True)
    paths = agreement_products.write(found, into)
    try:
        paths.append(agreement_products.draw(found, into / f"{monitored.stem}.png"))
    except CdemError as error:
        print(f"no picture: {error}", file=sys.stderr)
    if as_json:
        print(json.dumps(found.as_dict(), indent=2))
        return
    print(found.text())
    print_paths(paths)


def _direction(text: str | None) -> NDArray[np.float64] | None:
    """A unit vector: east, north, up."""
    if text is None:
        return None
    import numpy as np

    try:
        vector = np.array([float(word) for word in text.split(",")])
    except ValueError:
        vector = np.zeros(0)
    size = float(np.linalg.norm(vector))
    if len(vector) != 3 or not abs(size - 1) < ROUNDED:
        raise typer.BadParameter(
            f"--los takes a unit vector EAST,NORTH,UP from the ground to the satellite, e.g. "
            f"0.61,-0.11,0.78; got {text}"
        )
    return vector / size


def fit(
    file: Annotated[
        Path, typer.Argument(metavar="FIT.yaml", help="Names a study and the observations.")
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder; default FIT.fit, here.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print fit.json instead.")] = False,
) -> None:
    """Find the parameters of a study that agree with observations, with their uncertainty.

    Reads the results of cdem sweep; runs nothing."""
    from cdem.fit import products
    from cdem.fit.find import find
    from cdem.fit.fitting import Fit
    from cdem.fit.runs import runs_of

    what = Fit.load(file)
    with reporting() as report:
        runs = runs_of(what, report)
    found = find(runs, what.seed)
    folder = output or Path(f"{file.stem}.fit")
    folder.mkdir(parents=True, exist_ok=True)
    paths = products.write(found, folder, what.title)
    try:
        paths += products.draw(found, folder, what.title)
    except CdemError as error:
        print(f"no pictures: {error}", file=sys.stderr)
    if as_json:
        print(json.dumps(products.facts(found, what.title), indent=2))
        return
    print(products.text(found))
    print_paths(paths)
