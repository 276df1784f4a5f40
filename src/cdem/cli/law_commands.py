"""Verbs under ``cdem law``: the laws there are, and one of them on its own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cdem.cli.options import print_paths

law = typer.Typer(no_args_is_help=True, help="List laws, and try one on its own.")
SHOWN = 20
"""Rows of a curve that are printed."""


@law.command("list")
def list_laws() -> None:
    """List the laws of blocks and of interfaces, each with what it is."""
    from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS

    for kind, laws in (("materials", BLOCK_LAWS), ("interfaces", INTERFACE_LAWS)):
        print(kind)
        for one in laws.values():
            print(f"  {one.name:<20}{one.meaning}")


@law.command("test")
def test(
    name: Annotated[str, typer.Argument(metavar="LAW", help="See cdem law list.")],
    path: Annotated[
        str,
        typer.Option(
            help="Of blocks: uniaxial, tension, 'triaxial 5 MPa', 'extension 5 MPa', oedometer. Of "
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
        str | None, typer.Option(help="Where it ends: strain (0.02), slip or opening (1 cm).")
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help="Of a joint, e.g. '1 m/s'; by default slow.")
    ] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="CSV file.")] = None,
    plot: Annotated[Path | None, typer.Option(help="PNG file (extra viz).")] = None,
) -> None:
    """Lead one law along the path of a laboratory test and print the curve.

    A block law moves a cube of 1 m, 10 GPa unless set otherwise; an interface law the joint between
    two. Stresses are positive in tension.
    """
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
