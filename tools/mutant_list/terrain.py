"""Faults in `src/cdem/terrain`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "layer clipped",
        "the base of a layer may lie above the base of the layer above",
        "src/cdem/terrain/layers.py",
        "z.append(np.where(thickness > 0, raw, z[-1]))",
        "z.append(raw)",
        "tests/integration/terrain/test_layers.py -k wedge",
    ),
    Mutant(
        "layer parts",
        "parts of the bedrock grow upwards",
        "src/cdem/terrain/layers.py",
        "fractions = 1 - depth[::-1] / depth[-1]",
        "fractions = depth / depth[-1]",
        "tests/unit/terrain/test_layers.py -k grow",
    ),
    Mutant(
        "two heights",
        "a fold of a surface of triangles is not noticed",
        "src/cdem/terrain/triangles.py",
        "apart = (inside > self._near) & (np.abs(z - out[point]) > allowed)",
        "apart = inside > np.inf",
        "tests/unit/terrain/test_triangles.py -k two_heights",
    ),
    Mutant(
        "depths",
        "depths of a GOCAD file are taken as heights",
        "src/cdem/terrain/gocad.py",
        "points[one.first : end] *= [factor[0], factor[1], one.sign]",
        "points[one.first : end] *= [factor[0], factor[1], 1.0]",
        "tests/unit/terrain/test_facet_files.py -k depths",
    ),
]
