"""Faults in boundaries for waves: `core/columns`, and what Python gives to it and to the supports."""

from mutant_list.mutant import Mutant

COLUMNS = "tests/validation/test_columns.py"
BOUNDARIES = "tests/unit/model/test_boundaries.py"
FAULTS = [
    Mutant(
        "lagging column",
        "a side feels the velocity of its column before the step alone",
        "core/columns/side.hpp",
        "return 0.5 * (level_of(motion.before, l) + level_of(motion.after, l));",
        "return level_of(motion.before, l);",
        "tests/core/columns/test_side.cpp",
    ),
    Mutant(
        "column twice",
        "a second look in a step moves a column on",
        "core/columns/advance.hpp",
        "if (made[column.i] >= 0 && made[column.i] < step)",
        "if (made[column.i] >= 0)",
        "tests/core/columns/test_advance.cpp",
    ),
    Mutant(
        "lower layer alone",
        "a level feels the layer above it alone",
        "core/columns/advance.hpp",
        "Vec3<Real> f = above - below;",
        "Vec3<Real> f = above;",
        "tests/core/columns/test_advance.cpp",
    ),
    Mutant(
        "light column",
        "the highest frequency of a column forgets the layer below a level",
        "core/columns/data.cpp",
        "highest = std::max(highest, 2 * (below + above) / mass[l]);",
        "highest = std::max(highest, 2 * above / mass[l]);",
        "tests/core/columns/test_data.cpp",
    ),
    Mutant(
        "inward sides",
        "columns pull all sides along the positive axes",
        "src/cdem/model/columns.py",
        "row[:2] = weights[k] * normal[f, :2]",
        "row[:2] = weights[k] * abs(normal[f, :2])",
        COLUMNS,
    ),
    Mutant(
        "soft foot",
        "the foot of a column has the impedance of P waves along all axes",
        "src/cdem/model/columns.py",
        "return [s, s, p, 0.0]",
        "return [p, p, p, 0.0]",
        COLUMNS,
    ),
    Mutant(
        "stiff bond",
        "columns forget that bonds between layers yield",
        "src/cdem/model/columns.py",
        "rows[strip.foot_of[i] - 1] = [1.0, normal, 0.0, across]",
        "rows[strip.foot_of[i] - 1] = [1.0, 2 * normal, 0.0, 2 * across]",
        COLUMNS,
    ),
    Mutant(
        "half a wave",
        "a wave comes in with half of its traction",
        "src/cdem/model/boundaries.py",
        "traction = 2 * (z",
        "traction = 1 * (z",
        BOUNDARIES,
    ),
    Mutant(
        "exchanged impedances",
        "a wave pushes with the impedance of P waves across the face",
        "src/cdem/model/boundaries.py",
        "(z[:, 1:] * (direction - along) + z[:, :1] * along)",
        "(z[:, :1] * (direction - along) + z[:, 1:] * along)",
        BOUNDARIES,
    ),
    Mutant(
        "dropped reaction",
        "forces of supports go with them where a boundary begins",
        "src/cdem/run/stages.py",
        "b.boundaries.kept += np.where(before & ~after, reaction, 0.0)",
        "b.boundaries.kept += 0.0 * np.where(before & ~after, reaction, 0.0)",
        BOUNDARIES,
    ),
    Mutant(
        "whole outcrop",
        "the motion of an outcrop goes in as if it were the wave",
        "src/cdem/case/boundaries_schema.py",
        'share = 0.5 if self.kind == "compliant" and self.motion != "upgoing" else 1.0',
        "share = 1.0",
        "tests/unit/case/test_boundary_checks.py",
    ),
]
