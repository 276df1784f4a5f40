"""Bolts and water of a model, in its picture before the run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.water_schema import Level, Reservoir, WaterField
from cdem.mesh.element_shapes import NODES
from cdem.model.bolt_places import Polyline, polylines
from cdem.model.curves import constant
from cdem.model.water_fields import WaterTables
from cdem.output.model_panel import DOTS, Panel
from cdem.run.frame_files import VTK_TYPES

if TYPE_CHECKING:
    from cdem.mesh.topology import Topology
    from cdem.run.state import RunState

WATER = "#1f77d4"
"""Colour of water tables and open water."""
TILES = 120
"""Parts of a side of the surface of open water: those in the rock are left out."""


def draw_bolts(panel: Panel, sim: RunState) -> None:
    """Bolts as lines, thick where they are grouted, with a dot at each head."""
    case = sim.case
    lines = polylines(case, sim.build.topology, sim.build.group_names)
    for number, entry in enumerate(case.bolts):
        own = [line for line in lines if line.entry == number]
        fill = DOTS[number % len(DOTS)]
        short, long = (f"{end(line.length for line in own):.4g}" for end in (min, max))
        label = f"bolts {entry.name}: {len(own):,} of {entry.type}, "
        label += f"{short} m" if short == long else f"{short} to {long} m"
        label += f", from stage {entry.install}" if entry.install else ""
        heads = panel.pyvista.PolyData(np.array([line.points[0] for line in own]))
        panel.add(heads, fill, label, point_size=9, render_points_as_spheres=True)
        for first, last, width in ((0.0, entry.free_length, 1.5), (entry.free_length, np.inf, 4)):
            parts = [part for line in own if (part := _part(line, first, last)) is not None]
            if parts:
                ends = np.concatenate([np.stack([p[:-1], p[1:]], axis=1) for p in parts])
                bars = panel.pyvista.line_segments_from_points(ends.reshape(-1, 3))
                panel.add(bars, fill, line_width=width, lighting=False)


def _part(line: Polyline, first: float, last: float) -> NDArray[np.float64] | None:
    """Points of a bolt between two lengths from its head, shape (points, 3) [m]; None if none."""
    last = min(last, line.length)
    if last <= first:
        return None
    between = (line.starts > first) & (line.starts < last)
    return np.vstack([line.at(first), line.points[between], line.at(last)])


def draw_water(panel: Panel, sim: RunState) -> None:
    """Water tables in the rock, where the pressure of a field is zero, and the level of open water.

    Tables that a stage moves are drawn again for it. Levels over time are drawn at their highest.
    """
    t, names = sim.build.topology, sim.build.group_names
    rock = _volume(panel.pyvista, t)
    drawn: list[WaterField | Reservoir] = []
    for stage, case in _over_stages(sim.case):
        assert case.water is not None
        tables = WaterTables(case, t, names, constant())
        for number, entry in enumerate(case.water.fields):
            if entry not in drawn:
                drawn.append(entry)
                some = [names.index(name) for name in entry.groups or names]
                part = rock.extract_cells(np.flatnonzero(np.isin(rock["group"], some)))
                part["pressure"] = tables.signed(number, np.asarray(part.points, float))
                table = part.contour([0.0], scalars="pressure")
                label = f"water {entry.name or number}{stage}: {_kind(entry)}"
                _sheet(panel, table, label, "no table in the rock")
        if (open_ := case.water.reservoir) is not None and open_ not in drawn:
            drawn.append(open_)
            label = f"reservoir{stage}: level {_height(open_.level):g} m"
            _sheet(panel, _open_water(panel.pyvista, rock, open_), label, "outside the model")


def _sheet(panel: Panel, mesh: Any, label: str, missing: str) -> None:
    if mesh.n_cells:
        panel.show(mesh.points)
        panel.sheets([(mesh, WATER, label)])
    else:
        panel.legend.append((f"{label} ({missing})", "#ffffff"))


def _kind(entry: WaterField) -> str:
    """How a field is given, and its lift."""
    kinds = ("level", "plane", "surface", "formula", "table", "ru")
    kind = next(kind for kind in kinds if getattr(entry, kind) is not None)
    kind += "" if entry.level is None else f" {_height(entry.level):g} m"
    kind += f", lifted by {entry.lift:g} m" if entry.lift else ""
    return kind + (f", in {entry.interface}" if entry.interface else "")


def _over_stages(case: Case) -> Iterator[tuple[str, Case]]:
    """The case with its highest levels, at the start and after each stage that sets its water."""
    if case.water is None:
        return
    yield "", _highest(case)
    case = case.model_copy(deep=True)
    for stage in case.stages:
        settings = [(path, value) for path, value in stage.set.items() if path.startswith("water.")]
        for path, value in settings:
            case.set(path, value)
        if settings:
            yield f", stage {stage.name}", _highest(case)


def _highest(case: Case) -> Case:
    """A copy in which levels over time are at their highest."""
    copy = case.model_copy(deep=True)
    assert copy.water is not None
    for entry in (*copy.water.fields, copy.water.reservoir):
        if entry is not None and isinstance(entry.level, list):
            entry.level = [(0.0, max(height for _, height in entry.level))]
    return copy


def _height(level: Level) -> float:
    return float(level[0][1] if isinstance(level, list) else level)


def _volume(pyvista: Any, t: Topology) -> Any:
    """The elements with their groups, an UnstructuredGrid."""
    shapes = [shape for shape in NODES if len(t.element_nodes[shape])]
    cells = [np.insert(t.element_nodes[s], 0, NODES[s], axis=1).ravel() for s in shapes]
    types = [np.full(len(t.element_nodes[s]), VTK_TYPES[s], np.uint8) for s in shapes]
    rock = pyvista.UnstructuredGrid(
        np.concatenate(cells).astype(np.int64), np.concatenate(types), t.node_position
    )
    rock.cell_data["group"] = np.concatenate([t.element_group[s] for s in shapes])
    return rock


def _open_water(pyvista: Any, rock: Any, water: Reservoir) -> Any:
    """The surface of a reservoir over the model's plan, without the parts in the rock."""
    low, high = np.reshape(rock.bounds, (3, 2)).T
    if water.box is not None:
        low, high = np.maximum(low, water.box.min), np.minimum(high, water.box.max)
    height = _height(water.level)
    if (low >= high).any() or not low[2] <= height <= high[2]:
        return pyvista.PolyData()
    size, middle = high - low, 0.5 * (low + high)
    level = pyvista.Plane(
        center=(middle[0], middle[1], height), direction=(0, 0, 1), i_size=size[0], j_size=size[1],
        i_resolution=TILES, j_resolution=TILES,
    )  # fmt: skip
    inside = rock.find_containing_cell(level.cell_centers().points)
    return level.extract_cells(np.flatnonzero(inside < 0)).extract_surface(algorithm=None)
