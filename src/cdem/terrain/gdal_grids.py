"""The process that reads grids by GDAL, see `cdem.case.reader_process` and `cdem.terrain.gdal`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cdem.case import reader_process
from cdem.errors import CaseError
from cdem.terrain.rasters import MEND

SURFER = ("GSAG", "GSBG", "GS7BG")
NAMES = {"GTiff": "GeoTIFF", "VRT": "VRT"}
OF_VRT = ("VRT", "GTiff", "AAIGrid", *SURFER)
"""Drivers of a VRT and of the grids that it may name."""
OPTIONS = {
    "GDAL_VRT_ENABLE_PYTHON": "NO",
    "GDAL_VRT_ENABLE_RAWRASTERBAND": "NO",
    "GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR",
}


def read(path: Path, asked: dict[str, Any]) -> reader_process.Arrays:
    """Read a grid, or the part requested by the asking process.

    Args:
        path: The file.
        asked: ``driver``: driver of GDAL; ``vrt``: path of the VRT that is opened instead of the
            file.

    Returns:
        ``values``: heights, rows from the north; nothing if no part is requested.

    Raises:
        CaseError: It is not such a file.
    """
    import rasterio
    import rasterio._base

    from cdem.terrain.gdal import keep_drivers

    driver = asked["driver"]
    try:
        with rasterio.Env(**OPTIONS):
            keep_drivers(rasterio._base, OF_VRT if driver == "VRT" else (driver,))
            with rasterio.open(asked["vrt"] or path, driver=driver) as file:
                return _read(file)
    except rasterio.errors.RasterioError as error:
        name = NAMES.get(driver, "Surfer grid")
        raise CaseError(f"{path}: not a {name}: {error}") from None


def _read(file: Any) -> reader_process.Arrays:
    place = file.transform
    head = {
        "place": [place.a, place.b, place.c, place.d, place.e, place.f],
        "size": [file.width, file.height],
        "label": file.crs and file.crs.to_wkt(),
        "unit": (file.units[0] or "").strip(),
    }
    left, top, columns, rows = reader_process.ask(head)
    if not columns:
        return {}
    window = ((top, top + rows), (left, left + columns))
    values = file.read(1, masked=True, window=window).astype(float).filled(np.nan)
    return {"values": values * file.scales[0] + file.offsets[0]}


if __name__ == "__main__":
    import rasterio  # noqa: F401  # loading takes longer than reading is allowed

    reader_process.answer(read, MEND)
