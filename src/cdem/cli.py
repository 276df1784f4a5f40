"""The program ``cdem``: one function for each verb. What they need is imported when they run."""

from __future__ import annotations

import difflib
import json
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from cdem import __version__, cli_results
from cdem.errors import BodyError, CaseError, CdemError

if TYPE_CHECKING:
    from cdem.simulation import Simulation
    from cdem.verify import Outcome

STOPPED = 4  # exit status of a run that was stopped by a signal and can be resumed
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

CaseFile = Annotated[Path, typer.Argument(metavar="CASE.yaml", help="Case file.")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a value of the case; repeatable."),
]
Threads = Annotated[int | None, typer.Option(min=1, help="Threads; default all cores.")]


def main() -> None:
    """Run the program; a user's mistake is one message on stderr, never a traceback."""
    try:
        app()
    except CdemError as error:
        print(error, file=sys.stderr)
        sys.exit(error.exit_code)
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


# ------------------------------------------------------------------ cases


@app.command()
def new(
    template: Annotated[str | None, typer.Argument(help="Name; by default, list all.")] = None,
    folder: Annotated[Path, typer.Argument(metavar="[DIR]", help="Where to write it.")] = Path("."),
    force: Annotated[bool, typer.Option("--force", help="Replace files that exist.")] = False,
) -> None:
    """Write a commented case to start from."""
    home = resources.files("cdem") / "templates"
    names = sorted(f.name[:-5] for f in home.iterdir() if f.name.endswith(".yaml"))
    if template is None:
        for name in names:
            title = (home / f"{name}.yaml").read_text().splitlines()[0].lstrip("# ")
            print(f"{name:<12}{title}")
        return
    if template not in names:
        close = difflib.get_close_matches(template, names, n=1)
        hint = f"; did you mean {close[0]}?" if close else ""
        raise typer.BadParameter(f"no template '{template}'{hint} There are: {', '.join(names)}")
    case = (home / f"{template}.yaml").read_text()
    meshes = [f.name for f in home.iterdir() if f.name.endswith(".msh") and f.name in case]
    files = {f"{template}.yaml": case} | {name: (home / name).read_text() for name in meshes}
    for name in files:
        if (folder / name).exists() and not force:
            raise CaseError(f"{folder / name}: exists already; use --force or name another folder")
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text)
        print(f"wrote {folder / name}")
    print(f"next: cdem run {folder / template}.yaml")


@app.command()
def check(
    case_file: CaseFile,
    settings: Settings = None,
    threads: Threads = None,
    picture: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.png", help="Draw groups, supports, loads, interfaces; or a refused body."
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Read everything and report on the model; runs nothing."""
    if picture and picture.suffix.lower() != ".png":
        raise typer.BadParameter(f"--picture writes PNG: name a .png file, not {picture}")
    from cdem.case import Case

    case = Case.load(case_file, settings or [])
    from cdem.simulation import Simulation

    try:
        simulation = Simulation(case, threads=threads)
    except BodyError as refused:
        if picture:
            from cdem import preview, scene

            scene.write_image(picture, preview.draw_refused(refused))
            print(f"wrote {picture}: the body, with what is wrong in red")
        raise
    audit = simulation.audit
    print(json.dumps(audit.as_dict(), indent=2) if as_json else audit.text().rstrip())
    if picture:
        from cdem import preview, scene

        scene.write_image(picture, preview.draw_model(simulation))


@app.command()
def mesh(
    landslide_file: Annotated[Path, typer.Argument(metavar="LANDSLIDE.yaml", help="Terrain.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Mesh, .msh or .msh.gz; default LANDSLIDE.msh, here."),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Replace a value; repeatable."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Mesh a landslide from terrain, a sliding surface and bodies outlined in plan."""
    from cdem import terrain

    path = output or Path(f"{landslide_file.stem}.msh")
    solid = terrain.make_mesh(terrain.Landslide.load(landslide_file, settings or []))
    terrain.write(solid, path)
    facts = terrain.measure(solid)
    print(json.dumps(facts, indent=2) if as_json else f"{path}: {terrain.text(facts)}")


@app.command()
def schema(
    of: Annotated[Literal["case", "study"], typer.Argument(help="Kind of file.")] = "case",
) -> None:
    """Print the JSON schema of a case or a study, for editors."""
    from cdem.case import Case
    from cdem.study import Study

    print(json.dumps((Case if of == "case" else Study).schema(), indent=2))


# ------------------------------------------------------------------ running


@app.command()
def critical(
    case_file: CaseFile,
    between: Annotated[
        tuple[float, float], typer.Option(help="A value that rests, one that fails.")
    ],
    parameter: Annotated[
        str | None, typer.Option(metavar="PATH", help="Value of the case to vary.")
    ] = None,
    factor: Annotated[
        bool, typer.Option("--factor", help="Vary the factor of safety on all strengths instead.")
    ] = False,
    tolerance: Annotated[float, typer.Option(help="Width of the bracket to reach.")] = 0.01,
    limits: Annotated[
        list[str] | None,
        typer.Option(
            "--criterion",
            metavar="NAME=VALUE",
            help="Another limit of failure: travel, far, stall_steps or most_steps; repeatable.",
        ),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON at the end.")] = False,
) -> None:
    """Find the value at which a case fails, by bisection of its last, static stage.

    A trial is stable when it comes to rest. It has failed when a node has moved 2 % (travel) of the
    mean face size while the kinetic energy grew, or the whole of it (far), or goes on moving at no
    lower rate while the unbalance ratio stalls, or found no rest in a million steps. Trials start
    from the last stable state, unless the parameter makes another model (model.*, materials.*).
    """
    if (parameter is None) == (not factor):
        raise typer.BadParameter("give either --parameter PATH or --factor")
    from cdem import critical as search
    from cdem.case import Case
    from cdem.criterion import Criterion

    case = Case.load(case_file, settings or [])
    vary = search.parameter(parameter) if parameter else search.strength_reduction()
    name = parameter or "factor"
    criterion = Criterion.read(limits or [])
    print(f"a trial {criterion.text()}", file=sys.stderr)

    def report(trial: search.Trial, stable: float, failed: float) -> None:
        verdict = "stable" if trial.stable else "fails"
        print(
            f"{name} = {trial.value:.6g}: {verdict} ({trial.steps:,} steps, {trial.why}); "
            f"between {min(stable, failed):.6g} and {max(stable, failed):.6g}",
            file=sys.stderr,
            flush=True,
        )

    found = search.find_critical(
        case,
        vary,
        between,
        tolerance=tolerance,
        criterion=criterion,
        threads=threads,
        report=report,
    )
    if as_json:
        print(json.dumps({"parameter": name} | found.as_dict(), indent=2))
    else:
        print(f"{name}: rests at {found.stable:.6g}, fails at {found.failed:.6g}")


@app.command()
def sweep(
    study_file: Annotated[Path, typer.Argument(metavar="STUDY.yaml", help="Study file.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for all results; default STUDY.sweep, here."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Local processes, of one thread; default all cores.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Use this Dask scheduler instead.")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
) -> None:
    """Run a study: many variants of a case. What is finished is never repeated.

    Ctrl-C ends it; the same command goes on. Exit status 3 says that runs have failed.
    """
    if quiet and as_json:
        raise typer.BadParameter("--quiet and --json exclude one another")
    if workers and scheduler:
        raise typer.BadParameter("--workers and --scheduler exclude one another")
    from cdem.progress import line
    from cdem.study import Study
    from cdem.sweep import describe, run_study

    folder = output or Path(f"{study_file.stem}.sweep")
    tty = sys.stderr.isatty()
    with (
        _stop_on_signal("stopping, finished runs are kept") as stop,
        line(silent=quiet or (as_json and not tty), tty=tty) as show,
    ):
        table = run_study(
            Study.load(study_file),
            folder,
            workers=workers,
            scheduler=scheduler,
            progress=None
            if show is None
            else lambda p: show(str(p.finished == p.total), *describe(p)),
            should_stop=lambda: bool(stop),
        )
    paths = table.write(folder)
    if not quiet:
        paths += _draw_plots(table, folder)
    if as_json:
        print(json.dumps(table.as_dict(), indent=2))
    elif not quiet:
        cli_results.print_paths(paths)
    for run in table.failed:
        print(f"failed: {run.text()}", file=sys.stderr)
    if table.waiting:
        print(f"stopped; {table.waiting} runs are left: the same command goes on", file=sys.stderr)
        raise typer.Exit(STOPPED)
    if table.failed:
        raise typer.Exit(3)


def _draw_plots(table: Any, folder: Path) -> list[Path]:
    """Draw a study's plots; the table is whole without them, so a missing extra is only said."""
    from cdem.sweep_plots import draw_all

    try:
        return draw_all(table, folder / "plots")
    except CdemError as error:
        if isinstance(error, CaseError) and not table.failed:
            raise
        print(f"no plots: {error}", file=sys.stderr)
        return []


@app.command()
def verify(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME]...", help="Problems, or folders of your own; default quick."
        ),
    ] = None,
    full: Annotated[
        bool, typer.Option("--full", help="All problems, in all variants; takes hours.")
    ] = False,
    report: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the manual: .html, or .md (table).")
    ] = None,
    threads: Threads = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead.")] = False,
    listing: Annotated[bool, typer.Option("--list", help="Only list the problems.")] = False,
) -> None:
    """Compute problems whose answer is known and compare; exit status 3 if one is missed."""
    from cdem import verify as verification

    chosen = verification.problems(names or [])
    if listing:
        for problem in chosen:
            print(f"{problem.name:<20}{'' if problem.quick else '(full) '}{problem.title}")
        return
    manual = None
    if report:
        from cdem.manual import Manual

        manual = Manual(report)
    if not names and not full:
        chosen = [problem for problem in chosen if problem.quick]
    outcomes: list[verification.Outcome] = []
    for problem in chosen:
        if not as_json:
            print(f"{problem.name}: {problem.title}", flush=True)
        outcomes.append(problem.run(full=full, threads=threads))
        if not as_json:
            _print_outcome(outcomes[-1])
        if manual:  # after each, so that nothing is lost if the next one is stopped
            manual.add(outcomes[-1])
    passed = sum(outcome.passed for outcome in outcomes)
    if as_json:
        print(json.dumps([outcome.as_dict() for outcome in outcomes], indent=2))
    else:
        print(f"{passed} of {len(outcomes)} problems pass" + (f"; see {report}" if report else ""))
    if passed < len(outcomes):
        raise typer.Exit(3)


def _print_outcome(outcome: Outcome) -> None:
    from cdem.verify import HEADINGS

    rows = [HEADINGS, *(check.texts() for check in outcome.checks)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEADINGS))]
    for row in rows if outcome.checks else []:
        print("  " + "  ".join(f"{t:<{w}}" for t, w in zip(row, widths, strict=True)).rstrip())
    if outcome.failure:
        print(f"  FAILED: {outcome.failure}")
    print(f"  {outcome.wall_time:.1f} s", flush=True)


@app.command()
def benchmark(
    full: Annotated[
        bool, typer.Option("--full", help="Also a million tets; needs 8 GB and half an hour.")
    ] = False,
    threads: Threads = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead.")] = False,
) -> None:
    """Measure the speed of the kernels against the machine's own limits."""
    import os

    from cdem import benchmark as bench

    threads = threads or os.cpu_count() or 1
    limits = bench.machine(threads)
    if not as_json:
        for key, value in limits.items():
            print(
                f"{key}: {value / 1e9:.1f} G/s" if isinstance(value, float) else f"{key}: {value}"
            )
        print(f"{'what':<34}{'size':>10}{'thr':>4}{'median':>10} (least .. most)")
    rows = []
    for row in bench.run(list(bench.SIZES)[: 3 if full else 2], threads):
        rows.append(row)
        if not as_json:
            print(row.text(), flush=True)
    if as_json:
        print(json.dumps({"machine": limits, "rows": [vars(row) for row in rows]}, indent=2))


@app.command()
def run(
    case_file: CaseFile,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Result folder; default CASE.results, here."),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    device: Annotated[Literal["cpu", "cuda"], typer.Option(help="Where to compute.")] = "cpu",
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the checkpoint.")] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace what the result folder holds.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print summary.json at the end.")] = False,
) -> None:
    """Run all stages of a case. Ctrl-C stops it cleanly, to be resumed."""
    if resume and overwrite:
        raise typer.BadParameter("--resume and --overwrite exclude one another")
    if quiet and as_json:
        raise typer.BadParameter("--quiet and --json exclude one another")
    folder = output or Path(f"{case_file.stem}.results")
    with _stop_on_signal() as stop:
        from cdem.case import Case

        case = Case.load(case_file, settings or [])
        from cdem.simulation import Simulation

        if resume:
            _compare_cases(case, folder)

        simulation = Simulation(
            case,
            threads=threads,
            output=folder,
            overwrite=overwrite,
            resume=resume,
            device=device,
        )
        status = _run(simulation, folder, stop, quiet=quiet, as_json=as_json)
    summary = folder / "summary.json"
    if as_json:
        print(summary.read_text().rstrip())
    elif not quiet:
        print(f"{status}; results are in {folder}")
    if status == "stopped":
        again = _resume_command(case_file, folder, settings or [], threads)
        print(f"stopped with a checkpoint; go on with: {again}", file=sys.stderr)
        raise typer.Exit(STOPPED)


def _run(
    simulation: Simulation, folder: Path, stop: list[str], *, quiet: bool, as_json: bool
) -> str:
    from cdem.progress import watch

    tty = sys.stderr.isatty()
    silent = quiet or (as_json and not tty)
    if not silent:
        for warning in simulation.audit.warnings:
            print(f"warning: {warning}", file=sys.stderr)
    with watch(silent=silent, tty=tty) as progress:
        status = simulation.run(progress, lambda: bool(stop))
    if status != "stopped":
        _write_report(folder, silent=silent)
    return status


def _write_report(folder: Path, *, silent: bool) -> None:
    """Write report.html; the results are whole without it, so a missing extra is only said."""
    from cdem import view

    try:
        view.report(folder)
    except (CdemError, ImportError) as error:
        if not silent:
            print(f"no report.html: {error}", file=sys.stderr)


def _compare_cases(case: Any, folder: Path) -> None:
    """Say so if a run is resumed with another case than it was begun with."""
    path = folder / "case.yaml"
    if not path.is_file():
        return
    changes = [
        line
        for line in difflib.ndiff(path.read_text().splitlines(), case.dump().splitlines())
        if line[0] in "+-"
    ]
    if changes:
        print(
            f"warning: this is not the case that {folder} was begun with: "
            + "; ".join(" ".join(line.split()) for line in changes[:4]),
            file=sys.stderr,
        )


@contextmanager
def _stop_on_signal(kept: str = "stopping with a checkpoint") -> Iterator[list[str]]:
    """Collect SIGINT and SIGTERM instead of dying; a second one interrupts at once."""
    received: list[str] = []

    def receive(number: int, frame: FrameType | None) -> None:
        if received:
            raise KeyboardInterrupt
        received.append(signal.Signals(number).name)
        print(f"\n{received[0]}: {kept}; again: at once", file=sys.stderr)

    before = {number: signal.signal(number, receive) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield received
    except KeyboardInterrupt:
        print("stopped at once; the last checkpoint, if any, is kept", file=sys.stderr)
        raise typer.Exit(STOPPED) from None
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _resume_command(case: Path, folder: Path, settings: list[str], threads: int | None) -> str:
    import shlex

    words = ["cdem", "run", str(case), "-o", str(folder), "--resume"]
    for setting in settings:
        words += ["--set", setting]
    return shlex.join(words + ([] if threads is None else ["--threads", str(threads)]))


for _verb in (cli_results.info, cli_results.plot, cli_results.render, cli_results.runout,
              cli_results.export):  # fmt: skip
    app.command()(_verb)


@app.command()
def doctor() -> None:
    """Say what works on this machine, and how to mend what does not."""
    from cdem.doctor import report

    text, healthy = report()
    print(text)
    if not healthy:
        raise typer.Exit(1)
