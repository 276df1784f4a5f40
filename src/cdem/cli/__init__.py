"""The program ``cdem``: its commands, loaded on demand, and the handling of their errors."""

from __future__ import annotations

import contextlib
import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from cdem._version import __version__
from cdem.case import child
from cdem.cli.messages import Messages
from cdem.cli.verbs import Verbs
from cdem.errors import CdemError

app = typer.Typer(
    name="cdem",
    cls=Verbs,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Rock as blocks of finite elements that touch, bond, break and slide (CDEM).",
    epilog="Start with: cdem new incline; cdem check incline.yaml; cdem run incline.yaml",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Run the program; a user's mistake is one message on stderr, never a traceback."""
    with contextlib.redirect_stderr(Messages(sys.stderr)):
        _main()


def _main() -> None:
    try:
        _pass_over_matplotlibrc()
        app()
    except CdemError as error:
        print(error, file=sys.stderr)
        sys.exit(error.exit_code)
    except MemoryError as error:
        print(
            f"out of memory{f' ({error})' if str(error) else ''}: the model is too large for this "
            "machine or its limits; use fewer elements",
            file=sys.stderr,
        )
        sys.exit(1)
    except BrokenPipeError:  # the reader of the output, e.g. head, closed it
        sys.stderr.close()
        sys.exit(0)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        print(f"{where}{error.strerror or error}", file=sys.stderr)
        sys.exit(1)


def _pass_over_matplotlibrc() -> None:
    """Keep matplotlib from reading a settings file of a stranger in the current folder.

    matplotlib looks for this file only once, when it is imported, and there before other places.
    """
    if not os.path.lexists("matplotlibrc"):
        return
    here = Path.cwd()
    os.chdir(child.AWAY)
    try:
        with contextlib.suppress(ImportError):
            import matplotlib  # noqa: F401
    finally:
        os.chdir(here)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"cdem {__version__}")
        raise typer.Exit


@app.callback()
def _top(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print version."),
    ] = False,
) -> None:
    pass
