"""One view of the picture of a model: its plotter, its legend, and ways to draw."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem.output.render import snapshot
from cdem.output.scene import MATTE, SHARP, View, new_plotter, take

if TYPE_CHECKING:
    from cdem.mesh.topology import Topology
    from cdem.run.state import RunState

SIZE = (1000, 850)
BACK = np.array([0.6, -0.8, 0.75])
"""Direction of view."""
DOTS = ("black", "#d62728", "#9467bd", "#17becf", "#8c564b", "#7f7f7f", "#2ca02c")
"""Colours of dots and lines, one for each kind."""
SHEET = 0.4
"""Opacity of sheets: joints and water tables."""
MANY, LEAST = 12, 0.08
"""Sheets of more planes than this are fainter, down to this opacity."""
NEAR = 1e-6
"""Corners of sheets closer than this are one, over the size of the model."""


class Panel:
    """One view of the model, and the entries of its legend."""

    def __init__(self, pyvista: Any, sim: RunState) -> None:
        self.pyvista = pyvista
        self.plotter = new_plotter(pyvista, SIZE)
        self.legend: list[tuple[str, str]] = []
        self.position = sim.build.start_position
        self.size = float(np.linalg.norm(np.ptp(self.position, axis=0)))
        self.view = View.framing(self.position, BACK, SIZE)
        self.surface = snapshot(sim)

    def show(self, points: NDArray) -> None:
        """Widen the view to points outside the model, shape (points, 3) [m]."""
        self.view = View.framing(np.vstack([self.position, points]), BACK, SIZE)

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

    def sheets(self, meshes: Sequence[tuple[Any, str, str]]) -> None:
        """Draw translucent faces with their rims: each a mesh, its colour, and its label."""
        joined = [mesh.clean(tolerance=NEAR * self.size, absolute=True) for mesh, _, _ in meshes]
        planes = sum(mesh.connectivity()["RegionId"].max() + 1 for mesh in joined)
        opacity = float(np.clip(SHEET * MANY / max(planes, 1), LEAST, SHEET))
        for mesh, (_, color, label) in zip(joined, meshes, strict=True):
            self._sheet(mesh, color, label, opacity)

    def _sheet(self, whole: Any, color: str, label: str, opacity: float) -> None:
        self.add(whole, color, label, opacity=opacity)
        rim = whole.extract_feature_edges(
            boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
        )
        if rim.n_cells:
            self.add(rim, color, line_width=2, lighting=False)

    def ghost(self, t: Topology) -> None:
        """Draw the outside of the body, faint, with its sharp edges."""
        outer = np.ones(len(t.face_nodes), bool)
        outer[t.pair_faces.ravel()] = False
        skin = self.faces(t.node_position, t.face_nodes[outer])
        self.add(skin, "#bbbbbb", opacity=0.15)
        whole = skin.clean(tolerance=NEAR * self.size, absolute=True)
        edges = whole.extract_feature_edges(
            feature_angle=SHARP,
            boundary_edges=False,
            manifold_edges=False,
            non_manifold_edges=False,
        )
        if edges.n_cells:
            self.add(edges, "#777777", line_width=1, lighting=False)

    def image(self) -> NDArray[np.uint8]:
        self.plotter.add_axes(color="black")
        return take(self.plotter, self.view)
