"""Faults in `src/cdem/outcrop`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "ends of traces",
        "the mean length of traces divides by both ends of each, seen or not",
        "src/cdem/outcrop/traces.py",
        "int(seen.sum())",
        "int(seen.size)",
        "tests/unit/outcrop/test_traces.py",
    ),
    Mutant(
        "rims of facets",
        "points at edges, whose normals are mixed, belong to no facet",
        "src/cdem/outcrop/growing.py",
        "label[free[close]] = beside[at, best][close]",
        "del best, close",
        "tests/unit/outcrop/test_growing.py",
    ),
    Mutant(
        "places of planes",
        "the place of a tilted joint is that of its facet, not that at the middle of the outcrop",
        "src/cdem/outcrop/joint_planes.py",
        "(weight @ facets.centers[here] - middle) @ normal / (normal @ mean)",
        "(weight @ facets.centers[here] - middle) @ mean",
        "tests/unit/outcrop/test_joint_planes.py",
    ),
    Mutant(
        "holes of facets",
        "holes count as area of a facet",
        "src/cdem/outcrop/facets.py",
        "length.max(axis=1) <= LONGEST_EDGE * spacing",
        "length.max(axis=1) > 0",
        "tests/unit/outcrop/test_facets.py",
    ),
]
