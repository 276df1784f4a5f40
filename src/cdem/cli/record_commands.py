"""Commands on motions of the ground: record (files, layered ground) and records (of a run)."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdem.cli.options import print_paths
from cdem.errors import CaseError, CdemError

if TYPE_CHECKING:
    from cdem.case.waves_schema import Record

record = typer.Typer(
    name="record",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    help="Show a record of ground motion; layered ground: amplification, motion at depth.",
)
RecordFile = Annotated[Path, typer.Argument(metavar="FILE", help="Record: .at2, .csv, .txt, .npy.")]
Keys = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="A key of the record, e.g. unit=g; repeatable."
    ),
]
ProfileFile = Annotated[
    Path, typer.Option("--profile", metavar="PROFILE.yaml", help="Layers from the surface down.")
]
Picture = Annotated[Path | None, typer.Option(metavar="FILE.png", help="Draw into this file.")]
SHOWN_PEAKS = 6
"""Peaks of an amplification that are printed."""


@record.command("show")
def show(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Record, or CASE.yaml with some.")],
    settings: Keys = None,
    picture: Picture = None,
) -> None:
    """Print PGA, PGV, PGD, Arias intensity and duration after each step of processing.

    FILE is a record, whose keys may be set (--set unit=g --set "band=[0.1 Hz, 15 Hz]"), or a case.
    """
    from cdem.seismic.tables import record_lines

    records = records_of(file, settings or [])
    for name, one in records.items():
        print("\n".join(record_lines(name, one.steps())))
    if picture is not None:
        from cdem.output.record_pictures import draw_record

        for name, one in records.items():
            path = picture if len(records) == 1 else picture.with_stem(f"{picture.stem}-{name}")
            print_paths(draw_record(path, name, one.steps()[0][1], one.steps()[-1][1]))


def records_of(file: Path, settings: list[str]) -> dict[str, Record]:
    """Records of a case, or of one file."""
    from cdem.case.record_file import load_record

    if file.suffix.lower() not in (".yaml", ".yml"):
        return {file.stem: load_record(file, settings)}
    from cdem.case.case import Case

    case = Case.load(file, settings)
    for warning in case.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    if not case.records:
        raise CaseError(f"{file}: has no records; see docs/records.md")
    return case.records


@record.command("deconvolve")
def deconvolve(
    file: RecordFile,
    profile: ProfileFile,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="UP.csv", help="CSV file.")],
    f_max: Annotated[
        float,
        typer.Option("--f-max", help="No wave above this frequency; it fades from 0.9 of it [Hz]."),
    ],
    settings: Keys = None,
) -> None:
    """Find the up-going wave below layered ground that gives a motion of its surface.

    Linear, waves straight up. The result is an input with motion: upgoing. It has the quantity of
    the record.
    """
    import numpy as np

    from cdem.case.profile import Profile
    from cdem.case.record_file import load_record
    from cdem.seismic.processing import UNITS
    from cdem.seismic.site_response import deconvolved
    from cdem.whole_files import write_text

    ground, one = Profile.load(profile).ground, load_record(file, settings or [])
    surface = one.steps()[-1][1]
    nyquist = 0.5 / surface.step
    if not 0 < f_max <= nyquist:
        raise CaseError(f"--f-max {f_max:g}: must be above 0 and at most {nyquist:g} Hz")
    assert one.unit is not None
    values = getattr(surface, one.quantity) / UNITS[one.unit][1]
    up, growth = deconvolved(ground, values, surface.step, f_max)
    head = f"time [s], {one.quantity} [{one.unit}]"
    rows = zip(surface.times.tolist(), up.tolist(), strict=True)
    write_text(output, "\n".join([head, *(f"{t!r}, {v!r}" for t, v in rows), ""]))
    peaks = [float(np.abs(x).max()) for x in (values, up)]
    print(
        f"largest {one.quantity} {peaks[0]:.5g} {one.unit} at the surface, {peaks[1]:.5g} {one.unit} "
        f"of the up-going wave; below {f_max:g} Hz a frequency grew by at most {growth:.3g}"
    )
    print_paths(output)


@record.command("response")
def response(
    profile: ProfileFile,
    f_max: Annotated[float, typer.Option("--f-max", help="Highest frequency [Hz].")] = 25.0,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="CSV file.")] = None,
    picture: Picture = None,
) -> None:
    """Print how layered ground amplifies waves that go straight up: peaks, and a curve.

    Surface over outcrop (of the half space), and surface over the top of the half space within.
    """
    import numpy as np

    from cdem.case.profile import Profile
    from cdem.seismic import site_response

    if not f_max > 0:
        raise CaseError(f"--f-max {f_max:g}: must be above 0")
    ground = Profile.load(profile).ground
    f = np.linspace(f_max / 5000, f_max, 5000)
    ratios = {
        "surface over outcrop": np.abs(site_response.surface_over_outcrop(ground, f)),
        "surface over within": np.abs(site_response.surface_over_within(ground, f)),
    }
    for name, ratio in ratios.items():
        print(name)
        tops = np.flatnonzero((ratio[1:-1] > ratio[:-2]) & (ratio[1:-1] > ratio[2:])) + 1
        for k in tops[:SHOWN_PEAKS]:
            print(f"  {ratio[k]:>9.4g} at {f[k]:.4g} Hz")
    if output is not None:
        from cdem.whole_files import write_text

        rows = np.column_stack([f, *ratios.values()]).tolist()
        head = ",".join(["frequency [Hz]", *(f"{name} [1]" for name in ratios)])
        write_text(output, "\n".join([head, *(",".join(map(repr, x)) for x in rows), ""]))
        print_paths(output)
    if picture is not None:
        from cdem.output.record_pictures import draw_amplification

        print_paths(draw_amplification(picture, f, ratios))


def records(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Result folder of a run.")],
    to: Annotated[
        str | None, typer.Option("--to", metavar="NAME", help="Spectral ratios to this history.")
    ] = None,
    yields: Annotated[
        str | None,
        typer.Option("--yield", metavar="A..B", help="Newmark slip, e.g. 0.1g..0.4g, or 0.2g."),
    ] = None,
    stage: Annotated[str | None, typer.Option(help="Dynamic stage; default the last one.")] = None,
) -> None:
    """Measure the motions of a run: peaks, Arias intensity, spectra, Newmark slip, spectral ratios.

    Writes tables and pictures for every history with velocity or acceleration into DIR/motions. For
    points near blasts also the peak velocity (PPV) and the distance from the nearest charge.
    """
    from cdem.output import motions

    found = motions.measure(folder, to=to, yields=motions.accelerations(yields), stage=stage)
    print("\n".join(found.lines()))
    paths = found.write(folder)
    try:
        paths += found.draw(folder)
    except CdemError as error:
        print(f"no pictures: {error}", file=sys.stderr)
    print_paths(paths)
