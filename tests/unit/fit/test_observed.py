"""Observations as vectors, and the same of a run."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.fit.fitting import Fit
from cdem.fit.observed import distance_beyond, observed
from cdem.output.deposit import Deposit
from cdem.terrain.rasters import Raster


@pytest.fixture
def fit_of(tmp_path):
    """A fit with one observation, beside its files."""

    def fit_of(**one) -> Fit:
        path = tmp_path / "fit.yaml"
        path.write_text(json.dumps({"study": "study.yaml", "observed": [one]}))
        return Fit.load(path)

    return fit_of


def square(tmp_path, low: float, high: float) -> None:
    ring = [[low, low], [high, low], [high, high], [low, high], [low, low]]
    shape = {"type": "Polygon", "coordinates": [ring]}
    feature = {"type": "Feature", "properties": {}, "geometry": shape}
    collection = {"type": "FeatureCollection", "features": [feature]}
    (tmp_path / "mapped.geojson").write_text(json.dumps(collection))


def met(low: float, high: float, cell: float = 1.0) -> Raster:
    """The cells of a square in which rock was."""
    count = round((high - low) / cell)
    return Raster(low, low, cell, np.ones((count, count)))


def test_distance_beyond_is_positive_inside_and_negative_outside():
    at = np.array([[110.0, 110.0], [110.0, 103.0], [110.0, 95.0], [130.0, 110.0], [110.0, 60.0]])
    expected = [10, 3, -5, -10, -40]  # from the nearest edge of the square of 100 to 120
    assert distance_beyond(met(100, 120), at) == pytest.approx(expected, abs=0.51)


def test_distance_beyond_an_edge_inside_the_map_of_the_run():
    values = np.full((40, 40), np.nan)
    values[:, :17] = 1.0
    found = distance_beyond(Raster(0.0, 0.0, 2.0, values), np.array([[50.0, 40.0], [20.0, 40.0]]))
    assert found == pytest.approx([-16, 14], abs=1.0)


def test_a_run_that_equals_the_outline_lies_at_it(fit_of, tmp_path):
    square(tmp_path, 1000.0, 1200.0)
    one = observed(fit_of(outline="mapped.geojson", deviation="10 m"), None)[0]
    run = SimpleNamespace(maps=SimpleNamespace(affected=met(1000, 1200, 5.0)))
    assert one.of_run({}, run) == pytest.approx(np.zeros(len(one.values)), abs=2.6)
    larger = SimpleNamespace(maps=SimpleNamespace(affected=met(980, 1220, 5.0)))
    assert one.of_run({}, larger) == pytest.approx(np.full(len(one.values), 20.0), abs=2.6)


def test_errors_of_an_outline_are_alike_over_its_length(fit_of, tmp_path):
    square(tmp_path, 0.0, 100.0)
    one = observed(fit_of(outline="mapped.geojson", deviation=2, length=50), None)[0]
    apart = np.linalg.norm(one.at[0] - one.at[5])
    assert one.covariance[0, 5] == pytest.approx(4 * np.exp(-apart / 50))
    assert one.deviation == pytest.approx(2)
    assert np.linalg.eigvalsh(one.covariance).min() > 0


def test_thickness_is_the_mean_over_an_observed_cell(fit_of, tmp_path):
    (tmp_path / "thick.asc").write_text(
        "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n"
        "3 -9999\n1 2\n"
    )
    one = observed(fit_of(thickness="thick.asc", deviation="0.5 m"), None)[0]
    assert one.values.tolist() == [1, 2, 3]
    y = np.arange(20)[:, None] + 0.5
    deposit = Deposit(0.0, 0.0, 1.0, np.broadcast_to(0.1 * y, (20, 20)).copy())
    run = SimpleNamespace(deposit=deposit)
    assert one.of_run({}, run) == pytest.approx([0.5, 0.5, 1.5], abs=0.02)


def test_the_front_is_read_at_the_observed_times(fit_of, tmp_path):
    (tmp_path / "front.csv").write_text("time [s];distance [km];who\n20;0.4;a\n10;0.1;b\n")
    one = observed(fit_of(front="front.csv", deviation=5), None)[0]
    assert one.values.tolist() == [100, 400]
    assert one.notes == ["columns not used: who"]
    history = {"time": np.array([5.0, 15.0, 25.0]), "front": np.array([0.0, 90.0, 300.0])}
    assert one.of_run({}, SimpleNamespace(history=history)) == pytest.approx([90, 300])


def test_a_number_of_the_run_out_is_named_by_its_path(fit_of):
    run = SimpleNamespace(as_dict=lambda: {"deposit": {"area": 5.0}, "at_rest": True})
    one = observed(fit_of(runout="deposit.area", value=4, deviation=1), None)[0]
    assert one.of_run({}, run) == [5.0]
    for wrong in ("deposit.depth", "at_rest", "deposit"):
        one = observed(fit_of(runout=wrong, value=4, deviation=1), None)[0]
        with pytest.raises(CaseError, match=f"fit.yaml.*{wrong} is no number of runout.json"):
            one.of_run({}, run)


@pytest.mark.parametrize(
    "one, message",
    [
        ({"outlne": "a.gpkg", "deviation": 1}, "needs one of result, runout, outline"),
        ({"outline": "a.gpkg"}, "deviation: is missing"),
        ({"result": "x", "value": 1, "deviation": 0}, "must be above 0"),
        ({"front": "f.csv", "deviation": "5 s"}, "deviation.*'5 s'"),
        ({"outline": "a.gpkg", "deviation": 1, "lengths": 3}, "did you mean length"),
        ({"outline": "none.gpkg", "deviation": 1}, "none.gpkg"),
    ],
)
def test_a_wrong_observation_is_one_clear_error(fit_of, one, message):
    with pytest.raises(CaseError, match=message):
        observed(fit_of(**one), None)


@pytest.mark.parametrize(
    "text, message",
    [
        ("time,distance\n", "needs a line of names and rows of numbers"),
        ("time,x\n1,2\n", "has no column distance"),
        ("time,distance\n1,far\n", "must be numbers"),
    ],
)
def test_a_wrong_table_of_front_times_is_one_clear_error(fit_of, tmp_path, text, message):
    (tmp_path / "front.csv").write_text(text)
    with pytest.raises(CaseError, match=message):
        observed(fit_of(front="front.csv", deviation=5), None)
