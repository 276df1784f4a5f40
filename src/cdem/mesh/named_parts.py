"""Meshes in several files: named files must lie below the mesh's folder, and contain their data themselves."""

from __future__ import annotations

import re
from pathlib import Path

from cdem.errors import MeshError
from cdem.mesh.hdf5_links import refuse_links

INCLUDE = re.compile(
    rb"^\s*\*\s*INCLUDE\b[^\n]*?INPUT\s*=\s*([^,\n]*)", re.IGNORECASE | re.MULTILINE
)
MEND = "all files of a mesh must lie in its folder"


def check_parts(path: Path) -> None:
    """Refuse a mesh that leads to files elsewhere: by HDF5, XDMF, or ``*INCLUDE`` of Abaqus.

    Raises:
        MeshError: It does. Call this inside `reading`.
    """
    kind = path.suffix.lower()
    if kind in (".xdmf", ".xmf"):
        from defusedxml.ElementTree import parse

        for item in parse(path, forbid_dtd=True).getroot().iter():
            text = (item.text or "").strip()
            if item.tag.endswith("DataItem") and item.get("Format", "").upper() != "XML" and text:
                _check_hdf5(_below(path, path.parent, text.rpartition(":")[0] or text))
    elif kind == ".inp":
        _check_includes(path, path.parent, set())
    else:
        _check_hdf5(path)


def _check_hdf5(path: Path) -> None:
    import h5py

    if h5py.is_hdf5(path):
        with h5py.File(path, "r") as hdf5:
            refuse_links(hdf5, path)


def _check_includes(path: Path, folder: Path, seen: set[Path]) -> None:
    seen.add(path.resolve())
    for name in INCLUDE.findall(path.read_bytes()):
        other = _below(path, folder, name.decode(errors="replace").strip())
        if other in seen:
            raise MeshError(f"{path}: includes '{other.name}', which has been read already")
        if other.is_file():
            _check_includes(other, folder, seen)


def _below(path: Path, folder: Path, name: str) -> Path:
    """A file that a mesh names."""
    there = (folder / name).resolve()
    if "\0" in name or Path(name).is_absolute() or folder.resolve() not in there.parents:
        raise MeshError(f"{path}: names '{name[:80]}', which is not below its folder; {MEND}")
    return there
