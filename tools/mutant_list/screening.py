"""Faults in `src/cdem/screening`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "wedge on one plane",
        "a wedge slides down the plane whose fall the other one bars",
        "src/cdem/screening/sliding.py",
        "(inward[..., 1] < bar[..., 1])",
        "(inward[..., 1] > bar[..., 1])",
        "tests/unit/screening/test_sliding.py",
    ),
    Mutant(
        "turning body",
        "bodies that turn about the edge of their plane count as sliding",
        "src/cdem/screening/bodies.py",
        'if sliding.kind not in ("first", "second"):',
        "if True:",
        "tests/unit/screening/test_bodies.py",
    ),
    Mutant(
        "uplift into the rock",
        "water presses bodies onto their planes",
        "src/cdem/screening/loads.py",
        "force + lift @ normals",
        "force - lift @ normals",
        "tests/unit/screening/test_loads.py",
    ),
    Mutant(
        "crack without push",
        "water in a tension crack does not push",
        "src/cdem/screening/profiles.py",
        "push = 0.5 * UNIT_WATER * (loads.share * some.water) ** 2",
        "push = 0.0 * UNIT_WATER * (loads.share * some.water) ** 2",
        "tests/validation/test_rock_slopes.py",
    ),
    Mutant(
        "yield of the last root",
        "a body yields at the largest acceleration at which it may begin to slide",
        "src/cdem/screening/yields.py",
        "k[np.arange(count), slides.argmax(axis=1)]",
        "k[np.arange(count), slides.shape[1] - 1 - slides[:, ::-1].argmax(axis=1)]",
        "tests/unit/screening/test_yields.py",
    ),
    Mutant(
        "probability of safety",
        "cells count the samples in which a body rests",
        "src/cdem/screening/probability.py",
        "for k in np.flatnonzero(factor < 1).tolist():",
        "for k in np.flatnonzero(factor >= 1).tolist():",
        "tests/unit/screening/test_probability.py",
    ),
]
