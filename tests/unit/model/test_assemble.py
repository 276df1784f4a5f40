"""Arrays of the core: all of every joint is bonded."""

import numpy as np
import pytest
from scenes import simulate
from shared.joints import SETS, jointed_case

import cdem


@pytest.mark.parametrize("persistence, fisher", [(1.0, 200.0), (0.6, 200.0)])
def test_all_of_every_joint_is_bonded(persistence, fisher):
    """Where neighbours were cut differently, the true overlaps of their faces add up."""
    more = {"persistence": persistence, "scatter": {"fisher": fisher}}
    b = cdem.Simulation(
        jointed_case(
            {
                "model.joints": [s | more for s in SETS],
                "interfaces.default": {"friction_angle": 30, "cohesion": 1e6},
            }
        ),
        threads=1,
    ).build
    a = b.assembly
    made = b.arrays["face.area"][b.topology.face_kind > 0].sum() / 2
    kinds = ("triangles", "overlaps")
    bonded = [b.arrays[f"{k}.area"][: a.counts[f"{k}.count"]].sum() for k in kinds]
    assert sum(bonded) == pytest.approx(made, rel=1e-9)
    assert bonded[1] > 0.1 * made or persistence == 1


def test_faces_know_the_sphere_of_their_blocks_volume():
    blocks = [
        {"group": "a", "box": {"size": [1, 2, 3], "divisions": [1, 2, 1]}},
        {"group": "b", "box": {"size": [1, 1, 1], "shape": "tet4"}, "translate": [5, 0, 0]},
        {"group": "c", "box": {"size": [1, 1, 1]}, "translate": [9, 0, 0]},
    ]
    build = simulate(blocks, {"a": {}, "b": {}, "c": {"fix": ["x", "y", "z"]}}).build
    radius, group = build.arrays["face.radius"], build.topology.face_group
    for name, volume in (("a", 6.0), ("b", 1.0)):
        own = radius[group == build.group_names.index(name)]
        assert own == pytest.approx(np.full(len(own), (0.75 * volume / np.pi) ** (1 / 3)), rel=1e-8)
    assert (radius[group == build.group_names.index("c")] == 1e300).all()


def test_tets_that_flow_beside_others_have_a_nodal_mean():
    """Not tets alone in a block, of elastic rock, or where the case asks for none; no hexahedra."""
    blocks = [
        {"group": g, "box": {"size": [1, 1, 1], "shape": shape}, "translate": [2 * i, 0, 0]}
        for i, (g, shape) in enumerate(
            (("soft", "tet4"), ("hard", "tet4"), ("single", "tet4"), ("cubes", "hex8"))
        )
    ]
    soft = {"law": "mohr-coulomb", "cohesion": 1e6, "friction_angle": 30}
    rock = {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.25}
    for asked, expected in (("nodal-mean", {"soft": 6}), ("full", {})):
        sim = simulate(
            blocks,
            {b["group"]: {"material": "hard" if b["group"] == "hard" else "soft"} for b in blocks},
            materials={"soft": rock | soft, "hard": rock},
            model={"split": {"single": "elements"}},
            elements={"tetrahedra": asked},
        )
        b = sim.build
        averaged = b.arrays["tet4.nodal_mean"]
        names = np.array(b.group_names)[b.topology.element_group["tet4"]][: len(averaged)]
        flags = averaged[: len(names)].astype(bool)
        assert {g: int(flags[names == g].sum()) for g in set(names[flags])} == expected
        assert len(b.arrays["hex8.nodal_mean"]) == 0
        text = "soft: 6 elements of law mohr-coulomb"
        assert (f"  {text}, 6 with nodal mean\n" in sim.audit.text()) == bool(expected)
        assert f"  {text}" in sim.audit.text()


def test_cells_of_a_split_group_hide_nothing_of_each_other_or_their_bed():
    """Where they are in one another, a cell would lose the bed that its neighbour covers."""

    def flush(split):
        """Pairs of flush faces by group, once each."""
        sim = simulate(
            [
                {"group": "rock", "box": {"size": [2, 1, 1], "divisions": [2, 1, 1]}},
                {"group": "bed", "box": {"size": [2, 1, 1]}, "translate": [0, 0, -1]},
                {"group": "wall", "box": {"size": [1, 1, 1]}, "translate": [2, 0, 0.5]},
            ],
            {"rock": {}, "bed": {}, "wall": {}},
            interfaces={"default": {"friction_angle": 30, "cohesion": "1 MPa"}},
            model={"split": {"rock": split}},
        )
        t, first = sim.build.topology, sim.core.model()["flush.first"]
        own = np.repeat(np.arange(len(first) - 1), np.diff(first))
        names = np.array(t.group_names)[t.face_group]
        return {
            tuple(sorted([names[a], names[b]]))
            for a, b in zip(own, sim.core.model()["flush.face"], strict=True)
        }

    assert flush("elements") == set()
    assert flush("connected") == {("bed", "rock"), ("rock", "wall")}
