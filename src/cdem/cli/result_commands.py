"""Verbs of the command line that look at results: info, plot, render, runout, export."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from typer.core import TyperCommand

from cdem.cli.options import print_paths
from cdem.errors import CaseError, CdemError

ResultFolder = Annotated[Path, typer.Argument(metavar="DIR", help="Result folder of a run.")]


def info(folder: ResultFolder) -> None:
    """Say what a run did."""
    from cdem.output import report

    print(report.info(_results(folder)).rstrip())


def plot(folder: ResultFolder) -> None:
    """Draw histories and energies as PNG."""
    from cdem.output import figures

    print_paths(figures.plot(_results(folder)))


def _fields() -> list[str]:
    from cdem.output.shown import SHOWN

    return list(SHOWN)


class Fields(TyperCommand):
    """The verb render, whose help ends with the fields."""

    def format_epilog(self, ctx: Any, formatter: Any) -> None:
        from cdem.output.shown import SHOWN

        with formatter.section("Fields, of which a run has some"):
            formatter.write_dl([(shown.name, shown.meaning) for shown in SHOWN.values()])


def render(
    folder: ResultFolder,
    field: Annotated[
        str,
        typer.Option(
            help="Field that colours the picture, of those below.", autocompletion=_fields
        ),
    ] = "displacement",
    time: Annotated[
        float | None, typer.Option(help="Only the frame next to this time [s].")
    ] = None,
    cut: Annotated[
        str | None,
        typer.Option(
            "--slice",
            metavar="PLANE",
            help="Cut through the rock: x=VALUE, y=VALUE, z=VALUE, or upright over X0,Y0,X1,Y1.",
        ),
    ] = None,
    before_after: Annotated[
        bool, typer.Option("--before-after", help="Only the first and last frame, side by side.")
    ] = False,
    movie: Annotated[bool, typer.Option("--movie", help="Also make an animation.")] = False,
) -> None:
    """Draw the model as pictures or an animation."""
    if before_after and time is not None:
        raise typer.BadParameter("--time and --before-after exclude one another")
    from cdem.output import render as drawing

    paths = drawing.render(
        _results(folder), field=field, time=time, cut=cut, before_after=before_after, movie=movie
    )
    print_paths(paths)


def runout(
    folder: ResultFolder,
    groups: Annotated[
        str | None, typer.Option(metavar="A,B", help="Moving groups; default those that moved.")
    ] = None,
    direction: Annotated[
        str, typer.Option(metavar="AZIMUTH", help="Degrees clockwise from y, or auto.")
    ] = "auto",
    cell: Annotated[
        float | None, typer.Option(help="Cell of the map [m]; default about an element's size.")
    ] = None,
    sections: Annotated[
        list[str] | None,
        typer.Option("--section", metavar="X0,Y0,X1,Y1", help="Line to look through; repeatable."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print runout.json instead.")] = False,
) -> None:
    """Measure front, reach, H/L, deposit, sections and pieces; write maps and tables."""
    from cdem.output import runout as measuring

    found = measuring.measure(
        _results(folder),
        groups=None if groups is None else [name.strip() for name in groups.split(",")],
        direction=None if direction == "auto" else _numbers(direction, "--direction", 1)[0],
        cell=cell,
        sections=[_numbers(line, "--section", 4) for line in sections or []],
    )
    paths = found.write(folder)
    try:
        paths.append(found.draw(folder))
    except CdemError as error:  # without the extra that draws, the numbers are whole
        print(f"no deposit.png: {error}", file=sys.stderr)
    if as_json:
        print((folder / "runout.json").read_text().rstrip())
        return
    print(found.text())
    print_paths(paths)


def _numbers(text: str, option: str, count: int) -> list[float]:
    """Numbers between commas; wrong usage if they are not numbers, or not so many."""
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count:
        what = "a number" if count == 1 else f"{count} numbers with commas between"
        raise typer.BadParameter(f"{option} needs {what}, got {text!r}")
    return numbers


def export(
    folder: ResultFolder,
    to: Annotated[Literal["vtu"], typer.Option("--to", help="File format.")] = "vtu",
) -> None:
    """Write the frames as files for ParaView and the like."""
    from cdem.output import reader

    print_paths(reader.export(_results(folder), to=to))


def _results(folder: Path) -> Path:
    if not folder.is_dir():
        raise CaseError(f"{folder}: no such folder; name the result folder of a run")
    from cdem.run.result_folder import RESULT_FILES

    if not {path.name for path in folder.iterdir()} & RESULT_FILES:
        raise CaseError(f"{folder}: is not a result folder; 'cdem run CASE.yaml' makes one")
    return folder
