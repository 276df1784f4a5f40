"""The four element shapes: shape functions, Gauss rules, mass and stiffness of the stress-free mesh.

Everything here runs once, when a model is built; the step's kernels only read the result.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.arrays import determinant, in_pieces, matrix_product, same_everywhere

Array = NDArray[np.float64]

NODES = {"tet4": 4, "pyramid5": 5, "wedge6": 6, "hex8": 8}
"""Nodes of each shape, in the order of element numbers."""

_HEX_CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1]]
    + [[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
    dtype=float,
)


def _shape_tet4(p: Array) -> tuple[Array, Array]:
    values = np.column_stack([1 - p.sum(axis=1), p])
    slopes = np.tile(np.vstack([[-1.0, -1.0, -1.0], np.eye(3)]), (len(p), 1, 1))
    return values, slopes


def _shape_hex8(p: Array) -> tuple[Array, Array]:
    factors = 1 + p[:, None, :] * _HEX_CORNERS  # (points, 8, 3)
    values = factors.prod(axis=2) / 8
    slopes = np.stack(
        [
            _HEX_CORNERS[:, a] * factors[..., (a + 1) % 3] * factors[..., (a + 2) % 3] / 8
            for a in range(3)
        ],
        axis=2,
    )
    return values, slopes


def _shape_wedge6(p: Array) -> tuple[Array, Array]:
    r, s, t = p.T
    triangle = np.stack([1 - r - s, r, s], axis=1)
    triangle_slopes = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    low, high = (1 - t)[:, None] / 2, (1 + t)[:, None] / 2
    values = np.concatenate([triangle * low, triangle * high], axis=1)
    slopes = np.empty((len(p), 6, 3))
    for axis in range(2):
        slopes[:, :3, axis] = triangle_slopes[:, axis] * low
        slopes[:, 3:, axis] = triangle_slopes[:, axis] * high
    slopes[:, :3, 2] = -triangle / 2
    slopes[:, 3:, 2] = triangle / 2
    return values, slopes


def _shape_pyramid5(p: Array) -> tuple[Array, Array]:
    # rational functions on the base [-1, 1]^2 with the apex at z = 1
    x, y, z = p.T
    up = 1 - z
    sign = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
    a = up[:, None] + x[:, None] * sign[:, 0]
    b = up[:, None] + y[:, None] * sign[:, 1]
    values = np.column_stack([a * b / (4 * up[:, None]), z])
    slopes = np.zeros((len(p), 5, 3))
    slopes[:, :4, 0] = sign[:, 0] * b / (4 * up[:, None])
    slopes[:, :4, 1] = sign[:, 1] * a / (4 * up[:, None])
    slopes[:, :4, 2] = (a * b / up[:, None] - a - b) / (4 * up[:, None])
    slopes[:, 4, 2] = 1
    return values, slopes


_FUNCTIONS = {
    "tet4": _shape_tet4,
    "pyramid5": _shape_pyramid5,
    "wedge6": _shape_wedge6,
    "hex8": _shape_hex8,
}


def shape_functions(shape: str, points: Array) -> tuple[Array, Array]:
    """Shape functions at points of the reference element, (points, nodes), and their slopes."""
    return _FUNCTIONS[shape](points)


def _line(count: int) -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(count)


def _box_rule(count: int) -> tuple[Array, Array]:
    x, w = _line(count)
    points = np.array([(x[i], x[j], x[k]) for k, j, i in product(range(count), repeat=3)])
    weights = np.array([w[i] * w[j] * w[k] for k, j, i in product(range(count), repeat=3)])
    return points, weights


def _collapsed(shape: str, count: int) -> tuple[Array, Array]:
    """A rule of high degree from a box: collapse it onto the tetrahedron, wedge or pyramid."""
    box, weight = _box_rule(count)
    u, v, w = ((box + 1) / 2).T
    if shape == "tet4":
        points = np.column_stack([u * (1 - v) * (1 - w), v * (1 - w), w])
        return points, weight / 8 * (1 - v) * (1 - w) ** 2
    if shape == "wedge6":
        return np.column_stack([u * (1 - v), v, box[:, 2]]), weight / 4 * (1 - v)
    points = np.column_stack([box[:, 0] * (1 - w), box[:, 1] * (1 - w), w])
    return points, weight / 2 * (1 - w) ** 2


HOURGLASS = np.stack([_HEX_CORNERS[:, list(axes)].prod(axis=1) for axes in ((0, 1), (1, 2), (2, 0), (0, 1, 2))])  # fmt: skip
"""Patterns rs, st, tr, rst of the hourglass modes of a hexahedron, shape (4, 8)."""


def one_point(
    corners: Array, gradient: Array, volume: Array, young: Array
) -> tuple[Array, Array, Array]:
    """Hexahedra with one point: the mean gradients, and springs against hourglass modes.

    Args:
        corners: Node positions [m], shape (elements, 8, 3).
        gradient: Gradients of the full rule, from `reference_gradients`.
        volume: Volumes of the full rule.
        young: Young's modulus [Pa], shape (elements,).

    Returns:
        Gradients (elements, 1, 8, 3), volumes (elements, 1), and for each element the moments
        sum G_ak X_k of the four modes [m] and the stiffness E V^(1/3) / 48 [N/m], shape
        (elements, 13): bending of a cube is then that of a beam.
    """
    whole = volume.sum(axis=1, keepdims=True)
    mean = np.einsum("epnx,ep->enx", gradient, volume)[:, None] / whole[:, :, None, None]
    moments = np.einsum("an,enx->eax", HOURGLASS, corners).reshape(len(corners), 12)
    stiffness = young[:, None] * same_everywhere(np.cbrt(whole)) / 48
    return mean, whole, np.concatenate([moments, stiffness], axis=1)


def _stiffness_rule(shape: str) -> tuple[Array, Array]:
    """Points and weights of the element forces; the kernels have the same number of points."""
    if shape == "tet4":
        return np.full((1, 3), 0.25), np.array([1 / 6])
    if shape == "hex8":
        return _box_rule(2)
    if shape == "wedge6":
        triangle = np.array([[1 / 6, 1 / 6], [2 / 3, 1 / 6], [1 / 6, 2 / 3]])
        t = 1 / np.sqrt(3)
        points = [(*rs, z) for z in (-t, t) for rs in triangle]
        return np.array(points), np.full(6, 1 / 6)
    # pyramid, degree 2: four points at a quarter of the height's lower part and one on the axis,
    # from the moments of 1, z, z^2, x^2, x^2 z
    a = np.sqrt(32 / 135)
    points = [(i * a, j * a, 1 / 6) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return np.array([*points, (0, 0, 0.7)]), np.array([9 / 32] * 4 + [5 / 24])


def reference_gradients(shape: str, corners: Array) -> tuple[Array, Array]:
    """Gradients and volumes of the Gauss points of the stress-free mesh.

    Args:
        shape: "tet4", "pyramid5", "wedge6" or "hex8".
        corners: Node positions [m], shape (elements, nodes, 3).

    Returns:
        dN/dX [1/m], shape (elements, points, nodes, 3), and w J [m3], shape (elements, points).
    """
    jacobian, slopes, weights = _jacobians(shape, corners)
    a, b, c = (jacobian[:, :, row] for row in range(3))
    cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=2)
    whole = determinant(jacobian)
    gradient = matrix_product(slopes, cofactors / whole[..., None, None])
    return gradient, weights * whole


def volumes(shape: str, corners: Array) -> Array:
    """Volume of each Gauss point as in `reference_gradients` [m3], also of folded elements."""
    jacobian, _, weights = _jacobians(shape, corners)
    return weights * determinant(jacobian)


def _jacobians(shape: str, corners: Array) -> tuple[Array, Array, Array]:
    """dX_x / dr_r at the Gauss points, row r; slopes of the shape functions; weights."""
    points, weights = _stiffness_rule(shape)
    _, slopes = _FUNCTIONS[shape](points)
    return matrix_product(slopes.transpose(0, 2, 1), corners[:, None]), slopes, weights


def gauss_positions(shape: str, corners: Array) -> Array:
    """Gauss points of `reference_gradients` [m], shape (elements, points, 3)."""
    values, _ = _FUNCTIONS[shape](_stiffness_rule(shape)[0])
    return matrix_product(values, corners)


def point_values(shape: str, *, one: bool = False) -> Array:
    """Shape functions at the Gauss points, or at one in the middle [1], shape (points, nodes)."""
    points, weights = _stiffness_rule(shape)
    values, _ = _FUNCTIONS[shape](points)
    return np.average(values, axis=0, weights=weights)[None] if one else values


def mass_matrices(shape: str, corners: Array, density: Array) -> Array:
    """Consistent mass matrix of each element [kg], shape (elements, nodes, nodes).

    Its total mass, centre and inertia tensor are those of the solid, because positions are a
    combination of the shape functions.
    """
    if shape == "tet4":
        edges = corners[:, 1:] - corners[:, :1]
        return (density * determinant(edges) / 120)[:, None, None] * (np.ones((4, 4)) + np.eye(4))
    points, weights = _box_rule(3) if shape == "hex8" else _collapsed(shape, 4)
    values, slopes = _FUNCTIONS[shape](points)
    volume = np.empty((len(corners), len(points)))
    for p in range(len(points)):
        jacobian = matrix_product(corners.transpose(0, 2, 1), slopes[p])
        volume[:, p] = weights[p] * determinant(jacobian)
    return np.einsum("ep,pij->eij", density[:, None] * volume, values[:, :, None] * values[:, None])


def strain_rows(shape: str, gradient: Array, volume: Array) -> Array:
    """Strain matrix B in Voigt order xx yy zz xy yz zx (engineering shear); B-bar for hexahedra."""
    elements, points, nodes, _ = gradient.shape
    b: Array = np.zeros((elements, points, 6, nodes, 3))
    gx, gy, gz = (gradient[..., axis] for axis in range(3))
    b[:, :, 0, :, 0] = gx
    b[:, :, 1, :, 1] = gy
    b[:, :, 2, :, 2] = gz
    b[:, :, 3, :, 0], b[:, :, 3, :, 1] = gy, gx
    b[:, :, 4, :, 1], b[:, :, 4, :, 2] = gz, gy
    b[:, :, 5, :, 2], b[:, :, 5, :, 0] = gx, gz
    b = b.reshape(elements, points, 6, nodes * 3)
    if shape == "hex8":
        trace = b[:, :, :3].sum(axis=2)
        mean = np.einsum("epk,ep->ek", trace, volume) / volume.sum(axis=1)[:, None]
        b[:, :, :3] += ((mean[:, None] - trace) / 3)[:, :, None]
    return b


def lame_constants(young: Array, poisson: Array) -> tuple[Array, Array]:
    """First Lame constant and shear modulus [Pa] of Young's modulus [Pa] and Poisson's ratio."""
    return young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))


def elasticity(lame: Array, shear: Array) -> Array:
    """[D] of Eq. 2 [Pa], shape (elements, 6, 6), for engineering shear strains."""
    d = np.zeros((len(lame), 6, 6))
    d[:, :3, :3] = lame[:, None, None]
    for axis in range(3):
        d[:, axis, axis] += 2 * shear
        d[:, 3 + axis, 3 + axis] = shear
    return d


def squared_frequencies(
    shape: str,
    gradient: Array,
    volume: Array,
    lame: Array,
    shear: Array,
    mass: Array,
    hourglass: Array,
) -> Array:
    """Largest squared eigenfrequency of each free element [1/s2], exact.

    The largest over the elements is an upper bound for the mesh.

    Args:
        shape: Shape of the elements.
        gradient: As from `reference_gradients`.
        volume: As from `reference_gradients`.
        lame: First Lame constant [Pa], shape (elements,).
        shear: Shear modulus [Pa], shape (elements,).
        mass: Lumped masses (elements, nodes) or mass matrices (elements, nodes, nodes) [kg].
        hourglass: As from `one_point`, or of shape (elements, 0).
    """
    if shape == "tet4":
        inertia = mass[:, 0] if mass.ndim == 2 else mass[:, 0, 0] - mass[:, 0, 1]
        largest = in_pieces(_largest_of_tets, gradient[:, 0], lame, shear)
        return volume[:, 0] / inertia * largest
    keys = np.concatenate(
        [a.reshape(len(volume), -1) for a in (gradient, volume, lame, shear, mass, hourglass)],
        axis=1,
    )
    scale = np.abs(keys).max(axis=0, keepdims=True) + 1e-300
    # equal elements need one solution: a grid has few kinds
    _, first, kind = np.unique(
        np.round(keys / scale, 10), axis=0, return_index=True, return_inverse=True
    )
    largest = np.empty(len(first))
    for start in range(0, len(first), 4096):
        some = first[start : start + 4096]
        largest[start : start + 4096] = _largest_eigenvalue(
            strain_rows(shape, gradient[some], volume[some]),
            volume[some],
            elasticity(lame[some], shear[some]),
            mass[some],
            _hourglass_rows(gradient[some], hourglass[some]),
        )
    return largest[kind.reshape(-1)]


def _largest_of_tets(gradient: Array, lame: Array, shear: Array) -> Array:
    """Largest eigenvalue of B^T D B of tets of unit volume [Pa/m2], in closed form.

    Along the principal axes of G = sum g g^T, with squares g_1 >= g_2 >= g_3, shear strains
    are decoupled, with mu (g_i + g_j), and axial ones have lambda sqrt(g_i g_j) + 2 mu g_i
    delta_ij. All four masses of a tet are equal, lumped or not, and its gradients sum to zero.
    """
    squares = _eigenvalues(gradient.transpose(0, 2, 1) @ gradient)
    root = np.sqrt(np.maximum(squares, 0.0))
    axial = lame[:, None, None] * root[:, :, None] * root[:, None]
    for axis in range(3):
        axial[:, axis, axis] += 2 * shear * squares[:, axis]
    return np.maximum(shear * (squares[:, 0] + squares[:, 1]), _eigenvalues(axial)[:, 0])


def _eigenvalues(m: Array) -> Array:
    """Eigenvalues of symmetric 3 x 3 matrices, largest first (Smith 1961), shape (count, 3)."""
    mean = (m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2]) / 3
    rest = m - mean[:, None, None] * np.eye(3)
    size = np.sqrt(np.einsum("eij,eij->e", rest, rest) / 6)
    cosine = determinant(rest) / np.maximum(2 * size**3, 1e-300)
    angle = np.arccos(np.clip(cosine, -1, 1)) / 3
    first = mean + 2 * size * np.cos(angle)
    last = mean + 2 * size * np.cos(angle + 2 * np.pi / 3)
    return np.stack([first, 3 * mean - first - last, last], axis=1)


def _hourglass_rows(gradient: Array, hourglass: Array) -> Array:
    """Patterns of the hourglass springs times the root of their stiffness, (elements, 4, nodes)."""
    if hourglass.shape[1] == 0:
        return np.zeros((len(hourglass), 0, gradient.shape[2]))
    moments = hourglass[:, :12].reshape(-1, 4, 3)
    modes: Array = HOURGLASS - np.einsum("eax,enx->ean", moments, gradient[:, 0])
    return np.sqrt(hourglass[:, 12, None, None]) * modes


def _largest_eigenvalue(b: Array, volume: Array, d: Array, mass: Array, springs: Array) -> Array:
    nodes = mass.shape[1]
    if mass.ndim == 2:
        root = np.zeros((len(mass), nodes, nodes))
        root[:, np.arange(nodes), np.arange(nodes)] = 1 / np.sqrt(mass)
    else:  # L^-1 with M = L L^T
        root = np.linalg.inv(np.linalg.cholesky(mass))
    # rows of B times L^-T, per axis of the nodes
    turned = np.einsum("epsna,emn->epsma", b.reshape(*b.shape[:3], nodes, 3), root)
    turned = turned.reshape(b.shape)
    if (
        b.shape[1] == 1 and springs.shape[1] == 0
    ):  # one point: the 6 x 6 problem has the same non-zero eigenvalues
        factor = np.linalg.cholesky(d)
        small = np.einsum("est,epsk->eptk", factor, turned)[:, 0]
        small = np.einsum("etk,euk->etu", small, small) * volume[:, :1, None]
        return np.linalg.eigvalsh(small)[:, -1]
    stiffness = np.einsum("ep,epsk,est,eptl->ekl", volume, turned, d, turned, optimize=True)
    if springs.shape[1]:
        rows = np.einsum("ean,emn->eam", springs, root)
        resisted = np.einsum("ean,eam,xy->enxmy", rows, rows, np.eye(3))
        stiffness += resisted.reshape(stiffness.shape)
    return np.linalg.eigvalsh(stiffness)[:, -1]


FACES: dict[str, list[tuple[int, ...]]] = {
    "tet4": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
    "pyramid5": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    "wedge6": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "hex8": [
        (0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)
    ],
}  # fmt: skip
"""Faces of each shape, outward, counter-clockwise seen from outside."""
SLIVER = 0.02
"""Height over longest edge below which an element is called a sliver."""
