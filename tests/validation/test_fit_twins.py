"""Twin experiments: hidden frictions are found from the travel that they make, within their band.

A block slides s = 60 m down a plane of 30 degrees, with friction p, then over flat ground with
friction q, until it stops. It enters the flat with v^2 = 2 g s (sin 30 - cos 30 tan p), after the time
t = 2 s / v, and stops after v^2 / (2 g tan q).
"""

from dataclasses import replace

import numpy as np
import pytest

from cdem.fit.find import emulate, find, together
from cdem.fit.observed import Observed
from cdem.fit.posterior import sample
from cdem.fit.priors import Prior
from cdem.fit.runs import Runs
from cdem.study.sampling import draw
from cdem.study.schema import Parameter, Sampling

G, SLIDE = 9.81, 60.0
LOW, HIGH = np.array([8.0, 15.0]), np.array([22.0, 35.0])
DEVIATIONS = {"travel": 2.0, "time": 0.2}


def slide(p, q):
    """Travel on the flat [m], and time on the plane [s], for friction angles [deg]."""
    slope = np.radians(30)
    squared = 2 * G * SLIDE * (np.sin(slope) - np.cos(slope) * np.tan(np.radians(p)))
    return squared / (2 * G * np.tan(np.radians(q))), 2 * SLIDE / np.sqrt(squared)


@pytest.fixture(scope="module")
def runs() -> Runs:
    limits = zip("pq", LOW, HIGH, strict=True)
    parameters = {n: Parameter(uniform={"low": a, "high": b}) for n, a, b in limits}
    rows = draw(parameters, Sampling(count=24, seed=1))
    used = np.array([[row["p"], row["q"]] for row in rows])
    travel, time = slide(*used.T)
    priors = [Prior.of(n, n, one, used[:, k]) for k, (n, one) in enumerate(parameters.items())]
    wanted = [
        Observed(name, "", np.zeros(1), np.array([[d**2]]), lambda row, found: np.zeros(1), False)
        for name, d in DEVIATIONS.items()
    ]
    return Runs(priors, used, wanted, [travel[:, None], time[:, None]], [])


@pytest.mark.parametrize(
    ("trials", "least"), [(4, 2), pytest.param(20, 15, marks=pytest.mark.slow)]
)
def test_hidden_frictions_lie_in_their_bands(runs, trials, least):
    random = np.random.default_rng(11)
    whole, _ = emulate(runs, seed=1)
    hits, widths = np.zeros(2), np.zeros(2)
    for trial in range(trials):
        hidden = LOW + (HIGH - LOW) * random.random(2)
        noisy = [
            replace(one, values=np.array([value + one.deviation * random.standard_normal()]))
            for one, value in zip(runs.observed, slide(*hidden), strict=True)
        ]
        places = sample(together(whole, noisy), 2, seed=trial).places
        samples = np.column_stack([p.value(places[:, k]) for k, p in enumerate(runs.priors)])
        low, high = np.quantile(samples, (0.05, 0.95), axis=0)
        hits += (low <= hidden) & (hidden <= high)
        widths += (high - low) / trials
    assert (hits >= least).all(), hits
    # 90 % of a uniform distribution before
    assert (widths < 0.45 * 0.9 * (HIGH - LOW)).all(), widths


def test_an_observation_that_no_friction_explains_is_told(runs):
    far = [replace(one, values=np.array([500.0])) for one in runs.observed[:1]]
    found = find(replace(runs, observed=far, results=runs.results[:1]), seed=1)
    assert any("no parameters of the study explain it" in note for note in found.notes)
    assert any("end of its range" in note for note in found.notes)
