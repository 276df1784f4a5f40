"""Transformation of every file to the projection of a landslide; checks labels and reports steps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.map_system import look_up, unfit
from cdem.errors import CaseError
from cdem.terrain.heights import extra
from cdem.units import coordinates

Floats = NDArray[np.float64]
WGS84 = "EPSG:4326"
SLACK = 0.1  # allowed excess over 360 and 90 from rounding and half cells [deg]
NOT_TRUE = 1e-3  # relative error of lengths in a projection that gives a note


def horizontal(system: Any) -> Any:
    """The horizontal part of a projection, without heights."""
    if system.is_compound:
        return system.sub_crs_list[0]
    return system.to_2d() if len(system.axis_info) > 2 else system


def vertical_name(system: Any) -> str | None:
    """Vertical datum of a projection, or None."""
    if system.is_compound:
        return str(system.sub_crs_list[1].name)
    return f"ellipsoid of {system.name}" if len(system.axis_info) > 2 else None


def name_of(system: Any) -> str:
    """``EPSG:32632`` if the projection has a code, else WKT on one line."""
    code = system.to_authority()
    return ":".join(code) if code else " ".join(system.to_wkt().split())


def short_name(system: Any) -> str:
    """A projection in messages: its code, else its name."""
    code = system.to_authority()
    return ":".join(code) if code else f"'{system.name}'"


def same(a: Any, b: Any) -> bool:
    """Whether two projections are equal in plan."""
    a, b = horizontal(a), horizontal(b)
    return bool(name_of(a) == name_of(b) or a.equals(b, ignore_axis_order=True))


def moved(xy: Floats, source: Any, target: Any) -> Floats:
    """Points, shape (points, 2), x or longitude first, from one projection to another.

    Raises:
        CaseError: Some lie outside the domain of the target.
    """
    transformer = extra("pyproj").Transformer.from_crs(
        horizontal(source), horizontal(target), always_xy=True
    )
    out = np.column_stack(transformer.transform(*np.asarray(xy, float)[:, :2].T))
    bad = np.flatnonzero(~np.isfinite(out).all(axis=1))
    if len(bad):
        raise CaseError(
            f"({coordinates(xy[bad[0]])}) in {short_name(source)} is outside the domain of "
            f"{short_name(target)}"
        )
    return out


def utm_zone(longitude: float, latitude: float) -> Any:
    """The UTM zone (on WGS 84) at a longitude and latitude [deg]."""
    pyproj = extra("pyproj")
    area = extra("pyproj.aoi").AreaOfInterest(longitude, latitude, longitude, latitude)
    zones = extra("pyproj.database").query_utm_crs_info("WGS 84", area)
    if not zones:
        raise CaseError(
            f"there is no UTM zone at {longitude:.4g} E, {latitude:.4g} N; give a projection (crs)"
        )
    return pyproj.CRS.from_epsg(zones[0].code)


def stretch(ring: Floats, system: Any) -> float:
    """Relative excess of lengths in a projection over lengths on the ground; from an area.

    Args:
        ring: Corners of a polygon [m], shape (corners, 2).
        system: Its projection.
    """
    shapely = extra("shapely")
    polygon = shapely.Polygon(ring)
    fine = shapely.get_coordinates(shapely.segmentize(polygon, polygon.length / 1000))
    geod = extra("pyproj").Geod(ellps="WGS84")
    area = abs(geod.polygon_area_perimeter(*moved(fine, system, look_up(WGS84)).T)[0])
    return float(np.sqrt(polygon.area / area) - 1)


def looks_like_degrees(low: Floats, high: Floats) -> bool:
    """Whether coordinates may be longitude and latitude."""
    farthest = np.maximum(np.abs(low[:2]), np.abs(high[:2]))
    return bool(farthest[0] <= 180 + SLACK and farthest[1] <= 90 + SLACK)


def _beyond_degrees(low: Floats, high: Floats) -> bool:
    farthest = np.maximum(np.abs(low[:2]), np.abs(high[:2]))
    return bool(farthest[0] > 360 + SLACK or farthest[1] > 90 + SLACK)


class Projection:
    """The common projection in metres of all files.

    Attributes:
        target: A ``pyproj.CRS``; None if no file names one: then all are in the same metres.
        notes: A line for each applied rule.
    """

    def __init__(self, target: Any | None) -> None:
        self.target = target
        self.notes: list[str] = []
        self._levels: dict[str, Path] = {}

    def own(
        self, path: Path, label: str | None, told: str | None, low: Floats, high: Floats
    ) -> Any | None:
        """The projection of a file; None if it is the target's, or unknown.

        Args:
            path: The file.
            label: Projection named in the file.
            told: Projection given by the user, which takes precedence.
            low: Smallest coordinates in it.
            high: Largest.

        Raises:
            CaseError: The label cannot be true, or the file cannot be transformed to metres.
        """
        system = self._believed(path, label, told, low, high)
        if system is None:
            return None
        if horizontal(system).is_geographic and _beyond_degrees(low, high):
            raise CaseError(
                f"{path}: names {short_name(system)} (degrees), but its edges are "
                f"({coordinates(low[:2])}) to ({coordinates(high[:2])}): the label is wrong; write the "
                "true projection as 'crs' beside the file"
            )
        if self.target is None:
            if why := unfit(system):
                raise CaseError(f"{path}: {why}; write the projection of the landslide as crs")
            self.tell(f"{path.name}: is in {short_name(system)}; no other file names a projection")
            return None
        if same(system, self.target):
            return None
        self.tell(
            f"{path.name}: transformed from {short_name(system)} to {short_name(self.target)}"
        )
        return system

    def _believed(
        self, path: Path, label: str | None, told: str | None, low: Floats, high: Floats
    ) -> Any | None:
        if told is not None:
            system = look_up(told)
            if label is not None and not same(look_up(label), system):
                says = short_name(look_up(label))
                self.tell(f"{path.name}: names {says}, but {short_name(system)} is used as given")
            return system
        if label is not None:
            return look_up(label)
        if self.target is None:
            return None
        if path.suffix.lower() in (".geojson", ".json") and looks_like_degrees(low, high):
            self.tell(f"{path.name}: GeoJSON without crs, so longitude and latitude (RFC 7946)")
            return look_up(WGS84)
        self.tell(f"{path.name}: names no projection; {short_name(self.target)} is assumed")
        return None

    def bring(self, path: Path, label: str | None, told: str | None, xy: Floats) -> Floats:
        """Points of a file, shape (points, 2) or with heights (points, 3), in the target [m]."""
        own = self.own(path, label, told, xy.min(axis=0), xy.max(axis=0))
        if own is None:
            return xy
        try:
            return np.column_stack([moved(xy, own, self.target), xy[:, 2:]])
        except CaseError as error:
            raise CaseError(f"{path}: {error}") from None

    def same_heights(self, path: Path, label: str | None) -> None:
        """Refuse heights of two files with different vertical datums.

        Raises:
            CaseError: They differ, e.g. one is from the ellipsoid and one from sea level.
        """
        level = vertical_name(look_up(label)) if label is not None else None
        if level is None:
            return
        for other, first in self._levels.items():
            if other != level:
                raise CaseError(
                    f"{path}: its heights refer to '{level}', the heights of {first.name} to "
                    f"'{other}'; transform "
                    "both to one vertical datum first, e.g. with gdalwarp"
                )
        self._levels[level] = path

    def tell(self, *notes: str) -> None:
        """Add notes, each once."""
        self.notes += [note for note in dict.fromkeys(notes) if note not in self.notes]
