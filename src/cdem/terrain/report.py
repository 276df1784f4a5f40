"""Report on a landslide's mesh: counts, volumes, dip of the bed, shape of its tets; and its file."""

from __future__ import annotations

import gzip
import math
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.mesh.element_shapes import SLIVER
from cdem.terrain.solid import Solid, shape

Floats = NDArray[np.float64]


def measure(solid: Solid) -> dict[str, Any]:
    """Counts, volumes [m3], dip [deg] of the bed and shape of the tets."""
    corners = solid.points[solid.tets]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    height, ratio, angle = shape(corners)
    groups = {}
    for index, name in enumerate(solid.groups):
        some = solid.tet_group == index
        groups[name] = {
            "tets": int(some.sum()),
            "volume": float(volume[some].sum()),
            "smallest_height": float(height[some].min()),
        }
    return {
        "points": len(solid.points),
        "tets": len(solid.tets),
        "groups": groups,
        "bed": _bed(solid) if any(n.startswith("bed_") for n in solid.surfaces) else None,
        "layers": solid.layers,
        "smallest_height": float(height.min()),
        "smallest_height_ratio": float(ratio.min()),
        "smallest_dihedral_angle": float(angle.min()),
        "slivers": int((ratio < SLIVER).sum()),
        "surfaces": {name: len(faces) for name, faces in solid.surfaces.items()},
        "crs": solid.crs,
        "notes": solid.notes,
    }


def _bed(solid: Solid) -> dict[str, float]:
    """Dip and dip direction [deg] of the best-fitting plane of the bed, and its largest deviation [m]."""
    faces = np.concatenate([f for n, f in solid.surfaces.items() if n.startswith("bed_")])
    corners = solid.points[faces]
    weight = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    middle = corners.mean(axis=1)
    center = np.average(middle, axis=0, weights=weight)
    spread = (corners - center).reshape(-1, 3) * np.repeat(np.sqrt(weight), 3)[:, None]
    normal = np.linalg.svd(spread, full_matrices=False)[2][2]
    normal *= np.sign(normal[2])
    dip = math.degrees(math.atan2(math.hypot(normal[0], normal[1]), normal[2]))
    return {
        "dip": dip,
        "dip_direction": math.degrees(math.atan2(normal[0], normal[1])) % 360,
        "farthest": float(np.abs((corners - center) @ normal).max()),
    }


def text(facts: dict[str, Any]) -> str:
    """The facts of `measure` as text."""
    lines = [f"{facts['points']:,} points, {facts['tets']:,} tets"]
    width = max(map(len, facts["groups"]))
    for name, group in facts["groups"].items():
        lines.append(
            f"  {name:<{width}}  {group['tets']:>9,} tets  {group['volume'] / 1e6:>12,.4f} Mm3  "
            f"smallest height {group['smallest_height']:.3g} m"
        )
    if bed := facts["bed"]:
        lines.append(
            f"bed: dip {bed['dip']:.3f} deg towards {bed['dip_direction']:.3f} deg, "
            f"within {bed['farthest']:.2g} m of that plane"
        )
    if facts["layers"]:
        lines.append("thickness of layers where they are present, and their share of the plan:")
    for name, layer in facts["layers"].items():
        lines.append(
            f"  {name:<{width}}  {layer['least']:.3g} to {layer['most']:.3g} m, mean "
            f"{layer['mean']:.3g} m, {layer['share']:.1%}"
        )
    lines += [
        f"worst tets: height {facts['smallest_height']:.3g} m, height / longest edge "
        f"{facts['smallest_height_ratio']:.3g}, dihedral angle "
        f"{facts['smallest_dihedral_angle']:.3g} deg; {facts['slivers']} slivers (below {SLIVER})",
        "surfaces: " + ", ".join(facts["surfaces"]),
    ]
    if facts["crs"]:
        lines.append(f"projection: write into the case  crs: {facts['crs']}")
    return "\n".join(lines + [f"note: {note}" for note in facts["notes"]])


def write(solid: Solid, path: Path) -> None:
    """Write a gmsh file (``.msh`` or ``.msh.gz``) whose physical groups a case can name.

    Raises:
        CaseError: The name has another ending.
    """
    import meshio

    if not path.name.endswith((".msh", ".msh.gz")):
        raise CaseError(
            f"{path}: the mesh is written as .msh or .msh.gz (gmsh); choose such a name"
        )
    cells, tags, names = [], [], {}
    for tag, name in enumerate(solid.groups, start=1):
        cells.append(("tetra", solid.tets[solid.tet_group == tag - 1]))
        tags.append(np.full(len(cells[-1][1]), tag))
        names[name] = np.array([tag, 3])
    for tag, (name, faces) in enumerate(solid.surfaces.items(), start=len(names) + 1):
        cells.append(("triangle", faces))
        tags.append(np.full(len(faces), tag))
        names[name] = np.array([tag, 2])
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    mesh = meshio.Mesh(solid.points, cells, cell_data=data, field_data=names)
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "mesh.msh"
        mesh.write(plain, file_format="gmsh22", binary=True)
        if path.suffix != ".gz":
            shutil.copyfile(plain, path)
            return
        # without name and time, equal meshes give equal bytes
        with path.open("wb") as file, gzip.GzipFile("", "wb", fileobj=file, mtime=0) as packed:
            packed.write(plain.read_bytes())
