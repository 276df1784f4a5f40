"""Commands that show results: info, plot, render, view, runout, export."""

from __future__ import annotations

import contextlib
import json
import os
import sys
import tempfile
import webbrowser
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from typer.core import TyperCommand

from cdem.cli.options import AsJson, print_paths
from cdem.errors import BackendError, CaseError, CdemError

ResultFolder = Annotated[Path, typer.Argument(metavar="DIR", help="Result folder of a run.")]


def info(folder: ResultFolder, as_json: AsJson = False) -> None:
    """Summarize a run."""
    from cdem.output import report
    from cdem.output.reader import read_summary

    if as_json:
        print(json.dumps(read_summary(_results(folder)), indent=2))
        return
    print(report.info(_results(folder)).rstrip())


def plot(folder: ResultFolder, as_json: AsJson = False) -> None:
    """Draw histories and energies as PNG."""
    from cdem.output import figures

    print_paths(figures.plot(_results(folder)), as_json=as_json)


def _fields() -> list[str]:
    from cdem.case.shown_fields import SHOWN

    return list(SHOWN)


class Fields(TyperCommand):
    """The command render; its help ends with the list of fields."""

    def format_epilog(self, ctx: Any, formatter: Any) -> None:
        from cdem.case.shown_fields import SHOWN

        with formatter.section("Fields (a run has some of them)"):
            formatter.write_dl([(shown.name, shown.meaning) for shown in SHOWN.values()])


CLASSES = {"render": Fields}
"""Command classes that differ from typer's own."""


def render(
    folder: ResultFolder,
    field: Annotated[
        str,
        typer.Option(help="Field to colour by, from the list below.", autocompletion=_fields),
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
    from cdem.case.shown_fields import SHOWN

    if field not in SHOWN:
        import difflib

        close = difflib.get_close_matches(field, SHOWN, n=1)
        hint = f"did you mean {close[0]}?" if close else f"choose one of: {', '.join(SHOWN)}"
        raise CaseError(f"no field {field!r} to draw; {hint}")
    from cdem.output import render as drawing

    paths = drawing.render(
        _results(folder), field=field, time=time, cut=cut, before_after=before_after, movie=movie
    )
    print_paths(paths)


def view(
    folder: ResultFolder,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port; 0 for any.")] = 0,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Only print the address.")
    ] = False,
    save: Annotated[
        Path | None,
        typer.Option(metavar="FILE.html", help="Write the page into a file instead."),
    ] = None,
    budget: Annotated[
        float | None,
        typer.Option(metavar="MB", min=0.2, help="Largest size of that file; default 10."),
    ] = None,
) -> None:
    """Show a run in the browser, live while it runs. Ctrl-C ends it."""
    _results(folder)
    if save is not None:
        from cdem.output.report import BUDGET, report

        print_paths(report(folder, save, budget=int(1e6 * budget) if budget else BUDGET))
        return
    if budget is not None:
        raise typer.BadParameter("--budget goes with --save")
    from cdem.output.view import ViewServer

    with ViewServer(folder, port) as server:
        print(f"{server.address}\nCtrl-C ends it", flush=True)
        with tempfile.TemporaryDirectory(prefix="cdem-view-") as private:
            if not no_browser and _has_screen():
                webbrowser.open(_redirect(Path(private), server.address))
            with contextlib.suppress(KeyboardInterrupt):
                server.serve_forever()


def _redirect(folder: Path, address: str) -> str:
    """Address of a file that leads to the page; only this user can read the file.

    Other users can see the arguments of a browser, and the page's address holds its token.
    """
    path = folder / "view.html"
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(f'<!doctype html><meta http-equiv="refresh" content="0; url={address}">')
    return path.as_uri()


def _has_screen() -> bool:
    """Whether a browser can open a window; a browser in the terminal would block the terminal."""
    return sys.platform == "darwin" or any(
        os.environ.get(n) for n in ("DISPLAY", "WAYLAND_DISPLAY")
    )


def runout(
    folder: ResultFolder,
    groups: Annotated[
        str | None, typer.Option(metavar="A,B", help="Moving groups; default: groups that moved.")
    ] = None,
    direction: Annotated[
        str, typer.Option(metavar="AZIMUTH", help="Degrees clockwise from y, or auto.")
    ] = "auto",
    cell: Annotated[
        float | None, typer.Option(help="Cell of the map [m]; default about an element's size.")
    ] = None,
    sections: Annotated[
        list[str] | None,
        typer.Option("--section", metavar="X0,Y0,X1,Y1", help="Line of a section; repeatable."),
    ] = None,
    against: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Mapped outline to compare with.")
    ] = None,
    classes: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Use the colour classes of this run.")
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
        against=against,
        classes=classes,
    )
    paths = list(dict.fromkeys(p if p.parent == folder else p.parent for p in found.write(folder)))
    try:
        paths.append(found.write_geopackage(folder))
    except BackendError as error:  # numbers and rasters need no extra
        print(f"no runout.gpkg: {error}", file=sys.stderr)
    try:
        paths += found.draw(folder)
    except CdemError as error:
        print(f"no pictures: {error}", file=sys.stderr)
    if as_json:
        print((folder / "runout.json").read_text().rstrip())
        return
    print(found.text())
    print_paths(paths)


def _numbers(text: str, option: str, count: int) -> list[float]:
    """Numbers separated by commas; a usage error for other text or another count."""
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count:
        needed = "a number" if count == 1 else f"{count} numbers separated by commas"
        raise typer.BadParameter(f"{option} needs {needed}, got {text!r}")
    return numbers


def export(
    folder: ResultFolder,
    to: Annotated[Literal["vtu"], typer.Option("--to", help="File format.")] = "vtu",
    as_json: AsJson = False,
) -> None:
    """Write the frames as files for ParaView and the like."""
    from cdem.output import reader

    print_paths(reader.export(_results(folder), to=to), as_json=as_json)


def _results(folder: Path) -> Path:
    if folder.is_file():
        case = folder.suffix.lower() in (".yaml", ".yml")
        hint = f"; 'cdem check {folder}' checks a case" if case else ""
        raise CaseError(f"{folder}: is a file; name the result folder of a run{hint}")
    if not folder.is_dir():
        raise CaseError(f"{folder}: no such folder; name the result folder of a run")
    from cdem.run.result_folder import RESULT_FILES
    from cdem.run.written_files import refuse_links

    if not {path.name for path in folder.iterdir()} & RESULT_FILES:
        raise CaseError(f"{folder}: is not a result folder; 'cdem run CASE.yaml' makes one")
    refuse_links(folder)
    return folder
