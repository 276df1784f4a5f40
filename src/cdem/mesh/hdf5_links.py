"""HDF5 files must contain their data themselves: links to other files are refused."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from cdem.errors import CdemError, MeshError


def refuse_links(
    group: Any, path: Path, allowed: str = "", kind: type[CdemError] = MeshError
) -> None:
    """Refuse anything in a group that leads to another file.

    Args:
        group: Group of h5py.
        path: For messages.
        allowed: Name of a file beside it that external links may name.
        kind: Class of the error.

    Raises:
        CdemError: Of the class ``kind``: a link, or a dataset with its numbers in another file.
    """
    import h5py

    def lies_elsewhere(how: Any) -> bool:
        return how.get_layout() == h5py.h5d.VIRTUAL or how.get_external_count() > 0

    waiting, seen = [group.id], set()
    while waiting:
        inside = waiting.pop()
        for name in inside:
            link = inside.links.get_info(name).type
            if link == h5py.h5l.TYPE_EXTERNAL:
                leads_to = os.fsdecode(inside.links.get_val(name)[0])
                if not allowed or leads_to != allowed:
                    raise kind(
                        f"{path}: {name.decode(errors='replace')} leads to another file, {leads_to[:80]!r}"
                    )
            one = h5py.h5o.open(inside, name) if link == h5py.h5l.TYPE_HARD else None
            if isinstance(one, h5py.h5g.GroupID):
                where = h5py.h5o.get_info(one).addr
                waiting += [] if where in seen else [one]
                seen.add(where)
            elif isinstance(one, h5py.h5d.DatasetID) and lies_elsewhere(one.get_create_plist()):
                raise kind(
                    f"{path}: the numbers of {name.decode(errors='replace')} lie in another file"
                )
