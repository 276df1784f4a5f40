"""Run-out of a run: reach, thickness, speed through sections, number of pieces.

docs/runout.md has the definitions with their sources. All values follow from the frames of the
result folder; lengths are horizontal, along one direction, from the crown.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.element_volumes import Solids
from cdem.output.deposit import Deposit, checked_cell
from cdem.output.grain_sizes import GrainSizes
from cdem.output.map_layers import OF_PIECES, OF_VELOCITY, Maps, Moved
from cdem.output.map_picture import View, frame_of, ground_grid
from cdem.output.mapped import Fit, compare
from cdem.output.moving_mass import Body, Line
from cdem.output.runout_measures import EndMotion, crown_of, direction_of, follow, front_of
from cdem.output.runout_result import RunOut
from cdem.run.flow_maps import FlowMaps
from cdem.run.flow_recorder import read_maxima
from cdem.terrain.rasters import Raster

Floats = NDArray[np.float64]


def measure(
    folder: str | Path,
    *,
    groups: Sequence[str] | None = None,
    direction: float | None = None,
    cell: float | None = None,
    sections: Sequence[Sequence[float]] = (),
    against: str | Path | None = None,
    classes: str | Path | None = None,
) -> RunOut:
    """Measure the run-out in a result folder; docs/runout.md defines every quantity.

    Args:
        folder: Result folder of `cdem run`.
        groups: Moving groups; by default groups with at least a tenth of the largest mean
            displacement since the last reset.
        direction: Direction of motion, clockwise from y (north) [deg]; by default the direction in
            which the centre of mass moved in plan.
        cell: Side of a cell of the thickness map [m]; by default about the size of an element.
        sections: x0, y0, x1, y1 of lines in plan [m] for flow through sections.
        against: Vector file with the mapped outline of the affected area.
        classes: Result folder of another run, whose map classes are used.

    Raises:
        CdemError: The folder contains no frames; groups, direction, cell or a section are invalid;
            or
            the outline or the classes cannot be read.

    Example:
        >>> from cdem.output import runout
        >>> found = runout.measure("landslide.results")     # doctest: +SKIP
        >>> found.drop / found.reach                        # doctest: +SKIP
        0.41
    """
    limits = None if classes is None else _classes_of(Path(classes))
    outline = None if against is None else Path(against)
    return _measure(Body(Path(folder), groups), direction, cell, sections, outline, limits)


def _measure(
    body: Body,
    azimuth: float | None,
    cell: float | None,
    sections: Sequence[Sequence[float]],
    outline: Path | None,
    classes: Mapping[str, Sequence[float]] | None,
) -> RunOut:
    end = body.solids(body.frames[-1])
    direction = _azimuth(body, end, azimuth)
    way = np.array([np.sin(np.radians(direction)), np.cos(np.radians(direction)), 0.0])
    crown = crown_of(body.series.points(body.frames[0])[body.nodes], way)
    lines = [Line(line, way[:2], body.start) for line in sections]
    stays = body.stays(body.frames[-1])
    left = end.only(stays)
    flow, why = _maps_to_fill(body, left, cell)
    deposit = Deposit.of(left, flow.cell)
    history, fragments = follow(
        body, way, crown @ way, lines, flow, body.frames if why else body.frames[-1:]
    )
    source = Deposit.of(body.start, deposit.cell)
    maps = Maps.of(
        flow, source, deposit, from_frames=why, classes=classes,
        left_out=_left_out(body, recorded=not why),
        moved=Moved(left, np.linalg.norm(body.displacements(body.frames[-1])[stays], axis=1)),
    )  # fmt: skip
    front = front_of(body, body.frames[-1], way)
    fit = None
    if outline is not None:
        fit = compare(maps.affected, outline, body.crs, way[:2], float(front @ way))
    return RunOut(
        groups=body.groups,
        direction=direction % 360,
        crown=crown,
        front=front,
        history=history,
        fragments=fragments,
        sections=[line.section() for line in lines],
        deposit=deposit,
        source=source,
        taken_out=float(body.start.volumes()[~stays].sum()),
        end=EndMotion.of(body, end, stays),
        maps=maps,
        view=_view(body, maps, source, history, crown, front, lines, fit),
        grain_sizes=GrainSizes.of(fragments["volume"], left.volumes()) if fragments else None,
        fit=fit,
        crs=body.crs,
    )


def _maps_to_fill(body: Body, left: Solids, cell: float | None) -> tuple[FlowMaps, str]:
    """Maps recorded by the run, if they fit this body and cell up to the end; else empty ones.

    Returns:
        The maps, and why the run's records cannot be used.
    """
    first, last = (body.series.times[body.frames[k]] for k in (0, -1))
    empty = FlowMaps(checked_cell(left, cell), first)
    found = read_maxima(body.folder)
    if found is None:
        return empty, "the case has no output.maps"
    flow, groups, time = found
    if cell is not None and cell != flow.cell:
        return empty, f"the run recorded cells of {flow.cell:g} m"
    if set(groups) != set(body.groups):
        return empty, f"the run recorded {', '.join(groups)}"
    if time < last:
        return empty, f"the run recorded them up to t = {time:.6g} s"
    return flow, ""


def _azimuth(body: Body, end: Solids, direction: float | None) -> float:
    """The given direction of motion, or the direction of the centre of mass [deg]."""
    if direction is None:
        return direction_of(body, end)
    if not np.isfinite(direction):
        raise CdemError(f"the direction must be an azimuth in degrees, got {direction}")
    return float(direction)


def _left_out(body: Body, *, recorded: bool) -> set[str]:
    """Maps that the recorded fields do not allow; largest values may be recorded by the run."""
    names = body.series.names
    out = set() if "displacement" in names["PointData"] else {"permanent_displacement"}
    if recorded:
        return out
    out |= set() if "velocity" in names["PointData"] else OF_VELOCITY
    return out if "piece" in names["CellData"] else out | OF_PIECES


def _classes_of(folder: Path) -> dict[str, list[float]]:
    """Limits of the classes of the maps of another run."""
    path = folder / "runout.json"
    try:
        return json.loads(path.read_text())["maps"]["classes"]
    except (OSError, ValueError, KeyError, TypeError):
        raise CdemError(
            f"{path}: contains no classes of maps; --classes needs a result folder in which cdem "
            f"runout "
            "has written"
        ) from None


def _view(
    body: Body, maps: Maps, source: Deposit, history: Mapping[str, Floats], crown: Floats,
    front: Floats, lines: Sequence[Line], fit: Fit | None,
) -> View:  # fmt: skip
    edges = frame_of(maps.affected)
    x, y = ground_grid(edges)
    step = float(x[1] - x[0])
    return View(
        *edges,
        ground=Raster(x[0] - step / 2, y[0] - step / 2, step, body.ground(x, y)),
        source=source.raster,
        centre=np.column_stack([history[f"centre_{k}"] for k in "xyz"]),
        crown=crown,
        front=front,
        sections=[line.line for line in lines],
        outline=() if fit is None else fit.rings,
    )
