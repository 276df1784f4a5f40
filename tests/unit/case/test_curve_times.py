"""From when curves count; which are refused or told of because stages use them up."""

from __future__ import annotations

import pytest

from cdem import Case, CaseError, Simulation

PULSE = [[0, 0], [0.02, 1], [0.04, 0]]
REST = {"name": "rest", "mode": "static"}
OVER = (
    "is over at {end} s, before the stage {stage} begins: its times count from the start of the run"
)
GOES_ON = "also while the static stage {stage} comes to rest"


def dynamic(name, duration, **more):
    return {"name": name, "mode": "dynamic", "duration": duration} | more


def case(stages, *, velocities=(), tractions=(), water=None, **more):
    """A cube, with these stages and curves."""
    loads = {"gravity": [0, 0, -10], "velocities": list(velocities), "tractions": list(tractions)}
    return Case.from_dict({
        "model": {"blocks": [{"group": "rock", "box": {"size": [1, 1, 1]}}]},
        "materials": {"r": {"density": 2500, "young_modulus": "1 GPa", "poisson_ratio": 0.25}},
        "groups": {"rock": {"material": "r"}},
        "loads": loads,
        "stages": stages,
    } | ({"water": water} if water else {}) | more)  # fmt: skip


def driven(history=None, **more):
    return (
        {"group": "rock", "velocity": [1, 0, 0]} | ({"history": history} if history else {}) | more
    )


def pressed(history=None, **more):
    face = {"group": "rock", "normal": [1, 0, 0]}
    return {"surface": face, "traction": [1, 0, 0], "history": history} | more


KINDS = {
    "loads.velocities.0.history": lambda rows, **m: {"velocities": [driven(rows, **m)]},
    "loads.tractions.0.history": lambda rows, **m: {"tractions": [pressed(rows, **m)]},
    "water.fields.0.history": lambda rows, **m: {
        "water": {"fields": [{"level": 1, "history": rows} | m]}
    },
    "water.fields.0.level": lambda rows, **m: {"water": {"fields": [{"level": rows} | m]}},
    "water.reservoir.level": lambda rows, **m: {"water": {"reservoir": {"level": rows} | m}},
}
"""Every place of a case that may have a curve."""


def refusal(*args, **more):
    with pytest.raises(CaseError) as caught:
        case(*args, **more)
    return str(caught.value)


@pytest.mark.parametrize("path", KINDS)
def test_a_curve_that_is_over_before_the_last_dynamic_stage_is_refused(path):
    """Durations of the stages before are known: 0.1 and 0.2 s."""
    stages = [dynamic("a", 0.1), dynamic("b", 0.2), dynamic("shake", 1), REST]
    said = refusal(stages, **KINDS[path]([[0, 0], [0.25, 1]]))
    assert f"case: {path}: {OVER.format(end=0.25, stage='shake')}" in said
    assert "write stage: shake beside it" in said and len(said.splitlines()) == 1
    case(stages, **KINDS[path]([[0, 0], [0.35, 1]]))
    case(stages, **KINDS[path]([[0, 0], [0.25, 1]], stage="shake"))
    case(stages, **KINDS[path]([[0, 0], [0.25, 1]], stage="a"))  # said to be meant for it


@pytest.mark.parametrize("path", KINDS)
def test_a_curve_that_goes_on_in_a_static_stage_is_told(path):
    """Where its stage is not named; how long the static stage takes is not known."""
    stages = [REST, dynamic("shake", 1)]
    (said,) = case(stages, **KINDS[path](PULSE)).warnings
    assert said.startswith(f"case: {path}: goes on until 0.04 s from the start of the run, ")
    assert GOES_ON.format(stage="rest") in said
    for stage in ("rest", "shake"):
        assert not case(stages, **KINDS[path](PULSE, stage=stage)).warnings


def test_where_nothing_changes_nothing_is_over():
    stages = [REST, dynamic("a", 0.1), dynamic("shake", 1)]
    assert not case(stages, velocities=[driven([[0, 1]])]).warnings
    assert not case(stages, velocities=[driven([[0, 1], [0.01, 1]])]).warnings


def test_what_stays_as_it_is_does_not_make_a_curve_longer():
    late = [*PULSE, [10, 0]]
    said = refusal([dynamic("a", 0.1), dynamic("shake", 1)], velocities=[driven(late)])
    assert OVER.format(end=0.04, stage="shake") in said


@pytest.mark.parametrize("how", [{"until": "rest"}, {"max_steps": 10}])
def test_a_stage_that_may_end_early_decides_nothing_beforehand(how):
    case([dynamic("a", 0.1, **how), dynamic("shake", 1)], velocities=[driven(PULSE)])


def test_a_curve_that_is_longer_than_its_stage_is_told_where_it_goes_on_in_a_static_one():
    stages = [dynamic("shake", 0.03), dynamic("on", 0.005), REST]
    (said,) = case(stages, velocities=[driven(PULSE, stage="shake")]).warnings
    assert "goes on until 0.04 s from the begin of shake" in said
    assert GOES_ON.format(stage="rest") in said
    stages[1]["duration"] = 0.01
    assert not case(stages, velocities=[driven(PULSE, stage="shake")]).warnings


@pytest.mark.parametrize("path", KINDS)
def test_an_unknown_stage_is_answered_with_those_that_there_are(path):
    said = refusal([REST, dynamic("shake", 1)], **KINDS[path](PULSE, stage="shaek"))
    place = path.rpartition(".")[0]
    assert said == f"case: {place}.stage: no stage 'shaek'; the case has: rest, shake"


@pytest.mark.parametrize(
    ("load", "says"),
    [
        ({"velocities": [driven(stage="rest")]}, "give it with a history or level"),
        (
            {"water": {"reservoir": {"level": 1, "stage": "rest"}}},
            "give it with a history or level",
        ),
        ({"velocities": [driven([[-1, 0], [1, 1]], stage="rest")]}, "times must be at least 0"),
        ({"velocities": [driven([[1, 0], [1, 1]], stage="rest")]}, "history: times must increase"),
    ],
)
def test_a_stage_without_a_curve_and_times_before_it_are_refused(load, says):
    assert says in refusal([REST], **load)


def test_a_curve_cannot_begin_in_a_stage_where_its_group_is_not_there():
    model = {"blocks": [{"group": g, "box": {"size": [1, 1, 1]}} for g in ("rock", "fill")]}
    groups = {"rock": {"material": "r"}, "fill": {"material": "r"}}
    stages = [REST, dynamic("come", 1, add=["fill"]), dynamic("go", 1, remove=["fill"])]
    for stage in ("rest", "come", "go"):
        face = {"group": "fill", "normal": [0, 0, 1]}
        load = {"velocities": [driven(PULSE, stage=stage, group="fill")],
                "tractions": [pressed(PULSE, stage=stage, surface=face)]}  # fmt: skip
        if stage == "come":
            case(stages, model=model, groups=groups, **load)
            continue
        said = refusal(stages, model=model, groups=groups, **load)
        assert said.count(f"fill is not present in the stage {stage}") == 2


def test_a_history_that_a_stage_sets_counts_from_the_start_of_the_run_too():
    path = "loads.velocities.0"
    stages = [dynamic("a", 0.1), dynamic("shake", 1, set={f"{path}.history": PULSE})]
    said = refusal(stages, velocities=[driven([[0, 0], [1, 1]])])
    assert f"{path}.history: {OVER.format(end=0.04, stage='shake')}" in said
    stages[1]["set"][f"{path}.stage"] = "shake"
    case(stages, velocities=[driven([[0, 0], [1, 1]])])
    stages[1]["set"][f"{path}.stage"] = "shaek"
    assert "no stage 'shaek'" in refusal(stages, velocities=[driven([[0, 0], [1, 1]])])


def test_one_that_the_last_dynamic_stage_replaces_has_done_its_part():
    new = {"loads.velocities.0.history": [[0.1, 0], [0.5, 1]]}
    case([dynamic("a", 0.1), dynamic("shake", 1, set=new)], velocities=[driven(PULSE)])


def test_a_script_may_set_a_history_and_its_stage():
    """Names of stages that the case has are known while it runs, too."""
    stages = [dynamic("a", 0.02), dynamic("shake", 0.05)]
    sim = Simulation(case(stages, velocities=[driven(PULSE, stage="shake")]), threads=1)
    sim.run_stage("a")
    sim.set("loads.velocities.0.history", [[0, 0], [0.03, 1]])
    sim.set("loads.velocities.0.velocity", [2, 0, 0])
    with pytest.raises(CaseError, match="no stage 'shaek'; the case has: a, shake"):
        sim.set("loads.velocities.0.stage", "shaek")
    sim.run()
    assert sim.fields["velocity"][:, 0] == pytest.approx(2.0)
