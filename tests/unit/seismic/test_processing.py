"""Processing of records: order, integrals, filter, baseline."""

import numpy as np
import pytest
from shared.signals import G, synthetic

from cdem.seismic.measures import measures
from cdem.seismic.processing import (
    filtered,
    integral,
    of_acceleration,
    of_kind,
    on_baseline,
    process,
    steps_of,
    tapered,
)


def test_the_cubic_baseline_of_the_synthetic_record_is_as_computed_before():
    """PGA 0.36513 g, PGV 0.33722 m/s, velocity at the end 0.0023 m/s, from waves/record.py."""
    _, a = synthetic()
    found = measures(on_baseline(of_acceleration(a, 0.005), "acceleration"))
    assert found.pga / G == pytest.approx(0.36513, abs=1e-5)
    assert found.pgv == pytest.approx(0.33722, abs=1e-5)
    assert found.last_velocity == pytest.approx(0.0023, abs=1e-5)


def test_a_cubic_drift_is_removed_whole():
    """Also from a velocity; the rest is round-off of a drift of 2 m/s."""
    t = np.arange(2001) * 0.01
    drift = 0.1 * t - 0.03 * t**2 + 0.001 * t**3
    left = on_baseline(of_kind(drift, 0.01, "velocity"), "velocity")
    assert np.abs(left.velocity).max() < 1e-11


@pytest.mark.parametrize("kind", ["acceleration", "velocity", "displacement"])
def test_velocity_and_displacement_are_integrals_after_every_step(kind):
    """By the trapezoidal rule, to the bit."""
    _, a = synthetic()
    for _, one in steps_of(a, 0.005, kind, (0.2, 10.0), "cubic"):
        assert (one.displacement == integral(one.velocity, 0.005)).all()
        if kind == "acceleration":
            assert (one.velocity == integral(one.acceleration, 0.005)).all()


def test_the_filter_keeps_phase_and_halves_amplitudes_at_its_ends():
    """A burst of 1 Hz stays in place; at the ends of the band the factor is 1/2, far out 0."""
    t = np.arange(8000) * 0.005
    window = np.exp(-(((t - 20) / 4) ** 2))
    for frequency, factor in ((0.2, 0.5), (1.0, 1.0), (8.0, 0.5), (30.0, 0.0)):
        burst = window * np.cos(2 * np.pi * frequency * (t - 20))
        left = filtered(burst, 0.005, 0.2, 8.0)
        assert left[4000] == pytest.approx(factor, abs=0.02)
        assert abs((left * np.sin(2 * np.pi * frequency * (t - 20)) * window).sum()) < 1e-9


def test_the_taper_is_1_percent_of_each_end():
    """The middle keeps its bits."""
    left = tapered(np.ones(1000))
    assert left[0] == left[-1] == 0 and (left[10:990] == 1).all() and 0 < left[9] < 1


def test_the_steps_are_named_in_their_order():
    """Scale, taper, band, baseline; those not asked for are left out."""
    samples = " ".join(map(repr, synthetic()[1].tolist()))
    whole = process(samples, 2.0, 0.005, "acceleration", (0.1, 15.0), "cubic")
    names = ["as read, scaled", "taper", "band-pass 0.1 to 15 Hz", "cubic baseline"]
    assert [name for name, _ in whole] == names
    short = process(samples, 1.0, 0.005, "acceleration", None, "none")
    assert [name for name, _ in short] == names[:2]
    np.testing.assert_array_equal(whole[0][1].acceleration, 2 * short[0][1].acceleration)
    with pytest.raises(ValueError, match="read-only"):
        whole[-1][1].velocity[0] = 1
