"""Commands that assess a slope without a run: joints, screen."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cdem.cli import screening_options as options
from cdem.cli.options import Force, Overwrite, executing, print_paths, reporting
from cdem.errors import CaseError, CdemError

GRAVITY = 9.81
OPTIONAL = (
    "fos_yield.tif", "fos_newmark.tif", "fos_plane_yield.tif", "fos_plane_newmark.tif",
    "newmark.png", "fos_probability.tif", "samples.csv", "probability.png", "tornado.png",
)  # fmt: skip
"""Files that only some options of `cdem screen` write."""

if TYPE_CHECKING:
    from cdem.joints.kinematics import Slope
    from cdem.joints.survey import Survey
    from cdem.outcrop.survey import OutcropSurvey
    from cdem.screening.bodies import Limits
    from cdem.screening.confirm import Confirmed
    from cdem.screening.fos_map import FosMap
    from cdem.screening.loads import Loads
    from cdem.screening.planes import JointPlane
    from cdem.screening.probability import Floats, Probability
    from cdem.screening.products import Map
    from cdem.screening.shaking import Earthquake, Shaken
    from cdem.screening.uncertain import Uncertain
    from cdem.terrain.heights import Grid

Table = Annotated[
    Path, typer.Argument(metavar="TABLE.csv", help="dip, dip direction, ...; or a point cloud.")
]
SetsFile = Annotated[
    Path | None,
    typer.Option(
        "--output", "-o", help="Sets for a case, with a picture. Default TABLE.yaml, here."
    ),
]
Resolution = Annotated[
    str | None, typer.Option(metavar="M", help="Distance of points kept; default from the cloud.")
]
Angle = Annotated[
    float | None,
    typer.Option(metavar="DEG", help="Normals in a facet differ from its own by less. Default 12."),
]
Smallest = Annotated[
    str | None, typer.Option(metavar="M2", help="Smallest area of a facet; default 50 points.")
]


def joints(
    table: Table,
    output: SetsFile = None,
    extract: Annotated[
        bool, typer.Option("--extract", help="Find the joints in a point cloud of an outcrop.")
    ] = False,
    resolution: Resolution = None,
    angle: Angle = None,
    smallest: Smallest = None,
    slope: Annotated[
        str | None,
        typer.Option(
            metavar="DIP/DIRECTION", help="Also list failures possible on this slope: 60/090."
        ),
    ] = None,
    friction: Annotated[
        float | None, typer.Option(metavar="DEG", help="Friction angle of joints on the slope.")
    ] = None,
    lateral: Annotated[
        float, typer.Option(metavar="DEG", help="Planes fail within this angle of its direction.")
    ] = 20.0,
    sets: Annotated[
        int | None,
        typer.Option(min=1, max=12, help="Number of sets; default by BIC, or from the table."),
    ] = None,
    scanline: Annotated[
        str | None,
        typer.Option(metavar="PLUNGE/TREND", help="Scanline of all joints: 05/120."),
    ] = None,
    length: Annotated[
        float | None,
        typer.Option(metavar="M", help="Length of all scanlines; default from the joints."),
    ] = None,
    overwrite: Overwrite = False,
    force: Force = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Find the sets among measured joints, and joints that may slide or topple on a slope.

    With --extract the joints are flat parts of a point cloud (.las, .laz, .ply, .xyz ...).
    """
    face = _slope(slope, friction, lateral)
    path = output or Path(f"{table.stem}.yaml")
    if path.suffix not in (".yaml", ".yml"):
        raise typer.BadParameter(f"the sets are written as YAML: name a .yaml file, not {path}")
    if extract:
        if scanline is not None or length is not None:
            raise typer.BadParameter("--scanline and --length belong to tables, not to --extract")
        sizes = _sizes(resolution, angle, smallest)
        _refuse_existing([path, _facets_of(path)], overwrite or force)
        text, facts, written = _extract(table, path, sizes, sets, face)
    else:
        if not (resolution is angle is smallest is None):
            raise typer.BadParameter("--resolution, --angle and --smallest belong to --extract")
        _refuse_existing([path], overwrite or force)
        text, facts, written = _measured(table, path, scanline, length, sets, face)
    print(json.dumps(facts, indent=2) if as_json else text)
    if not as_json:
        print_paths(written)


def _refuse_existing(paths: list[Path], replace: bool) -> None:
    """Refuse to replace files: a user may have edited strengths."""
    for path in paths:
        if path.exists() and not replace:
            raise CaseError(f"{path}: exists already; use --overwrite or name another file with -o")


def _measured(
    table: Path,
    path: Path,
    scanline: str | None,
    length: float | None,
    sets: int | None,
    face: Slope | None,
) -> tuple[str, dict[str, Any], list[Path]]:
    """Find the sets of a table; returns text, facts and the files written."""
    from cdem.joints.measured import read_measured
    from cdem.joints.survey import Survey
    from cdem.outcrop.cloud_files import CLOUDS_ONLY

    if table.suffix.lower() in CLOUDS_ONLY:
        raise CaseError(f"{table}: is a point cloud; find the joints in it with --extract")

    along = None if scanline is None else _plane("--scanline", scanline)[::-1]
    if length is not None:
        _within("--length", length, 1e-6, 1e6)
    survey = Survey.of(table, read_measured(table, along), count=sets, length=length, slope=face)
    return survey.text(), survey.as_dict(), _write_survey(survey, path)


def _sizes(resolution: str | None, angle: float | None, smallest: str | None) -> dict[str, Any]:
    """Options of an extraction that are given."""
    sizes: dict[str, Any] = {}
    if resolution is not None:
        sizes["resolution"] = _number("--resolution", resolution, "m")
    if angle is not None:
        _within("--angle", angle, 1, 45)
        sizes["angle"] = angle
    if smallest is not None:
        sizes["smallest"] = _number("--smallest", smallest, "m2")
    return sizes


def _facets_of(path: Path) -> Path:
    return path.with_suffix(".facets.csv")


def _extract(
    cloud: Path, path: Path, sizes: dict[str, Any], sets: int | None, face: Slope | None
) -> tuple[str, dict[str, Any], list[Path]]:
    """Find the joints of a point cloud; returns text, facts and the files written."""
    from cdem.outcrop.cloud_files import read_outcrop
    from cdem.outcrop.extraction import extract
    from cdem.outcrop.facet_table import write_facets
    from cdem.outcrop.survey import OutcropSurvey

    read = read_outcrop(cloud)
    with reporting() as report:
        try:
            found = extract(read.points, **sizes, tell=report)
        except CaseError as error:
            raise CaseError(f"{cloud}: {error}") from None
    table = _facets_of(path)
    try:
        outcrop = OutcropSurvey.of(cloud, found, count=sets, slope=face)
    except CaseError as error:
        write_facets(found.facets, table, read.origin, None)
        raise CaseError(f"{error} of {table}, which has the facets, and read it") from None
    written = _write_survey(outcrop.survey, path)
    written.append(write_facets(found.facets, table, read.origin, outcrop))
    written += _draw_facets(outcrop, table.with_suffix(".png"))
    notes = "".join(f"note: {note}\n" for note in read.notes)
    return notes + outcrop.text(), outcrop.as_dict() | {"notes": read.notes}, written


def _draw_facets(outcrop: OutcropSurvey, path: Path) -> list[Path]:
    """Draw the facets; a lack of matplotlib was told with the other picture."""
    from cdem.output import facet_picture

    try:
        return [facet_picture.draw(outcrop, path)]
    except CdemError:
        return []


def _slope(face: str | None, friction: float | None, lateral: float) -> Slope | None:
    if (face is None) != (friction is None):
        raise typer.BadParameter("give both --slope DIP/DIRECTION and --friction DEG, or neither")
    if face is None or friction is None:
        return None
    from cdem.joints.kinematics import Slope

    dip, direction = _plane("--slope", face)
    _within("--friction", friction, 0, 90)
    _within("--lateral", lateral, 0, 90)
    return Slope(dip, direction, friction, lateral)


def _write_survey(survey: Survey, path: Path) -> list[Path]:
    """Write the sets and their picture; a lack of matplotlib is only a message."""
    from cdem.output import stereonet
    from cdem.whole_files import write_text

    write_text(path, survey.yaml())
    try:
        return [path, stereonet.draw(survey, path.with_suffix(".png"))]
    except CdemError as error:
        print(f"no picture: {error}", file=sys.stderr)
        return [path]


def screen(
    ground: options.GroundFile,
    sets: options.JointsFile,
    volume: options.Volumes,
    output: options.OutputFolder = None,
    density: options.Density = "2650",
    cell: options.Cell = None,
    stride: options.Stride = 4,
    confirm: options.Confirm = 0,
    workers: options.Workers = None,
    water: options.Water = None,
    crack: options.Crack = None,
    kh: options.HorizontalShaking = 0.0,
    kv: options.VerticalShaking = 0.0,
    pga: options.Pga = None,
    magnitude: options.Magnitude = None,
    record: options.RecordFile = None,
    uncertain: options.UncertainFile = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Map the factor of safety over terrain: wedges and planes of joints, by closed forms.

    With --confirm, writes a case for each of the worst bodies and lists both factors.
    """
    from cdem.screening.bodies import Limits
    from cdem.screening.ground import read_ground
    from cdem.screening.planes import read_planes

    smallest, largest = (_number("--volume", word, "m3") for word in volume)
    limits = Limits(smallest, largest, GRAVITY * _number("--density", density, "kg/m3"))
    quake = options.quake_of(pga, magnitude, record)
    planes, notes = read_planes(sets)
    grid, system, more = read_ground(ground, cell)
    loads, words = options.loads_of(water, crack, kh, kv, grid)
    chances, doubts = options.uncertain_of(uncertain, planes, loads)
    notes += [*more, *words, *options.quake_notes(quake), *doubts]
    columns = None if chances is None else chances.draw()
    found = _screen(grid, planes, limits, stride, loads, quake is not None)
    folder = output or Path(f"{ground.stem}.screen")
    folder.mkdir(parents=True, exist_ok=True)
    out = _Results(found, planes, folder, system, as_json)
    out.begin(notes)
    if quake is not None:
        out.shake(quake)
    if chances is not None and columns is not None:
        out.sample(chances, columns, stride, workers)
    out.tell()
    out.confirm(confirm, workers)
    out.end()


def _screen(
    grid: Grid,
    planes: list[JointPlane],
    limits: Limits,
    stride: int,
    loads: Loads,
    shaken: bool,
) -> FosMap:
    """Search the bodies, with a line of progress."""
    from cdem.screening import fos_map
    from cdem.screening.bodies import Ground

    with reporting() as report:
        return fos_map.screen(
            Ground(grid), planes, limits, stride, report, loads=loads, yields=shaken
        )


class _Results:
    """Results of a screening on their way to files and to the screen.

    Args:
        found: Maps and bodies.
        planes: The sets.
        folder: Folder of the files.
        system: Map projection, or None.
        as_json: Whether JSON is printed at the end in place of text.
    """

    def __init__(
        self,
        found: FosMap,
        planes: list[JointPlane],
        folder: Path,
        system: str | None,
        as_json: bool,
    ) -> None:
        self.found, self.planes, self.folder = found, planes, folder
        self.system, self.as_json = system, as_json
        self.shaken: Shaken | None = None
        self.chance: Probability | None = None
        self.confirmed: list[Confirmed] = []
        self.paths: list[Path] = []

    def begin(self, notes: list[str]) -> None:
        """Print and write what was found."""
        from cdem.screening import products, report

        self._print(report.text(self.found, self.planes, notes, self.system))
        path = self.folder / "fos.png"
        self._save(products.maps_of(self.found), lambda: [products.draw(self.found, path)])

    def shake(self, quake: Earthquake) -> None:
        """Compute, print and write yield accelerations and displacements."""
        from cdem.screening import products, report
        from cdem.screening.shaking import shake

        shaken = self.shaken = shake(self.found, quake)
        self._print(report.shaken_text(shaken))
        path = self.folder / "newmark.png"
        maps = products.maps_of_quake(shaken)
        self._save(maps, lambda: [products.draw_slip(self.found, shaken, path)])

    def sample(
        self, uncertain: Uncertain, columns: dict[str, Floats], stride: int, workers: int | None
    ) -> None:
        """Compute, print and write the probability of failure."""
        from cdem._instruction_sets import cores
        from cdem.screening import chance_files, report
        from cdem.screening.probability import evaluate

        how = {"stride": stride, "workers": workers or cores()}
        with reporting() as show:
            chance = evaluate(self.found, self.planes, uncertain, columns, report=show, **how)
        self.chance = chance
        self._print(report.chance_text(chance))
        self.paths.append(chance_files.write_samples(chance, self.folder / "samples.csv"))
        maps = [chance_files.map_of(chance)]
        self._save(maps, lambda: chance_files.draw_chance(self.found, chance, self.folder))

    def tell(self) -> None:
        """Print the paths of all files, and name those of earlier commands."""
        if not self.as_json:
            print_paths(self.paths)
        there = [self.folder / name for name in OPTIONAL]
        old = [path.name for path in there if path.exists() and path not in self.paths]
        if old:
            print(f"warning: left from an earlier command: {', '.join(old)}", file=sys.stderr)

    def confirm(self, count: int, workers: int | None) -> None:
        """Compute the worst bodies, and add them to the list of bodies."""
        self.confirmed = _confirm(self.found, count, self.folder, self.system, workers)
        if self.confirmed:
            self._write_bodies()
            self._print("factors of safety, closed form and computed (cdem critical):")
            for one in self.confirmed:
                self._print(one.text())

    def end(self) -> None:
        """Print JSON, if it is asked for."""
        from cdem.screening import report

        if not self.as_json:
            return
        facts = report.facts(self.found)
        if self.shaken is not None:
            facts["earthquake"] = report.shaken_facts(self.shaken)
        if self.chance is not None:
            facts["probability"] = report.chance_facts(self.chance)
        facts["confirmed"] = [report.confirmed_facts(one) for one in self.confirmed]
        print(json.dumps(facts, indent=2))

    def _save(self, maps: list[Map], draw: Callable[[], list[Path]]) -> None:
        """Write maps, bodies and pictures; a lack of matplotlib is only a message."""
        from cdem.screening import products

        self.paths += products.write_maps(maps, self.found.ground, self.folder, self.system)
        bodies = self._write_bodies()
        if bodies not in self.paths:
            self.paths.append(bodies)
        try:
            self.paths += draw()
        except CdemError as error:
            print(f"no picture: {error}", file=sys.stderr)

    def _write_bodies(self) -> Path:
        from cdem.screening import products

        return products.write_bodies(
            self.found,
            self.folder / products.BODIES,
            self.system,
            [one.computed for one in self.confirmed],
            self.shaken,
            self.chance,
        )

    def _print(self, text: str) -> None:
        if not self.as_json:
            print(text)


def _confirm(
    found: FosMap, count: int, folder: Path, system: str | None, workers: int | None
) -> list[Confirmed]:
    """Compute the worst bodies, with a line of progress."""
    if not count or not found.bodies:
        return []
    from cdem.screening.confirm import confirm

    with executing("stopping, finished bodies are kept", terminal_only=True) as how:
        into = folder / "confirm"
        return confirm(found, count, into, system=system, workers=workers, **how)


def _number(option: str, text: str, unit: str) -> float:
    """A positive number, with or without a unit."""
    from cdem.units import to_number

    try:
        value = to_number(text, unit)
    except ValueError as error:
        raise typer.BadParameter(f"{option}: {error}") from None
    if not value > 0:
        raise typer.BadParameter(f"{option} must be above 0, got {text}")
    return value


def _plane(option: str, text: str) -> tuple[float, float]:
    """Two angles separated by a slash: dip and dip direction, or plunge and trend [deg]."""
    first, slash, second = text.partition("/")
    try:
        dip, direction = float(first), float(second)
    except ValueError:
        dip, direction = -1.0, -1.0
    if not slash or not (0 <= dip <= 90 and 0 <= direction <= 360):
        raise typer.BadParameter(
            f"{option} takes an angle below the horizontal and an azimuth, e.g. 60/090; got {text}"
        )
    return dip, direction


def _within(option: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise typer.BadParameter(f"{option} must lie in {low:g} to {high:g}, got {value:g}")
