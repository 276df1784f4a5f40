"""Groups that come in: they begin free of stress between rock that has moved, and bear from then on."""

import re

import numpy as np
import pytest
from scenes import digest

import cdem
from cdem.run.fields import visible_faces

YOUNG, POISSON, WEIGHT, HEIGHT = 1e9, 0.3, 25e3, 4.0
REBOUND = WEIGHT * HEIGHT**2 * (1 + POISSON) * (1 - 2 * POISSON) / (YOUNG * (1 - POISSON))
"""Of a column of 4 m between smooth walls under as much rock [m]: q h / M."""
SITU = {"name": "situ", "mode": "static"}
WALLS = [([1, 0, 0], "x"), ([-1, 0, 0], "x"), ([0, 1, 0], "y"), ([0, -1, 0], "y")]


def column(*stages, upper=(2, 2, 2), shape="hex8", case=None, **more):
    """Two cubes of 4 m between smooth walls, the upper one to come."""
    supports = [{"surface": {"group": "low", "normal": [0, 0, -1]}, "fix": ["z"]}]
    for group in ("low", "up"):
        supports += [{"surface": {"group": group, "normal": n}, "fix": [a]} for n, a in WALLS]
    blocks = [
        {"group": group, "box": {"size": [4, 4, 4], "divisions": list(cells), "shape": shape},
         "translate": [0, 0, z]}
        for group, cells, z in (("low", (2, 2, 2), 0), ("up", upper, 4))
    ]  # fmt: skip
    data = {
        "model": {"blocks": blocks},
        "materials": {"rock": {"density": 2500, "young_modulus": YOUNG, "poisson_ratio": POISSON}},
        "groups": {"low": {"material": "rock"}, "up": {"material": "rock"}},
        "interfaces": {"default": {"friction_angle": 30}},
        "loads": {"gravity": [0, 0, -10], "supports": supports},
        "stages": [SITU, *stages],
    }
    return cdem.Simulation(cdem.Case.from_dict(data | (case or {})), **{"threads": 1, **more})


def add(**more):
    return {"name": "add", "mode": "static", "tolerance": 1e-7, "add": ["up"], **more}


def top_of(sim, group):
    """Mean rise of the top of a group since the start, over the rebound under 4 m of rock."""
    start = sim.build.start_position
    nodes = sim.build.nodes_of(group)
    top = nodes[start[nodes, 2] > start[nodes, 2].max() - 1e-6]
    return (sim.fields["position"][top] - start[top])[:, 2].mean() / REBOUND


SITU_STRESS = {"initial_stress": [{"vertical": "overburden", "k0": POISSON / (1 - POISSON)}]}
BOND = {"friction_angle": 30, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
JOINT = 1 / (10 * YOUNG / 2)  # compliance of a joint, 10 E / h with h of half the block [m/Pa]


@pytest.mark.parametrize("law", [{"friction_angle": 30}, BOND], ids=["joint", "bond"])
def test_the_ground_settles_under_what_is_added(law):
    """By q h / M, as it had risen; the fill itself by half of that and by what the joint gives way."""
    sim = column(add(), case=SITU_STRESS | {"interfaces": {"default": law}})
    sim.run()
    assert top_of(sim, "low") == pytest.approx(-1, abs=1e-6)
    joint = WEIGHT * HEIGHT * JOINT / REBOUND
    assert top_of(sim, "up") == pytest.approx(-1.5 - joint, rel=0.05)
    assert abs(sim.energies["error"]) < 1e-8


@pytest.mark.parametrize("shape, upper", [("tet4", (2, 2, 2)), ("hex8", (3, 3, 3))])
def test_meshes_and_faces_that_overlap_settle_alike(shape, upper):
    sim = column(add(), shape=shape, upper=upper, case=SITU_STRESS)
    sim.run()
    assert top_of(sim, "low") == pytest.approx(-1, abs=0.02)


def test_what_was_settled_before_does_not_count():
    """The ground settles under its own weight first; the fill begins on it, free of stress."""
    sim = column(add())
    sim.run_stage("situ")
    settled = top_of(sim, "low")
    assert settled == pytest.approx(-0.5, abs=0.01)
    with_it = column(add(), case=SITU_STRESS)
    for one in (sim, with_it):
        one.run()
    assert top_of(sim, "low") - settled == pytest.approx(top_of(with_it, "low"), abs=1e-3)
    nodes = sim.build.nodes_of("up")
    moved = [one.fields["displacement"][nodes] / REBOUND for one in (sim, with_it)]
    assert moved[0] == pytest.approx(moved[1], abs=1e-3)


@pytest.mark.parametrize("upper", [(2, 2, 2), (3, 3, 3)])
def test_nothing_moves_where_nothing_weighs(upper):
    """Rock is squeezed, so that its top has moved; what is bonded onto it then bears nothing."""
    squeeze = [{"surface": {"group": "low", "normal": n}, "traction": [-1e6 * x for x in n]}
               for n in ([1, 0, 0], [-1, 0, 0])]  # fmt: skip
    held = [{"surface": {"group": "low", "normal": [0, 0, -1]}, "fix": ["z"]}]
    case = {"loads": {"gravity": [0, 0, 0], "tractions": squeeze, "supports": held},
            "interfaces": {"default": BOND}}  # fmt: skip
    situ = {**SITU, "tolerance": 1e-8}
    sim = column(case=case | {"stages": [situ, add(tolerance=1e-7)]}, upper=upper)
    sim.run_stage("situ")
    before, low, up = sim.fields["position"].copy(), *map(sim.build.nodes_of, ("low", "up"))
    moved = np.abs(before - sim.build.start_position)[low].max()
    assert moved > 1e-3
    sim.run()
    assert np.abs(sim.fields["position"] - before)[low].max() < 1e-6 * moved
    assert np.abs(sim.fields["displacement"][up]).max() < 1e-6 * moved
    foot = up[sim.build.start_position[up, 2] < HEIGHT + 1e-6]
    followed = np.abs(sim.fields["position"] - sim.build.start_position)[foot].max()
    assert followed == pytest.approx(moved, rel=0.05)


def test_it_hangs_by_its_bonds():
    """A block without support below, placed beside rock that is held: it bears its weight by bonds."""
    blocks = [{"group": g, "box": {"size": [1, 1, 1]}, "translate": [x, 0, 0]}
              for g, x in (("wall", 0), ("shelf", 1))]  # fmt: skip
    case = {"model": {"blocks": blocks}, "interfaces": {"default": BOND},
            "groups": {"wall": {"material": "rock", "fix": ["x", "y", "z"]},
                       "shelf": {"material": "rock"}},
            "loads": {"gravity": [0, 0, -10]}}  # fmt: skip
    sim = column({**add(), "add": ["shelf"]}, case=case)
    sim.run()
    assert sim.finished_stages[-1]["status"] == "converged"
    assert sim.fields["reaction"][:, 2].sum() == pytest.approx(2 * 25e3, rel=1e-4)  # both blocks
    assert sim.broken == {"tension": 0, "shear": 0}


def test_dug_out_and_filled_again_with_another_material():
    """The same group comes in as a softer one: its own settlement is that of its modulus."""
    soft = {"density": 2500, "young_modulus": YOUNG / 10, "poisson_ratio": POISSON}
    rock = {**soft, "young_modulus": YOUNG}
    stages = [
        {"name": "dig", "mode": "static", "tolerance": 1e-7, "remove": ["up"]},
        add(set={"groups.up.material": "soft"}),
    ]
    sim = column(*stages, case=SITU_STRESS | {"materials": {"rock": rock, "soft": soft}})
    sim.run_stage("dig")
    assert top_of(sim, "low") == pytest.approx(1, abs=1e-6)
    assert sim.dug_out == ["up"]
    sim.run()
    assert top_of(sim, "low") == pytest.approx(0, abs=1e-6)
    own = sim.fields["displacement"][sim.build.nodes_of("up"), 2].min() / REBOUND
    joint = WEIGHT * HEIGHT * 10 * JOINT / REBOUND  # that of the softer side
    assert own == pytest.approx(-1 - 5, abs=1.2 * joint)
    assert sim.dug_out == [] and not sim.out.any()
    assert abs(sim.energies["error"]) < 1e-6


def test_what_is_not_there_is_not_shown_told_or_touched(tmp_path):
    """A stone falls through the place of a block that comes later."""
    stone = {"group": "stone", "box": {"size": [1, 1, 1]}, "translate": [1.5, 1.5, 8.5]}
    sim = column(add(), case=SITU_STRESS, output=tmp_path / "results")
    assert not sim.build.topology.face_group[visible_faces(sim)[0]].any()  # of the first group only
    assert "absent before the stage 'add': up" in sim.audit.text()
    assert sim.summary("finished")["taken_out"] == {}
    assert not any("support" in warning for warning in sim.audit.warnings)
    sim.run()
    assert len(np.unique(sim.build.topology.face_group[visible_faces(sim)[0]])) == 2
    data = sim.case.model_dump(mode="json")
    blocks = [*data["model"]["blocks"], stone]
    groups = {**data["groups"], "stone": {"material": "rock"}}
    fall = {"name": "fall", "mode": "dynamic", "duration": 0.95}
    late = {"name": "late", "mode": "dynamic", "duration": 0.01, "add": ["up"]}
    through = column(fall, late, case={"model": {"blocks": blocks}, "groups": groups})
    through.run_stage("fall")
    assert through.fields["position"][through.build.nodes_of("stone"), 2].min() < 4.5


def test_the_walls_of_a_hole_in_bonded_rock_are_shown():
    sim = column({"name": "dig", "mode": "static", "remove": ["up"]},
                 case=SITU_STRESS | {"interfaces": {"default": BOND}})  # fmt: skip
    before = len(visible_faces(sim)[0])
    sim.run()
    after = len(visible_faces(sim)[0])
    assert (
        after == before - 20 + 4
    )  # five sides of the upper cube leave, the top of the lower comes


def test_the_bits_do_not_depend_on_threads_or_resume(tmp_path):
    stages = [add(max_steps=400), {"name": "on", "mode": "dynamic", "duration": 0.05}]
    case = SITU_STRESS | {"interfaces": {"default": BOND}, "output": {"every": 0.02}}
    whole = column(*stages, case=case)
    whole.run()
    results = tmp_path / "results"
    first = column(*stages, case=case, output=results, threads=2)
    first.run_stage("add")
    first.close()
    second = column(*stages, case=case, output=results, resume=True)
    second.run()
    assert digest(second) == digest(whole)
    assert np.array_equal(second.fields["displacement"], whole.fields["displacement"])


@pytest.mark.parametrize(
    "stages, said",
    [
        ([add(add=["upp"])], "no group 'upp'"),
        ([add(), add(name="again")], "stages.2.add.0: up is present since the stage 'add'"),
        ([{"name": "dig", "mode": "static", "remove": ["up"]}, add(name="later")], None),
        ([{"name": "dig", "mode": "static", "remove": ["up"]}, add(), add(name="more")],
         "stages.3.add.0: up is present since the stage 'add'"),
        ([add(remove=["up"])], "the stage names up twice"),
        ([add(set={"groups.low.material": "rock"})], "'material' of a group is fixed at the start"),
    ],
)  # fmt: skip
def test_stages_that_do_not_fit(stages, said):
    if said is None:
        column(*stages)
        return
    with pytest.raises(cdem.CaseError, match=re.escape(said)):
        column(*stages)


def test_the_first_stage_adds_nothing():
    with pytest.raises(
        cdem.CaseError, match="groups that no later stage adds are present from the start"
    ):
        column(case={"stages": [add()]})


def test_a_run_cannot_go_on_as_one_that_had_begun_with_the_group(tmp_path):
    results = tmp_path / "results"
    stages = [{"name": "next", "mode": "static"}]
    column(*stages, output=results).run_stage("situ")
    with pytest.raises(cdem.CaseError, match=r"groups\.up: is absent at the start"):
        column({**stages[0], "add": ["up"]}, output=results, resume=True)


def test_rock_that_has_closed_a_hole_cannot_be_filled():
    """The ground has risen above the top of the fill, which is held."""
    held = [{"surface": {"group": "up", "normal": [0, 0, 1]}, "fix": ["z"]}]
    rise = {"surface": {"group": "low", "normal": [0, 0, -1]}, "velocity": [0, 0, 20],
            "components": ["z"], "history": [[0, 0], [0.1, 1]]}  # fmt: skip
    case = {"loads": {"gravity": [0, 0, 0], "supports": held, "velocities": [rise]}}
    stages = [{"name": "push", "mode": "dynamic", "duration": 0.3}, add()]
    sim = column(case=case | {"stages": stages}, upper=(1, 1, 1))
    sim.run_stage("push")
    with pytest.raises(cdem.CaseError, match=r"stages\.1\.add: the rock around group up has moved"):
        sim.run()
