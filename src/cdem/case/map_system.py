"""Map projections (coordinate reference systems): how a case writes and checks them."""

from __future__ import annotations

import re
from typing import Annotated, Any

from pydantic import AfterValidator

from cdem.errors import BackendError, CaseError

CODE = re.compile(r"[A-Za-z]{2,12}:\d{1,9}")
WKT = re.compile(r"[A-Z_]{3,30}\s*\[.*\]", re.DOTALL)
NAMES_FILE = re.compile(
    r"((grids|init|catalog)\s*=|PROJ4_GRIDS\W+|PARAMETERFILE\s*[\[(])[^\]\s]*[/\\]", re.IGNORECASE
)
"""A path given for a parameter of PROJ that opens a file."""
LONGEST = 20_000  # most characters of a WKT


def _written(text: str) -> str:
    """Text of a projection on one line; its meaning is looked up where it is used."""
    line = " ".join(text.split())
    if len(line) > LONGEST or not (CODE.fullmatch(line) or WKT.fullmatch(line)):
        raise ValueError(
            f"must be a code such as EPSG:32632, or WKT, got '{line[:40]}'; epsg.io lists the codes"
        )
    return line.upper() if CODE.fullmatch(line) else line


MapSystem = Annotated[str, AfterValidator(_written)]
"""A projection as text: ``EPSG:32632``, or WKT."""


def look_up(text: str) -> Any:
    """The projection of a text, a ``pyproj.CRS``.

    Raises:
        BackendError: The extra `terrain` is not installed.
        CaseError: There is no such projection.
    """
    try:
        import pyproj
    except ImportError as error:
        raise BackendError(
            f"map projections need pyproj: pip install 'cdem[terrain]' ({error})"
        ) from None
    if NAMES_FILE.search(text):
        raise CaseError(
            f"projection '{text[:60]}' names a file, which is not allowed; use a code such as "
            f"EPSG:32632"
        )
    try:
        return pyproj.CRS.from_user_input(text)
    except pyproj.exceptions.CRSError:
        raise CaseError(f"no projection '{text[:60]}'; epsg.io lists the codes") from None


def why_not(text: str) -> str | None:
    """Why a projection cannot hold coordinates in metres; None if it can, or if this is unknown.

    Without the extra `terrain`, nothing is known of projections.
    """
    try:
        system = look_up(text)
    except CaseError as error:
        return str(error)
    except BackendError:
        return None
    return unfit(system)


def unfit(system: Any) -> str | None:
    """Why a projection (``pyproj.CRS``) cannot measure lengths in metres; None if it can."""
    flat = system.sub_crs_list[0] if system.is_compound else system
    if not flat.is_projected:
        return (
            f"'{flat.name}' is not a map projection: its coordinates are not metres; use one for a "
            f"small "
            "area, e.g. a UTM zone"
        )
    factors = {axis.unit_conversion_factor for axis in flat.axis_info[:2]}
    if any(abs(factor - 1) > 1e-9 for factor in factors):
        return (
            f"'{flat.name}' is in {flat.axis_info[0].unit_name}, not in metres; use a "
            f"projection in metres"
        )
    if "Popular Visualisation" in flat.coordinate_operation.method_name:
        return (
            f"'{flat.name}' (Web Mercator) stretches lengths, by 1.4 times at 45 deg; use a UTM zone or "
            "the projection of the land survey"
        )
    return None
