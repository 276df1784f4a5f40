"""Facets that CloudCompare found in a cloud (plug-in qFacets; Dewez et al. 2016), as a table."""

from __future__ import annotations

from cdem.joints.tables import Table, number, plain

HEADINGS = {"horiz_ext", "vert_ext", "normalx", "normaly", "normalz"}
"""Headings by which a table is one of facets, in the form of `plain`."""
DIPS = ("dip", "dip_dir")
NONE = ("0", "-1")
"""Families of facets that were not classified."""


def prefer_normals(table: Table) -> None:
    """Leave out dips in whole degrees beside normals."""
    names = [plain(name) for name in table.head]
    if not set(names) >= HEADINGS:
        return
    idle = [i for i, name in enumerate(names) if name in DIPS]
    if not all(number(row[i]).is_integer() for row in table.rows for i in idle):
        return
    table.notes.append("facets of CloudCompare: planes by their normals, as dips are whole degrees")
    kept = [i for i in range(len(names)) if i not in idle]
    table.head = [table.head[i] for i in kept]
    table.rows = [[row[i] for i in kept] for row in table.rows]


def families(table: Table) -> list[str] | None:
    """The column of sets of a table; of facets their families, or None if none is classified."""
    sets = table.column("set")
    if not {plain(name) for name in table.head} >= HEADINGS:
        return sets
    named = ["" if word in NONE else f"family{word}" for word in sets]
    return named if any(named) else None
