"""What a sweep has drawn stays, whoever draws it again."""

from __future__ import annotations

import json
import sys

import pytest

from cdem.errors import BackendError, CdemError
from cdem.study import samples as module
from cdem.study.samples import SAMPLES, samples, to_keep

DRAWN = """\
parameters: {a.b: {uniform: {low: 0, high: 1}}, c.d: [1, 2], e.f: {normal: {mean: 0, deviation: 3}}}
sampling: {count: 5}
"""


def keep(study, folder):
    """Draw, and keep it as a sweep does."""
    drawn = samples(study, folder)
    rows = [row | {"c.d": value} for value in (1, 2) for row in drawn]
    (folder / SAMPLES).write_text(json.dumps(to_keep(study, rows)))
    return drawn


def test_a_sweep_goes_on_with_what_it_has_drawn(study, tmp_path, monkeypatch):
    drawn = keep(study(DRAWN), tmp_path)
    assert len(drawn) == 5 and drawn[0].keys() == {"a.b", "e.f"}
    monkeypatch.setattr(module, "draw", lambda *_: [])  # another SciPy
    assert samples(study(DRAWN), tmp_path) == drawn
    assert samples(study(DRAWN.replace("[1, 2]", "[1, 2, 3]")), tmp_path) == drawn
    for other in (DRAWN.replace("5}", "6}"), DRAWN.replace("high: 1", "high: 2")):
        assert samples(study(other), tmp_path) == []


def test_a_study_that_draws_nothing_keeps_nothing(study, tmp_path):
    assert samples(study("parameters: {a.b: [1]}"), tmp_path) == [{}]


@pytest.mark.parametrize(
    "spoil",
    [
        lambda kept: "{",
        lambda kept: "[]",
        lambda kept: json.dumps(kept | {"draws": kept["draws"][1:]}),
        lambda kept: json.dumps(kept | {"draws": [3] * 5}),
        lambda kept: json.dumps(kept | {"draws": [{"a.b": 1}] * 5}),
    ],
)
def test_damaged_samples_are_one_line(study, tmp_path, spoil):
    keep(study(DRAWN), tmp_path)
    path = tmp_path / SAMPLES
    path.write_text(spoil(json.loads(path.read_text())))
    with pytest.raises(CdemError, match=r"samples.json: is damaged"):
        samples(study(DRAWN), tmp_path)


@pytest.mark.parametrize(
    ("before", "refused"),
    [
        ({"sampling": {"count": 5}}, True),
        ({"sampling": {"method": "monte-carlo", "count": 5}}, False),
        ({"parameters": {}}, False),
    ],
)
def test_a_sweep_whose_hypercube_is_not_known_is_refused(study, tmp_path, before, refused):
    (tmp_path / "study.json").write_text(json.dumps(before))
    if refused:
        with pytest.raises(CdemError, match="without storing them") as error:
            samples(study(DRAWN), tmp_path)
        assert "\n" not in str(error.value) and "-o" in str(error.value)
    else:
        assert len(samples(study(DRAWN), tmp_path)) == 5


def test_latin_hypercubes_without_scipy_are_answered(study, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.stats.qmc", None)
    with pytest.raises(BackendError, match=r"needs SciPy: pip install 'cdem\[sweep\]'"):
        samples(study(DRAWN), tmp_path)
    text = DRAWN.replace("{count", "{method: monte-carlo, count")
    assert len(samples(study(text), tmp_path)) == 5
