"""The command that makes a landslide from a DEM and an outline: site."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from cdem.cli.options import Force, Overwrite
from cdem.errors import BackendError, CaseError

Text = str | None
Dem = Annotated[Path, typer.Argument(metavar="DEM", help="Ground: .tif, .vrt, .asc, .laz.")]
Outline = Annotated[
    Path, typer.Argument(metavar="OUTLINE", help="Outline: .kml, .gpkg, .shp, .geojson.")
]
Surface = Annotated[
    Text,
    typer.Option(
        metavar="FILE|{..}", help="Sliding surface: heights, or a mapping as in a landslide file."
    ),
]
Where = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME=VALUE", help="Select features of the outline; repeatable."),
]
Unit = Annotated[
    Literal["m", "ft", "us-ft", "cm", "dm"] | None, typer.Option(help="Unit of the heights.")
]


def _number(text: Text, option: str, unit: str) -> float | None:
    """A positive number with or without its unit."""
    from cdem.units import to_number

    if text is None:
        return None
    try:
        number = to_number(text, unit)
    except ValueError as error:
        raise CaseError(f"{option}: {error}") from None
    if number <= 0:
        raise CaseError(f"{option}: must be above 0, got {text}")
    return number


def site(
    dem: Dem,
    outline: Outline,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder to write to.")
    ] = Path("site"),
    depth: Annotated[
        Text, typer.Option(metavar="M", help="Sloping local base level of this depth: '60 m'.")
    ] = None,
    volume: Annotated[
        Text, typer.Option(metavar="M3", help="Sloping local base level of this volume: 3e6.")
    ] = None,
    surface: Surface = None,
    crs: Annotated[
        Text, typer.Option(help="Projection to work in; default: as the DEM, or UTM.")
    ] = None,
    dem_crs: Annotated[Text, typer.Option(help="Projection to use for the DEM.")] = None,
    outline_crs: Annotated[Text, typer.Option(help="The same for the outline.")] = None,
    layer: Annotated[Text, typer.Option(help="Layer of the outline.")] = None,
    where: Where = None,
    cell: Annotated[Text, typer.Option(metavar="M", help="Cell size of the ground.")] = None,
    size: Annotated[Text, typer.Option(metavar="M", help="Element size in the body.")] = None,
    margin: Annotated[
        float, typer.Option(min=0, help="Ground around the outline, as a multiple of its length.")
    ] = 0.5,
    fill: Annotated[Text, typer.Option(metavar="M|all", help="Largest gap to fill.")] = "200 m",
    unit: Unit = None,
    all_points: Annotated[
        bool, typer.Option("--all-points", help="Use all points of a cloud, not only the ground.")
    ] = False,
    cut: Annotated[bool, typer.Option("--cut", help="Cut the outline at the DEM's edge.")] = False,
    overwrite: Overwrite = False,
    force: Force = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Read a DEM and an outline; write a landslide and a case to start from."""
    from cdem.terrain import site as making

    if (output / "landslide.yaml").exists() and not (overwrite or force):
        raise CaseError(
            f"{output / 'landslide.yaml'}: exists already; use --overwrite or another --output"
        )
    question = making.Question(
        dem, outline, output,
        surface=making.surface_of(
            output, _number(depth, "--depth", "m"), _number(volume, "--volume", "m3"), surface
        ),
        crs=crs, dem_crs=dem_crs, outline_crs=outline_crs, layer=layer, where=_pairs(where or []),
        cell=_number(cell, "--cell", "m"), size=_number(size, "--size", "m"), margin=margin,
        fill="all" if fill == "all" else _number(fill, "--fill", "m") or 0.0, unit=unit,
        classes="all" if all_points else "ground", cut=cut,
    )  # fmt: skip
    found = making.make_site(question)
    _draw(found, output)
    if as_json:
        print(json.dumps(found.facts | {"notes": found.notes}, indent=2))
    else:
        print(_text(found, output))


def _pairs(texts: list[str]) -> dict[str, str]:
    pairs = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise CaseError(f"--where {text}: write NAME=VALUE, e.g. --where name=slide")
        pairs[name.strip()] = value.strip()
    return pairs


def _draw(found: Any, folder: Path) -> None:
    """Draw the picture, or note what is missing for it."""
    from cdem.terrain import site_picture

    try:
        found.files.append(site_picture.draw(found, folder / "site.png"))
    except BackendError as error:
        found.notes.append(f"no picture: {error}")


def _text(found: Any, folder: Path) -> str:
    """Results as text."""
    from cdem.terrain import site_files

    f = found.facts
    columns, rows = f["cells"]
    lines = [
        f"ground: {columns} x {rows} cells of {f['cell'][0]:g} m, {f['lowest']:.1f} to "
        f"{f['highest']:.1f} m, {f['crs'] or 'no projection'}"
    ]
    if "volume" in f:
        lines += [
            f"body: {f['volume'] / 1e6:.4f} Mm3 over {f['area']:,.0f} m2, {f['depth']:.1f} m deep",
            f"ordinary method of columns, 25 deg, no cohesion (ASSUMED): F = {f['factor']:.2f} towards "
            f"{f['direction']:03.0f} deg",
        ]
    lines += [f"note: {note}" for note in found.notes]
    lines += [f"wrote {path}" for path in found.files]
    lines.append("next:")
    if "volume" not in f:
        return "\n".join(
            [
                *lines,
                "  choose a sliding surface: repeat with --overwrite and --depth, --volume or --surface",
            ]
        )
    between = site_files.between_text(f["factor"])
    return "\n".join(
        [
            *lines,
            f"  cdem mesh {folder}/landslide.yaml -o {folder}/landslide.msh",
            f"  cdem critical {folder}/safety.yaml --factor --between {between}",
            f"  cdem run {folder}/case.yaml -o {folder}/case.results",
        ]
    )
