"""HDF5 files that hold their data themselves: links to other files are refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cdem.errors import CdemError, MeshError


def refuse_links(
    group: Any, path: Path, allowed: str = "", kind: type[CdemError] = MeshError
) -> None:
    """Stop at whatever in a group leads to another file.

    Args:
        group: Of h5py.
        path: For messages.
        allowed: Name of a file beside it that external links may name.
        kind: Class of the error.

    Raises:
        CdemError: Of the class ``kind``: a link, or a dataset whose numbers lie in another file.
    """
    import h5py

    waiting, seen = [group], set()
    while waiting:
        inside = waiting.pop()
        for name in inside:
            link = inside.get(name, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                if not allowed or link.filename != allowed:
                    raise kind(f"{path}: {name} leads to another file, {link.filename[:80]!r}")
                continue
            one = inside[name] if isinstance(link, h5py.HardLink) else None
            if isinstance(one, h5py.Group):
                where = h5py.h5o.get_info(one.id).addr
                waiting += [] if where in seen else [one]
                seen.add(where)
            elif isinstance(one, h5py.Dataset) and (one.is_virtual or one.external):
                raise kind(f"{path}: the numbers of {name} lie in another file")
