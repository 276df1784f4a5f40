"""Faults in `core/bolts`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "bolt step",
        "bolts do not count in the stable step",
        "core/bolts/data.hpp",
        "visit(hosts[k], stiffness[p] * std::abs(weights[k]));",
        "visit(hosts[k], 0 * stiffness[p] * std::abs(weights[k]));",
        "tests/validation/test_bolts.py::test_bolts_shorten_the_step",
    ),
    Mutant(
        "grout",
        "grout of bolts never slips",
        "core/bolts/chain.hpp",
        "n.grout_lost[i] ? 0.0 : n.grout[2 * i + 1];",
        "n.grout_lost[i] ? 0.0 : 1e30 * n.grout[2 * i + 1];",
        "tests/core/bolts/test_chain.cpp",
    ),
    Mutant(
        "bolt loss",
        "slip of grout loses the force after it, not the mean",
        "core/bolts/solve_bolts.hpp",
        "const Real spent = 0.5 * (force + after) * (free_after - free);",
        "const Real spent = after * (free_after - free);",
        "tests/core/bolts/test_solve_bolts.cpp",
    ),
    Mutant(
        "dowel",
        "a dowel bears twice its strength",
        "core/bolts/solve_bolts.hpp",
        "force = (limit / size) * force;",
        "force = (2 * limit / size) * force;",
        "tests/core/bolts/test_solve_bolts.cpp",
    ),
    Mutant(
        "cut bolt",
        "a bolt keeps its grout in rock that was dug out",
        "core/bolts/data.cpp",
        "    grout_lost[n] = 1;",
        "    grout_lost[n] = 0;",
        "tests/validation/test_bolts.py::test_what_is_dug_out_takes_its_part_of_a_bolt_along",
    ),
]
