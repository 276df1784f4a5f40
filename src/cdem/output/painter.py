"""Draws frames of one run with one view and one range of colours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from cdem.case.shown_fields import AXIAL_FORCE, SHOWN, Shown, size_of
from cdem.errors import CdemError
from cdem.output.cuts import Cuts, outlines
from cdem.output.reader import Surface
from cdem.output.scene import (
    LIFT,
    MATTE,
    NEUTRAL,
    PALE,
    SIZE,
    View,
    add_ground,
    add_rock,
    bar,
    color,
    color_map,
    foot,
    labels,
    new_plotter,
    take,
    with_title,
)

AMOUNTS, DIVERGING = "viridis", "RdBu_r"
"""Colour maps that also work without red or green: for amounts, and for signed values."""
GOLDEN = 0.6180339887
"""Multiples of it, modulo 1, lie far from one another."""
AROUND = 0.6
"""Rock beyond this distance, in sizes of the model, does not affect the view."""
THROUGH = 0.6
"""Opacity of rock with bolts, which show through it."""
FAINT = 0.1
"""Opacity of rock around bolts with coloured forces."""
BOLT = 0.004
"""Radius of a bolt with coloured force, in heights of the picture."""
STILL = 1e-3
"""Groups with smaller displacements, in sizes of the model, count as unmoved."""
NEAR_NOTHING = 0.05
"""One end of a signed range is neglected below this fraction of the other."""
SAMPLE = 9
"""Number of frames, evenly spread, that determine the view and the range of colours."""


class Frames(Protocol):
    """Frames by number, each read on demand."""

    def __len__(self) -> int: ...

    def __getitem__(self, frame: int) -> Surface: ...


def signed_span(low: float, high: float) -> tuple[float, float]:
    """Ends of the colours for these values: symmetric about zero, from zero, or unchanged."""
    most = max(abs(low), abs(high), 1e-12)
    if min(-low, high) > NEAR_NOTHING * most:
        return -most, most
    if min(abs(low), abs(high)) <= NEAR_NOTHING * most:
        return (low, 0.0) if -low > high else (0.0, max(high, most))
    return (low, high) if high - low > 1e-6 * most else (low - most, high + most)


class Painter:
    """One view and one range of colours for all frames of a run.

    Attributes:
        occlusion: Whether corners and gaps are darkened.
    """

    def __init__(
        self,
        pyvista: Any,
        frames: Frames,
        field: str,
        *,
        north: bool = False,
        occlusion: bool = False,
    ) -> None:
        self.pyvista, self.north, self.occlusion = pyvista, north, occlusion
        # a field of a study may be arbitrary, with its own unit
        self.shown = SHOWN.get(field) or Shown(field, field, "", "amount", field, np.asarray)
        self.plane = frames.plane if isinstance(frames, Cuts) else None
        last = len(frames) - 1
        sample = [frames[k] for k in sorted({round(k) for k in np.linspace(0, last, SAMPLE)})]
        self.names = self._names(sample)
        self.span = self._span(sample)
        self.map = self._map()
        self.size = float(np.linalg.norm(np.ptp(sample[0].points, axis=0)))
        self.ground = self._ground(sample)
        self.view = self._view(sample)

    def _values(self, surface: Surface) -> NDArray:
        if self.shown is AXIAL_FORCE:
            return surface.bolt_forces
        for data in (surface.point_data, surface.cell_data):
            if self.shown.of in data:
                values = np.asarray(self.shown.values(data[self.shown.of]), float)
                # neighbours in space have similar numbers: spread them over the palette
                return values * GOLDEN % 1 if self.shown.looks == "scattered label" else values
        raise CdemError(f"the run did not record {self.shown.of!r}; add it to output.fields")

    def _names(self, sample: Sequence[Surface]) -> list[str]:
        """Names of the values of a label; empty for other fields."""
        if self.shown.looks != "label":
            return []
        if self.shown.name == "group" and sample[-1].group_names:
            return sample[-1].group_names
        if self.shown.labels:
            return list(self.shown.labels)
        most = max(int(self._values(surface).max(initial=0)) for surface in sample)
        return ["none", *(f"{self.shown.name} {k}" for k in range(1, most + 1))]

    def _span(self, sample: Sequence[Surface]) -> tuple[float, float]:
        """The values at the ends of the colours."""
        if self.shown.looks == "label":
            return -0.5, len(self.names) - 0.5
        if self.shown.looks == "scattered label":
            return 0.0, 1.0
        values = [v[np.isfinite(v)] for v in map(self._values, sample)]
        values = [v for v in values if len(v)] or [np.zeros(1)]
        if self.shown.looks == "whole range":
            return 0.0, max(1.0, *(float(v.max()) for v in values))
        high = max(float(np.percentile(v, 99.5)) for v in values)
        if self.shown.looks == "amount":
            return 0.0, max(high, 1e-12)
        return signed_span(min(float(np.percentile(v, 0.5)) for v in values), high)

    def _map(self) -> Any:
        """Colour map of the values between the two ends."""
        import matplotlib
        from matplotlib.colors import ListedColormap

        looks = self.shown.looks
        if looks == "label":
            return ListedColormap([fill for _, fill in self._entries()])
        if looks == "amount":
            return color_map(AMOUNTS)
        low, high = self.span
        if looks == "signed" and low == -high:
            return matplotlib.colormaps[DIVERGING]
        if looks == "signed" and 0.0 in (low, high) and self.shown is not AXIAL_FORCE:
            return color_map(AMOUNTS) if low == 0 else color_map(AMOUNTS).reversed()
        return matplotlib.colormaps["tab20" if looks == "scattered label" else AMOUNTS]

    def _entries(self) -> list[tuple[str, str]]:
        """Names and colours of a label; "none" has the colour of rock."""
        if self.shown.name == "group":
            return [(name, color(k)) for k, name in enumerate(self.names)]
        rest = [(name, color(k)) for k, name in enumerate(self.names[1:])]
        return [(self.names[0], NEUTRAL), *rest]

    def _ground(self, sample: Sequence[Surface]) -> list[int]:
        """Groups that do not move."""
        moved: dict[int, float] = {}
        for surface in sample:
            if self.plane or "displacement" not in surface.point_data:
                return []
            at = np.where(surface.polygons < 0, surface.polygons[:, :1], surface.polygons)
            length = size_of(surface.point_data["displacement"])[at].max(axis=1)
            for group in np.unique(surface.cell_data["group"]):
                most = float(length[surface.cell_data["group"] == group].max())
                moved[int(group)] = max(moved.get(int(group), 0.0), most)
        return [group for group, most in moved.items() if most < STILL * self.size]

    def _view(self, sample: Sequence[Surface]) -> View:
        """The whole model, seen across the main motion and from above; along -y without motion
        in plan. A cut is seen from its front."""
        if self.plane:
            return View.fitting(np.vstack([s.points for s in sample]), self.plane.back)
        first, last = sample[0], sample[-1]
        low, high = first.points.min(axis=0), first.points.max(axis=0)
        moved = last.point_data.get("displacement", np.zeros((1, 3)))
        way = moved.mean(axis=0)[:2]
        moves = np.linalg.norm(way) > STILL * self.size
        way = way / np.linalg.norm(way) if moves else np.array([1.0, 0])
        side = np.array([way[1], -way[0]])
        # from the side, a little from the front of the motion, and from above
        back = np.array([*(0.8 * side + 0.6 * way), 0.75])
        away = AROUND * self.size
        points = np.vstack([surface.points for surface in sample])
        return View.fitting(np.clip(points, low - away, high + away), back)

    def draw(self, surface: Surface, title: str = "") -> NDArray:
        """One frame, titled by its time unless it has a title, shape (height, width, 3)."""
        plotter = new_plotter(self.pyvista, self.view.size)
        mesh = self.pyvista.PolyData(surface.points, faces=surface.faces)
        bolts = len(surface.bolts) > 0
        look: dict[str, Any] = {"color": PALE}
        if self.shown is not AXIAL_FORCE:
            values = self._values(surface)
            on_points = self.shown.of in surface.point_data
            (mesh.point_data if on_points else mesh.cell_data)["shown"] = values
            look = {"scalars": "shown", **self._colors()}
        if self.plane:
            self._draw_cut(plotter, mesh, surface, look)
        else:
            look["opacity"] = (FAINT if self.shown is AXIAL_FORCE else THROUGH) if bolts else 1.0
            self._draw_rock(plotter, mesh, surface, look)
        if bolts:
            self._draw_bolts(plotter, surface)
        dark = self.occlusion and not bolts and not self.plane
        image = take(plotter, self.view, occlusion=dark)
        return with_title(image, title or f"t = {surface.time:.4g} s")

    def _colors(self) -> dict[str, Any]:
        return {"cmap": self.map, "clim": self.span, "nan_color": NEUTRAL}

    def _draw_rock(self, plotter: Any, mesh: Any, surface: Surface, look: dict[str, Any]) -> None:
        stays = np.zeros(mesh.n_cells, bool)
        if self.ground:
            stays = np.isin(surface.cell_data["group"], self.ground)
        for add, some in ((add_ground, stays), (add_rock, ~stays)):
            if some.any():
                part = mesh if some.all() else mesh.extract_cells(np.flatnonzero(some))
                add(plotter, part.extract_surface(algorithm=None), self.view, **look)

    def _draw_cut(self, plotter: Any, mesh: Any, surface: Surface, look: dict[str, Any]) -> None:
        plotter.add_mesh(mesh, show_scalar_bar=False, lighting=False, **look)
        points = surface.points + LIFT * self.view.height * self.view.back
        lines = points[outlines(surface)].reshape(-1, 3)
        plotter.add_lines(lines, color="#222222", width=1.5)

    def _draw_bolts(self, plotter: Any, surface: Surface) -> None:
        if self.shown is not AXIAL_FORCE:
            plotter.add_lines(surface.bolts.reshape(-1, 3), color="#202020", width=4)
            return
        bars = self.pyvista.line_segments_from_points(surface.bolts.reshape(-1, 3))
        bars.cell_data["shown"] = surface.bolt_forces
        tubes = bars.tube(radius=BOLT * self.view.height)
        plotter.add_mesh(tubes, scalars="shown", show_scalar_bar=False, **MATTE, **self._colors())

    def with_foot(self, images: Sequence[NDArray]) -> NDArray:
        """Pictures side by side, above a legend, a scale and directions."""
        image = np.concatenate(images, axis=1)
        width = image.shape[1]
        if self.shown.looks == "label":
            entries = self._entries()
            legend = labels(entries, len(entries), SIZE[0] // 2)
        elif self.shown.looks == "scattered label":  # its numbers only tell things apart
            legend = np.full((1, 1, 3), 255, np.uint8)
        else:
            name = self.shown.name
            tension = self.shown.of.endswith("stress") and self.shown.looks == "signed"
            said = name + (", tension positive" if tension or name == AXIAL_FORCE.name else "")
            legend = bar(said, self.shown.unit, self.map, self.span, SIZE[0] // 2)
        strip = foot(legend, self.view, width, north=self.north)
        return np.concatenate([image, strip])
