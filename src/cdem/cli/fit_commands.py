"""Commands that compare runs with observations: fit."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from cdem.cli.options import print_paths
from cdem.errors import CdemError


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
    from cdem.run.progress import line

    what = Fit.load(file)
    tty = sys.stderr.isatty()
    with line(silent=not tty, tty=tty) as show:
        runs = runs_of(what, None if show is None else lambda words, part: show("", words, part))
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
