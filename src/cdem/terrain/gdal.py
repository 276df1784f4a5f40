"""GDAL in isolation: only the drivers that a file needs, in a process that reads nothing else.

Drivers of GDAL follow links to other files and the internet, and guess the kind of a file from its
content. So the reading process (`cdem.case.reader_process`) drops all drivers except those for the
kind given by the file's ending and first bytes.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from types import ModuleType


def keep_drivers(module: ModuleType, names: Iterable[str]) -> None:
    """Drop all drivers of a GDAL but these.

    Args:
        module: The compiled module of pyogrio or rasterio; each contains its own GDAL.
        names: Names of drivers.
    """
    gdal = ctypes.CDLL(module.__file__)
    gdal.GDALGetDriver.restype = ctypes.c_void_p
    gdal.GDALGetDescription.restype = ctypes.c_char_p
    gdal.GDALGetDescription.argtypes = gdal.GDALDeregisterDriver.argtypes = [ctypes.c_void_p]
    kept = {name.encode() for name in names}
    for number in reversed(range(gdal.GDALGetDriverCount())):
        driver = gdal.GDALGetDriver(number)
        if gdal.GDALGetDescription(driver) not in kept:
            gdal.GDALDeregisterDriver(driver)
    if gdal.GDALGetDriverCount() > len(kept):
        raise RuntimeError("GDAL keeps drivers that were dropped")
