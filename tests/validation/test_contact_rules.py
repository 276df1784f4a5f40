"""Narrow phase: which contacts begin and which are kept, one rule a test, for bodies at imposed places."""

from pathlib import Path

import numpy as np
import pytest
from scenes import ROCK, simulate, turn

import cdem
from cdem.rows import rows_of

AXIS = [1, 2, 3]
# Coordinates of up to 9 m are rounded to 1e-15 m, and a penetration is 1e-2 m.
ROUND_OFF = 1e-13  # of a contact force


class Scene:
    """A tet at imposed places beside fixed rock.

    The whole scene is rotated by `angle`; places and normals are given without the rotation.
    """

    def __init__(self, rock, tet, angle, interfaces=None):
        away = np.asarray(tet) + [0, 0, 9.0]
        self.turned = turn(AXIS, angle)
        self.sim = simulate(
            [*rock, {"group": "tet", "polyhedron": {"vertices": away.tolist()}}],
            {"rock": {"fix": ["x", "y", "z"]}, "tet": {}},
            interfaces=interfaces,
            model={"rotate": {"axis": AXIS, "angle": angle}},
            contact={"check": True},
        )
        self.nodes = self.sim.build.nodes_of("tet")
        at = self.sim.fields["position"][self.nodes] @ self.turned - [0, 0, 9.0]
        # the model may number the vertices in another order
        self.order = [int(np.linalg.norm(np.asarray(tet) - x, axis=1).argmin()) for x in at]

    def put(self, tet):
        """Compute one step with the tet here, at rest."""
        now = (np.asarray(tet)[self.order]) @ self.turned.T
        self.sim.motion[self.nodes, :3] = now
        self.sim.motion[self.nodes, 4:7] = 0
        self.sim.step(1)

    def springs(self):
        """Semi-springs of the tet's lowest vertex: outward normal of the target, and force [N]."""
        contacts, topology = self.sim.contacts, self.sim.build.topology
        own = topology.face_group[contacts["mother_face"]] == self.sim.build.group_names.index(
            "tet"
        )
        rows = np.flatnonzero(own & (contacts["kind"] == 0))
        corners = self.sim.build.start_position[
            topology.face_nodes[contacts["target_face"][rows]][:, :3]
        ]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal = normal / np.linalg.norm(normal, axis=1)[:, None] @ self.turned
        return normal.round(9) + 0.0, contacts["force_n"][rows]


BLOCK = [{"group": "rock", "box": {"size": [6, 6, 2]}, "translate": [-3, -3, -2]}]


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_loaded_contact_keeps_its_target_while_an_edge_dips_beyond_a_rim(angle):
    """The tet stands on one vertex beside the rim and leans over it.

    An edge then dips 7 degrees below the plane. The force keeps its value to round-off.
    """
    tip = np.array([2.5, 0, 0])
    arms = np.array([[0, 0, 0], [1.5, 0, 0.03], [0.8, 1, 0.8], [0.8, -1, 0.8]])
    scene = Scene(BLOCK, tip + arms, angle)
    for depth in (-1e-3, 1e-3, 1e-2):
        scene.put(tip - [0, 0, depth] + arms)
    normal, before = scene.springs()
    assert len(before) > 0 and (before > 0).all() and (normal == [0, 0, 1]).all()
    for lean in range(1, 9):
        scene.put(tip - [0, 0, depth] + arms @ turn([0, 1, 0], lean).T)
    normal, after = scene.springs()
    assert (normal == [0, 0, 1]).all()
    np.testing.assert_allclose(after, before, rtol=ROUND_OFF)


CORNER = [
    {"group": "rock", "box": {"size": size}, "translate": at}
    for size, at in [
        ([2, 2, 1], [-2, -1, -1]),  # floor
        ([1, 2, 1], [0, -1, -1]),  # under the wall
        ([1, 2, 1], [0, -1, 0]),  # wall
    ]
]
BONDED = {
    "default": {"friction_angle": 0, "cohesion": 1e9, "tensile_strength": 1e9},
    "pairs": [
        {"between": ["rock", "tet"], "friction_angle": 0, "cohesion": 0, "tensile_strength": 0}
    ],
}


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_vertex_that_slides_into_a_corner_keeps_its_contact_with_the_floor(angle):
    """Three bonded blocks make a floor and a wall; the vertex slides on the floor into the wall.

    It is 20 mm deep in both. Its indented point lies behind the corner, beside neither face. The
    force on the floor keeps its value to round-off.
    """
    arms = np.array([[0, 0, 0], [-1, 0, 0.9], [-0.6, 0.5, 1.2], [-0.6, -0.5, 1.2]])
    tip = np.array([-0.1, 0, 0])
    scene = Scene(CORNER, tip + arms, angle, BONDED)
    for depth in (-1e-3, 1e-3, 1e-2, 2e-2):
        scene.put(tip - [0, 0, depth] + arms)
    normal, before = scene.springs()
    assert len(before) > 0 and (before > 0).all() and (normal == [0, 0, 1]).all()
    for x in np.linspace(-0.1, 0.03, 27):
        scene.put([x, 0, -depth] + arms)
    normal, after = scene.springs()
    on_floor = after[(normal == [0, 0, 1]).all(axis=1)]
    np.testing.assert_allclose(on_floor, before, rtol=ROUND_OFF)


@pytest.mark.parametrize("angle", [0.0, 40.0])
@pytest.mark.parametrize("depth", [0.01, 0.05])
@pytest.mark.parametrize("pressed", ["floor", "wall"])
def test_vertex_pressed_into_one_side_of_a_corner_meets_the_other(pressed, depth, angle):
    """The vertex is 10 or 50 mm deep in the floor and slides into the wall, or the other way round.

    It touches the wall in the first step in which it is behind it, 0.5 mm deep, and keeps the floor
    with the force on it. From there the force on the wall grows in proportion to the depth.
    """
    arms = np.array([[0, 0, 0], [-1, 0, 0.9], [-0.6, 0.5, 1.2], [-0.6, -0.5, 1.2]])
    held, met = [0, 0, 1], [-1, 0, 0]
    into = np.array([1.0, 0, -1])  # the wall, and the floor
    along = np.array([1.0, 0, 0]) if pressed == "floor" else np.array([0, 0, -1.0])
    scene = Scene(CORNER, [-0.1, 0, 0.1] + arms, angle, BONDED)
    if pressed == "wall":
        held, met = met, held
    start = into * depth - along * (depth + 0.1)
    for way in (*np.arange(depth + 1e-3, 0, -4e-3), 0):
        scene.put(start - (into - along) * way + arms)
    normal, before = scene.springs()
    assert len(before) > 0 and (before > 0).all() and (normal == held).all()
    forces = []
    for way in np.arange(-9.5e-3, 9.6e-3, 1e-3):
        scene.put(start + along * (0.1 + way) + arms)
        normal, force = scene.springs()
        np.testing.assert_allclose(force[(normal == held).all(axis=1)], before, rtol=ROUND_OFF)
        on_met = force[(normal == met).all(axis=1)]
        assert (len(on_met) > 0) == (way > 0)
        forces.append(on_met.sum())
    growth = np.diff(forces[-9:])
    np.testing.assert_allclose(growth, growth[0], rtol=1e-9)
    assert growth[0] > 0


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_vertex_found_behind_a_corner_contacts_floor_and_wall(angle):
    """The vertex starts 0.1 m below the floor and 0.15 m behind the wall.

    That is deeper than the entry depth, and beside neither face. Two faces of the vertex oppose
    the floor and one opposes the wall. New contacts are free of stress: the force is 0.
    """
    tip = np.array([0.15, 0, -0.1])
    arms = np.array([[0, 0, 0], [-1, 0, 0.9], [-0.6, 0.5, 1.2], [-0.6, -0.5, 1.2]])
    scene = Scene(CORNER, tip + arms, angle, BONDED)
    scene.put(tip + arms)
    normal, force = scene.springs()
    np.testing.assert_array_equal(np.unique(normal, axis=0), [[-1, 0, 0], [0, 0, 1]])
    assert len(force) == 3
    np.testing.assert_array_equal(force, 0)


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_vertex_deep_inside_contacts_only_the_nearest_face(angle):
    """The vertex starts 0.2 m below the top and 0.1 m behind the side, deeper than the entry depth.

    The side is nearest and holds it. The top does not, not even against the face of the tet that
    looks down. The new contact is free of stress: the force is 0.
    """
    tip = np.array([2.9, 0, -0.2])
    arms = np.array([[0, 0, 0], [1.2, 0, 0.6], [0.1, 0.9, 1], [0.1, -0.9, 1]])
    scene = Scene(BLOCK, tip + arms, angle)
    scene.put(tip + arms)
    normal, force = scene.springs()
    assert len(force) > 0 and (normal == [1, 0, 0]).all()
    np.testing.assert_array_equal(force, 0)


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_vertex_in_a_thin_plate_has_no_contact_with_the_far_side(angle):
    """The vertex is 4 mm deep in the top of a plate of 0.1 m; one face of the tet looks up."""
    plate = [{"group": "rock", "box": {"size": [4, 4, 0.1]}, "translate": [-2, -2, -0.1]}]
    tip = np.array([0, 0, 0])
    arms = np.array([[0, 0, 0], [1, 0, 0.2], [0.8, 0.5, 0.8], [0.8, -0.5, 0.8]])
    scene = Scene(plate, tip + arms, angle)
    scene.put(tip - [0, 0, 0.004] + arms)
    normal, force = scene.springs()
    assert len(force) > 0 and (normal == [0, 0, 1]).all()


def test_vertex_released_deep_inside_a_block_is_held_at_its_depth():
    """A cube stands with a corner on a plate that is pushed into the bed and then drawn away.

    The corner's target is the plate while it enters the bed, deeper than the entry depth. When the
    plate has gone, the bed holds the corner where it is. Tolerances: the corner's penetration of
    the plate under the cube's weight, 1e-7 m, and the change of stiffness from plate to bed.
    """
    sim = simulate(
        [
            {"group": "bed", "box": {"size": [6, 6, 2]}, "translate": [-3, -3, -2]},
            {"group": "plate", "box": {"size": [1, 1, 0.05]}, "translate": [-0.5, -0.5, 0]},
            {
                "group": "cube",
                "box": {"size": [0.6, 0.6, 0.6]},
                "rotate": {"axis": [1, -1, 0], "angle": np.degrees(np.arccos(1 / np.sqrt(3)))},
                "translate": [0, 0, 0.05],
            },
        ],
        {
            "bed": {"fix": ["x", "y", "z"]},
            "plate": {"material": "heavy"},
            "cube": {"fix": ["x", "y"]},
        },
        # it is pushed, so its weight does not matter, but it allows longer steps
        materials={"heavy": ROCK | {"density": 64 * ROCK["density"]}},
        loads={
            "gravity": [0, 0, -20],
            "velocities": [
                {
                    "group": "plate",
                    "components": ["z"],
                    "velocity": [0, 0, -0.3],
                    "history": [[0, 0], [0.1, 1], [0.5, 1], [0.6, 0]],
                },
                {
                    "group": "plate",
                    "components": ["x", "y"],
                    "velocity": [10, 0, 0],
                    "history": [[0, 0], [0.6, 0], [0.605, 1], [0.9, 1]],
                },
            ],
        },
        stages=[
            {"name": "go", "mode": "dynamic", "duration": 0.75, "damping": {"contact": 0.1}},
        ],
    )
    sim.run_until(0.6)
    tip = sim.fields["position"][sim.build.nodes_of("cube"), 2].min()
    assert tip == pytest.approx(0.05 - 0.3 * 0.5, abs=3e-7)  # on the plate, below the bed
    sim.run_until(0.75)
    assert sim.fields["position"][sim.build.nodes_of("plate"), 0].min() > 0.5  # far from the corner
    assert sim.fields["position"][sim.build.nodes_of("cube"), 2].min() == pytest.approx(
        tip, abs=2e-6
    )


def test_no_vertex_is_deep_inside_its_own_bonded_body():
    """Blocks of bonded rock, cut by joints: nothing overlaps, so no contact may be deep.

    Vertices on joints lie behind the faces of other blocks. Six contacts 0.1 to 0.24 m deep began
    in the first step, and carried up to 0.4 MN once the rock moved.
    """
    example = Path(__file__).parents[2] / "examples/jointed_slope/jointed_slope.yaml"
    sim = cdem.Simulation(example, threads=1)
    assert not any("overlap" in warning for warning in sim.audit.warnings)
    sim.step(1)
    touches = sim.core.fields()["spring.target"] >= 0
    assert touches.sum() > 10
    assert rows_of(sim.core, "spring.state").stress_free_gap[touches].min() > -1e-6


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_vertex_deep_beside_a_rim_is_held_at_its_depth(angle):
    """One vertex of a tet lies 0.2 m deep in a block; an edge from it dips deeper beyond the rim.

    So the vertex is not the deepest point, and the edge crosses the rim below the entry depth. The
    nearest face holds the vertex. In free fall it would be 12.5 mm lower; its penetration under
    the tet's weight is 1e-7 m.
    """
    up = turn(AXIS, angle) @ [0, 0, 1]
    sim = simulate(
        [
            {"group": "rock", "box": {"size": [6, 6, 2]}, "translate": [-3, -3, -2]},
            {
                "group": "tet",
                "polyhedron": {
                    "vertices": [[2.5, 0, -0.2], [4, 0, -0.8], [3.3, 1, 0.6], [3.3, -1, 0.6]],
                    "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
                },
            },
        ],
        {"rock": {"fix": ["x", "y", "z"]}, "tet": {}},
        model={"rotate": {"axis": AXIS, "angle": angle}},
        loads={"gravity": (-10 * up).tolist()},
        stages=[{"name": "go", "mode": "dynamic", "duration": 0.05}],
    )
    tet = sim.build.nodes_of("tet")
    corner = tet[np.argmin(np.abs(sim.fields["position"][tet] @ up + 0.2))]
    sim.run_until(0.05)
    height = sim.fields["position"][corner] @ up
    assert height == pytest.approx(-0.2, abs=5e-7)
