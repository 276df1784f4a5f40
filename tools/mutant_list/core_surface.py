"""Faults in `core/surface`, and in the forces and dashpots that it puts on nodes."""

from mutant_list.mutant import PINNED, Mutant

FAULTS = [
    Mutant(
        "unturned",
        "a pressure that forgets that quadrilaterals are not flat",
        "core/surface/act_on_faces.hpp",
        "const Vec3<T> across = T(1 - a) * (x[3] - x[0]) + T(a) * (x[2] - x[1]);",
        "const Vec3<T> across = x[3] - x[0];",
        "tests/core/surface/test_act_on_faces.cpp",
    ),
    Mutant(
        "too early",
        "an entry acts before its stage",
        "core/surface/act_on_faces.hpp",
        "const auto mine = acts & (law > T(number - 0.5))",
        "const auto mine = (law > T(number - 0.5))",
        "tests/core/surface/test_act_on_faces.cpp",
    ),
    Mutant(
        "second module",
        "of two modules that apply forces only the last acts",
        "core/nodes/sum_applied.hpp",
        "(first ? own : Row::at(sum + at) + own).store(sum + at);",
        "own.store(sum + at);",
        f"{PINNED}[pressed-1]",
    ),
    Mutant(
        "lost sum",
        "a resumed run knows nothing of applied forces until its first step",
        "core/run/run.cpp",
        '{"add_applied", add_applied},',
        '{"add_applied", [](const Model&, State&) {}},',
        "tests/regression/test_resume_stages.py",
    ),
    Mutant(
        "lagging dashpot",
        "dashpots act with the velocity before the step alone",
        "core/nodes/dashpots.hpp",
        "const Real d0 = mass_over_kick + 0.5 * xx;",
        "const Real d0 = mass_over_kick;",
        "tests/core/nodes/test_dashpots.cpp",
    ),
    Mutant(
        "unbooked dashpot",
        "the half step that follows counts twice in the work of dashpots",
        "core/diagnostics/energy.cpp",
        "column_sum(q, s.nodes.radiated, nodes) - column_sum(q, s.nodes.radiated_sample, nodes);",
        "column_sum(q, s.nodes.radiated, nodes);",
        "tests/validation/test_surface.py",
    ),
]
