"""Damping of rock: factors of Rayleigh, and the fit of Maxwell branches."""

import numpy as np
import pytest

from cdem.case.damping_schema import Maxwell, Rayleigh
from cdem.model.damping import branches_of, fitted, rayleigh_factors


def test_rayleigh_factors_give_the_ratio_at_the_frequency_and_more_beside_it():
    """xi/2 (f0/f + f/f0): 15.4, 8.3, 5, 9.1 and 17 % of 5 % at 3 Hz."""
    factors = rayleigh_factors(Rayleigh(ratio=0.05, frequency=3))
    ratios = [factors.ratio(f) for f in (0.5, 1, 3, 10, 20)]
    assert ratios == pytest.approx([0.1542, 0.0833, 0.05, 0.0908, 0.1704], abs=5e-5)
    assert rayleigh_factors(None).stiffness == 0
    mass = rayleigh_factors(Rayleigh(ratio=0.05, frequency=3, part="mass"))
    assert (mass.ratio(3), mass.stiffness) == (pytest.approx(0.025), 0)


@pytest.mark.parametrize("ratio", [0.01, 0.02, 0.05, 0.2])
@pytest.mark.parametrize(("width", "worst"), [(10, 0.0015), (100, 0.03), (1000, 0.12)])
def test_branches_are_flat_over_the_band(ratio, width, worst):
    """The largest error of the ratio: 0.13, 2.9 and 11.3 % over one, two and three decades."""
    branches = branches_of(Maxwell(ratio=ratio, band=[1, width]))
    errors = np.abs(branches.ratio(np.geomspace(1, width, 2000)) / ratio - 1)
    assert errors.max() < worst
    assert errors.max() > 0.5 * worst


@pytest.mark.parametrize(
    ("ratio", "step", "storage"),
    [
        (0.01, 0.955, (1.014, 1.047, 1.081)),
        (0.02, 0.912, (1.028, 1.096, 1.168)),
        (0.05, 0.795, (1.068, 1.252, 1.469)),
    ],
)
def test_branches_cost_little_of_the_step_and_stiffen_the_rock(ratio, step, storage):
    """Step and storage moduli of a band of two decades, as another fit has them."""
    branches = branches_of(Maxwell(ratio=ratio, band=[0.2, 20]))
    assert branches.stiffer**-0.5 == pytest.approx(step, rel=2e-3)
    assert [branches.storage(f) for f in (0.2, 2, 20)] == pytest.approx(storage, rel=5e-3)


def test_a_reference_frequency_takes_the_storage_modulus_out_of_the_rock():
    """The moduli of the case then hold at that frequency."""
    branches = branches_of(Maxwell(ratio=0.05, band=[0.2, 20], reference=3))
    assert branches.part * branches.storage(3.0) == pytest.approx(1, abs=1e-5)
    assert branches_of(None).stiffer == branches_of(None).part == 1


def test_a_narrow_band_is_widened_to_a_decade_and_numbers_have_few_digits():
    """Three branches are not unique over less; digits beyond six depend on libraries."""
    narrow = branches_of(Maxwell(ratio=0.05, band=[1, 1.5]))
    middle = np.sqrt(1.5)
    wide = branches_of(Maxwell(ratio=0.05, band=[middle / 10**0.5, middle * 10**0.5]))
    assert narrow == wide
    for number in (*wide.frequency, *wide.weight):
        assert number == float(f"{number:.5e}")
    fitted.cache_clear()
    assert branches_of(Maxwell(ratio=0.05, band=[1, 1.5])) == narrow
