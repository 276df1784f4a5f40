"""A case for one body: tets between its planes and the ground, on a fixed bed, ready for `cdem critical`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import MeshError
from cdem.screening.bodies import Body, Ground, height_of
from cdem.screening.fos_map import FosMap
from cdem.screening.loads import UNIT_WATER, Loads
from cdem.screening.products import outline
from cdem.terrain import write
from cdem.terrain.heights import extra
from cdem.terrain.plan import Plan, flat_mesh, pieces_of, split_pinched
from cdem.terrain.solid import Solid, body_columns, stack
from cdem.whole_files import write_text

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ACROSS = 8.0
"""Elements along the side of a square of the body's area in plan."""
THIN = 0.1
"""Least thickness inside the body, in element sizes."""
GROWTH = 0.3
BODY = "body"
GRAVITY = 9.81
BETWEEN = (0.5, 2.0)
"""First factors to try, over the factor of the closed form."""
FAR = 0.02
"""A body has failed when a node has moved this fraction of the mean face size: rock beds are stiff."""


def body_mesh(body: Body, ground: Ground) -> tuple[Solid, list[int]]:
    """Mesh a body and a layer of rock below it.

    Returns:
        The mesh: the group `body` and a bed for each plane below it; and the numbers of those
            planes.

    Raises:
        MeshError: It cannot be meshed.
    """
    polygon = outline(body, ground)
    size = float(np.sqrt(polygon.area)) / ACROSS
    polygon = polygon.simplify(0.1 * size)
    parts, planes = _parts(body, polygon)
    lines: list[tuple[Floats, int, int]] = []
    for piece in pieces_of(parts, [polygon], size):
        for ends in zip(piece.points[:-1], piece.points[1:], strict=True):
            lines.append((np.array(ends), piece.left + 1, piece.right + 1))
    points, triangles, domain = flat_mesh(lines, [size] * len(parts), GROWTH)
    unknown = np.full(len(points), np.nan)
    plan = Plan(points, triangles, domain - 1, unknown, unknown, np.empty(0, np.int64), [])
    rim = _rim(triangles)
    zero = np.zeros(len(points), bool)
    zero[rim] = True
    plan.body[zero[triangles].all(axis=1)] = -1
    split_pinched(plan, zero)
    if not (plan.body >= 0).any():
        raise MeshError("the body is too narrow for its mesh")
    _lift(plan, body, planes, ground, rim, THIN * size)
    return _solid(plan, body, size, planes), planes


def _parts(body: Body, polygon: Any) -> tuple[list[Any], list[int]]:
    """The body's plan divided by plane: polygons, and the number of the plane below each."""
    shapely = extra("shapely")
    if len(body.planes) == 1:
        return [shapely.MultiPolygon([polygon])], [0]
    side = _side(body)
    along = np.array([-side[1], side[0]])
    far = 10 * float(np.hypot(*np.ptp(np.reshape(polygon.bounds, (2, 2)), axis=0)))
    start = body.point[:2]
    ring = [
        start - far * along,
        start + far * along,
        start + far * (along + side),
        start + far * (side - along),
    ]
    half = shapely.Polygon(ring)
    out, planes = [], []
    for number, part in enumerate((polygon.intersection(half), polygon.difference(half))):
        some = [p for p in shapely.get_parts(part) if p.geom_type == "Polygon"]
        if sum(p.area for p in some) > 1e-3 * polygon.area:
            out.append(shapely.MultiPolygon(some))
            planes.append(number)
    return out, planes


def _side(body: Body) -> Floats:
    """Horizontal unit vector from the intersection of two planes to the side where the first is higher."""
    first, second = (plane.normal[:2] / plane.normal[2] for plane in body.planes)
    return (second - first) / np.hypot(*(second - first))


def _rim(triangles: Ints) -> Ints:
    """Points on the edge of triangles."""
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    return np.unique(unique[count == 1])


def _lift(
    plan: Plan, body: Body, planes: list[int], ground: Ground, rim: Ints, thin: float
) -> None:
    """Give the plan its heights; the thickness is zero at the rim and nowhere else.

    Points on the intersection line of the planes are moved onto it, so that both beds are plane.
    """
    used = [np.unique(plan.triangles[plan.body == k]) for k in range(len(planes))]
    if len(planes) == 2:
        both, side = np.intersect1d(used[0], used[1]), _side(body)
        plan.points[both] -= ((plan.points[both] - body.point[:2]) @ side)[:, None] * side
    plan.bed = np.full(len(plan.points), np.nan)
    for number, some in zip(planes, used, strict=True):
        plan.bed[some] = height_of(body.planes[number], body.point, *plan.points[some].T)
    plan.ground = np.maximum(ground.grid(plan.points), plan.bed + thin)
    plan.ground[rim] = plan.bed[rim]


def _solid(plan: Plan, body: Body, size: float, planes: list[int]) -> Solid:
    points = [np.column_stack([plan.points, plan.ground])]
    columns = body_columns(plan, size, points)
    tets, _ = stack(plan, columns)
    # the bed: the same triangles, an element deep
    count = sum(len(p) for p in points)
    below = type(columns)()
    used = np.unique(plan.triangles[plan.body >= 0]).tolist()
    for number, at in enumerate(used):
        below.add(at, [count + number, columns.ids[at][0]])
    points.append(np.column_stack([plan.points[used], plan.bed[used] - size]))
    bed, part = stack(plan, below)
    names = [BODY, *(f"bed{k + 1}" for k in planes)]
    group = np.concatenate([np.zeros(len(tets), np.int64), part])
    return Solid(np.concatenate(points), np.concatenate([tets, bed]), group, names, {}, [], None)


def write_case(
    body: Body, number: int, found: FosMap, folder: Path, system: str | None = None
) -> Path:
    """Write the mesh and the case of a listed body; returns the path of the case.

    Args:
        body: The body.
        number: Number of the body in the list, from 1.
        found: The map with the body.
        folder: Folder to write to.
        system: Map projection, EPSG code or WKT; None for none.

    Raises:
        MeshError: It cannot be meshed.
    """
    solid, planes = body_mesh(body, found.ground)
    path = folder / f"body{number}.yaml"
    write(solid, path.with_suffix(".msh"))
    if found.loads.is_wet:
        _write_water(solid, body, found, folder / f"body{number}-water.csv")
    density = found.limits.unit_weight / GRAVITY
    write_text(path, _case_text(body, number, density, planes, system, found.loads))
    return path


def _write_water(solid: Solid, body: Body, found: FosMap, path: Path) -> None:
    """Write the pressure at the points of the mesh on the planes, and the same below them.

    A table must span a volume.
    """
    of_body = solid.tet_group == solid.groups.index(BODY)
    used = np.intersect1d(solid.tets[of_body], solid.tets[~of_body])
    points = solid.points[used]
    xy, bed = points[:, :2], body.bed(points[:, 0], points[:, 1])
    thickness = np.maximum(found.ground.grid(xy) - bed, 0.0)
    loads = found.loads
    heads = loads.share * loads.heads_at(found.ground.grid, xy, bed, thickness)
    lines = ["x, y, z, pressure"]
    for shift in (0.0, -1.0):
        for (x, y, z), head in zip(points.tolist(), heads.tolist(), strict=True):
            lines.append(f"{x!r}, {y!r}, {z + shift!r}, {UNIT_WATER * head:.6g}")
    write_text(path, "\n".join(lines) + "\n")


def _gravity(body: Body, loads: Loads) -> str:
    """Gravity with the shaking in it, as in a case."""
    across = (GRAVITY * loads.kh * body.sliding.heading).tolist()
    parts = [*across, -GRAVITY * (1 - loads.kv)]
    return "[" + ", ".join(f"{part:.9g}" for part in parts) + "]"


def _case_text(
    body: Body,
    number: int,
    density: float,
    planes: list[int],
    system: str | None,
    loads: Loads,
) -> str:
    name = f"body{number}"
    held = "friction_angle: 75, cohesion: 1 GPa, tensile_strength: 1 GPa"
    held += ", residual_friction_angle: 75, residual_cohesion: 1 GPa"
    beds = [(f"bed{k + 1}", body.planes[k]) for k in planes]
    lines = [
        f"# Body {number} of cdem screen: {body.name}, {body.volume:.0f} m3, F = {body.factor:.3f} by",
        f"# closed form; {loads.text()}.",
        f"# To compute it: cdem critical {name}.yaml --factor --criterion far={FAR}",
        "cdem: 2",
        f"title: Body {number} of a screening",
        *([] if system is None else [f"crs: {json.dumps(system)}"]),
        "model:",
        f"  mesh: {name}.msh",
        "materials:",
        "  # ASSUMED: modulus and Poisson's ratio",
        f"  rock: {{density: {density!r}, young_modulus: 10 GPa, poisson_ratio: 0.25}}",
        "groups:",
        "  body: {material: rock}",
        *(f"  {bed}: {{material: rock, fix: [x, y, z]}}   # {plane.name}" for bed, plane in beds),
        "interfaces:",
        "  # bonded while gravity is applied; the last stage has the strengths of the joints",
        f"  default: {{law: residual, {held}}}",
        "  pairs:",
        *(f"    - {{name: {bed}, between: [{BODY}, {bed}], {held}}}" for bed, _ in beds),
        *([] if not loads.is_wet else ["water:", "  fields:"]),
        *(
            f"    - {{interface: {bed}, table: {name}-water.csv, wet: always}}"
            for bed, _ in beds
            if loads.is_wet
        ),
        f"loads: {{gravity: {_gravity(body, loads)}}}",
        "stages:",
        "  - {name: settle, mode: static}",
        "  - name: decide",
        "    mode: static",
        "    set:",
        "      # all cohesion acts together, as in the closed form; with a residual_cohesion of 0 bonds",
        "      # break one after another, and the factor falls to about the value of friction "
        "alone",
    ]
    for bed, plane in beds:
        lines += [
            f"      interfaces.{bed}.friction_angle: {plane.friction!r}",
            f"      interfaces.{bed}.cohesion: {plane.cohesion!r}",
            f"      interfaces.{bed}.tensile_strength: 0",
            f"      interfaces.{bed}.residual_friction_angle: {plane.friction!r}",
            f"      interfaces.{bed}.residual_cohesion: {plane.cohesion!r}",
        ]
    return "\n".join(lines) + "\n"
