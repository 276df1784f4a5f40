"""Verbs that make and look at models: new, check, mesh, schema."""

from __future__ import annotations

import difflib
import json
from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

import typer

from cdem.cli.options import AllowCode, CaseFile, Settings, Strict, Threads, allow_own_laws
from cdem.errors import BodyError, CaseError


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
            print(f"{name:<14}{title}")
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
    strict: Strict = False,
    allow_code: AllowCode = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Read everything and report on the model; runs nothing."""
    if picture and picture.suffix.lower() != ".png":
        raise typer.BadParameter(f"--picture writes PNG: name a .png file, not {picture}")
    allow_own_laws(case_file, allow_code)
    from cdem.case.case import Case

    case = Case.load(case_file, settings or [])
    from cdem.run.simulation import Simulation

    try:
        simulation = Simulation(case, threads=threads)
    except BodyError as refused:
        if picture:
            from cdem.output import model_picture, render

            render.write_image(picture, model_picture.draw_refused(refused))
            print(f"wrote {picture}: the body, with what is wrong in red")
        raise
    audit = simulation.audit
    if picture:
        from cdem.output import model_picture, render

        render.write_image(picture, model_picture.draw_model(simulation))
    from cdem.run.estimate import estimate

    cost = estimate(simulation)
    facts = audit.as_dict() | cost.as_dict()
    assumed = _assumed(case_file)
    if as_json:
        print(json.dumps(facts | {"assumed": assumed}, indent=2))
    else:
        print("\n".join([audit.text(cost.text()).rstrip(), *assumed]))
    if strict:
        audit.refuse_warnings()


def _assumed(case_file: Path) -> list[str]:
    """Lines of a case with the mark ASSUMED: values that nobody measured."""
    from cdem.case.input_file import read_text

    lines = read_text(case_file, "case file").splitlines()
    return [
        f"  assumed: {case_file}:{number}: {line.partition('#')[0].strip()}"
        for number, line in enumerate(lines, start=1)
        if line.partition("#")[2].strip().startswith("ASSUMED") and line.partition("#")[0].strip()
    ]


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


def schema(
    of: Annotated[Literal["case", "study"], typer.Argument(help="Kind of file.")] = "case",
) -> None:
    """Print the JSON schema of a case or a study, for editors."""
    from cdem.case.case import Case
    from cdem.study.study import Study

    print(json.dumps((Case if of == "case" else Study).schema(), indent=2))
