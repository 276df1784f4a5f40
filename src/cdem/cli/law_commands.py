"""Commands under ``cdem law``: list laws, test one of them, or build your own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from cdem.cli.options import AllowCode, Force, Overwrite, print_paths
from cdem.errors import CaseError

law = typer.Typer(
    name="law",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    help="List laws, test one of them, or build your own.",
)
SHOWN = 20
"""Rows of a curve that are printed."""


@law.command("list")
def list_laws() -> None:
    """List the laws of blocks, interfaces and surfaces with their meanings."""
    from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS, SURFACE_LAWS

    kinds = {"materials": BLOCK_LAWS, "interfaces": INTERFACE_LAWS, "loads.surfaces": SURFACE_LAWS}
    for kind, laws in kinds.items():
        print(kind)
        for one in laws.values():
            print(f"  {one.name:<20}{one.meaning}")


@law.command("new")
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Small letters, digits and -.")],
    kind: Annotated[Literal["block", "interface", "surface"], typer.Option(help="Kind of law.")],
    folder: Annotated[Path, typer.Argument(metavar="[DIR]", help="Folder to write to.")] = Path(
        "."
    ),
    overwrite: Overwrite = False,
    force: Force = False,
) -> None:
    """Write the header of a law of your own to start from, and a test for it."""
    from cdem.tools.law_build import new_law

    paths = new_law(name, kind, folder, overwrite=overwrite or force)
    print_paths(paths)
    print(f"next: cdem law build {paths[0]}")


@law.command("build")
def build(
    files: Annotated[list[Path], typer.Argument(metavar="FILE.hpp...", help="One law per file.")],
) -> None:
    """Compile a library of your own laws. Cases name it under own_laws.

    Needs a C++20 compiler, cmake, ninja and nanobind (extra laws). This takes a minute or two.
    """
    from cdem.tools import law_build

    print_paths(law_build.build(files))


def _load(file: Path, allow_code: bool) -> str:
    """Load a user's own law and return its name."""
    from cdem.own_laws import load_own_laws
    from cdem.tools.law_build import Header

    name = Header.read(file).law
    if not allow_code:
        raise CaseError(
            f"{file}: is code that would run inside cdem; read it, then allow it with --allow-code"
        )
    load_own_laws(file)
    return name


@law.command("test")
def test(
    name: Annotated[
        str, typer.Argument(metavar="LAW", help="A law of cdem law list, or your FILE.hpp.")
    ],
    path: Annotated[
        str,
        typer.Option(
            help="For blocks: uniaxial, tension, 'triaxial 5 MPa', 'extension 5 MPa', oedometer. For "
            "interfaces: 'shear 1 MPa', opening."
        ),
    ],
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="KEY=VALUE", help="A key of the material or interface; repeatable."
        ),
    ] = None,
    to: Annotated[
        str | None, typer.Option(help="End of the path: strain (0.02), slip or opening (1 cm).")
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help="Slip rate of a joint, e.g. '1 m/s'; default slow.")
    ] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="CSV file.")] = None,
    plot: Annotated[Path | None, typer.Option(help="PNG file (extra viz).")] = None,
    allow_code: AllowCode = False,
) -> None:
    """Drive one law along the path of a laboratory test and print the curve.

    A block law deforms a cube of 1 m, with 10 GPa unless set otherwise. An interface law shears or
    opens the joint between two such cubes. Stresses are positive in tension.
    """
    if name.endswith(".hpp"):
        name = _load(Path(name), allow_code)
    from cdem.case.laws import BLOCK_LAWS
    from cdem.study.law_test import lead_law, number

    curve = lead_law(
        name,
        path,
        settings or [],
        to=number("--to", to, "1" if name in BLOCK_LAWS else "m"),
        speed=number("--speed", speed, "m/s"),
    )
    widths = [max(len(column), 12) for column in curve.columns]
    print("  ".join(f"{c:>{w}}" for c, w in zip(curve.columns, widths, strict=True)))
    step = max(1, len(curve.rows) // SHOWN)
    for row in curve.rows[step - 1 :: step]:
        print("  ".join(f"{x:>{w}.5g}" for x, w in zip(row, widths, strict=True)))
    if output is not None:
        print_paths(curve.write(output))
    if plot is not None:
        print_paths(curve.draw(plot))
