"""Effect of water at the start, for the audit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem.model.module import Built
from cdem.rows import rows_of

if TYPE_CHECKING:
    from cdem._core import Core


def wetted(build: Built) -> dict[str, Any] | None:
    """Effect of water at the start: wet faces, their area, the force on free nodes.

    Returns:
        Ready for JSON; None for a case without water.
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
    force = rows_of(build.core, "node.water").force
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
    build: Built, position: NDArray[np.float64]
) -> Iterator[tuple[NDArray[np.int32], NDArray[np.float64]]]:
    """Faces that may be wet, and the water pressure at their vertices [Pa], shape (vertices,
    faces).

    Args:
        build: A model with water.
        position: Positions of its nodes [m], shape (nodes, 3).
    """
    core = build.core
    for kind in ("wet_triangles", "wet_quads"):
        nodes, field, kept = (
            rows_of(core, f"{kind}.{key}").numbers.T for key in ("nodes", "field", "kept")
        )
        pressure = signed_pressure(core, field, position[nodes], kept)
        yield build.arrays[f"{kind}.face"], np.maximum(pressure, 0.0)


def signed_pressure(
    core: Core, field: NDArray[np.int32], at: NDArray[np.float64], kept: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Pressure of fields in this step, negative above the water [Pa].

    Args:
        core: The core of a model with water.
        field: Field of each point.
        at: Position of each point [m], with one more axis.
        kept: Its stored initial pressure, if its field uses one [Pa].
    """
    now = rows_of(core, "water.fields_now")
    linear = now.pressure[field] + (now.slope[field] * at).sum(axis=-1)
    return now.factor[field] * (linear + now.keeps[field] * kept)


def water_text(water: dict[str, Any] | None) -> list[str]:
    """Lines on the result of `wetted`."""
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


def idle_water(build: Built, water: dict[str, Any] | None) -> list[str]:
    """A warning if the water found by `wetted` has no effect."""
    if water is None or water["highest_pressure"] or water["porous_groups"]:
        return []
    sets = any(path.startswith("water.") for stage in build.case.stages for path in stage.set)
    bares = any(stage.add or stage.remove for stage in build.case.stages)  # exposes other faces
    if sets or bares or build.arrays["water.field_curve"].any():  # water may come later
        return []
    return [
        f"{build.case.where('water')}: water presses nowhere at the start: no rock has pores (biot), and "
        "no joint or face is wet; check levels, and wet of the fields"
    ]


def wet_bonds(build: Built, bonded: set[str]) -> list[str]:
    """A warning if water presses in bonded joints by the default of `wet`.

    Args:
        build: The model.
        bonded: Names of the sets of bonded joints.
    """
    case = build.case
    if case.water is None or not bonded or any(rock.biot for rock in case.materials.values()):
        return []
    if all("wet" in water.model_fields_set for water in case.water.fields):
        return []
    return [
        f"{case.where('water')}: water: water under the table presses in {', '.join(sorted(bonded))}, "
        "bonded or not (wet: auto); for joints that are dry until bonds break write wet: broken, "
        "else confirm with wet: auto"
    ]
