"""The result of a run-out: numbers, page of text, files and pictures."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.output.deposit import Deposit
from cdem.output.geopackage import Features, areas, lines, points, write_geopackage
from cdem.output.geotiff import epsg_of, write_geotiff
from cdem.output.grain_sizes import COLUMNS, GrainSizes
from cdem.output.map_layers import Maps
from cdem.output.map_picture import View, draw_deposit, draw_sheet
from cdem.output.mapped import Fit
from cdem.output.moving_mass import FRAGMENT, SECTION, Section
from cdem.output.runout_measures import HISTORY, EndMotion
from cdem.output.travel import Path as Way
from cdem.run.rest import SLOW_SPEED
from cdem.units import coordinates
from cdem.whole_files import write_json

Floats = NDArray[np.float64]

REST_MEAN = 0.05
"""A deposit has a mean speed below this [m/s] ..."""
REST_SHARE = 0.01
"""... and less than this fraction of its mass is faster than `SLOW_SPEED`."""


@dataclass
class RunOut:
    """Run-out of one run.

    Attributes:
        groups: The moving groups.
        direction: Direction of motion, clockwise from y (north) [deg].
        crown: Highest point of the moving rock at the start [m].
        front: Farthest point at the end, at the height of its element's lowest corner [m].
        history: Columns `HISTORY`, one value for each frame.
        fragments: Columns `FRAGMENT` at the end, largest first; empty if pieces were not recorded.
        sections: Histories through sections.
        deposit: Map of the thickness at the end.
        source: The same map of the start.
        taken_out: Initial volume of the elements that have left the domain by the end [m3].
        end: Motion of the rock at the end.
        maps: Largest values and arrival at each place, and their styles.
        view: Background of pictures of the maps.
        grain_sizes: Grain sizes of the pieces at the end, or None if pieces were not recorded.
        fit: Comparison with a mapped outline, or None.
        crs: Projection of the case, or None.
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
    end: EndMotion
    maps: Maps
    view: View
    grain_sizes: GrainSizes | None
    fit: Fit | None
    crs: str | None

    @property
    def speed_end(self) -> float:
        """Speed of the fastest moving element at the end [m/s]; 0 at rest."""
        return self.end.fastest

    @property
    def moving_share(self) -> float:
        """Fraction of the mass faster than `SLOW_SPEED` at the end."""
        return self.end.share

    @property
    def rests(self) -> bool:
        """Whether the rock has come to rest, so that its map shows a deposit."""
        return self.end.mean < REST_MEAN and self.end.share < REST_SHARE

    @property
    def noun(self) -> str:
        """Name of the rock at the end: a deposit only if it rests."""
        return "deposit" if self.rests else f"body at t = {self.history['time'][-1]:.6g} s"

    @property
    def motion(self) -> str:
        """Speed of rock in motion, or nothing."""
        if self.rests:
            return ""
        return (
            f"still moving at {self.speed_end:.3g} m/s ({100 * self.moving_share:.3g} % of the mass "
            f"above {SLOW_SPEED:g} m/s)"
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
        """Horizontal displacement of the centre of mass along the direction [m]."""
        return float(self.history["centre"][-1] - self.history["centre"][0])

    @property
    def path(self) -> float:
        """Length in plan of the path of the centre of mass [m]."""
        return float(self.history["path"][-1])

    @property
    def reach_along_path(self) -> float:
        """Distance of the front from the crown along the path of the centre of mass [m]."""
        way = Way(self.view.centre)
        return way.length_at(self.front) - way.length_at(self.crown)

    @property
    def energy_slope(self) -> float:
        """Mean fall of the energy line over the path of the centre of mass [1]."""
        line = self.history["energy_line"]
        return _ratio(float(line[0] - line[-1]), self.path)

    def as_dict(self) -> dict[str, Any]:
        """All results except maps and pieces, ready for JSON."""
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
            "along_path": {
                "reach": self.reach_along_path,
                "h_over_l": _ratio(self.drop, self.reach_along_path),
                "centre_travel": self.path,
                "centre_h_over_l": _ratio(self.centre_drop, self.path),
                "energy_slope": self.energy_slope,
            },
            "speed_most": np.max(h["speed_most"]),
            "centre_speed_most": np.max(h["speed"]),
            "volume": h["volume"][-1],
            "taken_out": self.taken_out,
            "at_rest": self.rests,
            "speed_end": self.speed_end,
            "speed_mean_end": self.end.mean,
            "moving_share": self.moving_share,
            "crs": self.crs,
            "maps": self.maps.as_dict(),
            "grain_sizes": None
            if self.grain_sizes is None
            else self.grain_sizes.sizes | {"element": self.grain_sizes.element},
            "against": None if self.fit is None else self.fit.as_dict(),
            "deposit": {
                "cell": d.cell,
                "volume": d.volume,
                "area": d.area,
                "length": d.length(self.direction),
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
            f"  crown at ({_place(self.crown)}), front at ({_place(self.front)}) m",
            "",
            f"  {'from the crown to':<22}{'L [m]':>12}{'H [m]':>12}{'H/L':>9}{'angle [deg]':>13}",
            _row("front", self.reach, self.drop),
            _row("99.9 % of the mass", h["reach_99_9"][-1]),
            _row("95 % of the mass", h["reach_95"][-1]),
            _row("centre of mass, moved", self.centre_travel, self.centre_drop),
            _row("front, along path", self.reach_along_path, self.drop),
            _row("centre, along path", self.path, self.centre_drop),
            "",
            f"  {self.noun}: {d.volume:.6g} m3 on {d.area:.6g} m2, {d.volume / d.area:.4g} m thick on "
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
                f"{100 * h['attached'][-1]:.3g} % is attached to other groups"
            )
        else:
            lines.append("  pieces: not recorded; add piece to output.fields")
        if self.grain_sizes is not None:
            sizes = ", ".join(f"{k} {v:.3g} m" for k, v in self.grain_sizes.sizes.items())
            lines.append(
                f"  grain sizes: {sizes}; no piece is finer than an element, "
                f"{self.grain_sizes.element:.3g} m in the median"
            )
        lines += self._text_of_maps()
        for number, section in enumerate(self.sections, start=1):
            s = section.history
            lines.append(
                f"  section {number} ({coordinates(section.line)}): passed "
                f"{s['passed'][-1]:.5g} m3, at most {s['area'].max():.5g} m2, "
                f"{np.nanmax(np.append(s['velocity'], 0)):.4g} m/s, "
                f"{np.nanmax(np.append(s['discharge'], 0)):.5g} m3/s"
            )
        return "\n".join(lines) + "\n"

    def _text_of_maps(self) -> list[str]:
        """Lines on energy line, maps and outline."""
        lines = []
        if np.isfinite(self.energy_slope):
            lines.append(
                f"  energy line: falls by {self.energy_slope:.4f} of the path of the centre of mass, "
                f"{np.degrees(np.arctan(self.energy_slope)):.2f} deg"
            )
        maps = self.maps
        lines.append(
            f"  maps: rock reached {maps.flow.affected.sum() * maps.flow.cell**2:.6g} m2 (at least "
            f"{maps.flow.met:g} m thick), "
            f"{_how(maps)}; an element passed up "
            f"to {maps.flow.jump:.2g} cells between two looks"
            + (": maxima have gaps, give the case output.maps" if maps.has_gaps else "")
        )
        if self.crs is None:
            lines.append("  maps carry no projection: the case has none (crs: EPSG:...)")
        elif epsg_of(self.crs) is None:
            lines.append(
                "  rasters carry no projection: the projection of the case has no EPSG code"
            )
        return lines + ([] if self.fit is None else [self.fit.text()])

    # ------------------------------------------------------------------ files

    def write(self, folder: str | Path) -> list[Path]:
        """Write runout.json, tables, and maps with their styles; see docs/runout.md."""
        folder, d = Path(folder), self.deposit
        names = ["runout.json", "deposit.asc", "deposit.tif", "runout.csv"]
        write_json(folder / "runout.json", self.as_dict())
        d.write_asc(folder / "deposit.asc")
        write_geotiff(
            folder / "deposit.tif", d.raster, epsg=epsg_of(self.crs), name="thickness", unit="m",
            tags=self._tags,
        )  # fmt: skip
        _write_csv(folder / "runout.csv", HISTORY, self.history)
        if self.fragments:
            _write_csv(folder / "fragments.csv", FRAGMENT, self.fragments)
            names.append("fragments.csv")
        if self.grain_sizes is not None:
            _write_csv(folder / "grain_sizes.csv", COLUMNS, self.grain_sizes.columns())
            names.append("grain_sizes.csv")
        if self.sections:
            frames = len(self.history["time"])
            number = np.repeat(np.arange(1, len(self.sections) + 1), frames)
            columns = {n: np.concatenate([s.history[n] for s in self.sections]) for n in SECTION}
            _write_csv(
                folder / "sections.csv", {"section": "1"} | SECTION, {"section": number} | columns
            )
            names.append("sections.csv")
        maps = self.maps.write(folder, epsg=epsg_of(self.crs), tags=self._tags)
        return [*(folder / name for name in names), *maps]

    @property
    def _tags(self) -> dict[str, str]:
        """Metadata of every raster."""
        return {
            "cdem_what": self.noun,
            "cdem_at_rest": str(self.rests),
            "cdem_time_end": f"{self.history['time'][-1]:.6g} s",
            "cdem_met_from": f"{self.maps.flow.met:g} m",
            "cdem_maxima": "frames" if self.maps.from_frames else "run",
        }

    def write_geopackage(self, folder: str | Path) -> Path:
        """Write runout.gpkg: pieces, areas, path, front and sections, with styles.

        Raises:
            BackendError: The extra `terrain` is not installed.
        """
        path = Path(folder) / "runout.gpkg"
        write_geopackage(path, self._features(), self.crs)
        return path

    def _features(self) -> list[Features]:
        p = self.fragments
        layers = [
            areas("affected", self.maps.affected, "#7f7f7f"),
            areas("source", self.source.raster, "#1f77b4"),
            areas("deposit" if self.rests else "body_end", self.deposit.raster, "#d95f0e"),
            lines(
                "path", [self.view.centre],
                {"length_m": np.array([self.path]), "drop_m": np.array([self.centre_drop])}, "#1f77b4",
            ),
            points(
                "front", np.array([self.crown, self.front]),
                {"what": np.array(["crown", "front"], dtype=object)}, "#d62728",
            ),
        ]  # fmt: skip
        if p:
            columns = {
                "piece": p["piece"], "elements": p["elements"], "volume_m3": p["volume"],
                "mass_kg": p["mass"], "diameter_m": p["diameter"], "attached": p["attached"] > 0,
            }  # fmt: skip
            places = np.column_stack([p[k] for k in "xyz"])
            layers.insert(0, points("fragments", places, columns, "#8c510a"))
        if self.sections:
            ends = [np.reshape(s.line, (2, 2)) for s in self.sections]
            columns = {
                "section": np.arange(1, len(ends) + 1),
                "passed_m3": np.array([s.history["passed"][-1] for s in self.sections]),
            }
            layers.append(lines("sections", ends, columns, "#2ca02c"))
        return layers

    def draw(self, folder: str | Path) -> list[Path]:
        """Draw deposit.png, maps.png, energy_line.png and grain_sizes.png.

        Raises:
            CdemError: matplotlib is not installed.
        """
        from cdem.output.figures import pyplot

        plt, folder = pyplot(), Path(folder)
        title = f"{self.noun}: {self.deposit.volume:.4g} m3"
        if not self.rests:
            title += f"\n{self.motion}"
        paths = [
            draw_deposit(folder / "deposit.png", self.maps, self.view, title, plt),
            draw_sheet(folder / "maps.png", self.maps, self.view, plt),
        ]
        if np.isfinite(self.history["energy_line"]).all():
            paths.append(self._draw_energy_line(folder / "energy_line.png", plt))
        if self.grain_sizes is not None:
            paths.append(self.grain_sizes.draw(folder, plt))
        return paths

    def _draw_energy_line(self, path: Path, plt: Any) -> Path:
        h = self.history
        figure, axes = plt.subplots(figsize=(6.4, 3.8))
        axes.plot(h["path"], h["energy_line"], "C3-", label="energy line")
        axes.plot(h["path"], h["centre_z"], "C0-", label="centre of mass")
        axes.plot(
            h["path"][[0, -1]], h["energy_line"][[0, -1]], "k--", lw=0.9,
            label=f"mean fall {self.energy_slope:.3f}",
        )  # fmt: skip
        axes.fill_between(h["path"], h["centre_z"], h["energy_line"], color="C3", alpha=0.12, lw=0)
        axes.set(xlabel="path of the centre of mass in plan [m]", ylabel="height [m]")
        axes.legend(frameon=False, fontsize=8)
        figure.savefig(path, bbox_inches="tight")
        plt.close(figure)
        return path


def _place(point: Floats) -> str:
    """Coordinates to a centimetre."""
    return coordinates(np.round(point, 2) + 0.0)


def _how(maps: Maps) -> str:
    return f"from frames ({maps.from_frames})" if maps.from_frames else "recorded during the run"


def _ratio(drop: float, reach: float) -> float:
    return drop / reach if reach > 0 else np.nan


def _row(what: str, reach: float, drop: float | None = None) -> str:
    if drop is None:
        return f"  {what:<22}{reach:>12.5g}"
    ratio = _ratio(drop, reach)
    angle = np.degrees(np.arctan(ratio))
    return f"  {what:<22}{reach:>12.5g}{drop:>12.5g}{ratio:>9.4f}{angle:>13.2f}"


def _median(volume: Floats) -> float:
    """Volume of the piece below which half of the whole volume lies; volumes are in decreasing order."""
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
