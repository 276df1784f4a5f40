"""Scenes of `trust/resume` are killed at the ends of their stages, and go on to the same bytes.

Frames, histories and summaries are compared. Water that rises (frames once had the pressures of
t = 0), bolts that come and go (once a crash), rock that is dug out and lets go (its kept forces once
were 0) and a lining that comes in (its reactions once differed by 1e-8).
"""

from __future__ import annotations

from functools import partial

import pytest
from shared.faults import fault
from shared.stopped import StagesOf

from cdem import Case, CaseError

slow = pytest.mark.slow


@pytest.mark.parametrize(
    "name",
    ["s01_dam", *(pytest.param(n, marks=slow) for n in ("s02_bolts", "s03_tunnel", "s04_lining"))],
)
def test_a_scene_killed_at_any_stage_goes_on_to_the_same_bytes(name, tmp_path):
    runs = StagesOf(fault(f"trust/resume/{name}.yaml"), tmp_path)
    for stage, _ in runs.stages[:-1]:
        assert runs.differing(partial(runs.stop_at_end, stage)) == [], stage


def bolts(which: int, stages: list[int], *, stays: bool = False) -> dict:
    """Of `s02_bolts` one bolt and some stages, the first of 100 steps."""
    case = fault("trust/resume/s02_bolts.yaml")
    case["bolts"] = [case["bolts"][which]]
    if stays:
        del case["bolts"][0]["remove"]
    case["histories"][0]["bolt"] = case["bolts"][0]["name"]
    case["stages"] = [case["stages"][k] for k in stages]
    case["stages"][0]["max_steps"] = 100
    return case


def lining(without: str) -> dict:
    """Of `s04_lining` three stages, the last without one of its keys."""
    case = fault("trust/resume/s04_lining.yaml")
    case["stages"] = case["stages"][:3]
    del case["stages"][2][without]
    return case


@pytest.mark.parametrize(
    ("case", "stage"),
    [
        pytest.param(partial(bolts, 1, [0, 1]), "w", id="install"),
        pytest.param(partial(bolts, 0, [0, 2]), "w", id="remove", marks=slow),
        pytest.param(partial(bolts, 0, [0, 1], stays=True), "w", id="plain", marks=slow),
        pytest.param(partial(lining, "set"), "dig", id="add"),
    ],
)
def test_the_small_cases_of_mini_go_on_to_the_same_bytes(case, stage, tmp_path):
    runs = StagesOf(case(), tmp_path)
    assert runs.differing(partial(runs.stop_at_end, stage)) == []


def test_the_case_of_mini_that_sets_without_add_is_refused():
    """`m_set`: a body that is in the model keeps its material."""
    told = r"stages.2.set.groups.tunnel.material: 'material' of a group is fixed at the start"
    with pytest.raises(CaseError, match=told) as caught:
        Case.from_dict(lining("add"))
    assert "\n" not in str(caught.value)
