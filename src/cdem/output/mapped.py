"""Fit of the area reached by rock to an outline mapped in the field."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import reading
from cdem.case.map_system import look_up
from cdem.errors import CaseError
from cdem.terrain.features import read_features
from cdem.terrain.heights import extra
from cdem.terrain.projection import Projection
from cdem.terrain.rasters import Raster

Floats = NDArray[np.float64]

WHAT = "reading a mapped outline"
ENDS_MEET = 0.05
"""A line is closed if its ends are nearer than this fraction of its length."""


@dataclass
class Fit:
    """Cells reached by the model compared with cells of a mapped outline, by their middles.

    Attributes:
        file: File of the outline.
        hit: Area in both [m2].
        beyond: Area in the model only [m2].
        missed: Area in the outline only [m2].
        front_gap: Distance of the model's front beyond the outline's, along the motion [m].
        rings: The outline [m], each of shape (points, 2).
        notes: How the outline was transformed to the model.
    """

    file: str
    hit: float
    beyond: float
    missed: float
    front_gap: float
    rings: list[Floats]
    notes: list[str]

    @property
    def csi(self) -> float:
        """Critical success index, also called Jaccard's: 1 for equal areas, 0 for separate ones."""
        return self.hit / (self.hit + self.beyond + self.missed)

    @property
    def hit_rate(self) -> float:
        """Fraction of the outline that the model reached."""
        return self.hit / (self.hit + self.missed)

    @property
    def precision(self) -> float:
        """Fraction of the model's area inside the outline."""
        return self.hit / (self.hit + self.beyond)

    @property
    def area_factor(self) -> float:
        """Area of the model over the area of the outline: the factor of conservativeness, FoC."""
        return (self.hit + self.beyond) / (self.hit + self.missed)

    def as_dict(self) -> dict[str, Any]:
        """Ready for JSON."""
        return {
            "file": self.file, "layer": "affected", "csi": self.csi, "hit_rate": self.hit_rate,
            "precision": self.precision, "foc": self.area_factor, "front_gap": self.front_gap,
            "area": {"hit": self.hit, "beyond": self.beyond, "missed": self.missed},
        }  # fmt: skip

    def text(self) -> str:
        """Lines of text for the user."""
        side = "beyond" if self.front_gap >= 0 else "short of"
        return (
            f"  against {self.file}, area met at any time: CSI {self.csi:.3f}, hit rate "
            f"{self.hit_rate:.3f}, precision {self.precision:.3f}, FoC {self.area_factor:.3f}\n"
            f"    {self.hit:.5g} m2 in both, {self.beyond:.5g} m2 of the model alone, "
            f"{self.missed:.5g} m2 missed; front {abs(self.front_gap):.4g} m {side} the outline's"
            + "".join(f"\n    {note}" for note in self.notes)
        )


def compare(affected: Raster, path: Path, crs: str | None, way: Floats, front: float) -> Fit:
    """Compare with the polygons of a file.

    Args:
        affected: Numbers in cells reached by rock, else nan.
        path: GIS file, see `read_features`.
        crs: Projection of the model; None if unknown.
        way: Direction of the motion in plan, a unit vector.
        front: Position of the model's front along it [m].

    Raises:
        CaseError: The file cannot be read, contains no area, or lies elsewhere.
    """
    projection = Projection(None if crs is None else look_up(crs))
    outline = read_outline(path, projection)
    shapely = extra("shapely", WHAT)
    x, y = affected.middles()
    within = shapely.contains_xy(outline, *np.meshgrid(x, y))
    met = np.isfinite(affected.values)
    cell = affected.cell**2
    hit, beyond = float((met & within).sum()) * cell, float((met & ~within).sum()) * cell
    if hit == 0:
        west, south, east, north = outline.bounds
        raise CaseError(
            f"{path}: its outline, x {west:.2f} to {east:.2f}, y {south:.2f} to {north:.2f}, has no "
            f"cell in common with the run-out, x {x[0]:.2f} to {x[-1]:.2f}, y {y[0]:.2f} to "
            f"{y[-1]:.2f}; is it in the coordinates of the case?"
            + "".join(f" ({note})" for note in projection.notes)
        )
    missed = float(_cells_within(outline, affected.cell)) * cell - hit
    farthest = float((shapely.get_coordinates(outline) @ way[:2]).max())
    rings = [
        shapely.get_coordinates(ring)
        for part in shapely.get_parts(outline)
        for ring in shapely.get_parts(shapely.boundary(part))
    ]
    return Fit(str(path), hit, beyond, missed, float(front - farthest), rings, projection.notes)


def _cells_within(outline: Any, cell: float) -> int:
    """Cells whose middles lie in an outline, also beyond the map; lines lie at multiples of a cell."""
    shapely = extra("shapely", WHAT)
    west, south, east, north = np.floor(np.array(outline.bounds) / cell)
    x = cell * (np.arange(west, east + 1) + 0.5)
    return sum(
        int(shapely.contains_xy(outline, x, np.full(len(x), cell * (row + 0.5))).sum())
        for row in np.arange(south, north + 1)
    )


def read_outline(
    path: Path,
    projection: Projection,
    *,
    layer: str | None = None,
    where: dict[str, Any] | None = None,
    told: str | None = None,
) -> Any:
    """The union of the polygons and closed lines of a file, in the coordinates of the model.

    Args:
        path: GIS file, see `read_features`.
        projection: Projection of the model.
        layer: Name of the layer; needed if there are several.
        where: Use only features with these properties.
        told: Projection of the file; overrides its own.

    Raises:
        CaseError: The file cannot be read, or contains no area.
    """
    shapely = extra("shapely", WHAT)
    found = read_features(path, layer, where)
    with reading(path, CaseError, "an outline is a polygon or a closed line"):
        shapes = [shapely.geometry.shape(geometry) for geometry, _ in found.items]
        areas = [area for shape in shapes for area in _areas(shapely.force_2d(shape))]
    if not areas:
        raise CaseError(f"{path}: contains no polygon or closed line; an outline is one of them")
    outline = shapely.union_all(shapely.make_valid(np.array(areas)))
    return shapely.transform(
        outline, lambda points: projection.bring(path, found.label, told, points)
    )


def _areas(shape: Any) -> list[Any]:
    """Polygons of a geometry, including closed lines."""
    shapely = extra("shapely", WHAT)
    areas = []
    for part in shapely.get_parts(shape):
        if part.geom_type == "Polygon" and not part.is_empty:
            areas.append(part)
        elif part.geom_type == "LineString" and len(part.coords) > 2:
            first, last = np.array(part.coords[0]), np.array(part.coords[-1])
            if np.linalg.norm(last - first) <= ENDS_MEET * part.length:
                areas.append(shapely.Polygon(part.coords))
    return areas
