"""The program ``cdem``: its commands, loaded on demand, and the handling of their errors."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from cdem._version import __version__
from cdem.case import child
from cdem.cli.messages import Messages
from cdem.cli.verbs import Verbs
from cdem.errors import CdemError
from cdem.ranks.launch import launched, launched_rank

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


FIRST_WORDS = 2.0
"""Without MPI the other ranks wait so long for the words of rank 0: their end may end it too [s]."""
RANKED = ("run", "doctor")
"""Commands that several ranks may run together."""


def main() -> None:
    """Run the program; a user's mistake is one message on stderr, never a traceback."""
    with _silence() if launched_rank() else contextlib.redirect_stderr(Messages(sys.stderr)):
        _main()


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Drop all that is printed: rank 0 tells it."""
    with (
        open(os.devnull, "w") as nowhere,
        contextlib.redirect_stdout(nowhere),
        contextlib.redirect_stderr(nowhere),
    ):
        yield


def _failing_together() -> contextlib.AbstractContextManager[None]:
    """With several ranks: an error of all is told once, an error of some ends all."""
    if launched() == 1:
        return contextlib.nullcontext()
    from cdem.ranks.mpi import world

    try:
        return world().failures.told()
    except CdemError:
        if launched_rank():
            time.sleep(FIRST_WORDS)
        raise


def _main() -> None:
    try:
        _pass_over_matplotlibrc()
        with _failing_together():
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
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print version."),
    ] = False,
) -> None:
    verb = context.invoked_subcommand
    if launched() > 1 and verb not in RANKED:
        raise CdemError(f"cdem {verb} runs on one rank")
