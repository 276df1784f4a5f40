"""Memory needed by a model and available: a model too large is refused before it is built."""

from __future__ import annotations

import resource
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from cdem.case.case import Case
from cdem.case.laws import INTERFACE_LAWS
from cdem.errors import ModelError
from cdem.mesh.element_shapes import FACES, NODES
from cdem.mesh.mesh import Mesh

START = 70e6
"""Bytes of the program without a model."""
WHILE_BUILT = {"tet4": 1500, "pyramid5": 4600, "wedge6": 5900, "hex8": 12_500}
"""Bytes per element of the largest temporary arrays while the model is built."""
NODE = 600
"""Bytes per node at that time."""
BUILT = {"tet4": 1000, "pyramid5": 2000, "wedge6": 1500, "hex8": 2500}
"""Bytes per element of a built model, without its faces."""
BONDED = {3: 1250, 4: 2090}
"""Bytes per bonded pair, by vertices of its faces."""
EXPOSED = {3: 4100, 4: 3600}
"""Bytes per exposed face that touches another, by vertices: its lists and contacts."""
SOLVED = {"tet4": 8300, "pyramid5": 13_000, "wedge6": 17_200, "hex8": 29_400}
"""Bytes per element that is a block of its own, while `relax: solve` solves."""
SOLVED_WHOLE = {"tet4": 1500, "pyramid5": 4000, "wedge6": 4000, "hex8": 8300}
"""The same where elements share nodes; pyramids and wedges are guessed from the others."""
# Solves measured with 2,700 to 27,000 elements (28 Nov 2026, a68b9a1). The others are fitted to the
# peaks of 15 meshes of 27,000 to 132,000 elements (25 Nov 2026), exposed faces to nine
# of 2,700 to 48,000 (26 Nov 2026): within 15 %, but for connected plates of tets one element thick,
# which take up to twice as much.

Pieces = Counter[tuple[str, bool, bool]]
"""Number of elements by shape, whether each is a block, and whether its group is bonded inside."""


def pieces_of_boxes(case: Case) -> Pieces:
    """Elements that the boxes of a case will have."""
    per_cell = {"hex8": 1, "wedge6": 2, "pyramid5": 6, "tet4": 6}
    pieces: Pieces = Counter()
    for block in case.model.blocks:
        if block.box is not None:
            cells = int(np.prod([float(n) for n in block.box.divisions]))
            shape = block.box.shape
            pieces[(shape, *_kind(case, block.group))] += cells * per_cell[shape]
    return pieces


def pieces_of_mesh(case: Case, mesh: Mesh) -> Pieces:
    """Elements that a mesh will have."""
    pieces: Pieces = Counter()
    for shape, groups in mesh.cell_group.items():
        for name, count in zip(
            mesh.group_names, np.bincount(groups, minlength=len(mesh.group_names)), strict=True
        ):
            pieces[(shape, *_kind(case, name))] += int(count)
    return pieces


def _kind(case: Case, group: str) -> tuple[bool, bool]:
    law = case.interfaces.between(group, group)
    bonded = law is not None and INTERFACE_LAWS[law.law].bonds(law)
    return case.model.split.get(group) == "elements", bonded


def need(pieces: Pieces, *, solves: bool = False) -> float:
    """Peak of memory while a model is built and begins to run [bytes].

    Args:
        pieces: What it is made of.
        solves: Whether a stage has `relax: solve`.
    """
    temporary = final = START
    for (shape, split, bonded), count in pieces.items():
        temporary += count * (WHILE_BUILT[shape] + NODE * (NODES[shape] if split else 1))
        final += count * BUILT[shape]
        if solves:
            final += count * (SOLVED if split else SOLVED_WHOLE)[shape]
        if split:
            for face in FACES[shape]:
                per_face = BONDED[len(face)] / 2 if bonded else EXPOSED[len(face)]
                final += count * per_face
    return max(temporary, final)


def room(root: Path = Path("/")) -> tuple[float, str]:
    """Memory still available to this process [bytes], and the limit behind it.

    Args:
        root: Root of /proc and /sys.
    """
    limits = [(np.inf, "nothing"), *_of_machine(root), *_of_groups(root)]
    most = resource.getrlimit(resource.RLIMIT_AS)[0]
    if most != resource.RLIM_INFINITY:
        used = int((root / "proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        limits.append((most - used, "the limit of the process (ulimit -v)"))
    return min(limits)


def _of_machine(root: Path) -> Iterator[tuple[float, str]]:
    try:
        lines = (root / "proc/meminfo").read_text().splitlines()
    except OSError:  # not Linux
        return
    for line in lines:
        if line.startswith("MemAvailable:"):
            yield float(line.split()[1]) * 1024, "the memory of this machine"


def _of_groups(root: Path) -> Iterator[tuple[float, str]]:
    """Room in the control groups of the process and their parents, of both versions."""
    try:
        lines = (root / "proc/self/cgroup").read_text().splitlines()
    except OSError:
        return
    for line in lines:
        _, controllers, path = line.split(":", 2)
        if controllers == "":
            base, used = "sys/fs/cgroup", "memory.current"
            limits = ["memory.max", "memory.high"]
        elif "memory" in controllers.split(","):
            base, used = "sys/fs/cgroup/memory", "memory.usage_in_bytes"
            limits = ["memory.limit_in_bytes"]
        else:
            continue
        folder = Path(path.lstrip("/"))
        for level in (folder, *folder.parents):  # in a container the path may be missing
            here = root / base / level
            for name in limits:
                limit = _number(here / name)
                if limit is not None:
                    taken = (_number(here / used) or 0) - _cache(here / "memory.stat")
                    yield limit - taken, f"the control group ({here / name})"


def _number(path: Path) -> float | None:
    try:
        text = path.read_text().strip()
    except OSError:
        return None
    return float(text) if text.isdigit() else None


def _cache(path: Path) -> float:
    """Bytes of cached files, which are freed on demand."""
    try:
        words = path.read_text().split()
    except OSError:
        return 0.0
    stat = dict(zip(words[::2], words[1::2], strict=False))
    return float(stat.get("total_inactive_file", stat.get("inactive_file", 0)))


def check_memory(case: Case, pieces: Pieces) -> None:
    """Refuse a model that will not fit.

    Args:
        case: The case.
        pieces: What its model is made of.

    Raises:
        ModelError: Names the memory needed, the memory available, and its limit.
    """
    solves = any(stage.relax == "solve" for stage in case.stages)
    wanted, (free, limit) = need(pieces, solves=solves), room()
    if wanted > free:
        without = need(pieces)
        way = (
            f", or relax: adaptive in static stages, which takes about {without / 1e9:.3g} GB"
            if without < free
            else ""
        )
        raise ModelError(
            f"{sum(pieces.values()):,} elements need about {wanted / 1e9:.3g} GB of memory; "
            f"{max(free, 0) / 1e9:.3g} GB are available ({limit}). Use fewer elements, or a "
            f"machine with more memory{way}"
        )
