"""GDAL shut in: in the process that reads, only the drivers that were kept are there."""

import subprocess

import pytest

from cdem.case import child

SCRIPT = """
import {module}, {inside}
from cdem.terrain.gdal import keep_drivers
{begin}
keep_drivers({inside}, ["{driver}"])
print(sorted({drivers}))
"""


@pytest.mark.parametrize(
    "names",
    [
        {"module": "pyogrio", "inside": "pyogrio._ogr", "driver": "GPKG", "begin": "",
         "drivers": "pyogrio.list_drivers()"},
        {"module": "rasterio", "inside": "rasterio._base", "driver": "GTiff",
         "begin": "env = rasterio.Env().__enter__()", "drivers": "env.drivers()"},
    ],
    ids=["pyogrio", "rasterio"],
)  # fmt: skip
def test_other_drivers_are_gone(names):
    pytest.importorskip(names["module"], reason="needs the extra 'terrain'")
    command = child.code(SCRIPT.format(**names))
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == f"['{names['driver']}']\n"
