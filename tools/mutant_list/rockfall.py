"""Faults in `src/cdem/rockfall`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "passage",
        "a passage is noted at the sample before it",
        "src/cdem/rockfall/tracks.py",
        "part = side[at] / (side[at] - side[at + 1])",
        "part = 0 * side[at]",
        "tests/unit/rockfall/test_tracks.py::test_a_throw_passes_at_the_height_of_its_parabola",
    ),
    Mutant(
        "rank",
        "the band of a quantile is one value too narrow",
        "src/cdem/rockfall/statistics.py",
        'above = int(np.searchsorted(upto, 1 - miss, side="left")) + 1',
        'above = int(np.searchsorted(upto, 1 - miss, side="left"))',
        "tests/unit/rockfall/test_statistics.py::"
        "test_ranks_are_the_narrowest_that_miss_with_a_fortieth_on_each_side",
    ),
    Mutant(
        "inertia",
        "the spin of a block by the inertia of its corners",
        "src/cdem/rockfall/rigid.py",
        'return (sums + np.einsum("t,tki,tkj->ij", self._share, a, b)) / 20',
        'return np.einsum("t,tki,tkj->ij", self._share, a, b) / 4',
        "tests/unit/rockfall/test_rigid.py::test_energies_of_a_turning_box",
    ),
    Mutant(
        "sticky ground",
        "blocks stick to ground that they touch as a window begins",
        "src/cdem/rockfall/fall.py",
        '"cohesion": 0.0,  # or the block would stick to ground that it touches at the start\n'
        '            "tensile_strength": 0.0,\n',
        "",
        "tests/validation/test_rockfall.py::"
        "test_a_slide_on_a_plane_has_the_speed_of_the_energy_balance",
    ),
]
