"""Faults in `core/rest`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "sheared spring",
        "springs of a solve are as stiff in shear as along their normal",
        "core/rest/item_matrix.hpp",
        "((i == j ? shear : 0) + (normal - shear) * axis[i] * axis[j]);",
        "(i == j ? normal : 0);",
        "tests/core/rest/test_pair_matrix.cpp",
    ),
    Mutant(
        "open crossing",
        "the far end of a crossed edge pulls on the wrong vertex in a solve",
        "core/rest/contact_matrix.hpp",
        "{1 - row[4], row[4], row[5] - 1, -row[5]}",
        "{1 - row[4], row[4], row[5], -row[5]}",
        "tests/core/rest/test_contact_matrix.cpp",
    ),
    Mutant(
        "whole force",
        "the work of a solve is that of its first force",
        "core/rest/moved_node.hpp",
        "work += 0.5 * (before[at] + now) * way[at];",
        "work += before[at] * way[at];",
        "tests/core/rest/test_rest.cpp",
    ),
    Mutant(
        "one sweep",
        "a V-cycle that smooths on the way down only, and so is not symmetric",
        "core/rest/multigrid.cpp",
        "for (int turn = 0; turn < turns; ++turn) {",
        "for (int turn = 1; turn < turns; ++turn) {",
        "tests/core/rest/test_multigrid.cpp",
    ),
    Mutant(
        "lost modes",
        "coarse spaces forget how their aggregates turn",
        "core/rest/aggregation.cpp",
        "back[6 * j + k] += along;",
        "",
        "tests/core/rest/test_aggregation.cpp",
    ),
]
