"""The process that reads lines and polygons by GDAL, see `cdem.case.reader_process` and `cdem.terrain.gdal`."""

from __future__ import annotations

import json
import shutil
import zipfile
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import quote

import numpy as np

from cdem.case import reader_process
from cdem.errors import CaseError
from cdem.terrain.features import MEND

DRIVERS = {
    ".gpkg": ("GPKG",),
    ".shp": ("ESRI Shapefile",),
    ".kml": ("LIBKML", "KML"),
    ".kmz": ("LIBKML", "KML"),
    ".fgb": ("FlatGeobuf",),
    ".dxf": ("DXF",),
}
"""Drivers for each file ending; all others are removed."""
BEGINS = {
    ".gpkg": b"SQLite format 3\0",
    ".shp": b"\0\0\x27\x0a",
    ".kmz": b"PK\x03\x04",
    ".fgb": b"fgb\x03fgb",
}
"""First bytes of files, by ending."""
HEAD, WAL = 4096, 2
UNPACKED = 100
"""Largest ratio of unpacked to packed size of a KMZ, beyond the first million bytes."""


def read(path: Path, asked: dict[str, Any]) -> reader_process.Arrays:
    """Read all features of a file, or of the layer that ``asked["layer"]`` names.

    Returns:
        ``text``: JSON with ``label`` and ``items``, each a geometry as in GeoJSON and properties.

    Raises:
        CaseError: It does not match its ending, leads to other files, or has no such layer.
    """
    import pyogrio
    import pyogrio._ogr
    import shapely

    from cdem.terrain.gdal import keep_drivers

    kind = path.suffix.lower()
    plain = _checked(path, kind, Path(asked["folder"]))
    keep_drivers(pyogrio._ogr, {d for d in DRIVERS[kind] if d in pyogrio.list_drivers()})
    items, label = [], None
    for name in _layers(path, plain, kind, asked["layer"]):
        meta, _, shapes, columns = pyogrio.raw.read(plain, layer=name)
        label = meta["crs"] or label
        fields = [str(field) for field in meta["fields"]]
        values = [column.tolist() for column in columns]
        for row, shape in enumerate(shapely.from_wkb(shapes)):
            if shape is not None:
                properties = {f: v[row] for f, v in zip(fields, values, strict=True)}
                items += [(part, properties) for part in _parts(shapely.geometry.mapping(shape))]
    text = json.dumps({"label": label, "items": items}, default=str)
    return {"text": np.frombuffer(text.encode(), np.uint8)}


def _layers(path: Path, plain: Path, kind: str, layer: str | None) -> list[str]:
    """Names of the layers to read."""
    import pyogrio

    layers = [str(name) for name in pyogrio.list_layers(plain)[:, 0]]
    if layer is not None and layer not in layers:
        raise CaseError(f"{path}: has no layer '{layer}'; there are: {', '.join(layers)}")
    if layer is None and len(layers) > 1 and kind not in (".kml", ".kmz"):
        raise CaseError(f"{path}: has several layers; choose with 'layer': {', '.join(layers)}")
    return layers if layer is None else [layer]


def _parts(geometry: dict[str, Any]) -> list[dict[str, Any]]:
    """The geometries of a collection; KML combines lines and points in one."""
    if geometry["type"] != "GeometryCollection":
        return [geometry]
    return [part for inner in geometry["geometries"] for part in _parts(inner)]


# ------------------------------------------------------------------ checks of a file


def _checked(path: Path, kind: str, folder: Path) -> Path:
    """The file for GDAL: the file itself, or a copy unpacked to a folder."""
    with path.open("rb") as file:
        head = file.read(HEAD)
    begins = head.startswith(BEGINS.get(kind, b""))
    if kind == ".dxf":
        begins = head.removeprefix(b"\xef\xbb\xbf").split()[:1] in ([b"0"], [b"999"])
    if not begins:
        raise CaseError(f"{path}: its first bytes do not match its ending {kind}; {MEND}")
    if kind in (".kml", ".kmz"):
        plain = path if kind == ".kml" else _unpacked(path, folder)
        with plain.open("rb") as file:
            _refuse_links(path, file)
        return plain
    if kind == ".gpkg":
        return _plain_database(path, head, folder)
    return path


def _unpacked(path: Path, folder: Path) -> Path:
    """The one KML file of a KMZ."""
    with zipfile.ZipFile(path) as packed:
        names = [one for one in packed.infolist() if one.filename.lower().endswith(".kml")]
        if len(names) != 1:
            raise CaseError(
                f"{path}: contains {len(names)} KML files instead of one; save each on its own"
            )
        most = 1_000_000 + UNPACKED * path.stat().st_size
        plain = folder / "doc.kml"
        with packed.open(names[0]) as file:
            content = file.read(most + 1)
        if len(content) > most:
            raise CaseError(
                f"{path}: unpacks to more than {UNPACKED} times its size, more than any map"
            )
        plain.write_bytes(content)
    return plain


def _refuse_links(path: Path, file: BinaryIO) -> None:
    """Refuse a KML file that declares entities, is not KML, or leads to other files."""
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import iterparse

    root = None
    try:
        for event, element in iterparse(file, events=("start", "end"), forbid_dtd=True):
            name = element.tag.rpartition("}")[2]
            if root is None and name.lower() != "kml":
                raise CaseError(f"{path}: is XML, but not KML: it begins with <{name[:40]}>")
            root = element if root is None else root
            if name == "NetworkLink":
                raise CaseError(
                    f"{path}: leads to another file (NetworkLink), which is not followed; save the "
                    f"folder "
                    "with the features themselves"
                )
            if event == "end" and name == "Placemark":
                element.clear()
    except DefusedXmlException:
        raise CaseError(
            f"{path}: declares entities (DOCTYPE), which are not allowed; remove them"
        ) from None


def _plain_database(path: Path, head: bytes, folder: Path) -> Path:
    """Check for a GeoPackage of plain tables: nothing in it computes, or reads another file, when read."""
    import sqlite3

    waiting = path.with_name(path.name + "-wal")
    if waiting.is_file() and waiting.stat().st_size:
        raise CaseError(f"{path}: is open in another program with unsaved changes; close it there")
    with sqlite3.connect(f"file:{quote(str(path))}?mode=ro&immutable=1", uri=True) as base:
        base.execute("PRAGMA trusted_schema = OFF")
        rows = base.execute("SELECT type, name, sql FROM sqlite_master").fetchall()
        for kind, name, sql in rows:
            words = " ".join(str(sql).upper().split())
            if kind == "view" or (
                words.startswith("CREATE VIRTUAL") and " USING RTREE" not in words
            ):
                raise CaseError(
                    f"{path}: has a view or virtual table '{name}', which would compute when read; "
                    "save the layer as a plain table"
                )
        for name in [name for kind, name, _ in rows if kind == "table"]:
            quoted = str(name).replace('"', '""')
            if any(c[6] in (2, 3) for c in base.execute(f'PRAGMA table_xinfo("{quoted}")')):
                raise CaseError(
                    f"{path}: table '{name}' has computed columns; save it as a plain table"
                )
    if head[18:20] == bytes([WAL, WAL]):  # SQLite would write files beside it
        return Path(shutil.copy(path, folder / "copy.gpkg"))
    return path


if __name__ == "__main__":
    import defusedxml.ElementTree  # noqa: F401  # loading takes longer than reading is allowed
    import pyogrio  # noqa: F401
    import shapely  # noqa: F401

    reader_process.answer(read, MEND)
