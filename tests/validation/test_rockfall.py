"""Falls of one block over ground from a grid, against closed forms and against `cdem run`.

A slide from rest along a plane reaches v = sqrt(2 g L (sin a - cos a tan phi)); a block that leaves a
cliff with u passes x at the height h - g x2 / (2 u2); a flat fall from h rebounds to e2 h.
"""

import meshio
import numpy as np
import pytest

from cdem.case.case import Case
from cdem.mesh.primitives import outward_faces, polyhedron
from cdem.rockfall.fall import Boulder, Physics, _Run, case_of, fall
from cdem.rockfall.ground import Ground
from cdem.rockfall.rigid import RigidBlock
from cdem.rockfall.tracks import Track, passages
from cdem.run.simulation import Simulation

G = 9.81
BOX = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2.0


def ground_of(x, z, rows=8, step=2.0):
    """Ground that is the same for all y, with the height z at points x apart by a step."""
    heights = np.repeat(np.asarray(z, float)[None], rows, axis=0)
    zone = np.zeros((rows - 1, len(x) - 1), np.int16)
    return Ground(float(x[0]), 0.0, np.array([step, step]), heights, zone)


def physics(modulus, friction, restitution=1.0, duration=30.0, **more):
    contact = {"friction_angle": friction, "restitution": restitution}
    return Physics(2600.0, modulus, [contact], 0.01, duration, **more)


def on_slope(angle, sides, along, ground, gap=0.0):
    """Corners of a box that lies flat on a slope that falls to the east, and its way."""
    a = np.radians(angle)
    down, normal = np.array([np.cos(a), 0, -np.sin(a)]), np.array([np.sin(a), 0, np.cos(a)])
    axes = np.array([down, [0, 1, 0], normal])
    place = np.array([along, 7.0, float(ground.height(np.array([along, 7.0])))])
    return (BOX * sides) @ axes + place + (sides[2] / 2 + gap) * normal


@pytest.mark.parametrize("friction", [0.0, 20.0])
def test_a_slide_on_a_plane_has_the_speed_of_the_energy_balance(friction):
    """v = sqrt(2 g L (sin a - cos a tan phi)), over windows and the seams between triangles."""
    angle = 35.0
    x = np.arange(0, 31, 1.0)
    ground = ground_of(x, 100 - np.tan(np.radians(angle)) * x, rows=15, step=1.0)
    boulder = Boulder(on_slope(angle, [1.6, 1.6, 0.5], 4.0, ground), np.zeros(3))
    run = fall(ground, boulder, physics(3e6, friction))
    assert run.windows >= 3
    assert run.status == "left the terrain"
    track = Track(run.samples, run.mass)
    a, phi = np.radians(angle), np.radians(friction)
    for at in (8.0, 24.0):
        found = passages(track, np.array([[at, 0.0], [at, 14.0]]), ground)
        way = (at - run.samples[0, 1]) / np.cos(a)
        expected = np.sqrt(2 * G * way * (np.sin(a) - np.cos(a) * np.tan(phi)))
        assert len(found["time"]) == 1
        assert found["velocity"][0] == pytest.approx(expected, rel=0.01)


def test_a_jump_off_a_cliff_passes_on_its_parabola():
    """Height h0 - g x2 / (2 u2), and the energy m (u2 + 2 g fall) / 2."""
    x = np.arange(0, 61, 2.0)
    z = np.interp(x, [0, 10, 12, 60], [60, 60, 0, 0])
    ground, u = ground_of(x, z), 9.0
    corners = BOX @ np.diag([1.0, 0.8, 0.6]) + [10.6, 7.0, 61.0]
    spin = np.array([0.3, 1.0, 2.0])
    run = fall(ground, Boulder(corners, np.array([u, 0, 0]), spin), physics(1e9, 30.0, 0.3, 2.9))
    track = Track(run.samples, run.mass)
    before = track["rotation"][0]
    for at in (15.0, 25.0, 33.0):
        found = passages(track, np.array([[at, 0.0], [at, 14.0]]), ground)
        drop = G * (at - 10.6) ** 2 / (2 * u**2)
        assert found["height"][0] == pytest.approx(61.0 - drop, rel=0.01)
        kinetic = run.mass * (u**2 + 2 * G * drop) / 2
        assert found["energy_translation"][0] == pytest.approx(kinetic, rel=0.01)
        assert found["energy_rotation"][0] == pytest.approx(before, rel=1e-3)


@pytest.mark.parametrize("e", [0.3, 0.6])
def test_a_flat_fall_rebounds_to_the_part_that_the_ground_returns(e):
    """e2 h; the strain of the block adds at most 1 - e2 times its share, s = 0.1 here."""
    x = np.arange(0, 25, 2.0)
    ground = ground_of(x, np.zeros(len(x)), rows=12)
    height = 2.0
    boulder = Boulder(BOX + [12.0, 12.0, 0.5 + height], np.zeros(3))
    run = fall(ground, boulder, physics(4e7, 30.0, e, 1.4, stiffening=30.0))
    z = run.samples[:, 3] - 0.5
    touch = int(np.argmin(z[: len(z) // 2]))
    assert z[touch:].max() == pytest.approx(e**2 * height, rel=0.05)


def test_a_run_is_that_of_the_same_case_by_hand(tmp_path):
    """As long as the block stays in one window: `cdem run` of its mesh, to the last bit."""
    x = np.arange(0, 41, 2.0)
    z = np.random.default_rng(1).normal(size=(21, len(x))) * 0.2
    ground = Ground(0.0, 0.0, np.array([2.0, 2.0]), z, np.zeros((20, len(x) - 1), np.int16))
    corners = BOX @ np.diag([1.0, 0.7, 0.5]) + [20.0, 20.0, 1.5]
    rules = physics(1e8, 30.0, 0.4, 0.6)
    boulder = Boulder(corners, np.array([1.0, 0.5, 0]))
    run = fall(ground, boulder, rules)
    assert run.windows == 1
    assert run.samples[:, 5].min() < 0.45  # it has met the ground

    mesh = polyhedron("block", corners)
    block = RigidBlock(mesh.points, mesh.cells["tet4"], 2600.0)
    start = block.motion(mesh.points, np.tile(boulder.velocity, (len(mesh.points), 1)))
    window, _ = ground.window(*_Run(ground, boulder, rules, 1e8)._edges(start))
    wedges = [("wedge", window.cells["wedge6"])]
    physical = [np.ones(len(window.cells["wedge6"]), int)]
    meshio.gmsh.write(
        tmp_path / "ground.msh",
        meshio.Mesh(
            window.points, wedges, cell_data={"gmsh:physical": physical, "gmsh:geometrical": physical},
            field_data={"ground_0": np.array([1, 3])},
        ),
        "2.2", binary=True,
    )  # fmt: skip
    body = {"vertices": corners.tolist(), "faces": outward_faces(corners, None)}
    motion = np.array([1.0, 0.5, 0.0]), np.zeros(3)
    case = case_of(body, rules, block.radius, 1e8, ["ground_0"], motion)
    data = case.model_dump(exclude_unset=True)
    data["model"]["mesh"] = str(tmp_path / "ground.msh")
    sim = Simulation(Case.from_dict(data), threads=1)
    nodes, rows = sim.groups["block"].nodes, []
    away = np.abs(sim.fields["position"][nodes][:, None] - mesh.points[None]).max(axis=2)
    nodes = nodes[away.argmin(axis=0)]

    def look(sim):
        motion = block.motion(sim.fields["position"][nodes], sim.fields["velocity"][nodes])
        rows.append([*motion.centre, *motion.velocity, *motion.spin, motion.rotation])

    sim.every(0.01, look)
    sim.run()
    assert sim.step_count == run.steps
    np.testing.assert_array_equal(np.array(rows), run.samples[1:, 1:11])


def test_windows_change_little():
    """The same bounce over a seam of windows and in one: the sums of momentum pass on unchanged."""
    x = np.arange(0, 25, 1.0)
    ground = ground_of(x, 20 - 0.2 * x, rows=10, step=1.0)
    corners = BOX @ np.diag([1.0, 0.9, 0.8]) + [4.0, 4.5, 20.2]
    boulder, rules = Boulder(corners, np.array([9.0, 0, 0])), physics(1e7, 30.0, 0.5, 1.2)
    many = fall(ground, boulder, rules)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("cdem.rockfall.fall.CELLS", 60.0)
        one = fall(ground, boulder, rules)
    assert (one.windows, many.windows >= 2) == (1, True)
    np.testing.assert_allclose(many.samples[-1, 1:4], one.samples[-1, 1:4], atol=0.1)
    assert abs(many.lost) < 0.02 * many.mass * 81 / 2
