"""Commands that make and check models: new, check, mesh, schema."""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from cdem.cli.options import (
    AllowCode,
    CaseFile,
    Force,
    Overwrite,
    Settings,
    Strict,
    Threads,
    allow_own_laws,
)
from cdem.errors import BodyError, CaseError

if TYPE_CHECKING:
    from importlib.abc import Traversable


def new(
    template: Annotated[
        str | None,
        typer.Argument(
            help="Name; by default, list all.",
            autocompletion=lambda: sorted(_template_names(resources.files("cdem") / "templates")),
        ),
    ] = None,
    folder: Annotated[Path, typer.Argument(metavar="[DIR]", help="Folder to write to.")] = Path(
        "."
    ),
    overwrite: Overwrite = False,
    force: Force = False,
) -> None:
    """Write a commented case to start from."""
    home = resources.files("cdem") / "templates"
    names = sorted(_template_names(home))
    if template is None:
        for name in names:
            title = _case_of(home, name).read_text().splitlines()[0].lstrip("# ")
            print(f"{name:<15}{title}")
        return
    if template not in names:
        close = difflib.get_close_matches(template, names, n=1)
        hint = f"; did you mean {close[0]}?" if close else ""
        raise typer.BadParameter(f"no template '{template}'{hint} There are: {', '.join(names)}")
    case = _case_of(home, template)
    beside = case.read_text()
    own = list((home / template).iterdir()) if (home / template).is_dir() else _meshes(home)
    files = [case, *(f for f in own if f.name != case.name and f.name in beside)]
    for file in files:
        if (folder / file.name).exists() and not (overwrite or force):
            raise CaseError(
                f"{folder / file.name}: exists already; use --overwrite or name another folder"
            )
    folder.mkdir(parents=True, exist_ok=True)
    for file in files:
        (folder / file.name).write_text(file.read_text())
        print(f"wrote {folder / file.name}")
    for line in _next_commands(beside, folder):
        print(f"next: {line}")


def _template_names(home: Traversable) -> Iterator[str]:
    """Names of templates: each is a case file, or a folder with a case of its name and its files."""
    for entry in home.iterdir():
        if entry.name.endswith(".yaml"):
            yield entry.name[: -len(".yaml")]
        elif (entry / f"{entry.name}.yaml").is_file():
            yield entry.name


def _meshes(home: Traversable) -> list[Traversable]:
    return [entry for entry in home.iterdir() if entry.name.endswith(".msh")]


def _case_of(home: Traversable, name: str) -> Traversable:
    return home / name / f"{name}.yaml" if (home / name).is_dir() else home / f"{name}.yaml"


def _next_commands(case: str, folder: Path) -> Iterator[str]:
    """Commands that lead to a first result, as written at the head of a template."""
    for line in case.splitlines():
        words = line.lstrip("# ").split("  ")[0].split()  # two blanks begin an explanation
        if len(words) < 3 or words[0] != "cdem" or words[1] == "check":
            continue
        words[2] = str(folder / words[2])
        if words[1] != "mesh":
            yield " ".join(words)
            return
        yield f"{' '.join(words)} -o {Path(words[2]).with_suffix('.msh')}"


def check(
    case_file: CaseFile,
    settings: Settings = None,
    threads: Threads = None,
    picture: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.png",
            help="Draw groups, supports, loads, joints, bolts, water, or a refused body.",
        ),
    ] = None,
    strict: Strict = False,
    allow_code: AllowCode = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Read all input and report on the model; runs nothing."""
    if picture and picture.suffix.lower() != ".png":
        raise typer.BadParameter(f"--picture writes PNG: name a .png file, not {picture}")
    allow_own_laws(case_file, allow_code)
    from cdem.case.case import Case
    from cdem.run.progress import busy

    case = Case.load(case_file, settings or [])
    from cdem.run.simulation import Simulation

    try:
        with busy("building the model"):
            simulation = Simulation(case, threads=threads)
    except BodyError as refused:
        if picture:
            from cdem.output import model_picture, render

            render.write_image(picture, model_picture.draw_refused(refused))
            print(f"wrote {picture}: the body, with its faults in red")
        raise
    audit = simulation.audit
    if picture:
        from cdem.output import model_picture, render

        render.write_image(picture, model_picture.draw_model(simulation))
    from cdem.run.estimate import estimate

    with busy("measuring the speed"):
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
    """Lines of a case with the mark ASSUMED: values without a measurement."""
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
    """Mesh a landslide or layers: terrain with bodies outlined in plan, or with layer surfaces."""
    from cdem import terrain
    from cdem.run.progress import busy

    path = output or Path(f"{landslide_file.stem}.msh")
    with busy("meshing"):
        solid = terrain.make_mesh(terrain.Landslide.load(landslide_file, settings or []))
    terrain.write(solid, path)
    facts = terrain.measure(solid)
    print(json.dumps(facts, indent=2) if as_json else f"{path}: {terrain.text(facts)}")


def schema(
    of: Annotated[
        Literal["case", "study", "fit", "rockfall", "uncertain"],
        typer.Argument(help="Kind of file."),
    ] = "case",
) -> None:
    """Print the JSON schema of a kind of file, for editors."""
    from cdem.case.case import Case
    from cdem.fit.fitting import Fit
    from cdem.rockfall.rockfall import Rockfall
    from cdem.screening.uncertain import Uncertain
    from cdem.study.study import Study

    kinds: dict[str, Any] = {"case": Case, "study": Study, "fit": Fit}
    kinds |= {"rockfall": Rockfall, "uncertain": Uncertain}
    print(json.dumps(kinds[of].schema(), indent=2))
