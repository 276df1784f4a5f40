"""Faults of fits and comparisons: bands too narrow, distances and directions with a wrong sign."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "runs that know themselves",
        "a run that is left out is predicted with itself",
        "src/cdem/fit/emulator.py",
        "self._scores[:, k] - (inverse @ self._scores[:, k]) * variances[:, k]",
        "self._scores[:, k]",
        "tests/unit/fit/test_emulator.py",
    ),
    Mutant(
        "emulators without errors",
        "the variance of the prediction does not count",
        "src/cdem/fit/posterior.py",
        "whole = own + variance[:, :, None] * np.eye(len(seen))",
        "whole = own + 0 * variance[:, :, None]",
        "tests/unit/fit/test_posterior.py",
    ),
    Mutant(
        "independent errors of an outline",
        "errors of neighbouring points of an outline are independent",
        "src/cdem/fit/observed.py",
        "return np.exp(-np.linalg.norm(at[:, None] - at[None], axis=-1) / length)",
        "return np.eye(len(at))",
        "tests/unit/fit/test_observed.py",
    ),
    Mutant(
        "edges without a side",
        "a run that falls short of an outline counts as beyond it",
        "src/cdem/fit/observed.py",
        "apart = (apart - 0.5 * np.sign(apart)) * met.cell",
        "apart = (abs(apart) - 0.5) * met.cell",
        "tests/unit/fit/test_observed.py",
    ),
    Mutant(
        "changes of one date",
        "the change of a point is its last displacement",
        "src/cdem/fit/monitored.py",
        "moved.append(found.moved[last] - found.moved[first])",
        "moved.append(found.moved[last])",
        "tests/unit/fit/test_monitored.py",
    ),
]
