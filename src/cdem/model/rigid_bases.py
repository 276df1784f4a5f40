"""Bases that move with a record, and keep the waves that come down to them in the model."""

from __future__ import annotations

from typing import Any

from cdem.model.build import Build
from cdem.model.wave_mesh import group_volume


def rigid_bases(build: Build, waves: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """A row for each rigid base, ready for JSON.

    Its period is 4 H / c (Kramer 1996, section 7.2): the slowest motion of a layer of height H on it,
    with the mean slowness of S waves in the rock above.

    Args:
        build: The model.
        waves: Rows of `wave_mesh`.
    """
    t = build.topology
    volume = {row["group"]: group_volume(build, row["group"]) for row in waves}
    time = sum(volume[row["group"]] / row["speed"] for row in waves)  # of a metre, times the volume
    rows = []
    for place in build.boundaries.places:
        if place.boundary.quiet or not place.boundary.inputs:
            continue
        z = t.node_position[:, 2]
        height = float(z.max() - z[place.nodes].min())
        rows.append({
            "name": place.boundary.name,
            "records": [given.record for given in place.boundary.inputs],
            "faces": len(place.faces),
            "height": height,
            "period": 4 * height * time / max(sum(volume.values()), 1e-300),
        })  # fmt: skip
    return rows


def base_lines(rows: list[dict[str, Any]]) -> list[str]:
    """Lines of the audit."""
    return [
        f"  boundary {row['name']}: {row['faces']:,} faces move with {', '.join(row['records'])}; what "
        f"comes down stays in the model, which rings at {row['period']:.3g} s (4 H/c_s, H = "
        f"{row['height']:.4g} m)"
        for row in rows
    ]
