"""The program ``cdem``: one function for each verb. What they need is imported when they run."""

from __future__ import annotations

import contextlib
import sys
from typing import Annotated

import typer

from cdem._version import __version__
from cdem.cli.installation_commands import benchmark, doctor, verify
from cdem.cli.law_commands import law
from cdem.cli.messages import Messages
from cdem.cli.model_commands import check, mesh, new, schema
from cdem.cli.result_commands import export, info, plot, render, runout, view
from cdem.cli.run_commands import run
from cdem.cli.site_commands import site
from cdem.cli.study_commands import critical, sweep
from cdem.errors import CdemError

app = typer.Typer(
    name="cdem",
    no_args_is_help=True,
    add_completion=False,
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
    except BrokenPipeError:  # the reader of our output, e.g. head, has enough
        sys.stderr.close()
        sys.exit(0)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        print(f"{where}{error.strerror or error}", file=sys.stderr)
        sys.exit(1)


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


for _verb in (new, check, site, mesh, schema, critical, sweep, verify, benchmark, run,
              info, plot, render, view, runout, export, doctor):  # fmt: skip
    app.command()(_verb)
app.add_typer(law, name="law")
