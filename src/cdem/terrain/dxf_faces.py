"""Triangles of a DXF file: 3DFACE, and meshes that are polylines; as text, on one layer."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from cdem.errors import CaseError
from cdem.mesh.obj_file import within
from cdem.terrain.facets import Facets, fanned

BINARY = b"AutoCAD Binary DXF"
POLYGON_MESH, POLYFACE, CLOSED_M, CLOSED_N, IS_POINT = 16, 64, 1, 32, 64
"""Bits of group 70 of a POLYLINE and of its VERTEX."""
METRES, UNITLESS = 6, 0
"""Values of $INSUNITS."""
SHOWN = 8
"""Most layers or kinds in a message."""
Groups = list[tuple[int, str]]  # code and value of each group of an entity


@dataclass
class _Found:
    """Corners and faces of all layers."""

    points: list[list[float]] = field(default_factory=list)
    loops: dict[str, list[list[int]]] = field(default_factory=dict)
    others: Counter[str] = field(default_factory=Counter)

    def add(self, layer: str, corners: list[list[float]], faces: list[list[int]]) -> None:
        first = len(self.points)
        self.points += corners
        self.loops.setdefault(layer, []).extend([[first + i for i in face] for face in faces])


def read_dxf_faces(path: Path, layer: str | None) -> Facets:
    """Read the faces on a layer; call it inside `reading`.

    Args:
        path: ASCII DXF.
        layer: Its layer; may be left out if only one has faces.

    Raises:
        CaseError: The file is binary, has no faces, or several layers have some.
    """
    raw = path.read_bytes()
    if raw.startswith(BINARY):
        raise CaseError(f"{path}: is a binary DXF; save it as ASCII DXF")
    lines = raw.decode("utf-8", errors="replace").lstrip("\ufeff").splitlines()
    found, unit = _Found(), UNITLESS
    pending: list[Groups] = []  # a polyline and its vertices
    for kind, groups in _entities(path, lines):
        if kind == "$INSUNITS":
            unit = int(groups[0][1])
        elif pending and kind == "VERTEX":
            pending.append(groups)
        elif pending:
            _mesh(path, found, pending)
            pending = []
        if kind == "3DFACE":
            _face(found, groups)
        elif kind == "POLYLINE" and _whole(groups, 70) & (POLYGON_MESH | POLYFACE):
            pending = [groups]
        elif kind not in ("$INSUNITS", "VERTEX", "SEQEND"):
            found.others[kind] += 1
    if pending:
        _mesh(path, found, pending)
    loops = found.loops[_chosen(path, found, layer)]
    notes = []
    if unit not in (METRES, UNITLESS):
        notes.append(
            f"{path.name}: its $INSUNITS {unit} (not metres) is not used: x and y are taken as metres"
        )
    points = np.array(found.points, float).reshape(-1, 3)
    return Facets(points, fanned(loops), notes, found.others)


def _chosen(path: Path, found: _Found, layer: str | None) -> str:
    """The layer to use."""
    names = sorted(found.loops)
    told = ", ".join(f"{name} ({len(found.loops[name])})" for name in names[:SHOWN])
    told += f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    if not names:
        kinds = ", ".join(f"{n} of {kind}" for kind, n in found.others.most_common(SHOWN))
        raise CaseError(
            f"{path}: has no faces (3DFACE, or a polyface mesh); it has: {kinds or 'nothing'}; "
            "export the surface as 3DFACE"
        )
    if layer is not None and layer not in names:
        raise CaseError(f"{path}: has no faces on layer '{layer}'; there are faces on: {told}")
    if layer is None and len(names) > 1:
        raise CaseError(f"{path}: has faces on several layers; choose one with 'layer': {told}")
    return names[0] if layer is None else layer


def _entities(path: Path, lines: list[str]) -> Iterator[tuple[str, Groups]]:
    """Entities of the section ENTITIES, with their groups; and $INSUNITS of the header."""
    section, kind = "", ""
    groups: Groups = []
    for at in range(0, len(lines) - 1, 2):
        try:
            code = int(lines[at])
        except ValueError:
            raise CaseError(
                f"{path}:{at + 1}: is no DXF: a group code is a whole number, not "
                f"'{lines[at].strip()[:40]}'"
            ) from None
        value = lines[at + 1].strip()
        if code == 2 and kind == "SECTION":
            section = value
        if section == "HEADER" and code == 70 and groups and groups[-1] == (9, "$INSUNITS"):
            yield "$INSUNITS", [(code, value)]
        if code == 0:
            if section == "ENTITIES" and kind not in ("SECTION", "ENDSEC", ""):
                yield kind, groups
            kind, groups = value, []
        else:
            groups.append((code, value))
    if section == "ENTITIES" and kind not in ("SECTION", "ENDSEC", "EOF", ""):
        raise CaseError(f"{path}: ends within an entity; is it complete?")


def _whole(groups: Groups, code: int) -> int:
    """The first whole number with a code; 0 without one."""
    return next((int(value) for one, value in groups if one == code), 0)


def _point(groups: Groups, number: int) -> list[float]:
    """A point of an entity: its first, second, third or fourth."""
    known = dict(groups)
    return [float(known[10 * (axis + 1) + number]) for axis in range(3)]


def _layer(groups: Groups) -> str:
    return next((value for code, value in groups if code == 8), "0")


def _face(found: _Found, groups: Groups) -> None:
    corners = [_point(groups, number) for number in range(3)]
    fourth = _point(groups, 3) if any(code == 13 for code, _ in groups) else corners[2]
    if fourth != corners[2]:
        corners.append(fourth)
    found.add(_layer(groups), corners, [list(range(len(corners)))])


def _mesh(path: Path, found: _Found, pending: list[Groups]) -> None:
    """Faces of a polyface mesh, or of a mesh of M by N points."""
    head, vertices = pending[0], pending[1:]
    if _whole(head, 70) & POLYFACE:
        corners, loops = _polyface(vertices)
    else:
        corners = [_point(one, 0) for one in vertices]
        rows, columns = _whole(head, 71), _whole(head, 72)
        if min(rows, columns) < 2 or rows * columns != len(corners):
            raise CaseError(
                f"{path}: a polyline mesh of {rows} by {columns} points has {len(corners)}"
            )
        loops = _of_grid(rows, columns, _whole(head, 70))
    if not all(within(loop, len(corners)) for loop in loops):
        raise CaseError(f"{path}: a polyline mesh names vertices that it does not have")
    found.add(_layer(head), corners, loops)


def _polyface(vertices: list[Groups]) -> tuple[list[list[float]], list[list[int]]]:
    """Corners and faces; a number is negative where the edge after it is hidden."""
    points = [bool(_whole(one, 70) & IS_POINT) for one in vertices]
    corners = [_point(one, 0) for one, is_point in zip(vertices, points, strict=True) if is_point]
    loops = [
        [abs(int(value)) - 1 for code, value in one if 71 <= code <= 74 and int(value)]
        for one, is_point in zip(vertices, points, strict=True)
        if not is_point
    ]
    return corners, loops


def _of_grid(rows: int, columns: int, flags: int) -> list[list[int]]:
    """Quadrilaterals of a mesh of rows by columns of points."""
    return [
        [
            i * columns + j,
            i * columns + (j + 1) % columns,
            (i + 1) % rows * columns + (j + 1) % columns,
            (i + 1) % rows * columns + j,
        ]
        for i in range(rows if flags & CLOSED_M else rows - 1)
        for j in range(columns if flags & CLOSED_N else columns - 1)
    ]
