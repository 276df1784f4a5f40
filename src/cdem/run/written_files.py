"""Files of a result folder that cdem wrote: `--overwrite` removes no others."""

from __future__ import annotations

from collections.abc import Iterable
from fnmatch import fnmatchcase
from pathlib import Path

from cdem.case.shown_fields import SHOWN
from cdem.case.stored import MARKER
from cdem.errors import CdemError
from cdem.whole_files import ASIDE, refuse_link, write_text

LOCK = ".cdem-lock"
"""The file held by a run while it writes."""
BEGUN = {MARKER, MARKER + ASIDE, LOCK}
"""Files left by a run killed at its start: a folder with no others holds no results."""
FOLDERS = {
    "vtu": ["frame-*.vtu"],  # cdem export
    "frames": ["frame-*.vtkhdf", "elements.h5"],
    "surface": ["frame-*.vtkhdf"],
    "bolts": ["frame-*.vtkhdf"],
    "records": ["*.csv"],
    "motions": ["*.csv", "*.png"],  # cdem records
    "maps": ["*.tif", "*.qml", "*.tif.aux.xml"],  # cdem runout, with files that GIS put beside them
}
"""Folders inside a result folder, and patterns of the names of their files."""
CUTS = ("", "-[xyz]=*", "-*,*,*,*")
"""Text after a field in the name of a picture: nothing, or the plane of a cut."""
PICTURES = ("-[0-9][0-9][0-9][0-9].png", "-overview.png", "-before-after.png", ".gif")
"""Ends of these names."""
WRITTEN = {
    # cdem run
    MARKER, LOCK, "case.yaml", "run.log", "summary.json", "checkpoint.h5", "checkpoint-before.h5",
    "histories.csv", "frames.vtkhdf", "surface.vtkhdf", "bolts.vtkhdf",
    "report.html", "maxima.h5",
    # cdem plot, render, export
    "energies.png", "unbalance.png", "history-*.png", "frames.pvd",
    *(f"{name}{cut}{end}" for name in SHOWN for cut in CUTS for end in PICTURES),
    # cdem runout
    "runout.json", "runout.csv", "fragments.csv", "sections.csv", "deposit.asc", "deposit.tif",
    "deposit.png", "maps.png", "energy_line.png", "grain_sizes.csv", "grain_sizes.png", "runout.gpkg", "runout.gpkg-shm", "runout.gpkg-wal",
}  # fmt: skip
"""Patterns of the names of all files that commands write into a result folder."""


def mark(folder: Path, run: str) -> None:
    """Mark a folder as made by cdem, with the run that writes into it."""
    write_text(
        folder / MARKER,
        "cdem run made this folder. With --overwrite it replaces the files that it writes here,\n"
        f"and does so only if there are no others.\nLast run: {run}\n",
    )


def _is_written(path: Path) -> bool:
    """Whether a path has the name and kind of a file of cdem, or of its remains after a kill."""
    if path.is_dir() and not path.is_symlink():
        patterns = FOLDERS.get(path.name, [])
        return bool(patterns) and all(
            not inside.is_dir() and _matches(inside.name, patterns) for inside in path.iterdir()
        )
    return _matches(path.name, WRITTEN)


def _matches(name: str, patterns: Iterable[str]) -> bool:
    return any(fnmatchcase(name.removesuffix(ASIDE), pattern) for pattern in patterns)


def check_replaceable(folder: Path, case_folder: Path) -> None:
    """Make sure that a folder holds only results.

    Args:
        folder: It exists and is not empty.
        case_folder: Folder of the case.

    Raises:
        CdemError: It is not a result folder, or holds the case or a file that cdem did not write.
    """
    advice = "so it is not overwritten; name another folder with -o"
    if folder.resolve() == case_folder.resolve():
        raise CdemError(f"{folder}: is the folder of the case, {advice}")
    refuse_link(folder / LOCK)
    if not (folder / MARKER).is_file():
        raise CdemError(
            f"{folder}: is not a result folder ({MARKER} is missing), {advice}, or remove it "
            f"yourself"
        )
    other = sorted(path.name for path in folder.iterdir() if not _is_written(path))
    if other:
        more = f" and {len(other) - 1} more" if len(other) > 1 else ""
        raise CdemError(
            f"{folder}: holds {other[0]}{more}, which cdem did not write, {advice}, or move it away"
        )


def refuse_links(folder: Path) -> None:
    """Make sure that files of cdem in a result folder are not links to other places.

    Raises:
        CdemError: A file or folder with a name used by cdem is a link.
    """
    for path in folder.iterdir():
        if path.name in FOLDERS:
            refuse_link(path)
            for inside in path.iterdir() if path.is_dir() else ():
                refuse_link(inside)
        elif _matches(path.name, WRITTEN):
            refuse_link(path)


def remove_written(folder: Path) -> None:
    """Remove the files of cdem from a folder; its mark and lock stay."""
    for path in folder.iterdir():
        if path.name in (MARKER, LOCK) or not _is_written(path):
            continue
        if path.is_dir() and not path.is_symlink():
            for inside in path.iterdir():
                inside.unlink()
            path.rmdir()
        else:
            path.unlink()
