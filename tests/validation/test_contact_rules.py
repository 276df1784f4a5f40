"""Which contacts begin and which are kept, one clause of the search at a time: bodies are put in place by hand."""

import numpy as np
import pytest
from scenes import simulate, turn

AXIS = [1, 2, 3]


class Scene:
    """A tet beside fixed rock; where it is in a step is imposed. Turned as a whole by `angle`, seen unturned."""

    def __init__(self, rock, tet, angle, interfaces=None):
        away = np.asarray(tet) + [0, 0, 9.0]
        self.turned = turn(AXIS, angle)
        self.sim = simulate(
            [*rock, {"group": "tet", "polyhedron": {"vertices": away.tolist()}}],
            {"rock": {"fix": ["x", "y", "z"]}, "tet": {}},
            interfaces=interfaces,
            model={"rotate": {"axis": AXIS, "angle": angle}},
        )
        self.nodes = self.sim.build.nodes_of("tet")
        at = self.sim.fields["position"][self.nodes] @ self.turned - [0, 0, 9.0]
        # the builder may list the vertices in an order of its own
        self.order = [int(np.linalg.norm(np.asarray(tet) - x, axis=1).argmin()) for x in at]

    def put(self, tet):
        """Compute one step with the tet here, at rest."""
        now = (np.asarray(tet)[self.order]) @ self.turned.T
        self.sim.fields["position"][self.nodes] = now
        self.sim.fields["velocity"][self.nodes] = 0
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
def test_a_loaded_contact_is_kept_while_an_edge_reaches_deeper_beyond_a_rim(angle):
    """The tet stands on one vertex beside the rim, then leans over it: an edge dips 7 degrees below the plane."""
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
    np.testing.assert_allclose(after, before, rtol=1e-9)


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
def test_a_vertex_pressed_into_a_corner_stays_on_the_floor(angle):
    """Floor and wall of three bonded blocks. The vertex slides on the floor into the wall, 20 mm deep in both:
    its indented point is beside neither, but behind the corner between them.
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
    np.testing.assert_allclose(on_floor, before, rtol=1e-9)


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_a_vertex_that_is_found_behind_a_corner_is_held_by_floor_and_wall(angle):
    """0.1 m below the floor and 0.15 m behind the wall, deeper than a contact begins, and beside neither.
    Two of its faces look at the floor, and one at the wall.
    """
    tip = np.array([0.15, 0, -0.1])
    arms = np.array([[0, 0, 0], [-1, 0, 0.9], [-0.6, 0.5, 1.2], [-0.6, -0.5, 1.2]])
    scene = Scene(CORNER, tip + arms, angle, BONDED)
    scene.put(tip + arms)
    normal, force = scene.springs()
    np.testing.assert_array_equal(np.unique(normal, axis=0), [[-1, 0, 0], [0, 0, 1]])
    assert len(force) == 3
    np.testing.assert_array_equal(force, 0)  # free of stress there


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_a_vertex_deep_inside_is_held_at_the_nearest_face_only(angle):
    """0.2 m below the top and 0.1 m behind the side, where no contact can begin any more but one that is held:
    at the side, and at the top not even by the tet's face that looks down and not sideways.
    """
    tip = np.array([2.9, 0, -0.2])
    arms = np.array([[0, 0, 0], [1.2, 0, 0.6], [0.1, 0.9, 1], [0.1, -0.9, 1]])
    scene = Scene(BLOCK, tip + arms, angle)
    scene.put(tip + arms)
    normal, force = scene.springs()
    assert len(force) > 0 and (normal == [1, 0, 0]).all()
    np.testing.assert_array_equal(force, 0)  # free of stress there


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_a_vertex_on_a_thin_plate_is_not_held_by_its_far_side(angle):
    """4 mm deep in the top of a plate of 0.1 m, with a face of the tet that looks up."""
    plate = [{"group": "rock", "box": {"size": [4, 4, 0.1]}, "translate": [-2, -2, -0.1]}]
    tip = np.array([0, 0, 0])
    arms = np.array([[0, 0, 0], [1, 0, 0.2], [0.8, 0.5, 0.8], [0.8, -0.5, 0.8]])
    scene = Scene(plate, tip + arms, angle)
    scene.put(tip - [0, 0, 0.004] + arms)
    normal, force = scene.springs()
    assert len(force) > 0 and (normal == [0, 0, 1]).all()


def test_a_vertex_let_go_inside_another_block_is_held_there():
    """A cube stands with a corner on a plate that is pushed into the bed and then drawn away.

    Each semi-spring has one target, the plate, while the corner sinks into the bed, deeper than a contact may
    begin: it used to fall through.
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
        {"bed": {"fix": ["x", "y", "z"]}, "plate": {}, "cube": {"fix": ["x", "y"]}},
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
                    "velocity": [5, 0, 0],
                    "history": [[0, 0], [0.6, 0], [0.61, 1], [1.2, 1]],
                },
            ],
        },
        stages=[
            {"name": "go", "mode": "dynamic", "duration": 0.9, "damping": {"contact": 0.1}},
        ],
    )
    sim.run_until(0.6)
    tip = sim.fields["position"][sim.build.nodes_of("cube"), 2].min()
    assert tip == pytest.approx(0.05 - 0.3 * 0.5, abs=2e-4)  # on the plate, below the bed
    sim.run_until(0.9)
    assert sim.fields["position"][sim.build.nodes_of("plate"), 0].min() > 0.5  # far from the corner
    assert sim.fields["position"][sim.build.nodes_of("cube"), 2].min() == pytest.approx(
        tip, abs=2e-4
    )


@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_a_vertex_that_has_sunk_beside_a_rim_is_held(angle):
    """A tet lies 0.2 m deep in a block with one vertex; an edge that leaves it reaches deeper, in the air beyond
    the rim. So the vertex is not the deepest point, and the edge crosses the rim deeper than a contact may begin:
    nothing held the tet. Now the vertex is held where it is, at the nearest face.
    """
    axis = [1, 2, 3]
    up = turn(axis, angle) @ [0, 0, 1]
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
        model={"rotate": {"axis": axis, "angle": angle}},
        loads={"gravity": (-10 * up).tolist()},
        stages=[{"name": "go", "mode": "dynamic", "duration": 0.05}],
    )
    tet = sim.build.nodes_of("tet")
    corner = tet[np.argmin(np.abs(sim.fields["position"][tet] @ up + 0.2))]
    sim.run_until(0.05)
    sunk = sim.fields["position"][corner] @ up
    assert sunk == pytest.approx(-0.2, abs=1e-3)  # in free fall it would be 12.5 mm lower
