"""Faults in `core/run`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "bare walls",
        "faces that fill covers can still be touched",
        "core/run/bring_in.cpp",
        "hidden[f] = !faces.bare[f];",
        "hidden[f] = 0;",
        "tests/core/run/test_bring_in.cpp",
    ),
    Mutant(
        "dry dig",
        "water on a wall that is dug out, lost at once",
        "core/run/excavate.cpp",
        "if (!leaves[k / 4]) now[k] -= change[k];",
        "if (!leaves[k / 4]) now[k] -= 0 * change[k];",
        "tests/validation/test_water.py",
    ),
    Mutant(
        "lumped forgotten",
        "a resumed run moves exact masses until the next release",
        "core/run/run.cpp",
        '{"list_lumped", list_lumped},',
        '{"list_lumped", [](const Model&, State&) {}},',
        "tests/regression/test_bits.py",
    ),
    Mutant(
        "taken out",
        "the energy of blocks that leave the domain is not booked",
        "core/run/take_out.cpp",
        "s.taken_out += before - stored_energy(m, s);",
        "",
        "tests/core/run/test_take_out.cpp",
    ),
    Mutant(
        "dug out",
        "what bonds bore is not kept when a block is dug out",
        "core/run/excavate.cpp",
        "kept.add_pairs();",
        "",
        "tests/core/run/test_excavate.cpp",
    ),
    Mutant(
        "dug out contacts",
        "forces of contacts with what is dug out are kept for their mothers alone",
        "core/run/excavate.cpp",
        "add(vertex(y, k), -row[4 + k], f);",
        "add(vertex(y, k), 0, f);",
        "tests/core/run/test_excavate.cpp",
    ),
    Mutant(
        "mates hidden",
        "faces that were bonded to what is dug out cannot be touched",
        "core/run/take_out.cpp",
        "if (is_active(i)) expose(s, faces[2 * i + side]);",
        "(void)side;",
        "tests/core/run/test_excavate.cpp",
    ),
    Mutant(
        "taken out friction",
        "losses at contacts leave with the blocks",
        "core/run/take_out.cpp",
        "s.taken_out_friction += friction[slot];",
        "",
        "tests/core/run/test_take_out.cpp",
    ),
    Mutant(
        "dilatation of a fill",
        "the means of a fill go on from before",
        "core/run/bring_in.cpp",
        "renew_nodal_means(m, s, comes);\n  bond",
        "bond",
        "tests/validation/test_nodal_mean.py::test_a_fill_begins_free_of_stress",
    ),
]
