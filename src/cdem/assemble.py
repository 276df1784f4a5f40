"""From topology and properties to the flat arrays of the compiled core."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cdem import shapes
from cdem.rows import first_of_each, in_pieces, lengths
from cdem.topology import Topology

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

DENSE_NODES = 16
"""Blocks of up to this many nodes get the full mass matrix: exact inertia at little cost."""
DENSE_NODES_MOST = 256
"""Larger blocks get it only if no lumped masses have the exact inertia (one element thick)."""
DEFORMED = 1.5
"""How much larger than in the stress-free mesh a face may become."""
LEAST_LUMP = 0.3
"""A corrected lumped mass may not fall below this part of the uncorrected one."""


@dataclass
class Properties:
    """What the case says, by group.

    Attributes:
        density: [kg/m3], shape (groups,).
        young_modulus: [Pa], shape (groups,).
        poisson_ratio: shape (groups,).
        interface_of: Index of the interface between two kinds of faces (see
            `Topology.face_kind`), shape (kinds, kinds).
        bonded: Whether that interface starts bonded (has cohesion or tension), the same shape.
        stiffness: (value, factor) of k_n and k_s by interface, shape (interfaces, 4).
        exact_mass: Exact inertia (default) or lumped masses as they come.
        supported: Components of nodes that are held or moved, shape (nodes, 3).
        target_step: Time step for which elements are made heavier where needed, or 0 [s].
        one_point: Whether hexahedra have one Gauss point and hourglass springs.
    """

    density: Floats
    young_modulus: Floats
    poisson_ratio: Floats
    interface_of: Ints
    bonded: NDArray[np.bool_]
    stiffness: Floats
    exact_mass: bool
    supported: NDArray[np.bool_]
    target_step: float = 0.0
    one_point: bool = False

    @property
    def lame(self) -> Floats:
        """First Lame constant by group [Pa]."""
        e, nu = self.young_modulus, self.poisson_ratio
        return e * nu / ((1 + nu) * (1 - 2 * nu))

    @property
    def shear(self) -> Floats:
        """Shear modulus by group [Pa]."""
        return self.young_modulus / (2 * (1 + self.poisson_ratio))


@dataclass
class Assembly:
    """Flat arrays of the model by name, counts, and what the audit wants to know."""

    arrays: dict[str, NDArray] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    element_mass: dict[str, Floats] = field(default_factory=dict)
    element_volume: dict[str, Floats] = field(default_factory=dict)
    element_frequency: dict[str, Floats] = field(default_factory=dict)
    added_mass: float = 0.0
    lumped_blocks: int = 0
    pair_faces: dict[str, Ints] = field(default_factory=dict)


def table(rows: NDArray, stride: int) -> NDArray:
    """Rows of numbers per item, shape (rows, items), padded to the core's stride and flattened.

    The padding repeats the last item, so that a lane that reads past the end meets sane numbers.
    """
    count = rows.shape[1]
    if count == 0:
        return np.zeros(rows.shape[0] * stride, rows.dtype)
    return np.ascontiguousarray(np.pad(rows, ((0, 0), (0, stride - count)), "edge")).ravel()


def ragged(owner: NDArray, value: NDArray, count: int) -> tuple[Ints, NDArray]:
    """Values listed by owner in the given order: starts (count + 1,) and values."""
    order = np.argsort(owner, kind="stable")
    return first_of_each(owner, count), np.ascontiguousarray(value[order])


def assemble(topology: Topology, properties: Properties, padded_stride) -> Assembly:
    """Build every array that the core's `take_model` wants.

    Args:
        topology: Blocks, elements, faces and pairs.
        properties: What the case says about them.
        padded_stride: The core's function from item count to table stride.
    """
    out = Assembly()
    out.counts = {
        "nodes": len(topology.node_position),
        "faces": len(topology.face_nodes),
        "edges": len(topology.edge_nodes),
        "interface_classes": len(properties.interface_of),
    }
    out.arrays["material.lambda"] = properties.lame
    out.arrays["material.mu"] = properties.shear
    out.arrays["material.law"] = np.zeros(len(properties.lame), np.int32)
    out.arrays["material.parameters"] = np.zeros(0)
    _elements(topology, properties, padded_stride, out)
    _faces(topology, properties, out)
    _pairs(topology, properties, padded_stride, out)
    _corners(topology, out)
    return out


def _elements(t: Topology, p: Properties, padded_stride, out: Assembly) -> None:
    row = 0
    mass: dict[str, Floats] = {}
    gravity_mass = np.zeros(len(t.node_position))
    geometry = {}
    for shape, nodes in shapes.NODES.items():
        connectivity = t.element_nodes[shape]
        count = len(connectivity)
        stride = padded_stride(count)
        corners = t.node_position[connectivity]
        group = t.element_group[shape]
        gradient, volume = shapes.reference_gradients(shape, corners)
        matrices = shapes.mass_matrices(shape, corners, p.density[group])
        hourglass = np.zeros((count, 0))
        if shape == "hex8" and p.one_point:
            gradient, volume, hourglass = shapes.one_point(
                corners, gradient, volume, p.young_modulus[group]
            )
        geometry[shape] = (gradient, volume, hourglass)
        mass[shape] = matrices
        np.add.at(gravity_mass, connectivity, matrices.sum(axis=2))
        points = volume.shape[1]
        flat = gradient[:, :, 1:].reshape(count, points * (nodes - 1) * 3)
        out.arrays[f"{shape}.nodes"] = table(connectivity.T.astype(np.int32), stride)
        out.arrays[f"{shape}.material"] = table(group[None].astype(np.int32), stride)
        out.arrays[f"{shape}.gradient"] = table(flat.T, stride)
        out.arrays[f"{shape}.volume"] = table(volume.T, stride)
        out.arrays[f"{shape}.hourglass"] = table(hourglass.T, stride)
        out.counts[f"{shape}.count"] = count
        out.counts[f"{shape}.corner_first"] = row
        row += count * nodes
        out.element_volume[shape] = volume.sum(axis=1)
        out.element_mass[shape] = matrices.sum(axis=(1, 2))
    out.counts["corner_rows"] = row
    out.arrays["node.gravity_mass"] = gravity_mass
    out.arrays["node.block"] = t.node_block
    out.arrays["node.place"] = t.node_place
    _mass(t, p, mass, geometry, out)


def _mass(t: Topology, p: Properties, matrices, geometry, out: Assembly) -> None:
    """Masses of the nodes, and the squared frequency that bounds the time step."""
    first = t.block_first_node
    size = np.diff(first)
    block_nodes = size[t.node_block]
    dense_block = (size <= DENSE_NODES) & p.exact_mass
    held = np.ones(len(size), bool)
    held[t.node_block[~p.supported.all(axis=1)]] = False
    dense_block &= ~held  # a block that cannot move needs no inverse

    while True:
        scaled, lumped, stiffness, frequency2 = _scaled_masses(
            t, p, matrices, geometry, dense_block, out
        )
        mass = lumped.copy()
        if not p.exact_mass:
            break
        without = _correct_lumps(t, scaled, lumped, mass, dense_block | held, out)
        if len(without) == 0:
            break
        dense_block[without] = True  # a full matrix has other frequencies: once more
    # u K u <= sum_e w_e^2 u_e M_e u_e: with lumped masses that is a sum over the nodes, and no
    # frequency of the mesh exceeds the largest sum_e w_e^2 m_e / m of a node
    lumped_frequency2 = stiffness / mass
    out.arrays["node.mass"] = mass
    out.arrays["node.frequency_squared"] = np.where(
        dense_block[t.node_block], frequency2, lumped_frequency2
    )
    out.arrays["node.lumped_frequency_squared"] = lumped_frequency2
    out.arrays["node.block_first"] = first[t.node_block].astype(np.int32)
    out.arrays["node.block_count"] = block_nodes.astype(np.int32)
    _dense_blocks(t, p, scaled, stiffness, dense_block, out)


def _scaled_masses(t: Topology, p: Properties, matrices, geometry, dense_block, out: Assembly):
    """Mass matrices after mass scaling; for each node its lumped mass, the sum of w_e^2 m_e over its
    elements, with the frequencies of lumped masses, and their largest w_e^2.

    The last counts elements of blocks with a full mass matrix with that, all others with lumped
    masses.
    """
    lumped = np.zeros(len(t.node_position))
    stiffness = np.zeros(len(t.node_position))
    frequency2 = np.zeros(len(t.node_position))
    scaled = {}
    out.element_frequency, out.added_mass = {}, 0.0
    for shape in shapes.NODES:
        connectivity, m = t.element_nodes[shape], matrices[shape]
        if len(m) == 0:
            scaled[shape] = m
            out.element_frequency[shape] = np.zeros(0)
            continue
        group = t.element_group[shape]
        dense = dense_block[t.element_block[shape]]
        rock = (p.lame[group], p.shear[group])
        gradient, volume, hourglass = geometry[shape]
        row_sums = m.sum(axis=2)
        lumped_square = shapes.squared_frequencies(
            shape, gradient, volume, rock[0], rock[1], row_sums, hourglass
        )
        square = lumped_square.copy()
        if dense.any():
            square[dense] = shapes.squared_frequencies(
                shape,
                gradient[dense],
                volume[dense],
                rock[0][dense],
                rock[1][dense],
                m[dense],
                hourglass[dense],
            )
        heavier = np.maximum(1.0, square * (p.target_step / 2) ** 2)
        out.added_mass += float(((heavier - 1) * out.element_mass[shape]).sum())
        scaled[shape] = m * heavier[:, None, None]
        square /= heavier
        out.element_frequency[shape] = np.sqrt(square)
        np.maximum.at(frequency2, connectivity, square[:, None])
        np.add.at(stiffness, connectivity, lumped_square[:, None] * row_sums)
        np.add.at(lumped, connectivity, row_sums * heavier[:, None])
    return scaled, lumped, stiffness, frequency2


def _second_moments(t: Topology, scaled, blocks: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Exact centre (sum m x) and second moments (sum m x x^T) of blocks about their first node."""
    origin = t.node_position[t.block_first_node[:-1]]
    second = np.zeros((len(blocks), 3, 3))
    for shape, m in scaled.items():
        some = blocks[t.element_block[shape]]
        if not some.any():
            continue
        block = t.element_block[shape][some]
        x = t.node_position[t.element_nodes[shape][some]] - origin[block][:, None]
        np.add.at(second, block, np.einsum("eij,eix,ejy->exy", m[some], x, x, optimize=True))
    return origin, second


def _correct_lumps(
    t: Topology, scaled, lumped: Floats, mass: Floats, skip, out: Assembly
) -> NDArray[np.intp]:
    """Shift the lumped masses of larger blocks, as little as possible, to their exact inertia.

    Minimises sum (m - m_lumped)^2 / m_lumped with mass, centre and second moments given. Blocks for
    which that needs a mass near zero (one element thick) are returned if small enough for the full
    mass matrix; else they keep their lumped masses and are counted for the audit.
    """
    todo = np.flatnonzero(~skip)
    without: list[int] = []
    out.lumped_blocks = 0
    if len(todo) == 0:
        return np.array(without, np.intp)
    origin, second = _second_moments(t, scaled, ~skip)
    upper = np.triu_indices(3)
    for b in todo:
        nodes = slice(t.block_first_node[b], t.block_first_node[b + 1])
        m = lumped[nodes]
        x = t.node_position[nodes] - origin[b]
        center = m @ x / m.sum()
        x = x - center
        exact = second[b] - m.sum() * np.outer(center, center)
        scale = np.sqrt(np.trace(exact) / m.sum())
        x, exact = x / scale, exact / scale**2
        rows = np.vstack([np.ones(len(m)), x.T, (x[:, upper[0]] * x[:, upper[1]]).T])
        target = np.concatenate([[m.sum()], np.zeros(3), exact[upper]])
        shift = m * (
            rows.T @ np.linalg.lstsq((rows * m) @ rows.T, target - rows @ m, rcond=1e-12)[0]
        )
        good = np.abs(rows @ (m + shift) - target).max() < 1e-9 * m.sum()
        if good and (m + shift > LEAST_LUMP * m).all():
            mass[nodes] = m + shift
        elif len(m) <= DENSE_NODES_MOST:
            without.append(int(b))
        else:
            out.lumped_blocks += 1
    return np.array(without, np.intp)


def _dense_blocks(
    t: Topology, p: Properties, scaled, stiffness: Floats, dense_block, out: Assembly
) -> None:
    """Mass matrices of small blocks, each row over its node's mass, and their inverses, each row
    times its node's mass, with supported nodes taken out."""
    mass, frequency2 = out.arrays["node.mass"], out.arrays["node.frequency_squared"]
    first, size = t.block_first_node, np.diff(t.block_first_node)
    dense_first = np.full(len(mass), -1, np.int32)
    dense_step = np.zeros(len(mass), np.int32)
    bound = 1 / mass
    held = np.zeros(len(size), bool)
    held[t.node_block[p.supported.any(axis=1)]] = True

    inverse, matrix, place = [np.zeros(0)], [np.zeros(0)], 0

    def keep(nodes: NDArray, inverses: Floats, matrices: Floats) -> None:
        """Nodes of blocks, (blocks, n), with a matrix for each or for all, or one for each axis."""
        nonlocal place
        n = nodes.shape[1]
        step = matrices[0].size
        rows = place + step * np.arange(len(matrices))[:, None] + n * np.arange(n)
        dense_first[nodes] = rows
        dense_step[nodes] = n * n if matrices.ndim == 4 else 0
        inverse.append(inverses.ravel())
        matrix.append(matrices.ravel())
        place += matrices.size

    for n in np.unique(size[dense_block]):
        free = np.flatnonzero(dense_block & ~held & (size == n))
        bound_to = np.flatnonzero(dense_block & held & (size == n))
        if n == 4 and len(free):  # tets: all have the same over their mass
            nodes = first[free][:, None] + np.arange(n)
            bound[nodes] = 5 / mass[nodes]
            keep(nodes, (5 * np.eye(4) - 1)[None], ((1 + np.eye(4)) / 5)[None])
            free = free[:0]
        for blocks in (free, bound_to):
            if len(blocks) == 0:
                continue
            nodes = first[blocks][:, None] + np.arange(n)
            m = _block_matrices(t, scaled, blocks, int(n))
            bound[nodes] = (1 / np.linalg.eigvalsh(m)[:, 0])[:, None]
            # K <= diag(stiffness) as well, which the worst element alone often exceeds
            root = np.sqrt(stiffness[nodes])
            least = np.linalg.eigvalsh(m / root[:, :, None] / root[:, None])[:, 0]
            frequency2[nodes] = np.minimum(frequency2[nodes], 1 / least[:, None])
            if blocks is bound_to:
                inverses = np.array([
                    _supported_inverse(one, p.supported[first[b] : first[b + 1]])
                    for one, b in zip(m, blocks, strict=True)
                ])  # fmt: skip
                m = np.repeat(m[:, None], 3, axis=1)
                per_row = mass[nodes][:, None, :, None]
            else:
                inverses = np.linalg.inv(m)
                per_row = mass[nodes][:, :, None]
            keep(nodes, inverses * per_row, m / per_row)
    out.arrays["node.mass_row_first"] = dense_first
    out.arrays["node.mass_axis_stride"] = dense_step
    out.arrays["node.inverse_mass_bound"] = bound
    out.arrays["mass.inverse"] = np.concatenate(inverse)
    out.arrays["mass.matrix"] = np.concatenate(matrix)


def _block_matrices(t: Topology, scaled, blocks: NDArray, n: int) -> Floats:
    place = np.full(len(t.block_first_node) - 1, -1)
    place[blocks] = np.arange(len(blocks))
    m = np.zeros((len(blocks), n, n))
    for shape, matrices in scaled.items():
        where = place[t.element_block[shape]]
        some = where >= 0
        if not some.any():
            continue
        nodes = t.element_nodes[shape][some]
        local = nodes - t.block_first_node[t.element_block[shape][some]][:, None]
        np.add.at(
            m, (where[some][:, None, None], local[:, :, None], local[:, None]), matrices[some]
        )
    return m


def _supported_inverse(m: Floats, supported: NDArray[np.bool_]) -> Floats:
    """Inverse per axis of the part of a mass matrix that is free along it, zero elsewhere."""
    out = np.zeros((3, *m.shape))
    for axis in range(3):
        free = np.flatnonzero(~supported[:, axis])
        if len(free):
            out[axis][np.ix_(free, free)] = np.linalg.inv(m[np.ix_(free, free)])
    return out


def face_heights(t: Topology, volumes: dict[str, Floats], area: Floats) -> Floats:
    """Height of the element behind each face above it [m]: the h of k_n = factor E / h."""
    # volume = area * height / divisor, for a prism 1 and for a pyramid 3; the sides of a wedge stand
    # across from an edge (2), those of a pyramid between the two cases
    by_sides = {
        "tet4": (3.0, 3.0),
        "pyramid5": (3.0, 3.0),
        "wedge6": (1.0, 2.0),
        "hex8": (1.0, 1.0),
    }
    triangle, quad = (
        np.concatenate([by_sides[s][k] * volumes[s] for s in shapes.NODES]) for k in (0, 1)
    )
    return np.where(t.face_nodes[:, 3] < 0, triangle[t.face_element], quad[t.face_element]) / area


def face_areas(position: Floats, face_nodes: NDArray) -> Floats:
    """Area of triangles and (mean-plane) quadrilaterals [m2], shape (faces,)."""
    x = position[np.where(face_nodes < 0, face_nodes[:, 2:3], face_nodes)]
    return 0.5 * lengths(np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]))


def _faces(t: Topology, p: Properties, out: Assembly) -> None:
    def geometry(nodes: NDArray) -> Floats:
        """Area, mean and largest distance of the vertices from their middle."""
        x = t.node_position[np.where(nodes < 0, nodes[:, 2:3], nodes)]
        inside = (nodes >= 0).astype(float)
        corners = inside.sum(axis=1)
        center = np.einsum("fkx,fk->fx", x, inside) / corners[:, None]
        distance = lengths(x - center[:, None]) * inside
        area = face_areas(t.node_position, nodes)
        return np.stack([area, distance.sum(axis=1) / corners, distance.max(axis=1)], axis=1)

    area, length, reach = in_pieces(geometry, t.face_nodes).T.copy()
    young = p.young_modulus[t.face_group]
    height = face_heights(t, out.element_volume, area)
    out.arrays |= {
        "face.nodes": t.face_nodes.ravel(),
        "face.edges": t.face_edges.ravel(),
        "face.interface_class": t.face_kind,
        "face.block": t.face_block,
        "face.element": t.face_element,
        "face.length": length,
        "face.reach": DEFORMED * reach,
        "face.area": area,
        "face.height": height,
        "face.stiffness": young / height,
        "face.movable": _movable(t, p),
        "edge.nodes": t.edge_nodes.ravel(),
        "edge.faces": t.edge_faces.ravel(),
        "edge_star.first": t.node_ring_first,
        "edge_star.node": t.node_ring,
        "interface.of": p.interface_of.astype(np.int32).ravel(),
    }


def _movable(t: Topology, p: Properties) -> NDArray[np.int8]:
    """Whether a face's block can move at all; two that cannot need not be searched for contact."""
    free = np.zeros(len(t.block_group), np.int8)
    free[t.node_block[~p.supported.all(axis=1)]] = 1
    return free[t.face_block]


def _pairs(t: Topology, p: Properties, padded_stride, out: Assembly) -> None:
    a, b = t.pair_faces.T
    bonded = p.bonded[t.face_kind[a], t.face_kind[b]] if len(a) else np.zeros(0, bool)
    corners = (t.face_nodes >= 0).sum(axis=1)
    exposed = np.ones(len(corners), np.int8)
    exposed[t.pair_faces[bonded].ravel()] = 0
    out.arrays["face.initially_exposed"] = exposed
    empty_real, empty_int = np.zeros(0), np.zeros(0, np.int32)
    for kind, n in (("triangles", 3), ("quads", 4)):
        some = bonded & (corners[a] == n) if len(a) else bonded
        faces, shift = t.pair_faces[some], t.pair_shift[some]
        k = np.arange(n)
        node_a = t.face_nodes[faces[:, 0]][:, :n]
        node_b = np.take_along_axis(t.face_nodes[faces[:, 1]], (shift[:, None] - k) % n, axis=1)
        count, stride = len(faces), padded_stride(len(faces))
        _pair_set(kind, faces, out.arrays["face.area"][faces[:, 0]], t, p, stride, out)
        nodes = np.concatenate([node_a, node_b], axis=1).astype(np.int32)
        out.arrays[f"{kind}.nodes"] = table(nodes.T, stride)
        out.arrays[f"{kind}.point_first"] = empty_int
        for name in ("weights_a", "weights_b", "point_area"):
            out.arrays[f"{kind}.{name}"] = empty_real
        out.counts[f"{kind}.count"] = count
        out.counts[f"{kind}.corner_first"] = out.counts["corner_rows"]
        out.counts["corner_rows"] += count * n

    faces = t.overlap_faces
    count, stride = len(faces), padded_stride(len(faces))
    area = np.add.reduceat(t.overlap_area, t.overlap_first[:-1]) if count else np.zeros(0)
    _pair_set("overlaps", faces, area, t, p, stride, out)
    out.arrays |= {
        "overlaps.nodes": empty_int,
        "overlaps.point_first": t.overlap_first.astype(np.int32),
        "overlaps.weights_a": t.overlap_weights_a.ravel(),
        "overlaps.weights_b": t.overlap_weights_b.ravel(),
        "overlaps.point_area": t.overlap_area,
    }
    out.counts |= {
        "overlaps.count": count,
        "overlaps.points": len(t.overlap_area),
        "overlaps.corner_first": out.counts["corner_rows"],
    }
    out.counts["corner_rows"] += count * 8


def _pair_set(kind, faces, area, t: Topology, p: Properties, stride: int, out: Assembly) -> None:
    sides = t.face_kind[faces].reshape(-1, 2)
    interface = p.interface_of[sides[:, 0], sides[:, 1]].astype(np.int32)
    out.pair_faces[kind] = faces
    out.arrays[f"{kind}.faces"] = faces.astype(np.int32).ravel()
    out.arrays[f"{kind}.interface"] = table(interface[None], stride)
    out.arrays[f"{kind}.area"] = table(area[None], stride)
    out.arrays[f"{kind}.stiffness"] = pair_stiffness(out, kind, p.stiffness, interface, stride)


def pair_stiffness(out: Assembly, kind: str, laws: Floats, interface: Ints, stride: int) -> Floats:
    """k_n and k_s of each pair [Pa/m] from its interface and the stiffer of its two sides."""
    faces = out.pair_faces[kind]
    stiffer = out.arrays["face.stiffness"][faces].reshape(-1, 2).max(axis=1, initial=0.0)
    law = laws[interface]
    rows = [np.where(law[:, i] > 0, law[:, i], law[:, i + 1] * stiffer) for i in (0, 2)]
    return table(np.array(rows), stride)


def _corners(t: Topology, out: Assembly) -> None:
    owner, row = [], []
    for shape in shapes.NODES:
        nodes = t.element_nodes[shape].ravel()
        owner.append(nodes)
        row.append(out.counts[f"{shape}.corner_first"] + np.arange(len(nodes)))
    for kind, n in (("triangles", 3), ("quads", 4)):
        count = out.counts[f"{kind}.count"]
        nodes = out.arrays[f"{kind}.nodes"].reshape(2, n, -1)[..., :count]
        rows = out.counts[f"{kind}.corner_first"] + np.arange(count * n).reshape(count, n).T
        owner.append(nodes.transpose(2, 0, 1).ravel())
        row.append(np.stack([~rows, rows]).transpose(2, 0, 1).ravel())  # force and reaction
    nodes = t.face_nodes[t.overlap_faces].reshape(-1)
    used = nodes >= 0
    owner.append(nodes[used])
    row.append(out.counts["overlaps.corner_first"] + np.flatnonzero(used))
    first, listed = ragged(
        np.concatenate(owner).astype(np.int64), np.concatenate(row).astype(np.int32),
        len(t.node_position),
    )  # fmt: skip
    out.arrays["corner.first"] = first
    out.arrays["corner.row"] = listed
