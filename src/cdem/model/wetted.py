"""What water does at the start, for the audit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.model.build import Build


def wetted(build: Build) -> dict[str, Any] | None:
    """What water does at the start: wet faces, their area, the force on what is free to move.

    Returns:
        Ready for JSON; None where the case has no water.
    """
    if build.case.water is None:
        return None
    arrays = build.arrays
    faces, area, most = 0, 0.0, 0.0
    for face, pressure in face_pressures(build, build.start_position):
        wet = (pressure > 0).any(axis=0)
        faces += int(wet.sum())
        area += float(arrays["face.area"][face][wet].sum())
        most = max(most, float(pressure.max(initial=0.0)))
    force = build.core.fields()["node.water"].reshape(-1, 4)[:, :3]
    free = arrays["support.row"][: len(force)] < 0
    biot = arrays["water.biot"]
    return {
        "wet_faces": faces,
        "wet_area": area,
        "highest_pressure": most,
        "force_on_free_nodes": force[free].sum(axis=0).tolist(),
        "porous_groups": [n for n, b in zip(build.group_names, biot, strict=False) if b > 0],
    }


def face_pressures(
    build: Build, position: NDArray[np.float64]
) -> Iterator[tuple[NDArray[np.int32], NDArray[np.float64]]]:
    """Faces that may be wet, and the pressure of water at their vertices [Pa], shape (vertices, faces).

    Args:
        build: A model with water.
        position: Of its nodes [m], shape (nodes, 3).
    """
    arrays, now = build.arrays, build.core.fields()
    rows = now["water.fields_now"].reshape(-1, 8)
    for kind, corners in (("triangles", 3), ("quads", 4)):
        count = build.assembly.counts[f"wet_{kind}.count"]
        if not count:
            continue
        nodes = arrays[f"wet_{kind}.nodes"].reshape(corners, -1)[:, :count]
        row = rows[now[f"wet_{kind}.field"].reshape(corners, -1)[:, :count]]
        kept = arrays[f"wet_{kind}.kept"].reshape(corners, -1)[:, :count]
        at = position[nodes]
        pressure = row[..., 5] * (
            row[..., 0] + (row[..., 1:4] * at).sum(axis=-1) + row[..., 4] * kept
        )
        yield arrays[f"wet_{kind}.face"][:count], np.maximum(pressure, 0.0)


def water_text(water: dict[str, Any] | None) -> list[str]:
    """Lines on what `wetted` found."""
    if water is None:
        return []
    force = ", ".join(f"{f:.4g}" for f in water["force_on_free_nodes"])
    lines = [
        "",
        f"  water presses on {water['wet_faces']:,} faces, {water['wet_area']:.6g} m2, with up to "
        f"{water['highest_pressure']:.4g} Pa; on nodes without support in sum {force} N",
    ]
    if water["porous_groups"]:
        lines.append(f"    and in the pores of {', '.join(water['porous_groups'])}")
    return lines


def idle_water(build: Build, water: dict[str, Any] | None) -> list[str]:
    """A warning where the water that `wetted` looked for does nothing."""
    if water is None or water["highest_pressure"] or water["porous_groups"]:
        return []
    sets = any(path.startswith("water.") for stage in build.case.stages for path in stage.set)
    bares = any(stage.add or stage.remove for stage in build.case.stages)  # other faces
    if sets or bares or build.arrays["water.field_curve"].any():  # it may come later
        return []
    return [
        f"{build.case.where('water')}: water presses nowhere at the start: no rock has pores (biot), and "
        "no joint or face is wet; look at levels, and at wet of the fields"
    ]


def dry_bonds(build: Build, bonded: set[str]) -> list[str]:
    """A warning where water lies at joints that hold by bonds, which let none in until they break.

    Args:
        build: The model.
        bonded: Names of the sets of joints that hold by bonds.
    """
    case = build.case
    if case.water is None or not bonded or any(rock.biot for rock in case.materials.values()):
        return []
    if not any("wet" not in water.model_fields_set for water in case.water.fields):  # auto, unsaid
        return []
    return [
        f"{case.where('water')}: water: no water presses in {', '.join(sorted(bonded))} until bonds "
        "break (wet: auto); if it stands in these joints, write wet: always, else wet: auto"
    ]
