"""Weight of the rock above points: blocks, gaps and layers."""

import numpy as np
import pytest

import cdem
from cdem.model.build import build
from cdem.model.overburden import weight_above

DENSITY = {"low": 2000.0, "high": 3000.0, "cap": 2500.0}


def topology(*blocks):
    """Blocks of (group, size, place, shape), their faces, and density by group."""
    return build(
        cdem.Case.from_dict(
            {
                "model": {
                    "blocks": [
                        {
                            "group": group,
                            "box": {"size": size, "divisions": [2, 2, 2], "shape": shape},
                            "translate": place,
                        }
                        for group, size, place, shape in blocks
                    ],
                    "split": {group: "elements" for group, *_ in blocks},
                },
                "materials": {
                    name: {"density": rho, "young_modulus": 1e9, "poisson_ratio": 0.2}
                    for name, rho in DENSITY.items()
                },
                "groups": {group: {"material": group} for group, *_ in blocks},
                "interfaces": {"default": {"friction_angle": 30}},
                "stages": [{"name": "go", "mode": "static"}],
            }
        )
    )


def above(model, points):
    density = np.array([DENSITY[name] for name in model.group_names])
    return weight_above(model.topology, density, np.array(points, float))


@pytest.mark.parametrize("shape", ["hex8", "tet4"])
def test_layers_and_a_gap(shape):
    """2 m of 2000 kg/m3, 1 m of 3000, a gap of 1 m, a cap of 1 m of 2500 that is narrower."""
    model = topology(
        ("low", [4, 4, 2], [0, 0, 0], shape),
        ("high", [4, 4, 1], [0, 0, 2], shape),
        ("cap", [2, 4, 1], [0, 0, 4], "hex8"),
    )
    points = [[1, 1, 0.5], [3, 1, 0.5], [1, 1, 2.5], [3, 3, 2.25], [1, 2, 3.5], [2.5, 2, 3.5]]
    weight, top = above(model, points)
    exact = [1.5 * 2000 + 3000 + 2500, 1.5 * 2000 + 3000, 1500 + 2500, 0.75 * 3000, 2500, 0]
    np.testing.assert_allclose(weight, exact, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(top, [5, 3, 5, 3, 5, 3], rtol=1e-12)


def test_points_on_edges_and_outside():
    """Edges of elements count once; beside the rock there is none."""
    model = topology(("low", [2, 2, 2], [0, 0, 0], "tet4"))
    points = [[1, 1, 0], [1, 0.5, 1], [0.5, 0.5, 0], [5, 5, 0], [1, 1, 2], [1, 1, 7]]
    weight, top = above(model, points)
    np.testing.assert_allclose(weight, [4000, 2000, 4000, 0, 0, 0], rtol=1e-12, atol=1e-9)
    assert top[3] == -np.inf


def test_a_slope():
    """Under an inclined face the depth is what lies above."""
    model = topology(("low", [4, 4, 4], [0, 0, 0], "tet4"))
    t = model.topology
    t.node_position[:, 2] *= 1 - t.node_position[:, 0] / 8  # top falls from 4 to 2 m
    rng = np.random.default_rng(3)
    points = rng.uniform(0, 4, (200, 3)) * [1, 1, 0.4]
    weight, _ = weight_above(t, np.array([2000.0]), points)
    depth = 4 - points[:, 0] / 2 - points[:, 2]
    np.testing.assert_allclose(weight, 2000 * depth, rtol=1e-9)
