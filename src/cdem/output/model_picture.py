"""A picture of a model before the run: groups, supports, loads, interfaces, joints, bolts, water."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdem.case.laws import INTERFACE_LAWS
from cdem.model.faces import face_areas
from cdem.model.interfaces import interfaces_of
from cdem.output.model_inside import draw_bolts, draw_water
from cdem.output.model_panel import BACK, DOTS, SIZE, Panel
from cdem.output.render import load_pyvista
from cdem.output.scene import View, add_rock, color, labels, new_plotter, take
from cdem.rows import rows_of

if TYPE_CHECKING:
    from cdem.errors import BodyError
    from cdem.run.state import RunState

MOST_INNER = 5000
"""Above this number, pairs of faces inside one group are only counted: drawn, they would hide the rest."""
INNER_SIZE = 0.6
"""Scale of drawn faces of pairs inside a group, so that gaps remain visible."""
INSIDE = ("#ee6677", "#228833", "#ccbb44", "#aa3377", "#999933", "#44aa99", "#882255", "#ddcc77")
"""Colours of joints and pairs of faces: those of `scene.color` without blue, which is water."""
ARROW = 0.08
"""Length of the arrow of the largest load over the size of the model."""


def draw_model(sim: RunState) -> NDArray[np.uint8]:
    """Two views side by side, shape (height, width, 3).

    The left view has the groups, with dots at fixed or driven nodes and arrows at loaded nodes. The
    right view has the translucent body with joints, other pairs of touching faces by pair of groups,
    bolts and water tables.

    Raises:
        CdemError: pyvista is not installed, or OpenGL is missing.
    """
    pyvista = load_pyvista()
    panels = [Panel(pyvista, sim) for _ in range(2)]
    panels[1].ghost(sim.build.topology)
    _groups(panels[0], sim)
    _held(panels[0], sim)
    _loads(panels[0], sim)
    _interfaces(panels[1], sim)
    draw_bolts(panels[1], sim)
    draw_water(panels[1], sim)
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
    plotter, view = new_plotter(pyvista, SIZE), View.framing(points, BACK, SIZE)
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


def _groups(panel: Panel, sim: RunState) -> None:
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


def _held(panel: Panel, sim: RunState) -> None:
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


def _loads(panel: Panel, sim: RunState) -> None:
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


def _interfaces(panel: Panel, sim: RunState) -> None:
    """Joints as whole translucent planes; other pairs inside a group smaller than they are."""
    t, names = sim.build.topology, sim.build.group_names
    pairs = np.concatenate([t.pair_faces, t.overlap_faces])
    groups = np.sort(t.face_group[pairs].reshape(-1, 2), axis=1)
    laws, table = interfaces_of(sim.case, names)
    kinds = t.face_kind[pairs].reshape(-1, 2)
    joints = np.where(kinds[:, 0] // len(names) == kinds[:, 1] // len(names), kinds[:, 0], 0)
    joints = joints // len(names) - 1
    where = np.column_stack([groups, table[kinds[:, 0], kinds[:, 1]], joints])
    sheets = []
    for number, (a, b, index, joint) in enumerate(np.unique(where, axis=0)):
        fill = INSIDE[number % len(INSIDE)]
        faces = pairs[(where == (a, b, index, joint)).all(axis=1), 0]
        law = laws[index]
        nodes, strengths = t.face_nodes[faces], INTERFACE_LAWS[law.law].summary(law)
        between = f"{names[a]} - {names[b]}"
        if joint >= 0:
            between += f", joint {sim.case.model.joint_surfaces[joint]}"
        if 0 <= joint < len(sim.case.model.joints):
            area = face_areas(t.node_position, nodes).sum()
            size = f"{area:,.0f}" if area >= 100 else f"{area:.3g}"
            label = f"{between}: {size} m2, {strengths}"
            sheets.append((panel.faces(t.node_position, nodes), fill, label))
            continue
        label = f"{between}: {len(faces):,} pair(s), {strengths}"
        if a == b and len(faces) > MOST_INNER:
            panel.legend.append((label + " (not drawn)", "#ffffff"))
            continue
        points = t.node_position[np.where(nodes < 0, nodes[:, :1], nodes)]
        if a == b:
            middle = np.where((nodes >= 0)[..., None], points, np.nan)
            middle = np.nanmean(middle, axis=1, keepdims=True)
            points = middle + INNER_SIZE * (points - middle)
        own = np.where(nodes < 0, -1, np.arange(nodes.size).reshape(nodes.shape))
        panel.add(panel.faces(points.reshape(-1, 3), own), fill, label)
    panel.sheets(sheets)
