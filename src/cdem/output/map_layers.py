"""The maps of a run-out as layers: name, unit, colours, classes and style of each."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.element_volumes import Solids
from cdem.output.deposit import Deposit
from cdem.output.geotiff import write_geotiff
from cdem.run.flow_maps import ARRIVAL, MAXIMA, TRACE, FlowMaps
from cdem.terrain.rasters import Raster

Floats = NDArray[np.float64]

FOLDER = "maps"
CLASSES = 8
"""Most classes of a map, with limits at round numbers."""
EARTH = ("#ffffd4", "#fee391", "#fec44f", "#fe9929", "#d95f0e", "#993404")
VIRIDIS = ("#440154", "#414487", "#2a788e", "#22a884", "#7ad151", "#fde725")
PLASMA = ("#0d0887", "#6a00a8", "#b12a90", "#e16462", "#fca636", "#f0f921")
REDS = ("#fee5d9", "#fcbba1", "#fc9272", "#fb6a4a", "#de2d26", "#a50f15")
BALANCE = ("#2166ac", "#67a9cf", "#d1e5f0", "#fddbc7", "#ef8a62", "#b2182b")


@dataclass(frozen=True)
class Layer:
    """One map.

    Attributes:
        unit: Unit of its values.
        title: Its title.
        colors: From the lowest class to the highest.
        scale: Factor from SI to its unit.
    """

    unit: str
    title: str
    colors: Sequence[str]
    scale: float = 1.0


LAYERS = {
    "thickness_end": Layer("m", "thickness at the end", EARTH),
    "thickness_max": Layer("m", "largest thickness", EARTH),
    "velocity_max": Layer("m/s", "largest velocity of an element", VIRIDIS),
    "velocity_mean_max": Layer("m/s", "largest mean velocity of the column", VIRIDIS),
    "momentum_max": Layer("m2/s", "largest momentum (thickness x velocity)", REDS),
    "energy_area_max": Layer("kJ/m2", "largest kinetic energy of the column", REDS, 1e-3),
    "energy_piece_max": Layer("kJ", "largest kinetic energy of a piece", REDS, 1e-3),
    "pressure_max": Layer("kPa", "largest pressure (density x velocity^2)", REDS, 1e-3),
    ARRIVAL: Layer("s", "arrival after the start", PLASMA),
    "change": Layer("m", "end less start", BALANCE),
    "permanent_displacement": Layer("m", "displacement of the rock at the end", VIRIDIS),
}
"""All maps, by name."""
OF_VELOCITY = {
    "velocity_max", "velocity_mean_max", "momentum_max", "energy_area_max", "energy_piece_max",
    "pressure_max",
}  # fmt: skip
"""Maps that need the field velocity in the frames."""
OF_PIECES = {"energy_piece_max"}
"""Maps that need the field piece."""


@dataclass
class Moved:
    """Rock at the end, and the length of the displacement of each element [m]."""

    solids: Solids
    way: Floats


@dataclass
class Maps:
    """The maps of one run-out.

    Attributes:
        rasters: By name, in the order and units of `LAYERS`.
        flow: Largest values and arrivals that they are made from.
        from_frames: Why largest values come from frames; empty if the run recorded them.
        affected: Cells reached by rock, 1 or not a number.
        classes: Limits of the classes of each map.
    """

    rasters: dict[str, Raster]
    flow: FlowMaps
    from_frames: str
    affected: Raster
    classes: dict[str, list[float]]

    @classmethod
    def of(
        cls,
        flow: FlowMaps,
        start: Deposit,
        end: Deposit,
        *,
        from_frames: str = "",
        left_out: Container[str] = (),
        moved: Moved | None = None,
        classes: Mapping[str, Sequence[float]] | None = None,
    ) -> Maps:
        """Make the maps.

        Args:
            flow: Largest values and arrivals.
            start: Thickness at the start.
            end: Thickness at the end, on cells of the same size.
            from_frames: Why `flow` does not come from records of the run.
            left_out: Names of maps that cannot be made.
            moved: Displacement of the rock at the end; None leaves its map empty.
            classes: Limits of the classes by name; other maps get fitting classes.
        """
        cell, met = flow.cell, flow.affected
        corner = (flow.low[0] * cell, flow.low[1] * cell)

        def over(values: Floats) -> Raster:
            return Raster(*corner, cell, values)

        ends, starts = (_spread(d, flow) for d in (end, start))
        rock = (ends > 0) | (starts > 0)
        rasters = {
            "thickness_end": over(np.where(ends > 0, ends, np.nan)),
            **{name: over(np.where(met, flow[name], np.nan)) for name in MAXIMA},
            ARRIVAL: over(flow[ARRIVAL]),
            "change": over(np.where(rock | met, ends - starts, np.nan)),
            "permanent_displacement": over(_moved(moved, flow)),
        }
        kept = {
            name: Raster(*corner, cell, rasters[name].values * layer.scale)
            for name, layer in LAYERS.items()
            if name not in left_out
        }
        given = classes or {}
        limits = {
            name: [float(v) for v in given.get(name, limits_of(name, raster.values))]
            for name, raster in kept.items()
        }
        return cls(kept, flow, from_frames, over(np.where(met, 1.0, np.nan)), limits)

    @property
    def has_gaps(self) -> bool:
        """Whether an element may have crossed a cell between two looks."""
        return self.flow.jump > 1

    def as_dict(self) -> dict[str, Any]:
        """The maps in runout.json."""
        return {
            "cell": self.flow.cell,
            "met": self.flow.met,
            "from_run": not self.from_frames,
            "jump": self.flow.jump,
            "area_affected": float(self.flow.affected.sum()) * self.flow.cell**2,
            "largest": {n: float(np.nanmax(r.values, initial=0)) for n, r in self.rasters.items()},
            "classes": self.classes,
        }

    def write(self, folder: Path, *, epsg: int | None, tags: Mapping[str, str]) -> list[Path]:
        """Write a GeoTIFF and a style for each map into the folder `maps` of a result folder."""
        (folder / FOLDER).mkdir(exist_ok=True)
        paths = []
        for name, raster in self.rasters.items():
            layer, path = LAYERS[name], folder / FOLDER / f"{name}.tif"
            write_geotiff(
                path, raster, epsg=epsg, name=name, unit=layer.unit,
                tags={"cdem_quantity": layer.title} | dict(tags),
            )  # fmt: skip
            path.with_suffix(".qml").write_text(raster_style(layer, self.classes[name]))
            paths += [path, path.with_suffix(".qml")]
        return paths


def _moved(moved: Moved | None, flow: FlowMaps) -> Floats:
    """Largest displacement of an element above each cell [m]; not a number where there is no rock."""
    out = np.full(flow.layers.shape[1:], np.nan)
    if moved is None or not len(moved.way):
        return out
    low, shape = moved.solids.grid(flow.cell)
    most = np.full(shape[0] * shape[1], np.nan)
    for part in moved.solids.parts(flow.cell, low, shape):
        above = np.abs(part.share) > TRACE
        np.fmax.at(most, part.place[above], moved.way[part.owner[above]])
    column, row = np.subtract(low, flow.low)
    out[row : row + shape[0], column : column + shape[1]] = most.reshape(shape)
    return out


def _spread(deposit: Deposit, flow: FlowMaps) -> Floats:
    """Thickness on the grid of the maps, which contains the grid of the deposit [m]."""
    rows, columns = flow.layers.shape[1:]
    out = np.zeros((rows, columns))
    column = round(deposit.x / deposit.cell) - flow.low[0]
    row = round(deposit.y / deposit.cell) - flow.low[1]
    height, width = deposit.thickness.shape
    out[row : row + height, column : column + width] = np.where(
        deposit.covered, deposit.thickness, 0.0
    )
    return out


def limits_of(name: str, values: Floats) -> list[float]:
    """Limits of classes at round numbers: from 0, or symmetric about 0."""
    most = float(np.nanmax(np.abs(values), initial=0.0))
    if not most > 0:
        return [0.0, 1.0]
    if name == "change":
        step = _round_up(2 * most / CLASSES)
        return [step * k for k in range(-CLASSES // 2, CLASSES // 2 + 1)]
    step = _round_up(most / CLASSES)
    return [step * k for k in range(int(np.ceil(most / step * (1 - 1e-12))) + 1)]


def _round_up(size: float) -> float:
    """The smallest of 1, 2, 2.5 or 5 times a power of ten that is not below a size."""
    power = 10.0 ** np.floor(np.log10(size))
    return float(next(f for f in (1, 2, 2.5, 5, 10) if f * power >= size * (1 - 1e-12)) * power)


def colors_of(layer: Layer, count: int) -> list[str]:
    """Colours of this number of classes, from the lowest to the highest."""
    table = np.array([[int(c[k : k + 2], 16) for k in (1, 3, 5)] for c in layer.colors])
    places = np.linspace(0, len(table) - 1, count) if count > 1 else np.zeros(1)
    mixed = [np.interp(places, np.arange(len(table)), channel) for channel in table.T]
    return ["#" + "".join(f"{round(v):02x}" for v in color) for color in zip(*mixed, strict=True)]


def raster_style(layer: Layer, limits: Sequence[float]) -> str:
    """The style of a raster for QGIS (QML): classes with their limits in the legend."""
    classes = list(pairwise(limits))
    items = "".join(
        f'<item alpha="255" color="{color}" value="{"inf" if high == limits[-1] else f"{high:.10g}"}" '
        f'label="{low:.10g} - {high:.10g} {layer.unit}"/>'
        for (low, high), color in zip(classes, colors_of(layer, len(classes)), strict=True)
    )
    return (
        "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
        '<qgis version="3.22.0" styleCategories="AllStyleCategories"><pipe>'
        '<rasterrenderer type="singlebandpseudocolor" band="1" opacity="0.8" alphaBand="-1" '
        f'classificationMin="{limits[0]:.10g}" classificationMax="{limits[-1]:.10g}">'
        '<rastershader><colorrampshader colorRampType="DISCRETE" classificationMode="1" clip="0" '
        f'minimumValue="{limits[0]:.10g}" maximumValue="{limits[-1]:.10g}">{items}'
        "</colorrampshader></rastershader></rasterrenderer></pipe></qgis>\n"
    )
