"""Rolling resistance: a sphere rolls to rest over 7/5 v^2 / (2 g mu_r), and rests where tan < mu_r.

About the point where it touches, a sphere has the inertia 7/5 m R^2, and the couple mu_r R m g
brakes it: a = 5/7 mu_r g. The spheres here have facets, which brake a little by themselves.
"""

import meshio
import numpy as np
import pytest
from scenes import case, digest, mean_velocity, momentum, simulate, turn

import cdem

GRAVITY, RADIUS = 9.81, 0.5


def icosphere(path, levels):
    """Write a sphere of tets about its middle that rests on a facet at z = 0; height of the middle."""
    golden = (1 + 5**0.5) / 2
    corners = np.array([(0, s, t * golden) for s in (-1, 1) for t in (-1, 1)])
    points = np.concatenate([np.roll(corners, k, axis=1) for k in range(3)]).astype(float)
    near = np.linalg.norm(points[:, None] - points[None], axis=2) < 2.1
    faces = [
        (a, b, c)
        for a in range(12)
        for b in range(a)
        for c in range(b)
        if near[a, b] and near[b, c] and near[a, c]
    ]
    points = list(points / np.linalg.norm(points[0]))
    for _ in range(levels):
        middle, finer = {}, []

        def between(a, b, middle=middle):
            key = (min(a, b), max(a, b))
            if key not in middle:
                points.append((points[a] + points[b]) / np.linalg.norm(points[a] + points[b]))
                middle[key] = len(points) - 1
            return middle[key]

        for a, b, c in faces:
            x, y, z = between(a, b), between(b, c), between(c, a)
            finer += [(a, x, z), (b, y, x), (c, z, y), (x, y, z)]
        faces = finer
    at = RADIUS * np.array([*points, (0, 0, 0)])
    down = at[list(faces[0])].mean(axis=0)
    down /= np.linalg.norm(down)
    side = np.cross(down, [1, 0, 0])
    side /= np.linalg.norm(side)
    at = at @ np.array([side, np.cross(side, -down), -down]).T
    at[:, 2] -= at[:, 2].min()
    tets = np.array([(len(at) - 1, *face) for face in faces])
    a, b, c = (at[tets[:, k]] - at[tets[:, 0]] for k in (1, 2, 3))
    inverted = np.einsum("ij,ij->i", np.cross(a, b), c) < 0
    tets[inverted] = tets[inverted][:, [0, 2, 1, 3]]
    meshio.write_points_cells(path, at, [("tetra", tets)], file_format="vtk")
    return at[-1, 2]


def ball(folder, resistance, *, slope=0.0, speed=0.0, rock=None, damping=0.5):
    """A sphere of 162 vertices on a fixed plate, at rest or rolling along x."""
    height = icosphere(folder / "ball.vtk", 2)
    angle = np.arctan(slope)
    return simulate(
        [{"group": "bed", "box": {"size": [8, 4, 1]}, "translate": [-1.513, -1.987, -1]}],
        {
            "bed": {"fix": ["x", "y", "z"]},
            "default": {"velocity": [speed, 0, 0], "angular_velocity": [0, speed / height, 0]},
        },
        defaults=True,
        rock=rock,
        interfaces={"default": {"friction_angle": 50, "rolling_resistance": resistance}},
        loads={"gravity": [GRAVITY * np.sin(angle), 0, -GRAVITY * np.cos(angle)]},
        model={"mesh": str(folder / "ball.vtk"), "split": {"default": "one"}},
        stages=[
            {
                "name": "roll",
                "mode": "dynamic",
                "duration": 99,
                "damping": {"contact": damping, "stiffness": 0.1},
            }
        ],
    )


@pytest.mark.parametrize("young", ["1 GPa", pytest.param("10 GPa", marks=pytest.mark.slow)])
def test_a_sphere_rests_where_the_slope_is_below_the_rolling_resistance(tmp_path, young):
    """tan(slope) = 0.25. With 0.3 it rocks on its facet; with 0.1 it rolls off."""
    moved = {}
    for resistance in (0.1, 0.3):
        sim = ball(tmp_path, resistance, slope=0.25, rock={"young_modulus": young})
        nodes = sim.build.nodes_of("default")
        while sim.time < 0.6:
            sim.step(500)
        assert abs(sim.energies["error"]) < 1e-3
        moved[resistance] = sim.fields["displacement"][nodes, 0].mean()
    assert abs(moved[0.3]) < 0.03
    assert moved[0.1] > 0.06


@pytest.mark.slow
def test_a_sphere_rolls_to_rest(tmp_path):
    """On the flat, mu_r = 0.2, from 1 m/s to 0.15: 0.321 m, theory 0.349 m; rock of 100 GPa.

    Facets brake too: 0.16 m/s2 without rolling resistance, 11 % of what it brakes with.
    """
    sim = ball(tmp_path, 0.2, speed=1.0, rock={"young_modulus": "100 GPa"}, damping=1.0)
    way, before, velocity = 0.0, 0.0, 1.0
    while velocity > 0.15:
        sim.step(500)
        velocity = mean_velocity(sim, "default")[0]
        way += velocity * (sim.time - before)
        before = sim.time
    assert abs(sim.energies["error"]) < 1e-3
    theory = 7 / 5 * (1 - velocity**2) / (2 * GRAVITY * 0.2)
    assert 0.88 * theory < way < 1.02 * theory


def collide(resistance, rotation=None, steps=900):
    """Two blocks meet off centre, spinning, without gravity."""
    around = turn(*rotation) if rotation else np.eye(3)
    more = (
        {"model": {"rotate": {"axis": list(rotation[0]), "angle": rotation[1]}}} if rotation else {}
    )
    sim = simulate(
        [
            {"group": "a", "box": {"size": [1, 1, 1]}},
            {"group": "b", "box": {"size": [1, 0.8, 0.7]}, "translate": [0.3, 0.2, 1.002]},
        ],
        {
            "a": {"velocity": (around @ [0, 0, 1]).tolist()},
            "b": {"velocity": (around @ [0.5, 0, -1]).tolist(),
                  "angular_velocity": (around @ [0.3, 0.8, 0.2]).tolist()},
        },
        defaults=True,
        interfaces={"default": {"friction_angle": 30, "rolling_resistance": resistance}},
        time={"step": 8e-6},
        **more,
    )  # fmt: skip
    start = momentum(sim)
    sim.step(steps)
    return sim, start, around


def test_momentum_is_kept_and_the_ledger_closes():
    sim, start, _ = collide(0.4)
    assert sim.energies["friction"] > collide(0.0)[0].energies["friction"]
    # the elements alone change the angular momentum by 4e-10
    for before, after, error in zip(start, momentum(sim), (1e-13, 2e-9), strict=True):
        assert np.abs(after - before).max() < error * np.abs(before).max()
    assert abs(sim.energies["error"]) < 1e-3


def test_rolling_resistance_does_not_depend_on_the_frame():
    sim, _, _ = collide(0.4)
    turned, _, around = collide(0.4, ([1, 2, 3], 77.0))
    for group in "ab":
        expected = around @ mean_velocity(sim, group)
        assert np.abs(mean_velocity(turned, group) - expected).max() < 1e-11
    assert turned.energies["friction"] == pytest.approx(sim.energies["friction"], rel=1e-10)


def test_a_cube_slides_as_without(tmp_path):
    def slide(resistance):
        sim = simulate(
            [
                {"group": "bed", "box": {"size": [8, 4, 1]}, "translate": [0, 0, -1]},
                {"group": "block", "box": {"size": [1, 1, 0.4]}, "translate": [1.37, 1.503, 0]},
            ],
            {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
            defaults=True,
            interfaces={"default": {"friction_angle": 10, "rolling_resistance": resistance}},
            loads={"gravity": [GRAVITY / 2, 0, -GRAVITY * 0.75**0.5]},
            stages=[
                {
                    "name": "slide",
                    "mode": "dynamic",
                    "duration": 9,
                    "damping": {"contact": 0.1, "stiffness": 0.2},
                }
            ],
        )
        while sim.time < 0.2:
            sim.step(100)
        return mean_velocity(sim, "block")[0] / sim.time

    theory = GRAVITY * (0.5 - 0.75**0.5 * np.tan(np.radians(10)))
    assert slide(0.3) == pytest.approx(slide(0.0), rel=1e-4)
    assert slide(0.3) == pytest.approx(theory, rel=1e-2)


def heap(threads, **more):
    """27 cubes fall onto a plate and roll."""
    stones = [
        {
            "group": "stones",
            "box": {"size": [1, 1, 1]},
            "rotate": {"axis": [1, 2, 3], "angle": 20.0 * (i + j + k)},
            "translate": [1.9 * i, 1.9 * j, 1.9 * k + 1],
        }
        for i in range(3)
        for j in range(3)
        for k in range(3)
    ]
    return cdem.Simulation(
        case(
            [
                {
                    "group": "plate",
                    "box": {"size": [12, 12, 1], "divisions": [12, 12, 1]},
                    "translate": [-3, -3, -1],
                },
                *stones,
            ],
            {"plate": {"fix": ["x", "y", "z"]}, "stones": {"velocity": [2, 0.5, -6]}},
            interfaces={"default": {"friction_angle": 30, "rolling_resistance": 0.2}},
            loads={"gravity": [0, 0, -GRAVITY]},
            stages=[{"name": "fall", "mode": "dynamic", "duration": 0.15}],
            output={"every": 0.05},
            defaults=True,
        ),
        threads=threads,
        **more,
    )


def test_threads_and_a_stop_give_identical_results(tmp_path):
    whole = heap(1, output=tmp_path / "whole")
    whole.run()
    assert np.abs(whole.core.fields()["spring.rolling"]).max() > 0
    assert abs(whole.energies["error"]) < 1e-3
    other = heap(3)
    other.run()
    assert digest(other) == digest(whole)
    asked = iter([False, False, True])
    assert heap(2, output=tmp_path / "broken").run(should_stop=lambda: next(asked)) == "stopped"
    resumed = heap(1, output=tmp_path / "broken", resume=True)
    resumed.run()
    assert digest(resumed) == digest(whole)
