"""Blocks that overlap at the start: held free of stress, or refused."""

from __future__ import annotations

from cdem.errors import ModelError
from cdem.model.build import Build


def adopt_overlaps(build: Build) -> tuple[float, int, int]:
    """Accept overlaps at the start as free of stress if contacts can hold them.

    Returns:
        Depth of the deepest vertex [m], number of vertices, a face of the deepest; for `Audit`.

    Raises:
        ModelError: Elements of two blocks overlap and no contact holds them; with blocks, groups,
            depth and place of the deepest overlap.
    """
    held, (count, a, b, depth, allowed, place) = build.core.adopt_overlaps()
    if not count:
        return held
    names = [build.group_names[build.topology.block_group[block]] for block in (a, b)]
    where = ", ".join(f"{x:.4g}" for x in place)
    pairs = "1 pair" if count == 1 else f"{count:,} pairs"
    raise ModelError(
        f"blocks overlap at the start, too deeply for contacts: block {a} (group {names[0]}) "
        f"and block {b} (group {names[1]}) by {depth:.3g} m near ({where}), where contacts work "
        f"down to {allowed:.3g} m; {pairs} of elements in all. Move the blocks apart, cut one of "
        "them, or remove duplicates"
    )
