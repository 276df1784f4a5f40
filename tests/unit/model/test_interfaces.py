"""Which interface holds where: joints before groups, and only where faces can touch."""

from __future__ import annotations

from shared.cases import CUBE
from shared.joints import SETS, jointed_case

import cdem


def test_interfaces_follow_the_joint_then_the_groups():
    b = cdem.Simulation(
        jointed_case({
            "model.joints": SETS,
            "interfaces.pairs": [{"joint": "b", "friction_angle": 11, "cohesion": 5},
                                 {"between": ["rock", "rock"], "friction_angle": 22, "cohesion": 5}],
        }), threads=1,
    ).build  # fmt: skip
    t, a = b.topology, b.assembly
    law = b.arrays["triangles.interface"][: a.counts["triangles.count"]]
    kind = t.face_kind[a.pair_faces["triangles"]]
    assert (kind[:, 0] == kind[:, 1]).all() and set(kind[:, 0]) == {1, 2, 3}
    assert ((kind[:, 0] == 2) == (law == 0)).all() and set(law) == {0, 1}
    table = b.arrays["interface.of"].reshape(4, 4)
    assert (table == [[1, 1, 0, 1]] * 4).all()  # what touches a face of set b has its law


def test_only_what_can_touch_needs_an_interface(run_cli, cube_folder):
    alone = CUBE.replace("interfaces: {default: {friction_angle: 30}}\n", "")
    (cube_folder / "alone.yaml").write_text(alone)
    assert run_cli("check", "alone.yaml")[0] == 0
    second = ", {group: cube, box: {size: [1, 1, 1]}, translate: [3, 0, 0]}]}"
    (cube_folder / "two.yaml").write_text(alone.replace("]}}]}", "]}}" + second))
    status, _, err = run_cli("check", "two.yaml")
    assert status == 1
    assert "may come to touch" in err
