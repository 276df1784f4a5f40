"""Faults in `src/cdem/joints`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "border of blocks",
        "points between blocks move off their border, onto the plane of a joint",
        "src/cdem/joints/snapping.py",
        "single | (low != high)[number] | ",
        "single | ",
        "tests/unit/joints/test_snapping.py",
    ),
    Mutant(
        "rim of a disc",
        "a disc that reaches into a block by its rim only does not cut it",
        "src/cdem/joints/discs.py",
        "met[c.cell[faces[_away(disc.center, start, end) <= disc.radius]]] = True",
        "del faces, start, end",
        "tests/unit/joints/test_discs.py",
    ),
    Mutant(
        "centre of a face",
        "a face counts for a disc by its first corner, not by its centre",
        "src/cdem/joints/discs.py",
        "center = x[0] + (area[:, None] * (a + b)).sum(axis=0) / (3 * area.sum())",
        "center = x[0]",
        "tests/unit/joints/test_discs.py",
    ),
    Mutant(
        "cone of a set",
        "the cone of confidence of a set is that of 90 %, not 95 %",
        "src/cdem/joints/sets.py",
        "(20 ** (1 / (count - 1)) - 1)",
        "(10 ** (1 / (count - 1)) - 1)",
        "tests/unit/joints/test_sets.py",
    ),
    Mutant(
        "dip",
        "dip direction mirrored at the north",
        "src/cdem/joints/directions.py",
        "across * math.sin(azimuth), across * math.cos(azimuth)",
        "-across * math.sin(azimuth), across * math.cos(azimuth)",
        "tests/unit/joints/test_joints.py",
    ),
    Mutant(
        "seed",
        "random part of a joint set without its seed",
        "src/cdem/joints/joints.py",
        "[joint.seed, zlib.crc32",
        "[0, zlib.crc32",
        "tests/unit/joints/test_joints.py",
    ),
]
