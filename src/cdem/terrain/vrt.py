"""Virtual rasters (VRT): mosaics of plain grids below their own folder, rewritten before GDAL sees
one.

A VRT may name files, addresses, programs and services in many ways. GDAL reads only a copy with
known elements and checked sources.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, tostring

from cdem.errors import CaseError

PLAIN = {".tif": (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"), ".tiff": (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"),
         ".asc": (b"ncols", b"NCOLS", b"nrows", b"NROWS"), ".grd": (b"DSAA", b"DSBB", b"DSRB")}  # fmt: skip
"""Endings of grids that a VRT may name, and their first bytes."""
MEND = "gdalbuildvrt makes VRT files of grids beside them; gdal_translate makes a .tif of any other"
MOST = 50_000_000
"""Largest size of a VRT [bytes]."""
WHOLE = ("SRS", "GeoTransform")
"""Elements of a VRT that are copied unchanged."""
PASSED = ("Metadata", "BlockXSize", "BlockYSize", "OverviewList")
"""Elements of a VRT that do not affect heights."""
BAND = (
    "NoDataValue",
    "UnitType",
    "Offset",
    "Scale",
    "HideNoDataValue",
    "ColorInterp",
    "Description",
)
BAND_PASSED = ("Metadata", "Histograms", "CategoryNames", "ColorTable")
SOURCES = ("SimpleSource", "ComplexSource")
OF_SOURCE = (
    "SourceBand",
    "SrcRect",
    "DstRect",
    "NODATA",
    "ScaleOffset",
    "ScaleRatio",
    "UseMaskBand",
)
SOURCE_PASSED = ("SourceProperties",)
ATTRIBUTES = {
    "SRS": ("dataAxisToSRSAxisMapping",), "SrcRect": ("xOff", "yOff", "xSize", "ySize"),
    "DstRect": ("xOff", "yOff", "xSize", "ySize"), "SimpleSource": ("resampling",),
    "ComplexSource": ("resampling",), "VRTRasterBand": ("dataType", "band", "blockXSize", "blockYSize"),
    "VRTDataset": ("rasterXSize", "rasterYSize"),
}  # fmt: skip


def plain(path: Path) -> tuple[str, list[Path]]:
    """A rewritten VRT, and the grids that it names.

    Raises:
        CaseError: It contains anything but heights from plain grids below its folder; names it.
    """
    from defusedxml.ElementTree import parse

    if path.stat().st_size > MOST:
        raise CaseError(f"{path}: is larger than {MOST // 1_000_000} MB; {MEND}")
    root = parse(path, forbid_dtd=True).getroot()
    if root.tag != "VRTDataset":
        raise CaseError(f"{path}: not a VRT: it begins with <{root.tag[:40]}>")
    out = _same(path, root)
    files: list[Path] = []
    for part in root:
        if part.tag in WHOLE:
            out.append(_text(path, part))
        elif part.tag == "VRTRasterBand":
            out.append(_band(path, part, files))
        elif part.tag not in PASSED:
            raise _foreign(path, part.tag)
    if not files:
        raise CaseError(f"{path}: names no grid; {MEND}")
    return tostring(out, encoding="unicode"), list(dict.fromkeys(files))


def refuse_links(path: Path) -> None:
    """Refuse an ``.aux.xml`` beside a grid that leads to another file, e.g. to overviews.

    Raises:
        CaseError: It does; or it is not XML.
    """
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import ParseError, parse

    beside = path.with_name(path.name + ".aux.xml")
    if not beside.is_file():
        return
    try:
        root = parse(beside, forbid_dtd=True).getroot()
    except (ParseError, DefusedXmlException):
        raise CaseError(f"{beside}: is not plain XML; remove it") from None
    for part in root.iter():
        if (
            "overview"
            in " ".join([part.tag, part.text or "", *part.attrib, *part.attrib.values()]).lower()
        ):
            raise CaseError(f"{beside}: leads to another file of overviews; remove it")


def _band(path: Path, band: Any, files: list[Path]) -> Element:
    out = _same(path, band, {"subClass": ("VRTSourcedRasterBand",)})
    for part in band:
        if part.tag in SOURCES:
            out.append(_source(path, part, files))
        elif part.tag in BAND:
            out.append(_text(path, part))
        elif part.tag not in BAND_PASSED:
            raise _foreign(path, part.tag)
    return out


def _source(path: Path, source: Any, files: list[Path]) -> Element:
    out = _same(path, source)
    for part in source:
        if part.tag == "SourceFilename":
            files.append(_grid(path, part))
            SubElement(out, "SourceFilename", relativeToVRT="0").text = str(files[-1])
        elif part.tag in OF_SOURCE:
            out.append(_text(path, part))
        elif part.tag not in SOURCE_PASSED:
            raise _foreign(path, part.tag)
    return out


def _grid(path: Path, part: Any) -> Path:
    """The file that a VRT names: a plain grid below its folder."""
    name = (part.text or "").strip()
    home = path.parent.resolve()
    relative = part.get("relativeToVRT") == "1" and "\0" not in name
    there = (home / name).resolve() if relative else home
    shown = f"{path}: names '{name[:80]}', which is"
    if not relative or Path(name).is_absolute() or home not in there.parents:
        raise CaseError(f"{shown} not a relative path (relativeToVRT) below its own folder; {MEND}")
    begins = PLAIN.get(there.suffix.lower())
    if begins is None:
        raise CaseError(f"{shown} none of {', '.join(PLAIN)}; {MEND}")
    if not there.is_file():
        raise CaseError(f"{shown} missing")
    with there.open("rb") as file:
        head = file.read(4096)
    if not head.startswith(begins) or b"<VRTDataset" in head:
        raise CaseError(f"{shown} not of the kind of its ending; {MEND}")
    refuse_links(there)
    return there


def _same(path: Path, part: Any, more: dict[str, tuple[str, ...]] | None = None) -> Element:
    """An empty element with its known attributes."""
    allowed = ATTRIBUTES.get(part.tag, ())
    for name, value in part.items():
        if name not in allowed and value not in (more or {}).get(name, ()):
            raise _foreign(path, f'{part.tag} {name}="{value[:40]}"')
    return Element(part.tag, {name: part.get(name) for name in allowed if part.get(name)})


def _text(path: Path, part: Any) -> Element:
    if len(part):
        raise _foreign(path, part[0].tag)
    out = _same(path, part)
    out.text = part.text
    return out


def _foreign(path: Path, what: str) -> CaseError:
    return CaseError(f"{path}: has <{what[:80]}>, which is not supported in a VRT; {MEND}")
