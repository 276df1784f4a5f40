"""Arguments, options, signals and printing of paths, shared by several commands."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Annotated, Any

import typer

STOPPED = 4  # exit status of a run that was stopped by a signal and can be resumed

CaseFile = Annotated[Path, typer.Argument(metavar="CASE.yaml", help="Case file.")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a value of the case; repeatable."),
]
Threads = Annotated[
    int | None, typer.Option(min=1, help="Threads; default all cores, or the share of a rank.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead.")]

Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace files that exist.")]


def _tell_of_overwrite(force: bool) -> bool:
    """Accept the earlier name of `--overwrite`, and tell the present one."""
    if force:
        print("warning: --force is now --overwrite; the next version refuses it", file=sys.stderr)
    return force


Force = Annotated[bool, typer.Option("--force", hidden=True, callback=_tell_of_overwrite)]

AllowCode = Annotated[
    bool,
    typer.Option("--allow-code", help="Run the code of own_laws; read it first."),
]
Strict = Annotated[bool, typer.Option("--strict", help="Treat warnings as errors.")]


def print_paths(paths: Path | Iterable[Path], *, as_json: bool = False) -> None:
    """Print one path a line, or a list of JSON."""
    found = [paths] if isinstance(paths, Path) else paths
    if as_json:
        print(json.dumps([str(path) for path in found], indent=2))
        return
    for path in found:
        print(path)


def allow_own_laws(case_file: Path, allowed: bool) -> None:
    """Load the own laws that a case names, if they are allowed; done before the case is read."""
    if not allowed:
        return
    from cdem.own_laws import load_own_laws

    files = raw_data(case_file).get("own_laws")
    if isinstance(files, list) and files and all(isinstance(file, str) for file in files):
        load_own_laws(*(case_file.parent / file for file in files))


def allow_own_laws_of_study(study_file: Path, allowed: bool) -> None:
    """Load the own laws of the case that a study names, if they are allowed."""
    if allowed and isinstance(case := raw_data(study_file).get("case"), str):
        allow_own_laws(study_file.parent / case, allowed)


def raw_data(file: Path) -> dict[str, Any]:
    """A case or study as plain data, unchecked."""
    from cdem.case.input_file import read_text
    from cdem.case.yaml_text import parse

    data = parse(read_text(file, "file"), str(file))
    return data if isinstance(data, dict) else {}


@contextmanager
def stop_on_signal(kept: str = "stopping with a checkpoint") -> Iterator[list[str]]:
    """Collect SIGINT and SIGTERM instead of dying; a second one interrupts at once."""
    received: list[str] = []

    def receive(number: int, frame: FrameType | None) -> None:
        if received:
            raise KeyboardInterrupt
        received.append(signal.Signals(number).name)
        print(f"\n{received[0]}: {kept}; once more to stop at once", file=sys.stderr)

    before = {number: signal.signal(number, receive) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield received
    except KeyboardInterrupt:
        print("stopped at once; the last checkpoint, if any, is kept", file=sys.stderr)
        raise typer.Exit(STOPPED) from None
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def reporting() -> Iterator[Callable[[str, float], None] | None]:
    """A line of progress on a terminal: a function of a text and the share done, or None."""
    from cdem.run.progress import line

    tty = sys.stderr.isatty()
    with line(silent=not tty, tty=tty) as show:
        yield None if show is None else lambda words, part: show("", words, part)


@contextmanager
def executing(
    kept: str, *, silent: bool = False, terminal_only: bool = False
) -> Iterator[dict[str, Callable[..., Any] | None]]:
    """Arguments `progress` and `should_stop` of functions that execute many runs.

    Args:
        kept: Message when a signal comes.
        silent: Whether there is no progress.
        terminal_only: Whether a file gets none.
    """
    from cdem.run.progress import line
    from cdem.study.sweep import describe

    tty = sys.stderr.isatty()
    with (
        stop_on_signal(kept) as stop,
        line(silent=silent or (terminal_only and not tty), tty=tty) as show,
    ):
        tell = None
        if show is not None:
            tell = lambda p: show(str(p.finished == p.total), *describe(p))  # noqa: E731
        yield {"progress": tell, "should_stop": lambda: bool(stop)}
