"""A picture of a model before the run: groups, supports, loads, interfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.laws import INTERFACE_LAWS
from cdem.model.interfaces import interfaces_of
from cdem.output.render import load_pyvista, snapshot
from cdem.output.scene import MATTE, View, add_rock, color, labels, new_plotter, take
from cdem.rows import rows_of

if TYPE_CHECKING:
    from cdem.errors import BodyError
    from cdem.run.state import RunState

SIZE = (1000, 850)
MOST_INNER = 5000
"""Above this number, pairs of faces inside one group are only counted: drawn, they would hide the rest."""
INNER_SIZE = 0.6
"""Scale of drawn faces of pairs inside a group, so that gaps remain visible."""
ARROW = 0.08
"""Length of the arrow of the largest load over the size of the model."""
_BACK = np.array([0.6, -0.8, 0.75])
"""Direction of view."""
DOTS = ("black", "#d62728", "#9467bd", "#17becf", "#8c564b", "#7f7f7f", "#2ca02c")
"""Colours of the dots, one for each kind of support."""


def draw_model(sim: RunState) -> NDArray[np.uint8]:
    """Two views side by side, shape (height, width, 3).

    The left view has the groups, with dots at fixed or driven nodes and arrows at loaded nodes. The
    right view has the pairs of touching faces, by pair of groups, in the translucent body.

    Raises:
        CdemError: pyvista is not installed, or OpenGL is missing.
    """
    pyvista = load_pyvista()
    panels = [_Panel(pyvista, sim) for _ in range(2)]
    _groups(panels[0], sim)
    _held(panels[0], sim)
    _loads(panels[0], sim)
    _interfaces(panels[1], sim)
    rows = max(len(panel.legend) for panel in panels)
    return np.concatenate(
        [np.concatenate([labels(panel.legend, rows, SIZE[0]), panel.image()]) for panel in panels],
        axis=1,
    )


def draw_refused(refused: BodyError) -> NDArray[np.uint8]:
    """The refused body, with its faults in red, shape (height, width, 3).

    Raises:
        CdemError: pyvista is not installed, or OpenGL is missing.
    """
    pyvista = load_pyvista()
    points = np.asarray(refused.points, float)
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    plotter, view = new_plotter(pyvista, SIZE), View.framing(points, _BACK, SIZE)
    flat = np.concatenate([[len(face), *face] for face in refused.faces])
    body = pyvista.PolyData(points, faces=flat)
    add_rock(plotter, body, view, color="#bab0ac", opacity=0.6)
    for mark in refused.marks:
        if len(mark) == 1:
            shape = pyvista.Sphere(radius=0.015 * size, center=points[mark[0]])
        else:
            shape = pyvista.Tube(
                pointa=points[mark[0]], pointb=points[mark[1]], radius=0.006 * size
            )
        plotter.add_mesh(shape, color="#d62728")
    plotter.add_axes(color="black")
    return take(plotter, view)


class _Panel:
    """One view of the model, and the entries of its legend."""

    def __init__(self, pyvista: Any, sim: RunState) -> None:
        self.pyvista = pyvista
        self.plotter = new_plotter(pyvista, SIZE)
        self.legend: list[tuple[str, str]] = []
        position = sim.build.start_position
        self.size = float(np.linalg.norm(np.ptp(position, axis=0)))
        self.view = View.framing(position, _BACK, SIZE)
        self.surface = snapshot(sim)

    def add(self, mesh: Any, color: str, label: str | None = None, **how: Any) -> None:
        """Draw a mesh in one colour; a label adds it to the legend."""
        self.plotter.add_mesh(mesh, color=color, **MATTE, **how)
        if label is not None:
            self.legend.append((label, color))

    def faces(self, points: NDArray, nodes: NDArray) -> Any:
        """A mesh of faces, whose fourth node is -1 for a triangle."""
        counts = (nodes >= 0).sum(axis=1)
        flat = np.column_stack([counts, nodes])
        return self.pyvista.PolyData(points, faces=flat[flat >= 0])

    def image(self) -> NDArray[np.uint8]:
        self.plotter.add_axes(color="black")
        return take(self.plotter, self.view)


def _groups(panel: _Panel, sim: RunState) -> None:
    surface = panel.surface
    mesh = panel.pyvista.PolyData(surface.points, faces=surface.faces)
    for index, name in enumerate(sim.build.group_names):
        some = np.flatnonzero(surface.cell_data["group"] == index)
        if len(some):
            part = mesh.extract_cells(some)
            add_rock(
                panel.plotter, part.extract_surface(algorithm=None), panel.view, color=color(index)
            )
            panel.legend.append((name, color(index)))


def _held(panel: _Panel, sim: RunState) -> None:
    """Dots at fixed or driven nodes of outer faces, one colour for each kind."""
    row = sim.build.arrays["support.row"]
    component = rows_of(sim.core, "support.component").numbers
    driven = (rows_of(sim.core, "support.velocity").numbers != 0).any(axis=1)
    outer = np.unique(sim.build.topology.face_nodes)
    nodes = outer[(outer >= 0) & (row[outer] >= 0)]
    ways = np.column_stack([component[row[nodes]], driven[row[nodes]]])
    for number, way in enumerate(np.unique(ways, axis=0)):
        some = nodes[(ways == way).all(axis=1)]
        axes = ", ".join(a for a, held in zip("xyz", way[:3], strict=True) if held)
        what = "driven" if way[3] else "held"
        panel.add(
            panel.pyvista.PolyData(sim.build.start_position[some]), DOTS[number % len(DOTS)],
            f"{what} in {axes}: {len(some):,} nodes", point_size=7, render_points_as_spheres=True,
        )  # fmt: skip


def _loads(panel: _Panel, sim: RunState) -> None:
    """Arrows of the nodal forces of tractions, the largest at full length."""
    first = sim.build.arrays["load.first"]
    nodes = np.repeat(np.arange(len(first) - 1), np.diff(first))
    if len(nodes) == 0:
        return
    force = rows_of(sim.core, "load.force").force
    arrows = force / np.linalg.norm(force, axis=1).max() * ARROW * panel.size
    tips = sim.build.start_position[nodes]
    cloud = panel.pyvista.PolyData(tips - arrows)
    cloud["load"] = arrows
    glyphs = cloud.glyph(orient="load", scale="load", factor=1.0)
    panel.add(glyphs, "#c00000", f"traction: {len(np.unique(nodes)):,} nodes")


def _interfaces(panel: _Panel, sim: RunState) -> None:
    surface = panel.surface
    skin = panel.pyvista.PolyData(surface.points, faces=surface.faces)
    panel.add(skin, "#bbbbbb", opacity=0.15)
    t, names = sim.build.topology, sim.build.group_names
    pairs = np.concatenate([t.pair_faces, t.overlap_faces])
    groups = np.sort(t.face_group[pairs].reshape(-1, 2), axis=1)
    laws, table = interfaces_of(sim.case, names)
    kinds = t.face_kind[pairs].reshape(-1, 2)
    where = np.column_stack([groups, table[kinds[:, 0], kinds[:, 1]]])
    for number, (a, b, index) in enumerate(np.unique(where, axis=0)):
        faces = pairs[(where == (a, b, index)).all(axis=1), 0]
        law = laws[index]
        joint = f", joint {law.joint}" if getattr(law, "joint", None) else ""
        label = f"{names[a]} - {names[b]}{joint}: {len(faces):,} pair(s), "
        label += INTERFACE_LAWS[law.law].summary(law)
        if a == b and len(faces) > MOST_INNER:
            panel.legend.append((label + " (not drawn)", "#ffffff"))
            continue
        nodes = t.face_nodes[faces]
        points = t.node_position[np.where(nodes < 0, nodes[:, :1], nodes)]
        if a == b:
            middle = np.where((nodes >= 0)[..., None], points, np.nan)
            middle = np.nanmean(middle, axis=1, keepdims=True)
            points = middle + INNER_SIZE * (points - middle)
        own = np.where(nodes < 0, -1, np.arange(nodes.size).reshape(nodes.shape))
        panel.add(panel.faces(points.reshape(-1, 3), own), color(number), label)
