"""Faults of ranks: what they decide alone, and what they lack."""

from mutant_list.mutant import Mutant

GOLDEN = "tests/regression/test_ranks.py"

FAULTS = [
    Mutant(
        "ranks that decide",
        "each rank rebuilds its pair list when its own part asks for it",
        "core/contact/pair_list/rebuild.cpp",
        "own.release = words[0] > 0, own.outer = words[1] > 0;",
        "own.inner = own.inner;",
        GOLDEN,
    ),
    Mutant(
        "step of a rank",
        "each rank takes the stable step of its own part",
        "core/nodes/time_step.cpp",
        "for (const HighestNode& one : of_all_ranks(s, own))",
        "for (const HighestNode& one : {own})",
        GOLDEN,
    ),
    Mutant(
        "ghosts left alone",
        "the motion of ghosts does not come from their owners",
        "core/step.cpp",
        "  receive_ghosts(s);             // ranks/",
        "",
        GOLDEN,
    ),
    Mutant(
        "tiles of a rank",
        "a rank divides its elements into tiles of its own",
        "core/model/tiles.cpp",
        "    if (given) return tile_of[block] != tile_of[block - 1];\n",
        "",
        GOLDEN,
    ),
    Mutant(
        "sums of ghosts",
        "items count for every rank that has them",
        "core/base/primitive_loops.hpp",
        "if (!counted.own[first + i]) numbers[i] = 0;",
        "if (first < 0) numbers[i] = 0;",
        GOLDEN,
    ),
    Mutant(
        "paths of ghosts",
        "a rank predicts the paths of ghosts from the elements that it has",
        "core/contact/broad_phase/predict_nodes.hpp",
        "    if (own[node]) return;\n",
        "    if (node >= 0) return;\n",
        "tests/regression/test_ghosts.py",
    ),
    Mutant(
        "one layer of ghosts",
        "a rank has no faces around those that touch its own",
        "src/cdem/ranks/parts.py",
        "return boxes.near(boxes.some(found).and_others(choosing)) | acting",
        "return acting",
        "tests/regression/test_ghosts.py",
    ),
    Mutant(
        "old whole",
        "the whole state is not forgotten when the parts go on",
        "src/cdem/ranks/shared_core.py",
        "self._whole_is_new = self._is_prepared = False\n        self._known",
        "self._is_prepared = True\n        self._known",
        "tests/integration/test_shared_runs.py",
    ),
    Mutant(
        "elements out of their blocks",
        "elements that share nodes may begin anywhere",
        "src/cdem/ranks/slices.py",
        "lacks[run[-1]] = 0",
        "lacks[:] = 0",
        "tests/unit/ranks/test_slices.py",
    ),
]
