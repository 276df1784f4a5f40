"""Unusual geometry of a model: crowded edges, strengths without bonds."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cdem.case.interface_schema import Interface, InterfacePair
from cdem.case.laws import INTERFACE_LAWS
from cdem.case.types import AUTO, Stiffness
from cdem.mesh.arrays import lengths
from cdem.mesh.overlap import flush_faces
from cdem.mesh.topology import Topology
from cdem.model.build import Build
from cdem.model.interfaces import interfaces_of, name_of

Floats = NDArray[np.float64]

NEAR = 0.01
"""Gap over the size of the smaller group below which two groups are probably meant to touch."""
COMPARED = 2_000
"""Number of vertices and faces on each side compared for a gap; the nearest by their boxes."""
UNEVEN = 4
"""Ratio of contact areas over the faces under a sliding body above which a warning is given."""
ALIKE = 0.9
"""Fraction of a joint's stiffness in its contacts above which no warning is given."""
FACING = -0.9
"""Cosine limit for the normals of faces that lie on each other."""


def crowded_edges(t: Topology) -> Iterator[str]:
    """Warn if more than two outer faces of a block meet at an edge: the mesh is not a manifold."""
    used = t.face_edges[t.face_edges >= 0]
    crowded = np.flatnonzero(np.bincount(used, minlength=len(t.edge_nodes)) > 2)
    if len(crowded) == 0:
        return
    nodes = t.edge_nodes[crowded[0]]
    group = t.group_names[t.block_group[t.node_block[nodes[0]]]]
    place = ", ".join(f"{x:.6g}" for x in t.node_position[nodes].mean(axis=0))
    yield (
        f"group {group}: more than two outer faces meet at {len(crowded)} edge(s), the first at "
        f"({place}): bodies connected by an edge only, or a non-manifold mesh. Correct the "
        "mesh, or use model.split"
    )


def idle_bonds(build: Build) -> Iterator[str]:
    """Warn of interfaces with strength in the case but without bonds at the start."""
    case, t = build.case, build.topology
    used = [
        build.arrays[f"{kind}.interface"][: build.assembly.counts[f"{kind}.count"]]
        for kind in ("triangles", "quads", "overlaps")
    ]
    numbers = set(np.unique(np.concatenate(used)).tolist())
    laws: list[tuple[str, Interface]] = [
        (f"interfaces.pairs.{i}", pair) for i, pair in enumerate(case.interfaces.pairs)
    ]
    if case.interfaces.default is not None and len(t.block_group) > 1 and not numbers:
        laws.append(("interfaces.default", case.interfaces.default))
    for number, (path, law) in enumerate(laws):
        bonding = {p.name for p in INTERFACE_LAWS[law.law].parameters if p.bonds}
        given = sorted(bonding & law.model_fields_set)
        if number in numbers or not given or not INTERFACE_LAWS[law.law].bonds(law):
            continue
        yield f"{case.where(path)}: {path}: {' and '.join(given)} bond nothing{_why(t, law)}"


def _why(t: Topology, law: Interface) -> str:
    if not isinstance(law, InterfacePair):
        return ": no faces of two blocks touch at the start"
    if law.between is None:
        return f": no two faces of the joint set {law.joint} touch at the start"
    a, b = law.between
    if a == b:
        single = (t.block_group == t.group_names.index(a)).sum() == 1
        return (
            f": group {a} is one block (see model.split)" if single else f": no faces in {a} touch"
        )
    gap, size = _gap(t, a, b)
    near = "; place them face on face if they should be bonded" if gap < NEAR * size else ""
    away = f"the nearest vertex is about {gap:.3g} m from the other's surface"
    return f": no faces of {a} and {b} touch at the start, {away}{near}"


def _gap(t: Topology, a: str, b: str) -> tuple[float, float]:
    """Smallest distance of vertices of one group to faces of the other, and size of the smaller [m]."""
    sides = [np.flatnonzero(t.face_group == t.group_names.index(name)) for name in (a, b)]
    corners = [t.node_position[t.face_nodes[faces]] for faces in sides]
    for faces, x in zip(sides, corners, strict=True):
        triangles = t.face_nodes[faces, 3] < 0
        x[triangles, 3] = x[triangles, 2]
    gaps = []
    for own, other in ((0, 1), (1, 0)):
        points = corners[own].reshape(-1, 3)
        low, high = (f(corners[other], axis=(0, 1)) for f in (np.min, np.max))
        points = np.unique(_nearest(points, points, points, low, high), axis=0)
        low, high = points.min(axis=0), points.max(axis=0)
        x = corners[other]
        x = _nearest(x, x.min(axis=1), x.max(axis=1), low, high)
        gaps += [float(_distances(points, x[:, k]).min()) for k in ([0, 1, 2], [0, 2, 3])]
    return min(gaps), min(float(np.ptp(x, axis=(0, 1)).max()) for x in corners)


def _nearest(items: Floats, low: Floats, high: Floats, box_low: Floats, box_high: Floats) -> Floats:
    """The items with boxes nearest to a box, at most `COMPARED`."""
    away = np.maximum(np.maximum(box_low - high, low - box_high), 0)
    return items[np.argsort(lengths(away), kind="stable")[:COMPARED]]


def _distances(points: Floats, triangles: Floats) -> Floats:
    """Distance of each point to the nearest triangle: to its interior, or to a corner [m]."""
    u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(u, v)
    square = np.einsum("ij,ij->i", normal, normal)
    sound = square > 0  # a triangle stored as a quadrilateral has a flat second half
    triangles, u, v, normal, square = (x[sound] for x in (triangles, u, v, normal, square))
    best = np.full(len(points), np.inf)
    for number, point in enumerate(points):
        to = point - triangles[:, 0]
        s = np.einsum("ij,ij->i", np.cross(to, v), normal) / square
        r = np.einsum("ij,ij->i", np.cross(u, to), normal) / square
        inside = (s >= 0) & (r >= 0) & (s + r <= 1)
        height = np.abs(np.einsum("ij,ij->i", to, normal)) / np.sqrt(square)
        corner = lengths(triangles - point).min(axis=1)
        best[number] = np.where(inside, height, corner).min(initial=np.inf)
    return best


def uneven_tiles(build: Build) -> Iterator[str]:
    """Warn of a group on smaller faces of another whose areas differ much.

    Blocks of one group cut by joints always differ, and seldom slide over many seams.
    """
    t, core = build.topology, build.core.fields()
    exposed, first = core["search.exposed_face"], core["outer.slot_first"]
    mother = exposed[np.repeat(np.arange(len(first) - 1) // 4, np.diff(first))]
    target = exposed[core["outer.vf_pairs"].reshape(2, -1)[1, core["outer.slot_pairs"]]]
    others = t.face_group[mother] != t.face_group[target]
    mother, target = mother[others], target[others]
    lie = np.einsum("ij,ij->i", _normals(t, mother), _normals(t, target)) < FACING
    mother, target = mother[lie], target[lie]
    share = build.arrays["face.area"] / (t.face_nodes >= 0).sum(axis=1)
    part = np.minimum(1, share[target] / share[mother])
    groups = len(t.group_names) * t.face_group[mother].astype(int) + t.face_group[target]
    for pair in np.unique(groups):
        least, most = np.quantile(part[groups == pair], [0.05, 0.95])
        if most < UNEVEN * least:
            continue
        a, b = (t.group_names[i] for i in divmod(int(pair), len(t.group_names)))
        yield (
            f"group {a} lies on faces of {b} that are smaller than its own and whose areas differ "
            f"{most / least:.2g} times: where it slides over their seams without being lifted, it "
            "drops by up to half its settlement at each. Make these faces similar, or larger"
        )


def unlike_sides(build: Build) -> Iterator[str]:
    """Warn of contacts with less than a soft joint's given stiffness, because its two sides have
    different meshes.

    A vertex gets the smaller of both faces' area per vertex, and each side contributes half the
    stiffness: (1 + q) / 2 of k A with q the ratio of both, 0.56 for nine faces on one.
    """
    t, a = build.topology, build.arrays
    laws, _ = interfaces_of(build.case, build.group_names)
    if not any(not k.relative for law in laws for k in _given_stiffness(law)):
        return
    first, fine = flush_faces(t, ~build.paired)
    coarse = np.repeat(np.arange(len(t.face_nodes)), np.diff(first))
    share = a["face.area"] / (t.face_nodes >= 0).sum(axis=1)
    ratio = share[fine] / share[coarse]
    coarse, fine, ratio = (x[ratio < 1] for x in (coarse, fine, ratio))
    classes, count = a["face.interface_class"], build.assembly.counts["interface_classes"]
    between = a["interface.of"].reshape(count, count)[classes[coarse], classes[fine]]
    rock = np.minimum(a["face.stiffness"][coarse], a["face.stiffness"][fine])
    for number in np.unique(between):
        given = [k for k in _given_stiffness(laws[number]) if not k.relative]
        of_it = between == number
        if not given or min(k.value for k in given) >= rock[of_it].min():
            continue
        part = (1 + np.average(ratio[of_it], weights=a["face.area"][fine[of_it]])) / 2
        if part > ALIKE:
            continue
        names = sorted({t.group_names[t.face_group[f[of_it][0]]] for f in (coarse, fine)})
        yield (
            f"interface {name_of(laws[number])}: faces of {' and '.join(names)} lie on each other and "
            f"differ in size; where they are not bonded the joint has about {part:.2g} of the stiffness "
            "given. Mesh both sides alike, or give a larger stiffness"
        )


def _given_stiffness(law: Interface) -> list[Stiffness]:
    """Contact stiffnesses given by a case."""
    own = law.contact_stiffness
    several = [law.stiffness_n, law.stiffness_s] if own == AUTO else [own]
    return [k for k in several if isinstance(k, Stiffness) and k != AUTO]


def _normals(t: Topology, faces: NDArray) -> Floats:
    """Unit normals of faces."""
    nodes = t.face_nodes[faces]
    nodes = np.where(nodes < 0, nodes[:, 2:3], nodes)
    x = t.node_position[nodes]
    normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    return normal / lengths(normal)[:, None]
