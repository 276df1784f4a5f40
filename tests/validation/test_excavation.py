"""Rock that is dug out: what it bore is kept, and let go at once, in parts or over time."""

from pathlib import Path

import numpy as np
import pytest
from scenes import digest

import cdem
from cdem.output.report import info
from cdem.run.fields import visible_faces

YOUNG, POISSON, WEIGHT, HEIGHT = 1e9, 0.3, 25e3, 4.0
REBOUND = WEIGHT * HEIGHT**2 * (1 + POISSON) * (1 - 2 * POISSON) / (YOUNG * (1 - POISSON))
"""Of the lower half of a column between smooth walls when the upper half is dug out [m]."""
SITU = {"name": "situ", "mode": "static"}


def column(*stages, lower=(2, 2, 2), **more):
    """Two cubes of 4 m between smooth walls, under their weight from the start."""
    walls = [([1, 0, 0], "x"), ([-1, 0, 0], "x"), ([0, 1, 0], "y"), ([0, -1, 0], "y")]
    supports = [{"surface": {"group": "low", "normal": [0, 0, -1]}, "fix": ["z"]}]
    for group in ("low", "up"):
        supports += [{"surface": {"group": group, "normal": n}, "fix": [a]} for n, a in walls]
    blocks = [
        {"group": group, "box": {"size": [4, 4, 4], "divisions": list(cells), "shape": "tet4"},
         "translate": [0, 0, z]}
        for group, cells, z in (("low", lower, 0), ("up", (2, 2, 2), 4))
    ]  # fmt: skip
    return cdem.Simulation(
        cdem.Case.from_dict(
            {
                "model": {"blocks": blocks},
                "materials": {
                    "rock": {"density": 2500, "young_modulus": YOUNG, "poisson_ratio": POISSON}
                },
                "groups": {"low": {"material": "rock"}, "up": {"material": "rock"}},
                "interfaces": {"default": {"friction_angle": 30}},
                "loads": {"gravity": [0, 0, -10], "supports": supports},
                "initial_stress": [{"vertical": "overburden", "k0": POISSON / (1 - POISSON)}],
                "stages": [SITU, *stages],
            }
        ),
        **{"threads": 1, **more},
    )


def dig(**more):
    return {"name": "dig", "mode": "static", "tolerance": 1e-7, "remove": ["up"], **more}


def rebound(sim):
    """Mean rise of the top of the lower cube over that of theory."""
    start = sim.build.start_position
    top = sim.build.nodes_of("low")
    top = top[start[top, 2] > HEIGHT - 1e-6]
    return (sim.fields["position"][top] - start[top])[:, 2].mean() / REBOUND


@pytest.mark.parametrize("release", [None, {"parts": 4}])
def test_the_column_rebounds(release):
    """u = q h / M, M the modulus of confined compression."""
    sim = column(dig(release=release))
    sim.run()
    assert rebound(sim) == pytest.approx(1, abs=1e-7)
    assert abs(sim.energies["error"]) < 3e-7


def test_a_part_is_held_until_a_later_stage():
    hold = {"name": "hold", "mode": "static", "tolerance": 1e-7}
    rest = {"name": "rest", "mode": "static", "tolerance": 1e-7, "release": {"parts": 2}}
    sim = column(dig(release={"parts": 3, "to": 0.4}), hold, rest)
    for stage, part in (("dig", 0.4), ("hold", 0.4), ("rest", 1)):
        sim.run_stage(stage)
        assert rebound(sim) == pytest.approx(part, abs=1e-6)


def test_release_over_time_is_almost_static():
    """Over 20 periods of the column: the end swings by some thousandths."""
    sim = column(
        {"name": "dig", "mode": "dynamic", "duration": 0.5, "remove": ["up"],
         "release": {"over": 0.4}, "damping": {"mass": 20}}
    )  # fmt: skip
    sim.run_until(0.2)
    assert rebound(sim) == pytest.approx(0.5, abs=0.01)
    sim.run()
    assert rebound(sim) == pytest.approx(1, abs=5e-3)
    assert abs(sim.energies["error"]) < 1e-5


def test_faces_that_overlap_let_go_alike():
    sim = column(dig(), lower=(3, 3, 3))
    sim.run()
    assert rebound(sim) == pytest.approx(1, abs=0.02)


@pytest.mark.parametrize("angle", [0, 30], ids=["faces", "edges and vertices"])
def test_forces_of_contacts_are_kept(angle):
    """What lay on a block bears on it as before while nothing is let go: it does not move."""
    blocks = [
        {"group": "base", "box": {"size": [3, 3, 1]}, "translate": [-1.5, -1.5, -1]},
        {"group": "block", "box": {"size": [1, 1, 1]}, "translate": [-0.5, -0.5, 0]},
        {"group": "load", "box": {"size": [2, 0.4, 1]}, "translate": [-1, -0.2, 1],
         "rotate": {"axis": [0, 0, 1], "angle": f"{angle} deg"}},
    ]  # fmt: skip
    stages = [
        {"name": "situ", "mode": "static", "tolerance": 1e-8},
        {"name": "dig", "mode": "static", "tolerance": 1e-6, "remove": ["load"],
         "release": {"to": 0}},
        {"name": "go", "mode": "static", "tolerance": 1e-6, "release": {"to": 1}},
    ]  # fmt: skip
    sim = cdem.Simulation(
        cdem.Case.from_dict(
            {
                "model": {"blocks": blocks},
                "materials": {
                    "rock": {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.2}
                },
                "groups": {
                    "base": {"material": "rock", "fix": ["x", "y", "z"]},
                    "block": {"material": "rock"},
                    "load": {"material": "rock"},
                },
                "interfaces": {"default": {"friction_angle": 30}},
                "loads": {"gravity": [0, 0, -10]},
                "stages": stages,
            }
        ),
        threads=1,
    )
    block = sim.build.nodes_of("block")
    sim.run_stage("situ")
    before = sim.fields["position"][block].copy()
    settled = (sim.build.start_position[block] - before)[:, 2].max()
    sim.run_stage("dig")
    assert np.abs(sim.fields["position"][block] - before).max() < 1e-5 * settled
    sim.run_stage("go")
    assert (sim.fields["position"][block] - before)[:, 2].max() > 0.2 * settled


def test_what_was_dug_out_is_not_shown_and_is_told(tmp_path):
    sim = column(dig(), output=tmp_path / "results")
    sim.run()
    faces, _ = visible_faces(sim)
    t = sim.build.topology
    assert set(t.block_group[t.face_block[faces]]) == {sim.build.group_names.index("low")}
    assert "removed: 1 blocks of group up" in info(tmp_path / "results")


def test_threads_and_a_stop_in_between_give_identical_results(tmp_path):
    def run(threads=1, **more):
        return column(dig(release={"parts": 6}), lower=(3, 3, 3), threads=threads, **more)

    whole = run(output=tmp_path / "whole")
    whole.run()
    other = run(3)
    other.run()
    assert digest(other) == digest(whole)
    asked = iter([False] * 3 + [True])
    broken = run(output=tmp_path / "broken")
    assert broken.run(should_stop=lambda: next(asked)) == "stopped"
    assert 0 < broken.stage.parts < 6
    assert broken.core.scalars()["relief_to"] == pytest.approx(1 - broken.stage.parts / 6)
    resumed = run(output=tmp_path / "broken", resume=True)
    resumed.run()
    assert digest(resumed) == digest(whole)


@pytest.mark.parametrize(
    ("stages", "text"),
    [
        ([{"name": "dig", "mode": "static", "remove": ["top"]}], "no group 'top'"),
        ([dig(), {**dig(), "name": "again"}], "up was removed in the stage 'dig'"),
        ([dig(release={"over": 1})], "release.over has no effect in a static stage"),
        (
            [{"name": "a", "mode": "dynamic", "duration": 1, "release": {"parts": 2}}],
            "release.parts has no effect in a dynamic stage",
        ),
        ([{"name": "a", "mode": "static", "release": {}}], "no group has been removed yet"),
        (
            [dig(), {"name": "a", "mode": "static", "release": {"to": 0.5}}],
            "must be at least 1, the part that an earlier stage has released",
        ),
    ],
)
def test_mistakes(stages, text):
    with pytest.raises(cdem.CaseError, match=text):
        column(*stages)


def test_nothing_is_dug_out_in_the_first_stage():
    case = column().case
    with pytest.raises(
        cdem.CaseError, match="there are no forces before the first stage to release"
    ):
        cdem.Case.from_dict({**case.model_dump(mode="json", exclude_unset=True), "stages": [dig()]})


@pytest.mark.slow
def test_the_wedge_of_the_templates_falls_unless_bolts_hold_it():
    """Free fall once the face lets go, from 0.12 s on: g t^2 / 2; bolts: millimetres."""
    home = Path(cdem.__file__).parent / "templates"
    drops = {}
    for name in ("tunnel", "tunnel_bolts"):
        sim = cdem.Simulation(home / f"{name}.yaml", threads=1)
        sim.run_until(0.5)
        drops[name] = -float(sim.fields["displacement"][:, 2].min())
    assert drops["tunnel"] == pytest.approx(9.81 * 0.38**2 / 2, rel=0.2)
    assert drops["tunnel_bolts"] < 0.01
