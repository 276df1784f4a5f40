"""Rasters as GeoTIFF, written without a library: TIFF 6.0, OGC GeoTIFF 1.1, and GDAL's metadata."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from numpy.typing import NDArray

from cdem._version import __version__
from cdem.case.map_system import look_up
from cdem.errors import BackendError
from cdem.terrain.projection import horizontal
from cdem.terrain.rasters import NOTHING, Raster

Floats = NDArray[np.float64]

SHORT, LONG, DOUBLE, ASCII = "H", "I", "d", "s"
KINDS = {ASCII: 2, SHORT: 3, LONG: 4, DOUBLE: 12}
PIXEL_IS_AREA = (1025, 0, 1, 1)
PROJECTED = (1024, 0, 1, 1)
METRE = (3076, 0, 1, 9001)


def write_geotiff(
    path: Path,
    raster: Raster,
    *,
    epsg: int | None = None,
    name: str = "",
    unit: str = "",
    tags: Mapping[str, str] | None = None,
) -> None:
    """Write a GeoTIFF of 32-bit numbers, compressed.

    Args:
        path: The file.
        raster: The raster to write.
        epsg: Code of the projection of x and y, which are metres; None names none.
        name: Description of the band.
        unit: Unit of the band.
        tags: Metadata of the file, as GDAL shows them.
    """
    rows, columns = raster.values.shape
    pixels = zlib.compress(raster.rows.astype("<f4").tobytes())
    entries: list[tuple[int, str, tuple]] = [
        (256, LONG, (columns,)), (257, LONG, (rows,)), (258, SHORT, (32,)),
        (259, SHORT, (8,)), (262, SHORT, (1,)), (273, LONG, (8,)), (277, SHORT, (1,)),
        (278, LONG, (rows,)), (279, LONG, (len(pixels),)),
        (305, ASCII, (f"cdem {__version__}\0".encode(),)), (339, SHORT, (3,)),
        (33550, DOUBLE, (raster.cell, raster.cell, 0.0)),
        (33922, DOUBLE, (0.0, 0.0, 0.0, raster.x, raster.north, 0.0)),
        *([] if epsg is None else [(34735, SHORT, _geokeys(epsg))]),
        (42112, ASCII, (_metadata(name, unit, tags or {}),)),
        (42113, ASCII, (f"{NOTHING:g}\0".encode(),)),
    ]  # fmt: skip
    directory, more = b"", b""
    first = 8 + len(pixels) + len(pixels) % 2  # place of the directory; long values follow it
    after = first + 2 + 12 * len(entries) + 4
    for tag, kind, values in entries:
        data = values[0] if kind == ASCII else struct.pack(f"<{len(values)}{kind}", *values)
        count = len(data) if kind == ASCII else len(values)
        if len(data) > 4:
            place = struct.pack("<I", after + len(more))
            more += data + b"\0" * (len(data) % 2)
        else:
            place = data.ljust(4, b"\0")
        directory += struct.pack("<HHI", tag, KINDS[kind], count) + place
    head = struct.pack("<2sHI", b"II", 42, first) + pixels + b"\0" * (len(pixels) % 2)
    path.write_bytes(head + struct.pack("<H", len(entries)) + directory + b"\0" * 4 + more)


def _geokeys(epsg: int) -> tuple[int, ...]:
    """Directory of keys: version, their number, then key, place, count and value of each."""
    keys = [PROJECTED, PIXEL_IS_AREA, (3072, 0, 1, epsg), METRE]
    return (1, 1, 0, len(keys), *(number for key in keys for number in key))


def _metadata(name: str, unit: str, tags: Mapping[str, str]) -> bytes:
    """Tags of the file, description and unit of the band, in GDAL's words."""
    items = [f"<Item name={quoteattr(key)}>{escape(value)}</Item>" for key, value in tags.items()]
    for role, value in (("description", name), ("unittype", unit)):
        if value:
            items.append(
                f'<Item name="{role.upper()}" sample="0" role="{role}">{escape(value)}</Item>'
            )
    return f"<GDALMetadata>{''.join(items)}</GDALMetadata>\0".encode()


def epsg_of(crs: str | None) -> int | None:
    """EPSG code of the horizontal part of a projection; None without code or projection."""
    if crs is None:
        return None
    try:
        system = look_up(crs)
    except BackendError:  # without the extra a code is used unchecked
        return int(crs[5:]) if crs.startswith("EPSG:") else None
    code = horizontal(system).to_epsg()
    return None if code is None else int(code)
