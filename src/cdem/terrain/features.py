"""Lines and polygons with their properties: GeoJSON by itself; GeoPackage, Shapefile, KML, DXF by GDAL."""

from __future__ import annotations

import importlib.util
import json
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cdem.case import reader_process
from cdem.case.input_file import is_file, read_text, reading
from cdem.errors import CaseError
from cdem.terrain.heights import extra

GEOJSON = (".geojson", ".json")
BY_GDAL = (".gpkg", ".shp", ".kml", ".kmz", ".fgb", ".dxf")
KINDS = f"{', '.join((GEOJSON[0], *BY_GDAL[:-1]))} or {BY_GDAL[-1]}"
MEND = f"lines and polygons are read from {KINDS}"
WHAT = "terrain file"


@dataclass
class Features:
    """Contents of a file of lines and polygons.

    Attributes:
        items: Geometry as in GeoJSON (``type``, ``coordinates``), and properties, of each feature.
        label: Projection named in the file, for `look_up`, or None.
    """

    items: list[tuple[dict[str, Any], dict[str, Any]]]
    label: str | None


def read_features(
    path: Path, layer: str | None = None, where: dict[str, Any] | None = None
) -> Features:
    """Read the features of a file.

    Args:
        path: ``.geojson``, or a format of GDAL with the extra `terrain`.
        layer: Name of the layer; needed if there are several, except in KML, whose folders are
            layers.
        where: Use only features with these property values.

    Raises:
        CaseError: The file is missing, of another kind, or has no such layer or features.
    """
    kind = path.suffix.lower()
    if kind in GEOJSON:
        with reading(path, CaseError, MEND):
            found = _geojson(path, read_text(path, WHAT))
    elif kind in BY_GDAL:
        if not is_file(path):
            raise CaseError(f"{path}: cannot read the {WHAT}: No such file or directory")
        found = _by_gdal(path, layer)
    else:
        raise CaseError(f"{path}: {MEND}")
    return _chosen(path, found, where) if where else found


def _chosen(path: Path, found: Features, where: dict[str, Any]) -> Features:
    names = sorted({name for _, properties in found.items for name in properties})
    for key in where:
        if key not in names:
            raise CaseError(f"{path}: no feature has a property '{key}'; there are: {names}")
    kept = [
        (geometry, properties)
        for geometry, properties in found.items
        if all(str(properties.get(key)) == str(value) for key, value in where.items())
    ]
    if not kept:
        key = next(iter(where))
        values = sorted({str(properties.get(key)) for _, properties in found.items})[:10]
        raise CaseError(f"{path}: no feature has {where}; of {key} there are: {values}")
    return Features(kept, found.label)


def _geojson(path: Path, text: str) -> Features:
    if text.lstrip().startswith("<"):
        raise CaseError(f"{path}: is XML, not GeoJSON; name a KML file .kml")
    try:
        data = json.loads(text)
    except json.JSONDecodeError as error:
        raise CaseError(f"{path}:{error.lineno}:{error.colno}: not JSON: {error.msg}") from None
    features = data.get("features", [data]) if isinstance(data, dict) else None
    if not isinstance(features, list) or not all(isinstance(f, dict) for f in features):
        raise CaseError(f"{path}: not GeoJSON: no features in it")
    items = []
    for feature in features:
        geometry, properties = feature.get("geometry") or feature, feature.get("properties") or {}
        if not isinstance(geometry, dict) or not isinstance(properties, dict):
            raise CaseError(f"{path}: not GeoJSON: a geometry or its properties are not {{...}}")
        items.append((geometry, properties))
    return Features(items, _geojson_label(data))


def _geojson_label(data: dict[str, Any]) -> str | None:
    """The name in the member `crs` of older files."""
    member = data.get("crs")
    properties = member.get("properties") if isinstance(member, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    return name if isinstance(name, str) else None


def _by_gdal(path: Path, layer: str | None) -> Features:
    for name in ("pyogrio", "shapely"):
        if importlib.util.find_spec(name) is None:
            extra(name)
    with tempfile.TemporaryDirectory(prefix="cdem-read-") as folder:
        asked = {"layer": layer, "folder": folder}
        read = reader_process.read(
            "cdem.terrain.gdal_features", path, MEND, kind=CaseError, asked=asked
        )
    found = json.loads(read["text"].tobytes())
    return Features(
        [(geometry, properties) for geometry, properties in found["items"]], found["label"]
    )
