"""From topology and properties to the flat arrays of the compiled core."""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np
from numpy.typing import NDArray

from cdem.mesh import element_shapes
from cdem.mesh.arrays import in_pieces, lengths, same_everywhere
from cdem.mesh.topology import Topology
from cdem.model.faces import face_areas, face_heights
from cdem.model.flat_arrays import Assembly, Floats, Ints, Properties, ragged, table
from cdem.model.flush import flush_rows
from cdem.model.mass_scaling import OFFER, Scaling
from cdem.model.masses import Geometry, node_masses
from cdem.model.module import Module

Stride = Callable[[int], int]
"""The core's function from item count to table stride."""
DEFORMED = 1.5
"""Largest growth of a face over its stress-free size."""


def assemble(
    topology: Topology, properties: Properties, padded_stride: Stride, modules: Collection[Module]
) -> Assembly:
    """Build every array of the core's `take_model`, except arrays of modules.

    Args:
        topology: Blocks, elements, faces and pairs.
        properties: Properties from the case.
        padded_stride: The core's function from item count to table stride.
        modules: Modules of the model; their corner rows follow the rows of pairs.
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
    out.arrays["material.law"] = properties.law
    out.arrays["material.parameters"] = properties.law_parameters.ravel()
    _elements(topology, properties, padded_stride, out)
    _faces(topology, properties, out)
    _pairs(topology, properties, padded_stride, out)
    _corners(topology, modules, out)
    nodes = len(topology.node_position)
    out.module_stiffness = sum((m.node_stiffness(nodes) for m in modules), np.zeros(nodes))
    if properties.added_mass is None:
        _scale_masses(topology, properties, out)
    return out


def _element_tables(t: Topology, p: Properties, shape: str) -> tuple[Geometry, Floats]:
    """Geometry and mass matrices of the elements of a shape."""
    corners, group = t.node_position[t.element_nodes[shape]], t.element_group[shape]
    gradient, volume = element_shapes.reference_gradients(shape, corners)
    hourglass = np.zeros((len(corners), 0))
    if shape == "hex8" and p.one_point:
        gradient, volume, hourglass = element_shapes.one_point(
            corners, gradient, volume, p.stiffening[group] * p.young_modulus[group]
        )
    matrices = element_shapes.mass_matrices(shape, corners, p.density[group])
    return (gradient, volume, hourglass), matrices


def _elements(t: Topology, p: Properties, padded_stride: Stride, out: Assembly) -> None:
    row = 0
    mass: dict[str, Floats] = {}
    gravity_mass = np.zeros(len(t.node_position))
    geometry = {}
    for shape, nodes in element_shapes.NODES.items():
        connectivity = t.element_nodes[shape]
        count = len(connectivity)
        stride = padded_stride(count)
        group = t.element_group[shape]
        geometry[shape], matrices = _element_tables(t, p, shape)
        gradient, volume, hourglass = geometry[shape]
        mass[shape] = matrices
        np.add.at(gravity_mass, connectivity, matrices.sum(axis=2))
        points = volume.shape[1]
        flat = gradient[:, :, 1:].reshape(count, points * (nodes - 1) * 3)
        out.arrays[f"{shape}.nodes"] = table(connectivity.T.astype(np.int32), stride)
        out.arrays[f"{shape}.material"] = table(group[None].astype(np.int32), stride)
        out.arrays[f"{shape}.gradient"] = table(flat.T, stride)
        out.arrays[f"{shape}.volume"] = table(volume.T, stride)
        out.arrays[f"{shape}.hourglass"] = table(hourglass.T, stride)
        out.arrays[f"{shape}.values"] = np.zeros(0)  # used by water in pores
        out.arrays[f"{shape}.nodal_mean"] = table(_averaged(t, p, shape), stride)
        out.counts[f"{shape}.count"] = count
        out.counts[f"{shape}.corner_first"] = row
        row += count * nodes
        out.element_volume[shape] = volume.sum(axis=1)
        out.element_mass[shape] = matrices.sum(axis=(1, 2))
    out.counts["corner_rows"] = 0  # elements have tiles
    out.arrays["node.gravity_mass"] = gravity_mass
    out.arrays["node.block"] = t.node_block
    out.arrays["node.place"] = t.node_place
    out.added_mass = np.zeros(len(t.node_position)) if p.added_mass is None else p.added_mass
    node_masses(t, p, mass, geometry, out.added_mass, out)


def _averaged(t: Topology, p: Properties, shape: str) -> NDArray[np.int8]:
    """Whether elements average their dilatation at the nodes, shape (1, elements): tets of blocks of
    several tets with a plastic material. Shape (0, elements) if none does."""
    block = t.node_block[t.element_nodes[shape][:, 0]]
    several = np.bincount(block, minlength=len(t.block_group))[block] > 1
    averaged = several & p.nodal_mean[t.element_group[shape]] & (shape == "tet4")
    return averaged[None][: int(averaged.any())].astype(np.int8)


def _scale_masses(t: Topology, p: Properties, out: Assembly) -> None:
    """Add mass as the case asks, and note the gain of a little mass."""
    scaling = Scaling(t, p, out)
    bought = scaling.added(scaling.limit(OFFER)) if scaling.free_mass > 0 else 0 * out.added_mass
    out.limits = (scaling.limit_at_the_start(0 * bought), scaling.limit_at_the_start(bought))
    out.free_mass = scaling.free_mass
    if p.mass_scaling is None:
        return
    out.added_mass = scaling.wanted(p.mass_scaling, p.safety)
    tables = {shape: _element_tables(t, p, shape) for shape in element_shapes.NODES}
    geometry = {shape: of for shape, (of, _) in tables.items()}
    node_masses(t, p, {shape: m for shape, (_, m) in tables.items()}, geometry, out.added_mass, out)


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
    height = face_heights(t, np.concatenate(list(out.element_volume.values())), area)
    flush_first, flush = flush_rows(t, p.flush)
    beside_flush = np.zeros(len(t.node_position), np.int8)
    of_flush = t.face_nodes[np.diff(flush_first) > 0]
    beside_flush[of_flush[of_flush >= 0]] = 1
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
        "face.radius": _radius(t, p, out),
        "flush.first": flush_first,
        "flush.face": flush,
        "node.flush": beside_flush,
        "edge.nodes": t.edge_nodes.ravel(),
        "edge.faces": t.edge_faces.ravel(),
        "edge_star.first": t.node_ring_first,
        "edge_star.node": t.node_ring,
        "interface.of": p.interface_of.astype(np.int32).ravel(),
    }


def _movable(t: Topology, p: Properties) -> NDArray[np.int8]:
    """Whether a face's block moves at all; contacts between two fixed blocks need no search."""
    free = np.zeros(len(t.block_group), np.int8)
    free[t.node_block[p.driven | ~p.supported.all(axis=1)]] = 1
    return free[t.face_block]


def _radius(t: Topology, p: Properties, out: Assembly) -> Floats:
    """Radius of a sphere of the volume of a face's block [m]; 1e300 for a fixed block."""
    volume = np.zeros(len(t.block_group))
    for shape, of_elements in out.element_volume.items():
        np.add.at(volume, t.node_block[t.element_nodes[shape][:, 0]], of_elements)
    radius = same_everywhere(np.cbrt(0.75 / np.pi * volume))[t.face_block]
    return np.where(_movable(t, p), radius, 1e300)


def _pairs(t: Topology, p: Properties, padded_stride: Stride, out: Assembly) -> None:
    a, b = t.pair_faces.T
    bonded = p.paired[t.face_kind[a], t.face_kind[b]] if len(a) else np.zeros(0, bool)
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


def _pair_set(
    kind: str,
    faces: Ints,
    area: Floats,
    t: Topology,
    p: Properties,
    stride: int,
    out: Assembly,
) -> None:
    sides = t.face_kind[faces].reshape(-1, 2)
    interface = p.interface_of[sides[:, 0], sides[:, 1]].astype(np.int32)
    out.pair_faces[kind] = faces
    out.arrays[f"{kind}.faces"] = faces.astype(np.int32).ravel()
    out.arrays[f"{kind}.interface"] = table(interface[None], stride)
    out.arrays[f"{kind}.area"] = table(area[None], stride)
    stiffer = out.arrays["face.stiffness"][faces].reshape(-1, 2).max(axis=1, initial=0.0)
    law = p.stiffness[interface]
    rows = [np.where(law[:, i] > 0, law[:, i], law[:, i + 1] * stiffer) for i in (0, 2)]
    own = p.bond_stiffness[faces].reshape(-1, 2)
    both = (own > 0).all(axis=1) & p.automatic[interface]
    in_series = 2 * own[:, 0] * own[:, 1] / np.maximum(own.sum(axis=1), 1e-300)
    rows = [np.where(both, in_series, row) for row in rows]
    out.arrays[f"{kind}.stiffness"] = table(np.array(rows), stride)
    out.arrays[f"{kind}.strength"] = _strength(faces, interface, p, stride)


def _strength(faces: Ints, interface: Ints, p: Properties, stride: int) -> Floats:
    """Factors on the strength of pairs; empty where no interface is heterogeneous."""
    if not any(p.strength_factors):
        return np.zeros(0)
    factor = np.ones(len(faces))
    for index, factors in enumerate(p.strength_factors):
        own = interface == index
        if factors is not None and own.any():
            factor[own] = factors(faces[own])
    return table(factor[None], stride)


def _corners(t: Topology, modules: Collection[Module], out: Assembly) -> None:
    """List the corner rows of each node: rows of pairs, then rows of modules."""
    owner, row = [], []
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
    for module in modules:
        nodes = module.corner_nodes()
        if not len(nodes):
            continue
        owner.append(nodes[nodes >= 0])
        row.append(out.counts["corner_rows"] + np.flatnonzero(nodes >= 0))
        out.counts[f"{module.name}.corner_first"] = out.counts["corner_rows"]
        out.counts["corner_rows"] += len(nodes)
    first, listed = ragged(
        np.concatenate(owner).astype(np.int64), np.concatenate(row).astype(np.int32),
        len(t.node_position),
    )  # fmt: skip
    out.arrays["corner.first"] = first
    out.arrays["corner.row"] = listed
