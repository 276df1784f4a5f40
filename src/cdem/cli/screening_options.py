"""Options of `cdem screen` for water, shaking and probability, and what they mean together."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdem.errors import CaseError

if TYPE_CHECKING:
    from cdem.screening.loads import Loads
    from cdem.screening.planes import JointPlane
    from cdem.screening.shaking import Earthquake
    from cdem.screening.uncertain import Uncertain
    from cdem.terrain.heights import Grid

MOST_PGA = 5.0
"""Largest acceleration that is believed [g], as for records."""

GroundFile = Annotated[
    Path, typer.Argument(metavar="GROUND", help="A grid (.tif, .asc), or LANDSLIDE.yaml.")
]
JointsFile = Annotated[
    Path, typer.Option("--joints", metavar="JOINTS.yaml", help="Joint sets, or a case.")
]
Volumes = Annotated[
    tuple[str, str],
    typer.Option(metavar="FROM TO", help="Range of volumes [m3]: --volume 500 2e5."),
]
OutputFolder = Annotated[
    Path | None, typer.Option("--output", "-o", help="Folder; default GROUND.screen, here.")
]
Density = Annotated[
    str, typer.Option(metavar="KG/M3", help="Density of the rock; matters with cohesion and water.")
]
Cell = Annotated[
    float | None, typer.Option(metavar="M", help="Cell size of the map; default the grid's.")
]
Stride = Annotated[int, typer.Option(min=1, help="Cells between points of the first search.")]
Confirm = Annotated[
    int, typer.Option(min=0, metavar="N", help="Compute the N worst bodies with cdem critical.")
]
Workers = Annotated[
    int | None, typer.Option(min=1, help="Local processes for these; default all cores.")
]
Water = Annotated[
    str | None,
    typer.Option(
        metavar="SHARE|FILE|'H m'",
        help="Filled share of the height between plane and ground, 0 to 1; or a grid (.tif, .asc) "
        "of heights of the water table; or one height, with its unit.",
    ),
]
Crack = Annotated[
    str | None,
    typer.Option(metavar="M", help="Depth of a tension crack behind the crest of profiles: '8 m'."),
]
HorizontalShaking = Annotated[
    float, typer.Option("--kh", metavar="G", help="Shaking in the direction of sliding [g].")
]
VerticalShaking = Annotated[
    float, typer.Option("--kv", metavar="G", help="Shaking up, makes bodies lighter [g].")
]
Pga = Annotated[
    str | None,
    typer.Option(metavar="A", help="Also map Newmark displacements for this PGA: 0.3g."),
]
Magnitude = Annotated[
    float | None, typer.Option(metavar="M", help="Moment magnitude, goes with --pga.")
]
RecordFile = Annotated[
    Path | None,
    typer.Option("--record", metavar="FILE", help="Also map Newmark displacements in a record."),
]
UncertainFile = Annotated[
    Path | None,
    typer.Option(
        "--uncertain",
        metavar="FILE.yaml",
        help="Distributions; also maps the probability of F < 1.",
    ),
]


def loads_of(
    water: str | None, crack: str | None, kh: float, kv: float, grid: Grid
) -> tuple[Loads, list[str]]:
    """Water and shaking, and messages for the user.

    Raises:
        CaseError: An option is wrong.
    """
    from cdem.screening.loads import Loads, number_of, read_water
    from cdem.units import to_number

    share, level, notes = read_water(water, grid)
    depth = 0.0
    if crack is not None:
        try:
            depth = to_number(crack, "m")
        except ValueError as error:
            raise CaseError(f"--crack: {error}") from None
        if not 0 < depth <= 1e4:
            raise CaseError(f"--crack must lie above 0 and below 10 km, got {crack}")
    kh, kv = number_of("--kh", kh, 0.0, 5.0), number_of("--kv", kv, -5.0, 0.99)
    return Loads(kh, kv, share, level, depth), notes


def quake_of(pga: str | None, magnitude: float | None, record: Path | None) -> Earthquake | None:
    """The earthquake of the options, or None.

    Raises:
        CaseError: An option is wrong, or two contradict each other.
    """
    from cdem.screening.shaking import Earthquake

    if pga is not None and record is not None:
        raise CaseError("--pga and --record both give an earthquake; leave out one")
    if magnitude is not None and pga is None:
        raise CaseError("--magnitude goes with --pga")
    if magnitude is not None and not 3 <= magnitude <= 10:
        raise CaseError(f"--magnitude must lie in 3 to 10, got {magnitude:g}")
    if record is not None:
        from cdem.cli.record_commands import records_of

        found = records_of(record, [])
        if len(found) > 1:
            raise CaseError(f"{record}: has {len(found)} records; name the file of one of them")
        return Earthquake.of(next(iter(found.values())).steps()[-1][1], record)
    return None if pga is None else Earthquake(_acceleration(pga), magnitude)


def quake_notes(quake: Earthquake | None) -> list[str]:
    """Messages on an earthquake."""
    from cdem.seismic.displacement import MAGNITUDES

    if quake is None or quake.magnitude is None:
        return []
    low, high = MAGNITUDES
    if low <= quake.magnitude <= high:
        return []
    return [f"the displacements were fitted to magnitudes of {low:g} to {high:g}"]


def _acceleration(text: str) -> float:
    """An acceleration with its unit [g]."""
    from cdem.seismic.processing import GRAVITY
    from cdem.units import to_number

    match = re.fullmatch(r"\s*([0-9.]+)\s*g\s*", text)
    try:
        number = float(text)
    except ValueError:
        number = None
    if number is not None:
        raise CaseError(f"--pga {text}: write the unit: 0.3g, or '3 m/s2'")
    try:
        value = float(match[1]) if match else to_number(text, "m/s2") / GRAVITY
    except ValueError:
        raise CaseError(f"--pga {text[:60]}: write an acceleration: 0.3g, or '3 m/s2'") from None
    if not 0 < value <= MOST_PGA:
        raise CaseError(f"--pga must lie above 0 and up to {MOST_PGA:g} g, got {text}")
    return value


def uncertain_of(
    file: Path | None, planes: list[JointPlane], loads: Loads
) -> tuple[Uncertain | None, list[str]]:
    """The distributions, and messages for the user.

    Raises:
        CaseError: The file is wrong.
    """
    if file is None:
        return None, []
    from cdem.screening.uncertain import Uncertain

    uncertain = Uncertain.load(file)
    uncertain.for_sets(planes, loads)
    strengths = {name.rpartition(".")[0] for name in uncertain.parameters
                 if name.endswith((".cohesion", ".friction_angle"))}  # fmt: skip
    notes = [
        f"{plane.name}: drawn strengths are those of joint and rock bridges together"
        for plane in planes
        if plane.persistence < 1 and plane.name in strengths
    ]
    return uncertain, notes
