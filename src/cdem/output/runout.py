"""Run-out of a finished run: how far, how thick, how fast through sections, in how many pieces.

The definitions, with their sources, are in docs/runout.md. All follow from the frames of the result
folder; lengths are horizontal, along one direction, from the crown.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.output.deposit import Deposit
from cdem.output.element_volumes import Solids
from cdem.output.moving_mass import FRAGMENT, SECTION, STILL, Body, Line, Section
from cdem.output.reader import read_histories
from cdem.run.rest import REST_SPEED
from cdem.units import coordinates
from cdem.whole_files import write_json

Floats = NDArray[np.float64]

SAME = 1e-9
"""Heights and lengths that differ by less than this part of the body's size are the same."""
HISTORY = {
    "time": "s", "front": "m", "reach_99_9": "m", "reach_95": "m", "centre": "m",
    "centre_x": "m", "centre_y": "m", "centre_z": "m", "speed": "m/s", "speed_most": "m/s",
    "volume": "m3", "pieces": "1", "largest": "1", "attached": "1", "broken_tension": "1",
    "broken_shear": "1",
}  # fmt: skip
"""Columns of runout.csv with their units."""


@dataclass
class RunOut:
    """Run-out of one run.

    Attributes:
        groups: The moving groups.
        direction: Of motion, clockwise from y (north) [deg].
        crown: Highest point of the moving rock at the start [m].
        front: Farthest point at the end; its height is the lowest of the element it belongs to [m].
        history: Columns `HISTORY`, one value for each frame.
        fragments: Columns `FRAGMENT` at the end, largest first; empty if pieces were not recorded.
        sections: Histories through sections.
        deposit: Map of the thickness at the end.
        source: The same map of the start.
        speed_end: Speed of the fastest element that moves at the end [m/s]: as recorded, else its
            mean since the frame before.
        taken_out: Volume at the start of what has left the domain of the case by the end [m3].
        moving_share: Part of the mass that moves: whose speed at the end, and whose mean since the
            frame before, is above `REST_SPEED`.
    """

    groups: list[str]
    direction: float
    crown: Floats
    front: Floats
    history: dict[str, Floats]
    fragments: dict[str, Floats]
    sections: list[Section]
    deposit: Deposit
    source: Deposit
    taken_out: float
    speed_end: float
    moving_share: float

    @property
    def rests(self) -> bool:
        """Whether the rock has come to rest, so that its map is one of a deposit."""
        return self.moving_share == 0

    @property
    def motion(self) -> str:
        """How fast the rock still moves, or nothing."""
        if self.rests:
            return ""
        return (
            f"still moving at {self.speed_end:.3g} m/s ({100 * self.moving_share:.3g} % of the mass "
            f"above {REST_SPEED:g} m/s)"
        )

    @property
    def drop(self) -> float:
        """Height of the crown above the front [m]: H."""
        return float(self.crown[2] - self.front[2])

    @property
    def reach(self) -> float:
        """Horizontal distance from the crown to the front [m]: L."""
        return float(self.history["front"][-1])

    @property
    def centre_drop(self) -> float:
        """Fall of the centre of mass [m]."""
        return float(self.history["centre_z"][0] - self.history["centre_z"][-1])

    @property
    def centre_travel(self) -> float:
        """Horizontal way of the centre of mass along the direction [m]."""
        return float(self.history["centre"][-1] - self.history["centre"][0])

    def as_dict(self) -> dict[str, Any]:
        """Everything but the maps and the pieces, ready for JSON."""
        h, d = self.history, self.deposit
        volume = self.fragments.get("volume", np.zeros(0))
        return {
            "groups": self.groups,
            "direction": self.direction,
            "crown": self.crown,
            "front": self.front,
            "reach": self.reach,
            "drop": self.drop,
            "h_over_l": _ratio(self.drop, self.reach),
            "reach_95": h["reach_95"][-1],
            "reach_99_9": h["reach_99_9"][-1],
            "centre_travel": self.centre_travel,
            "centre_drop": self.centre_drop,
            "centre_h_over_l": _ratio(self.centre_drop, self.centre_travel),
            "speed_most": np.max(h["speed_most"]),
            "centre_speed_most": np.max(h["speed"]),
            "volume": h["volume"][-1],
            "taken_out": self.taken_out,
            "at_rest": self.rests,
            "speed_end": self.speed_end,
            "moving_share": self.moving_share,
            "deposit": {
                "cell": d.cell,
                "volume": d.volume,
                "area": d.area,
                "thickness_mean": d.volume / d.area,
                "thickness_most": float(d.thickness.max()),
            },
            "fragments": {
                "pieces": h["pieces"][-1],
                "largest": h["largest"][-1],
                "attached": h["attached"][-1],
                "median_volume": _median(volume),
            },
            "broken": {"tension": h["broken_tension"][-1], "shear": h["broken_shear"][-1]},
            "sections": [{"line": s.line, "history": s.history} for s in self.sections],
            "history": h,
        }

    def text(self) -> str:
        """The result as a page of text."""
        h, d = self.history, self.deposit
        lines = [
            f"run-out of {', '.join(self.groups)}: {h['volume'][-1]:.6g} m3 towards "
            f"{self.direction:.1f} deg, t = {h['time'][-1]:.6g} s",
            *(
                []
                if self.rests
                else [f"  {self.motion}: no deposit yet; front and reach are not final"]
            ),
            *(
                [f"  {self.taken_out:.6g} m3 more have left model.domain and do not count"]
                if self.taken_out
                else []
            ),
            f"  crown at ({coordinates(self.crown)}), front at ({coordinates(self.front)}) m",
            "",
            f"  {'from the crown to':<22}{'L [m]':>12}{'H [m]':>12}{'H/L':>9}{'angle [deg]':>13}",
            _row("front", self.reach, self.drop),
            _row("99.9 % of the mass", h["reach_99_9"][-1]),
            _row("95 % of the mass", h["reach_95"][-1]),
            _row("centre of mass, moved", self.centre_travel, self.centre_drop),
            "",
            f"  {'deposit' if self.rests else 'rock now'}: {d.volume:.6g} m3 on {d.area:.6g} m2, {d.volume / d.area:.4g} m thick on "
            f"average, {d.thickness.max():.4g} m at most (solid rock; cells of {d.cell:g} m)",
            f"  fastest: centre of mass {np.max(h['speed']):.4g} m/s, an element "
            f"{np.max(h['speed_most']):.4g} m/s"
            if np.isfinite(h["speed"]).any()
            else "  fastest: not recorded; add velocity to output.fields",
            f"  broken springs: {h['broken_tension'][-1]:,.0f} tension, "
            f"{h['broken_shear'][-1]:,.0f} shear",
        ]
        if self.fragments:
            lines.append(
                f"  pieces: {h['pieces'][-1]:,.0f}, the largest {100 * h['largest'][-1]:.3g} % of "
                f"the volume; half of it in pieces below "
                f"{_median(self.fragments['volume']):.4g} m3; "
                f"{100 * h['attached'][-1]:.3g} % hangs on other groups"
            )
        else:
            lines.append("  pieces: not recorded; add piece to output.fields")
        for number, section in enumerate(self.sections, start=1):
            s = section.history
            lines.append(
                f"  section {number} ({coordinates(section.line)}): passed "
                f"{s['passed'][-1]:.5g} m3, at most {s['area'].max():.5g} m2, "
                f"{np.nanmax(np.append(s['velocity'], 0)):.4g} m/s, "
                f"{np.nanmax(np.append(s['discharge'], 0)):.5g} m3/s"
            )
        return "\n".join(lines) + "\n"

    def write(self, folder: str | Path) -> list[Path]:
        """Write runout.json, runout.csv, fragments.csv, sections.csv, deposit.asc and deposit.tif."""
        folder = Path(folder)
        names = ["runout.json", "deposit.asc", "deposit.tif", "runout.csv"]
        write_json(folder / "runout.json", self.as_dict())
        self.deposit.write_asc(folder / "deposit.asc")
        self.deposit.write_tiff(folder / "deposit.tif")
        _write_csv(folder / "runout.csv", HISTORY, self.history)
        if self.fragments:
            _write_csv(folder / "fragments.csv", FRAGMENT, self.fragments)
            names.append("fragments.csv")
        if self.sections:
            frames = len(self.history["time"])
            number = np.repeat(np.arange(1, len(self.sections) + 1), frames)
            columns = {n: np.concatenate([s.history[n] for s in self.sections]) for n in SECTION}
            _write_csv(
                folder / "sections.csv", {"section": "1"} | SECTION, {"section": number} | columns
            )
            names.append("sections.csv")
        return [folder / name for name in names]

    def draw(self, folder: str | Path) -> Path:
        """Draw deposit.png: thickness, outline of the source, crown, front and sections.

        Raises:
            CdemError: matplotlib is not installed.
        """
        from cdem.output.figures import pyplot

        plt = pyplot()
        d, s = self.deposit, self.source
        figure, axes = plt.subplots(figsize=(7.5, 6))
        rows, columns = d.thickness.shape
        image = axes.imshow(
            np.where(d.covered, d.thickness, np.nan), origin="lower", cmap="YlOrBr", vmin=0,
            extent=(d.x, d.x + columns * d.cell, d.y, d.y + rows * d.cell),
        )  # fmt: skip
        figure.colorbar(image, label="thickness of solid rock [m]", shrink=0.8)
        outline = np.pad(s.covered.astype(float), 1)
        east = s.x + s.cell * (np.arange(outline.shape[1]) - 0.5)
        north = s.y + s.cell * (np.arange(outline.shape[0]) - 0.5)
        axes.contour(east, north, outline, [0.5], colors="k", linestyles="--", linewidths=0.8)
        axes.plot(self.history["centre_x"], self.history["centre_y"], "C0-", label="centre of mass")
        axes.plot(*self.crown[:2], "k^", label="crown")
        axes.plot(*self.front[:2], "C3v", label="front")
        for number, section in enumerate(self.sections, start=1):
            x0, y0, x1, y1 = section.line
            axes.plot([x0, x1], [y0, y1], "C2-", lw=1.5)
            axes.annotate(str(number), (x1, y1), color="C2")
        axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
        title = f"t = {self.history['time'][-1]:.4g} s; dashed: the source"
        axes.set_title("\n".join([title, self.motion] if self.motion else [title]), fontsize=10)
        axes.autoscale_view()
        axes.legend(frameon=False, fontsize=8)
        path = Path(folder) / "deposit.png"
        figure.savefig(path, bbox_inches="tight")
        plt.close(figure)
        return path


def measure(
    folder: str | Path,
    *,
    groups: Sequence[str] | None = None,
    direction: float | None = None,
    cell: float | None = None,
    sections: Sequence[Sequence[float]] = (),
) -> RunOut:
    """Measure the run-out in a result folder; docs/runout.md defines every quantity.

    Args:
        folder: Result folder of `cdem run`.
        groups: Moving groups; by default those that moved a tenth as far as the farthest, or more,
            since displacements were last reset.
        direction: Of motion, clockwise from y (north) [deg]; by default that in which the
            centre of mass moved in plan.
        cell: Side of a cell of the thickness map [m]; by default about the size of an element.
        sections: x0, y0, x1, y1 of lines in plan [m] through which rock is followed.

    Raises:
        CdemError: The folder holds no frames, or groups, direction, cell or a section make no sense.

    Example:
        >>> from cdem.output import runout
        >>> found = runout.measure("landslide.results")     # doctest: +SKIP
        >>> found.drop / found.reach                        # doctest: +SKIP
        0.41
    """
    folder = Path(folder)
    body = Body(folder, groups)
    end = body.solids(body.frames[-1])
    if direction is None:
        direction = _direction(body, end)
    elif not np.isfinite(direction):
        raise CdemError(f"the direction must be an azimuth in degrees, got {direction}")
    way = np.array([np.sin(np.radians(direction)), np.cos(np.radians(direction)), 0.0])
    crown = _crown(body.series.points(body.frames[0])[body.nodes], way)
    lines = [Line(line, way[:2], body.start) for line in sections]
    history, fragments = _follow(body, way, crown @ way, lines)
    stays = body.stays(body.frames[-1])
    deposit = Deposit.of(end.only(stays), cell)
    return RunOut(
        groups=body.groups,
        direction=float(direction % 360),
        crown=crown,
        front=_front(body, body.frames[-1], way),
        history=history | _broken(folder, history["time"]),
        fragments=fragments,
        sections=[line.section() for line in lines],
        deposit=deposit,
        source=Deposit.of(body.start, deposit.cell),
        taken_out=float(body.start.volumes()[~stays].sum()),
        **_motion_at_the_end(body, end, stays),
    )


def _motion_at_the_end(body: Body, end: Solids, stays: NDArray[np.bool_]) -> dict[str, float]:
    """`speed_end` and `moving_share` of a run-out, of the elements that stay."""
    last, before = body.frames[-1], body.frames[-2]
    passed = body.series.times[last] - body.series.times[before]
    way = np.linalg.norm(end.centroids() - body.solids(before).centroids(), axis=1)
    recorded = np.linalg.norm(body.velocities(last), axis=1)
    speed = np.where(np.isnan(recorded), way / passed, recorded)
    moves = stays & (speed >= REST_SPEED) & (way / passed >= REST_SPEED)  # else it only vibrates
    share = body.mass[moves].sum() / body.mass[stays].sum()
    return {"speed_end": float(speed[moves].max(initial=0.0)), "moving_share": float(share)}


def _follow(
    body: Body, way: Floats, origin: float, lines: Sequence[Line]
) -> tuple[dict[str, Floats], dict[str, NDArray]]:
    """Columns `HISTORY` frame by frame, and the pieces at the end; lines see every frame, too.

    Args:
        body: The moving elements.
        way: Unit vector along the motion.
        origin: Where distances along it count from [m].
        lines: Sections through which rock is followed.
    """
    rows, before = [], body.start.centroids()
    for frame in body.frames:
        time, solids, velocity = (
            body.series.times[frame],
            body.solids(frame),
            body.velocities(frame),
        )
        stays, centroid = body.stays(frame), solids.centroids()
        left, mass = solids.only(stays), body.mass[stays]
        volume, speeds = left.volumes(), velocity[stays]
        centre = mass @ centroid[stays] / mass.sum()
        density = mass / volume  # the mass stays while the volume changes
        places = left.triangles @ way
        pieces = body.pieces(frame, volume, stays)
        rows.append(
            [
                time,
                places.max() - origin,
                *(left.level_below_which(q, way, density) - origin for q in (0.999, 0.95)),
                centre @ way - origin,
                *centre,
                np.linalg.norm(mass @ speeds) / mass.sum(),
                np.linalg.norm(speeds, axis=1).max(),
                volume.sum(),
                *((np.nan,) * 3 if pieces is None else pieces.row()),
            ]
        )
        for line in lines:
            line.follow(time, solids, stays, velocity, before, centroid)
        before = centroid
    history = dict(zip(list(HISTORY)[: len(rows[0])], np.array(rows).T, strict=True))
    return history, {} if pieces is None else pieces.table(mass, centroid[stays])


def _direction(body: Body, end: Solids) -> float:
    """Direction in which the centre of mass has moved in plan, clockwise from y [deg]."""
    moved = body.mass @ (end.centroids() - body.start.centroids()) / body.mass.sum()
    size = np.ptp(body.start.middle, axis=0).max()
    if np.linalg.norm(moved[:2]) <= STILL * size:
        raise CdemError(
            "the centre of mass has not moved in plan, so give a direction (an azimuth)"
        )
    return float(np.degrees(np.arctan2(moved[0], moved[1])))


def _crown(points: Floats, way: Floats) -> Floats:
    """Highest point; of several, the one that is farthest back."""
    near = SAME * np.ptp(points, axis=0).max()
    top = points[points[:, 2] >= points[:, 2].max() - near]
    return top[(top @ way).argmin()]


def _front(body: Body, frame: int, way: Floats) -> Floats:
    """Farthest point, at the height of the lowest corner of its element.

    A front may be upright, so that top and bottom are equally far; it is the foot that counts.
    """
    points, stays = body.series.points(frame), body.stays(frame)
    best, foot, first = -np.inf, 0.0, 0
    for all_of_shape in body.cells.values():
        nodes = all_of_shape[stays[first : first + len(all_of_shape)]]
        first += len(all_of_shape)
        if len(nodes) == 0:
            continue
        x = points[nodes]
        element, corner = np.unravel_index((x @ way).argmax(), x.shape[:2])
        if x[element, corner] @ way > best:
            best, place, foot = x[element, corner] @ way, x[element, corner], x[element, :, 2].min()
    return np.array([*place[:2], foot])


def _broken(folder: Path, times: Floats) -> dict[str, Floats]:
    """Springs broken by the time of each frame, by kind."""
    columns = read_histories(folder)
    row = np.searchsorted(columns["time [s]"], times, side="right") - 1
    return {f"broken_{k}": columns[f"broken {k}"][row] for k in ("tension", "shear")}


def _ratio(drop: float, reach: float) -> float:
    return drop / reach if reach > 0 else np.nan


def _row(what: str, reach: float, drop: float | None = None) -> str:
    if drop is None:
        return f"  {what:<22}{reach:>12.5g}"
    ratio = _ratio(drop, reach)
    angle = np.degrees(np.arctan(ratio))
    return f"  {what:<22}{reach:>12.5g}{drop:>12.5g}{ratio:>9.4f}{angle:>13.2f}"


def _median(volume: Floats) -> float:
    """Volume of the piece below which half of the whole volume lies; volumes fall."""
    if len(volume) == 0:
        return np.nan
    return float(volume[np.searchsorted(np.cumsum(volume), 0.5 * volume.sum())])


def _write_csv(path: Path, units: Mapping[str, str], columns: Mapping[str, NDArray]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(
            [name if unit == "1" else f"{name} [{unit}]" for name, unit in units.items()]
        )
        writer.writerows(zip(*(columns[name].tolist() for name in units), strict=True))
