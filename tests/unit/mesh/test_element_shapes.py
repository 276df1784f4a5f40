"""The closed form of a tet's highest frequency."""

import numpy as np
import pytest

from cdem.mesh import element_shapes


def test_highest_frequency_of_tets_is_the_root_of_the_largest_eigenvalue():
    """w^2 = max eig M^-1 K with K = V B^T D B put together here: regular, random and flat tets."""
    rng = np.random.default_rng(3)
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]) + rng.uniform(
        -0.2, 0.2, (60, 4, 3)
    )
    corners[:5] = [[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1]]
    corners[5:10, :, 2] *= 1e-3
    lame, shear, density = rng.uniform(1, 9, 60), rng.uniform(0.1, 5, 60), rng.uniform(1, 3, 60)
    gradient, volume = element_shapes.reference_gradients("tet4", corners)
    assert volume[0, 0] == pytest.approx(8 / 3)
    mass = element_shapes.mass_matrices("tet4", corners, density)
    for inertia in (mass, mass.sum(axis=2)):
        found = element_shapes.squared_frequencies(
            "tet4", gradient, volume, lame, shear, inertia, np.zeros((60, 0))
        )
        for e in range(60):
            stiffness = np.zeros((4, 3, 4, 3))
            for i in range(4):
                for j in range(4):
                    a, b = gradient[e, 0, i], gradient[e, 0, j]
                    block = lame[e] * np.outer(a, b) + shear[e] * np.outer(b, a)
                    stiffness[i, :, j] = volume[e, 0] * (block + shear[e] * (a @ b) * np.eye(3))
            m = inertia[e] if inertia.ndim == 3 else np.diag(inertia[e])
            full = np.linalg.inv(np.kron(m, np.eye(3))) @ stiffness.reshape(12, 12)
            assert found[e] == pytest.approx(np.linalg.eigvals(full).real.max(), rel=1e-9)
