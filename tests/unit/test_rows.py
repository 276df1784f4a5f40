"""Arrays of the core by the names of their parts."""

import numpy as np
import pytest
from scenes import simulate

from cdem.rows import rows_of

BLOCKS = [
    {"group": "a", "box": {"size": [2, 1, 1], "divisions": [2, 1, 1], "shape": "tet4"}},
    {"group": "b", "box": {"size": [1, 1, 1]}, "translate": [0, 0, 1]},
]


@pytest.fixture
def sim():
    """Bonded tets under a cube that falls on them."""
    tough = {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}
    return simulate(
        BLOCKS, {"a": {"fix": ["x", "y", "z"]}, "b": {"velocity": [1, 2, -3]}},
        interfaces={"default": {"friction_angle": 0}, "pairs": [{"between": ["a", "a"], **tough}]},
        model={"split": {"a": "elements"}},
    )  # fmt: skip


def test_parts_are_views_and_pads_have_no_name(sim):
    motion = rows_of(sim.core, "node.motion")
    assert motion.numbers.shape == (len(sim.fields["mass"]), 8)
    nodes = sim.build.nodes_of("b")
    assert (motion.velocity[nodes] == [1, 2, -3]).all()
    motion.velocity[nodes] = [4, 5, 6]
    assert (sim.fields["velocity"][nodes] == [4, 5, 6]).all()
    assert (sim.fields["position"] == motion.position).all()
    with pytest.raises(AttributeError, match=r"node.motion has no part ''; it has: position, vel"):
        getattr(motion, "")


def test_one_number_is_a_row_of_it(sim):
    sim.step(20)
    state, target = rows_of(sim.core, "spring.state"), sim.core.fields()["spring.target"]
    assert state.force_n.shape == target.shape and state.shear.shape == (len(target), 2)
    contacts = sim.contacts
    pressed = contacts["force_n"][contacts["kind"] == 0]
    assert len(pressed) and (state.force_n[target >= 0] == pressed).all()


def test_columns_are_rows_without_what_pads_them(sim):
    pairs = sim.build.assembly.pair_faces["triangles"]
    stiffness = rows_of(sim.core, "triangles.stiffness")
    assert stiffness.normal.shape == stiffness.shear.shape == (len(pairs),) and len(pairs) > 8
    flat = sim.build.arrays["triangles.stiffness"]
    np.testing.assert_array_equal(stiffness.shear, flat[len(flat) // 2 :][: len(pairs)])
    assert rows_of(sim.core, "triangles.bond").numbers.shape == (len(pairs), 3)


def test_every_array_has_its_rows(sim):
    """Those that nothing asks for have none."""
    sim.step(1)
    counts = {kind["name"]: kind["count"] for kind in sim.core.describe_rows()}
    for info in sim.core.describe():
        numbers, rows = rows_of(sim.core, info["name"]).numbers, info["rows"]
        if numbers.size and rows and info["layout"] != "starts":
            assert numbers.shape == (counts[rows], info["numbers"]), info["name"]


def test_what_is_not_there_is_told(sim):
    with pytest.raises(KeyError, match=r"node.spin"):
        rows_of(sim.core, "node.spin")
    with pytest.raises(
        AttributeError, match=r"face.area has no part 'x'; it has: none, only numbers"
    ):
        _ = rows_of(sim.core, "face.area").x
