"""The solid: columns of tets in the bodies, a closed shell around the bedrock, and tets inside it."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cdem.errors import MeshError
from cdem.terrain.heights import extra
from cdem.terrain.landslide import Landslide
from cdem.terrain.plan import Plan, flat_mesh
from cdem.units import coordinates

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
FLAT = 0.05  # height over longest edge of tets to remove at the ground
TET_FACES = np.array([(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)])  # outward, opposite a corner


@dataclass
class Solid:
    """Tets in groups, with labelled surfaces.

    Attributes:
        points: Positions [m], shape (points, 3).
        tets: Point ids of positive volume, shape (tets, 4).
        tet_group: Number of each tet's group in `groups`.
        groups: The bedrock, then the bodies; or layers from the ground downwards, then the bedrock.
        surfaces: By name, point ids of triangles, shape (faces, 3).
        notes: Messages for the user.
        crs: Projection of the points as text for a case; None if no file names one.
        layers: By group, `least`, `mean` and `most` thickness of a layer where it is present [m], and
            the `share` of the plan that it covers [1].
    """

    points: Floats
    tets: Ints
    tet_group: Ints
    groups: list[str]
    surfaces: dict[str, Ints]
    notes: list[str]
    crs: str | None
    layers: dict[str, dict[str, float]] = field(default_factory=dict)


class Columns:
    """Points stacked over the plan: each column from low to high, with its heights as fractions."""

    def __init__(self) -> None:
        self.ids: dict[int, list[int]] = {}
        self.parts: dict[int, list[float]] = {}

    def add(self, at: int, ids: list[int], parts: list[float] | None = None) -> None:
        """Add a column: its points from low to high, and their fractions; equal parts without."""
        self.ids[at] = ids
        self.parts[at] = parts or [k / max(1, len(ids) - 1) for k in range(len(ids))]

    def climb(self, feet: list[int]) -> list[tuple[list[int], int, int]]:
        """From the bottom of some columns to their top, one point at a time.

        All columns are climbed in the same order, by fraction and then by number, so two neighbours
        divide the wall between common columns alike.

        Returns:
            For each step: the points before it, the moving foot, and its new point.
        """
        steps = sorted(
            (part, at, k, foot)
            for foot, at in enumerate(feet)
            for k, part in enumerate(self.parts[at])
            if k > 0
        )
        stand = [self.ids[at][0] for at in feet]
        path = []
        for _, at, k, foot in steps:
            path.append((list(stand), foot, self.ids[at][k]))
            stand[foot] = self.ids[at][k]
        return path


def make_solid(landslide: Landslide, plan: Plan) -> Solid:
    """Fill the space between base and ground with tets.

    The bodies are stacked in columns between bed and ground; netgen fills the bedrock from
    its closed surface, which includes the bodies' undersides and walls.

    Raises:
        MeshError: A shell does not close, or the bedrock cannot be filled.
    """
    points = [np.column_stack([plan.points, plan.ground])]
    columns = body_columns(plan, landslide.sizes.body, points)
    tets, group = stack(plan, columns)
    body_skin = _skin(tets)
    tops = {tuple(sorted(t)) for t in plan.triangles[plan.body >= 0].tolist()}
    under = np.array(
        [t for t in body_skin.tolist() if tuple(sorted(t)) not in tops], np.int64
    ).reshape(-1, 3)
    ground = plan.triangles[plan.body < 0]
    sides, base = _outside(landslide, plan, points)
    shell = np.concatenate([ground, under[:, ::-1], *sides.values(), base])
    xyz = np.concatenate(points)
    _check_closed(shell, xyz)
    xyz, rock = fill(xyz, shell, landslide.sizes.far, landslide.sizes.growth)
    rock = _peel(xyz, rock, plan)
    solid = Solid(
        xyz,
        np.concatenate([rock, tets]),
        np.concatenate([np.zeros(len(rock), np.int64), group]),
        [landslide.bedrock, *(body.group for body in landslide.bodies)],
        {"fix_base": base} | {f"fix_side_{name}": faces for name, faces in sides.items()},
        list(plan.notes),
        landslide.system,
    )
    _name_surfaces(solid, plan, columns)
    check_conforming(solid, np.concatenate([plan.triangles, base, *sides.values()]))
    return solid


def body_columns(plan: Plan, size: float, points: list[Floats]) -> Columns:
    """Divide the height between bed and ground into parts of about one size."""
    columns = Columns()
    count = len(plan.points)
    for at in np.unique(plan.triangles[plan.body >= 0]).tolist():
        low, high = plan.bed[at], plan.ground[at]
        if low == high:
            columns.add(at, [at])
            continue
        parts = max(1, round((high - low) / size))
        z = low + (high - low) * np.arange(parts) / parts
        points.append(np.column_stack([np.tile(plan.points[at], (parts, 1)), z]))
        columns.add(at, [*range(count, count + parts), at])
        count += parts
    return columns


def stack(plan: Plan, columns: Columns) -> tuple[Ints, Ints]:
    """Tets of the bodies and their groups."""
    tets, group = [], []
    for triangle, body in zip(plan.triangles.tolist(), plan.body.tolist(), strict=True):
        if body < 0:
            continue
        for stand, _, to in columns.climb(triangle):
            tets.append([*stand, to])
            group.append(body + 1)
    return np.array(tets, np.int64).reshape(-1, 4), np.array(group, np.int64)


def _skin(tets: Ints) -> Ints:
    """Faces of only one tet, outward."""
    faces = tets[:, TET_FACES].reshape(-1, 3)
    _, where, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    return faces[np.sort(where[count == 1])]


def _outside(
    landslide: Landslide, plan: Plan, points: list[Floats]
) -> tuple[dict[str, Ints], Ints]:
    """Triangles of the four sides (S, E, N, W) and of the base, outward; adds their points."""
    rim, count = plan.rim, sum(len(p) for p in points)
    base_z = landslide.extent.base
    xy = plan.points[rim]
    base_xy, base = _base(landslide, xy)
    on_base = count + np.arange(len(rim))
    points.append(np.column_stack([base_xy, np.full(len(base_xy), base_z)]))
    base = count + base[:, ::-1]
    count += len(base_xy)
    edge = np.hypot(*(np.roll(xy, -1, axis=0) - xy).T)
    edge = (edge + np.roll(edge, 1)) / 2
    columns = Columns()
    for k, at in enumerate(rim.tolist()):
        high = plan.ground[at]
        parts = max(1, round((high - base_z) / edge[k]))
        z = base_z + (high - base_z) * np.arange(1, parts) / parts
        points.append(np.column_stack([np.tile(xy[k], (parts - 1, 1)), z]))
        columns.add(k, [int(on_base[k]), *range(count, count + parts - 1), at])
        count += parts - 1
    sides: dict[str, list[list[int]]] = {"S": [], "E": [], "N": [], "W": []}
    for k, name in enumerate(sides_of(xy)):
        for stand, _, to in columns.climb([k, (k + 1) % len(rim)]):
            sides[name].append([*stand, to])
    return {name: np.array(faces) for name, faces in sides.items()}, base


def sides_of(rim: Floats) -> list[str]:
    """Side (S, E, N, W) of each edge of the rim, from a point to the next one.

    Args:
        rim: Its points in order [m], shape (points, 2).
    """
    low, high = rim.min(axis=0), rim.max(axis=0)
    on = {"S": rim[:, 1] == low[1], "E": rim[:, 0] == high[0]}
    on |= {"N": rim[:, 1] == high[1], "W": rim[:, 0] == low[0]}
    return [
        next(name for name, there in on.items() if there[k] and there[(k + 1) % len(rim)])
        for k in range(len(rim))
    ]


def _base(landslide: Landslide, rim: Floats) -> tuple[Floats, Ints]:
    """Triangles of the base within the points of the rim, which come first."""
    ends = np.stack([rim, np.roll(rim, -1, axis=0)], axis=1)
    lines = [(pair, 1, 0) for pair in ends]
    sizes = landslide.sizes
    points, triangles, _ = flat_mesh(lines, [sizes.far], sizes.growth)
    if not np.array_equal(points[: len(rim)], rim) or len(_open_edges(triangles)) != len(rim):
        raise MeshError(
            "the base cannot be triangulated with the edges of the ground; give another sizes.far"
        )
    return points, triangles


def _open_edges(triangles: Ints) -> Ints:
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    return unique[count != 2]


def _check_closed(shell: Ints, points: Floats) -> None:
    bad = _open_edges(shell)
    if len(bad):
        raise MeshError(
            f"the surface of the bedrock has {len(bad)} edges without exactly two faces, "
            f"e.g. at ({coordinates(points[bad[0]].mean(axis=0))}); give another outline or sizes.body"
        )


def shape(corners: Floats) -> tuple[Floats, Floats, Floats]:
    """Smallest height [m] of tets, its ratio to the longest edge, smallest dihedral angle [deg].

    Args:
        corners: [m], shape (tets, 4, 3).
    """
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    sides = corners[:, TET_FACES]
    normals = np.cross(sides[:, :, 1] - sides[:, :, 0], sides[:, :, 2] - sides[:, :, 0])
    doubled = np.linalg.norm(normals, axis=2)
    height = 6 * volume / doubled.max(axis=1)
    pairs = list(combinations(range(4), 2))
    longest = np.max(
        [np.linalg.norm(corners[:, i] - corners[:, j], axis=1) for i, j in pairs], axis=0
    )
    unit = normals / doubled[:, :, None]
    cosine = np.max([-np.einsum("ij,ij->i", unit[:, i], unit[:, j]) for i, j in pairs], axis=0)
    return height, height / longest, np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def check_conforming(solid: Solid, outside: Ints) -> None:
    """Check that all parts share every face between them, and that the outside is unchanged.

    Args:
        solid: The mesh.
        outside: All triangles of its surface, shape (triangles, 3).

    Raises:
        MeshError: They do not, or a tet has no volume.
    """
    skin = np.sort(_skin(solid.tets), axis=1)
    wanted = np.sort(outside, axis=1)
    same = (
        len(skin) == len(wanted)
        and (skin[np.lexsort(skin.T)] == wanted[np.lexsort(wanted.T)]).all()
    )
    corners = solid.points[solid.tets]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1])
    if not same or volume.min() <= 0:
        raise MeshError(
            "the mesher has changed the surface of the bedrock or left an empty tet; give another "
            "sizes.body or sizes.growth"
        )


def fill(points: Floats, shell: Ints, size: float, growth: float) -> tuple[Floats, Ints]:
    """Fill a closed surface with tets.

    Args:
        points: Positions [m], shape (points, 3); unused ones are kept.
        shell: Outward triangles, every edge twice.
        size: Largest edge length [m].
        growth: Growth of the edge length per distance [1].

    Returns:
        The points, new ones at the end, and tets of positive volume.

    Raises:
        MeshError: The surface crosses itself, or is too uneven to be filled.
    """
    netgen = extra("netgen.meshing")
    netgen.SetMessageImportance(0)
    mesh = netgen.Mesh(dim=3)
    used = np.unique(shell)
    ids = {int(i): mesh.Add(netgen.MeshPoint(netgen.Pnt(*points[i].tolist()))) for i in used}
    rock = netgen.FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1)  # codespell:ignore domin
    face = mesh.Add(rock)
    for triangle in shell.tolist():
        mesh.Add(netgen.Element2D(face, [ids[i] for i in triangle]))
    settings = netgen.MeshingParameters(maxh=size, grading=growth)
    try:
        mesh.GenerateVolumeMesh(mp=settings)
        mesh.OptimizeVolumeMesh(settings)
    except Exception as error:
        raise MeshError(f"the bedrock cannot be filled with tets: {error}") from None
    cells = mesh.Elements3D().NumPy()["nodes"][:, :4].astype(np.int64) - 1
    if len(cells) == 0:
        raise MeshError(
            "the bedrock cannot be filled with tets: its surface crosses itself or is too uneven; "
            "give a larger terrain.smooth or a smaller sizes.body"
        )
    made = np.unique(cells[cells >= len(used)])
    number = np.full(cells.max() + 1, -1)
    number[: len(used)] = used
    number[made] = len(points) + np.arange(len(made))
    fresh = np.array(mesh.Coordinates())[made]
    return np.concatenate([points, fresh]), number[cells][:, [0, 2, 1, 3]]


def _peel(points: Floats, tets: Ints, plan: Plan) -> Ints:
    """Remove flat tets at the ground of the bedrock: two of its triangles are reoriented for each.

    On a nearly plane ground the mesher places tets over the edge between two triangles,
    a few centimetres high. Without them the ground is divided by the other diagonal.
    """
    ground = np.flatnonzero(plan.body < 0)
    number: dict[tuple[int, ...], int] = {
        tuple(sorted(t)): k
        for k, t in zip(ground.tolist(), plan.triangles[ground].tolist(), strict=True)
    }
    _, ratio, _ = shape(points[tets])
    flat = np.flatnonzero(ratio < FLAT)
    flat = flat[np.argsort(ratio[flat], kind="stable")].tolist()
    gone = np.zeros(len(tets), bool)
    peeled = True
    while peeled:  # one may lie under another
        peeled = False
        for i in flat:
            faces = tets[i][TET_FACES].tolist()
            outer = [number.get(tuple(sorted(face)), -1) for face in faces]
            inner = [face[::-1] for face, k in zip(faces, outer, strict=True) if k < 0]
            if gone[i] or len(inner) != 2 or not _sound(points[inner]):
                continue
            outer = [k for k in outer if k >= 0]
            for face, k in zip(inner, outer, strict=True):
                del number[tuple(sorted(plan.triangles[k].tolist()))]
                plan.triangles[k] = face
                number[tuple(sorted(face))] = k
            gone[i] = peeled = True
    return tets[~gone]


def _sound(triangles: Floats) -> bool:
    """Whether triangles [m], shape (triangles, 3, 3), face upwards and are no needles."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    longest = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
    doubled = np.linalg.norm(normal, axis=1)
    return bool((normal[:, 2] > 0.01 * doubled).all() and (doubled > FLAT * longest**2).all())


def _name_surfaces(solid: Solid, plan: Plan, columns: Columns) -> None:
    """Name the ground and the bed by group, and the walls by the two adjacent groups."""
    names = solid.groups
    feet = np.full(len(solid.points), -1)
    for at, ids in columns.ids.items():
        feet[at] = ids[0]
    for body, name in enumerate(names, start=-1):
        triangles = plan.triangles[plan.body == body]
        solid.surfaces[f"ground_{name}"] = triangles
        if body >= 0:
            solid.surfaces[f"bed_{name}"] = feet[triangles]
    beds = {tuple(sorted(t)) for t in feet[plan.triangles[plan.body >= 0]].tolist()}
    faces = solid.tets[:, TET_FACES].reshape(-1, 3)
    owner = np.repeat(solid.tet_group, 4)
    order = np.lexsort(np.sort(faces, axis=1).T)
    key = np.sort(faces, axis=1)[order]
    same = np.flatnonzero((key[1:] == key[:-1]).all(axis=1))
    first, second = order[same], order[same + 1]
    walls: dict[str, list[Ints]] = {}
    for f, g in zip(first, second, strict=True):
        if owner[f] != owner[g] and tuple(sorted(faces[f].tolist())) not in beds:
            low, high = sorted((f, g), key=lambda i: owner[i])
            name = f"wall_{names[owner[low]]}_{names[owner[high]]}"
            walls.setdefault(name, []).append(faces[high])
    solid.surfaces |= {name: np.array(some) for name, some in walls.items()}
