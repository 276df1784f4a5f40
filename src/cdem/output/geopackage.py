"""Points, lines and areas as a GeoPackage with styles."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.terrain.heights import extra
from cdem.terrain.rasters import Raster

WHAT = "a GeoPackage"
STYLES = "layer_styles"
"""The table of styles for QGIS."""


@dataclass
class Features:
    """One layer.

    Attributes:
        name: Name of the layer.
        kind: Kind of its geometries: "Point Z", "LineString", "LineString Z" or "MultiPolygon".
        geometries: Geometries of shapely.
        columns: Columns by name with unit; one value per geometry.
        color: Colour of its style.
    """

    name: str
    kind: str
    geometries: Sequence[Any]
    columns: Mapping[str, NDArray]
    color: str


def areas(name: str, raster: Raster, color: str) -> Features:
    """The cells of a raster that have a value, as one area."""
    shapely = extra("shapely", WHAT)
    has = np.pad(np.isfinite(raster.values), ((0, 0), (1, 1))).astype(int)
    row, first = np.nonzero(np.diff(has, axis=1) == 1)  # runs of cells, row by row
    last = np.nonzero(np.diff(has, axis=1) == -1)[1]
    x, y = raster.x + raster.cell * np.array([first, last]), raster.y + raster.cell * row
    runs = shapely.box(x[0], y, x[1], y + raster.cell) if len(row) else []
    area = shapely.MultiPolygon(
        [part for part in shapely.get_parts(shapely.union_all(runs)) if part.geom_type == "Polygon"]
    )
    return Features(name, "MultiPolygon", [area], {"area_m2": np.array([area.area])}, color)


def lines(
    name: str, places: Sequence[NDArray], columns: Mapping[str, NDArray], color: str
) -> Features:
    """Lines through places [m], each of shape (points, 2 or 3)."""
    shapely = extra("shapely", WHAT)
    kind = "LineString Z" if len(places) and places[0].shape[1] == 3 else "LineString"
    return Features(name, kind, [shapely.linestrings(p) for p in places], columns, color)


def points(name: str, places: NDArray, columns: Mapping[str, NDArray], color: str) -> Features:
    """Points at places [m], shape (points, 3)."""
    return Features(name, "Point Z", extra("shapely", WHAT).points(places), columns, color)


def write_geopackage(path: Path, layers: Sequence[Features], crs: str | None) -> None:
    """Write layers into a new file, with their styles.

    Args:
        path: The file; an older one is replaced.
        layers: At least one.
        crs: Projection of all places, or None.

    Raises:
        BackendError: The extra `terrain` is not installed.
    """
    pyogrio, shapely = extra("pyogrio", WHAT), extra("shapely", WHAT)
    path.unlink(missing_ok=True)

    def write(name: str, kind: str | None, geometry: Any, columns: Mapping[str, NDArray]) -> None:
        pyogrio.raw.write(
            path, geometry, list(columns.values()), list(columns), layer=name,
            geometry_type=kind, crs=crs if kind else None, driver="GPKG", append=path.exists(),
        )  # fmt: skip

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "'crs' was not provided")  # reported elsewhere
        for layer in layers:
            shapes = np.asarray(layer.geometries, dtype=object)
            write(layer.name, layer.kind, shapely.to_wkb(shapes), layer.columns)
        write(STYLES, None, None, _styles(layers))


def _styles(layers: Sequence[Features]) -> dict[str, NDArray]:
    count = len(layers)

    def all_are(text: str) -> NDArray:
        return np.array([text] * count, dtype=object)

    return {
        "f_table_catalog": all_are(""),
        "f_table_schema": all_are(""),
        "f_table_name": np.array([layer.name for layer in layers], dtype=object),
        "f_geometry_column": all_are("geom"),
        "styleName": all_are("cdem"),
        "styleQML": np.array([vector_style(layer) for layer in layers], dtype=object),
        "styleSLD": all_are(""),
        "useAsDefault": np.ones(count, bool),
        "description": all_are("written by cdem"),
        "owner": all_are(""),
    }


def vector_style(layer: Features) -> str:
    """The style of a layer for QGIS (QML): one symbol."""
    red, green, blue = (int(layer.color[k : k + 2], 16) for k in (1, 3, 5))
    solid = f"{red},{green},{blue},255"
    if layer.kind.startswith("Point"):
        symbol, kind = "marker", "SimpleMarker"
        values = {"name": "circle", "color": solid, "size": "1.6", "outline_color": "0,0,0,255"}
    elif layer.kind.startswith("Line"):
        symbol, kind = "line", "SimpleLine"
        values = {"line_color": solid, "line_width": "0.5"}
    else:
        symbol, kind = "fill", "SimpleFill"
        values = {"color": f"{red},{green},{blue},60", "outline_color": solid, "style": "solid"}
        values |= {"outline_width": "0.5"}
    items = "".join(f'<prop k="{key}" v="{value}"/>' for key, value in values.items())
    return (
        "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
        '<qgis version="3.22.0" styleCategories="Symbology"><renderer-v2 type="singleSymbol">'
        f'<symbols><symbol type="{symbol}" name="0" alpha="1"><layer class="{kind}" enabled="1">'
        f"{items}</layer></symbol></symbols></renderer-v2></qgis>\n"
    )
