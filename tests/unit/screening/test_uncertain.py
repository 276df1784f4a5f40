"""The file of distributions: names, units, limits, errors with their place."""

import numpy as np
import pytest
from shared.hills import joint

from cdem.errors import CaseError
from cdem.screening.loads import Loads
from cdem.screening.uncertain import Uncertain

SETS = [joint("set1", 50, 90, 30, 20e3), joint("set2", 80, 200, 35, 0.0)]
GOOD = """uncertain: 1
parameters:
  set1.friction_angle: {normal: {mean: 32, deviation: 3, low: 0}}
  set1.cohesion: {lognormal: {mean: 30, deviation: 12}, unit: kPa}
  water: {triangular: {low: 0, mode: 0.3, high: 1}}
  kh: {uniform: {low: 0, high: 0.2}}
sampling: {count: 40, seed: 1}
"""


def load(tmp_path, text):
    path = tmp_path / "u.yaml"
    path.write_text(text)
    uncertain = Uncertain.load(path)
    uncertain.for_sets(SETS, Loads())
    return uncertain


def test_samples_are_sets_and_loads(tmp_path):
    uncertain = load(tmp_path, GOOD)
    columns = uncertain.draw()
    assert not uncertain.turns and uncertain.label("set1.cohesion") == "set1.cohesion [kPa]"
    assert uncertain.label("kh") == "kh"
    samples = list(uncertain.samples(columns, SETS, Loads(kv=0.1, crack=8)))
    assert len(samples) == 40
    for number, one in enumerate(samples):
        first, second = one.planes
        assert first.cohesion == pytest.approx(1e3 * columns["set1.cohesion"][number])
        assert first.friction == columns["set1.friction_angle"][number]
        assert second == SETS[1] or np.array_equal(second.normal, SETS[1].normal)
        assert (one.loads.share, one.loads.kh) == (columns["water"][number], columns["kh"][number])
        assert (one.loads.kv, one.loads.crack) == (0.1, 8)


def test_directions_turn_the_sets(tmp_path):
    text = GOOD.replace("kh: {uniform: {low: 0, high: 0.2}}",
                        "set2.dip: {normal: {mean: 88, deviation: 4, high: 90}}\n"
                        "  set1.dip_direction: {uniform: {low: -20, high: 20}}")  # fmt: skip
    uncertain = load(tmp_path, text)
    columns = uncertain.draw()
    assert uncertain.turns
    for number, one in enumerate(uncertain.samples(columns, SETS, Loads())):
        assert one.planes[1].dip == pytest.approx(min(columns["set2.dip"][number], 89.5))
        assert one.planes[1].dip_direction == pytest.approx(200)
        assert one.planes[0].dip_direction == pytest.approx(
            columns["set1.dip_direction"][number] % 360
        )
        assert one.planes[0].dip == pytest.approx(50)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("set1.cohesion", "set1.cohesoin", ":4:3: .*did you mean set1.cohesion"),
        (
            "set1.cohesion",
            "set9.cohesion",
            "neither a value of a set nor a load; did you mean set2",
        ),
        ("water:", "snow:", "possible are set1.friction_angle"),
        ("unit: kPa", "unit: m", ":4:.*wrong dimension"),
        ("{uniform: {low: 0, high: 0.2}}", "[0, 0.1]", "give a distribution in place of values"),
        ("deviation: 12", "deviaton: 12", ":4:.*did you mean deviation"),
        ("sampling: {count: 40, seed: 1}", "", "sampling: is missing"),
        ("count: 40", "count: 0", "must be at least 1"),
        ("count: 40", "count: 900000", "at most 100,000"),
        ("uncertain: 1", "uncertain: 2", ":1:1: uncertain: must be 1"),
        ("uncertain: 1", "study: 1", "unknown key"),
    ],
)
def test_mistakes_name_their_place(tmp_path, old, new, said):
    with pytest.raises(CaseError, match=said):
        load(tmp_path, GOOD.replace(old, new))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("mean: 32, deviation: 3, low: 0", "mean: 2, deviation: 3", "outside 0 to 89"),
        ("high: 1}", "high: 1.4}", "water: .* outside 0 to 1"),
        ("{lognormal: {mean: 30, deviation: 12}, unit: kPa}",
         "{normal: {mean: 30, deviation: 30}, unit: kPa}", r"outside 0 to 1e\+09 \[kPa\]"),
    ],
)  # fmt: skip
def test_impossible_values_are_refused(tmp_path, old, new, said):
    uncertain = load(tmp_path, GOOD.replace(old, new))
    with pytest.raises(CaseError, match=said + ".*limit the distribution"):
        uncertain.draw()


def test_a_share_beside_a_water_table(tmp_path):
    uncertain = load(tmp_path, GOOD)
    with pytest.raises(CaseError, match=r":5:3: parameters.water: is drawn as a share"):
        uncertain.for_sets(SETS, Loads(share=1, level=np.zeros((2, 2))))


def test_an_empty_file(tmp_path):
    with pytest.raises(CaseError, match=r"the file is empty; see docs/screening.md"):
        load(tmp_path, "")
