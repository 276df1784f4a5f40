"""The faults that mutants.py plants: what might go wrong in one line, and the quickest test for it."""

from typing import NamedTuple


class Mutant(NamedTuple):
    """One fault.

    Attributes:
        name: For the command line.
        fault: What it stands for.
        file: Where it is planted.
        old: Text that occurs once in the file.
        new: Text that takes its place.
        test: A file of tests/core, or words for pytest.
    """

    name: str
    fault: str
    file: str
    old: str
    new: str
    test: str


FAILURE = "tests/validation/test_failure.py::"

PYTHON = [
    Mutant(
        "degrees",
        "angles of a law taken for radians",
        "src/cdem/case/laws.py",
        "values[p.name] = math.tan(math.radians(values[p.name]))",
        "values[p.name] = math.tan(values[p.name])",
        FAILURE + "test_sliding_begins_at_the_friction_angle",
    ),
    Mutant(
        "unit",
        "kPa a thousand times too large",
        "src/cdem/units.py",
        '"kPa": 1e3',
        '"kPa": 1e6',
        "tests/unit/test_units.py",
    ),
    Mutant(
        "pair",
        "interface of a pair of groups ignored for the default",
        "src/cdem/model/interfaces.py",
        "table[a, b] = table[b, a] = index",
        "table[a, b] = table[b, a]",
        "tests/unit/model/test_interfaces.py",
    ),
    Mutant(
        "inherit",
        "a pair does not take the default's values",
        "src/cdem/case/interface_schema.py",
        "pair.__dict__[field] = getattr(self.default, field)",
        "pair.__dict__.setdefault(field, getattr(self.default, field))",
        "tests/unit/case/test_interface_schema.py",
    ),
    Mutant(
        "support",
        "a support holds all components",
        "src/cdem/model/supports.py",
        "component[nodes, axis] = 1",
        "component[nodes] = 1",
        "tests/unit/model/test_supports.py",
    ),
    Mutant(
        "traction",
        "traction on a triangle shared by four",
        "src/cdem/model/loads.py",
        "(area / used.sum(axis=1))[:, None]",
        "(area / 4)[:, None]",
        "tests/unit/model/test_loads.py",
    ),
    Mutant(
        "spin",
        "initial spin the other way round",
        "src/cdem/model/loads.py",
        "np.cross(np.asarray(group.angular_velocity, float), x - center)",
        "np.cross(x - center, np.asarray(group.angular_velocity, float))",
        "tests/unit/model/test_loads.py",
    ),
    Mutant(
        "columns",
        "columns of histories in the order z y x",
        "src/cdem/run/histories.py",
        "{'xyz'[axis]}",
        "{'zyx'[axis]}",
        "tests/unit/run/test_histories.py",
    ),
    Mutant(
        "resume",
        "a resumed run keeps one history row too many",
        "src/cdem/run/history_file.py",
        "lines[1:-1][:keep_rows]",
        "lines[1:-1][: keep_rows + 1]",
        "tests/unit/run/test_history_file.py",
    ),
    Mutant(
        "fingerprint",
        "a checkpoint of another model is taken",
        "src/cdem/run/simulation.py",
        "if attributes.nodes != self.build.fingerprint:",
        "if not attributes.nodes:",
        "tests/unit/run/test_result_folder.py",
    ),
    Mutant(
        "dip",
        "dip direction mirrored at the north",
        "src/cdem/joints/joints.py",
        "np.array([np.sin(dip) * np.sin(azimuth)",
        "np.array([-np.sin(dip) * np.sin(azimuth)",
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
    Mutant(
        "overlap",
        "area of an overlap without its mean part",
        "src/cdem/mesh/overlap.py",
        "/ 3 + triangle.sum() / (3 * len(polygon))",
        "/ 3",
        "tests/unit/mesh/test_overlap.py",
    ),
    Mutant(
        "groups",
        "groups of merged meshes mixed up",
        "src/cdem/mesh/mesh.py",
        "return numbers[piece.cell_group[shape]]",
        "return piece.cell_group[shape]",
        "tests/unit/mesh/test_mesh.py",
    ),
    Mutant(
        "mesh_file",
        "a missing mesh file is not checked for",
        "src/cdem/mesh/mesh_files.py",
        "if not is_file(path):",
        "if path.is_dir():",
        "tests/unit/mesh/test_mesh_files.py",
    ),
    Mutant(
        "runout",
        "front of the run-out measured at the rear end",
        "src/cdem/output/runout.py",
        "places.max() - origin",
        "places.min() - origin",
        "tests/unit/output/test_runout.py",
    ),
    Mutant(
        "reduction",
        "strength reduction of the angle instead of its tangent",
        "src/cdem/case/laws.py",
        "math.degrees(math.atan(math.tan(math.radians(value)) / factor))",
        "value / factor",
        "tests/validation/test_critical.py::test_strength_reduction_gives_the_factor_of_safety",
    ),
    Mutant(
        "hourglass",
        "hourglass springs twice as stiff",
        "src/cdem/mesh/element_shapes.py",
        "np.cbrt(whole) / 48",
        "np.cbrt(whole) / 24",
        "tests/validation/test_elements.py",
    ),
]
"""Faults in Python: nothing is built."""

CORE = [
    Mutant(
        "curve",
        "curves interpolated from the wrong end",
        "core/nodes/curves.cpp",
        "f[after - 1] + part *",
        "f[after - 1] + (1 - part) *",
        "tests/core/nodes/test_curves.cpp",
    ),
    Mutant(
        "step_bound",
        "bound of the time step without contacts and bonds",
        "core/nodes/time_step.cpp",
        "2 * stiffness * (m.lumped",
        "0 * stiffness * (m.lumped",
        "tests/core/nodes/test_time_step.cpp",
    ),
    Mutant(
        "sleep",
        "a fixed node that carries a load sleeps",
        "core/nodes/sleep.cpp",
        "fixed[i] && !pulled[i] && m.load_first[i] == m.load_first[i + 1]",
        "fixed[i] && !pulled[i]",
        "tests/core/nodes/test_sleep.cpp",
    ),
    Mutant(
        "stopped",
        "energy of stopped motion not booked",
        "core/nodes/masses.cpp",
        "s.stopped_energy += energy_of_motion(m, s);",
        "",
        "tests/core/nodes/test_masses.cpp",
    ),
    Mutant(
        "held_weight",
        "weight on held components hides the unbalance",
        "core/diagnostics/unbalance.cpp",
        "(supports.given(i, 2) ? 0 : std::abs(f.z))",
        "std::abs(f.z)",
        "tests/core/diagnostics/test_unbalance.cpp",
    ),
    Mutant(
        "edge_energy",
        "shear energy of semi-edges not in the ledger",
        "core/diagnostics/energy.cpp",
        "sum += edge.energy_n + edge.energy_s;",
        "sum += edge.energy_n;",
        "tests/core/contact/force/test_accumulate.cpp",
    ),
    Mutant(
        "ordered_sum",
        "sums whose order depends on the number of threads",
        "core/base/reduce.hpp",
        "constexpr Index chunk = 1024;",
        "const Index chunk = runs_alone() ? 1024 : 512;",
        "tests/core/base/test_reduce.cpp",
    ),
    Mutant(
        "skin",
        "skin of the lists watched at ten times its width",
        "core/contact/broad_phase/predicted_motion.cpp",
        "dot(off, off) > then.w",
        "dot(off, off) > T(100.0) * then.w",
        "tests/core/contact/pair_list/test_rebuild.cpp",
    ),
    Mutant(
        "inner_list",
        "inner list pruned without room for motion",
        "core/contact/pair_list/prune.hpp",
        "select(below, room.at(1, p), room.at(0, p)) + skins",
        "select(below, room.at(1, p), room.at(0, p)) - skins",
        "tests/core/contact/pair_list/test_inner_list.cpp",
    ),
    Mutant(
        "transfer",
        "the force of a released bond is not transferred to its contacts",
        "core/bonds/release.cpp",
        "ps.stored[i] -= transfer_to_contact(m, s, p, ps, i);",
        "ps.stored[i] -= 0;",
        "tests/core/bonds/test_release.cpp",
    ),
    Mutant(
        "transfer_shear",
        "shear of a released overlap goes to the wrong side",
        "core/bonds/transfer_to_contact.cpp",
        "(c.on_b ? share : -share) * shear",
        "(c.on_b ? -share : share) * shear",
        "tests/validation/test_breakable.py::"
        "test_bonds_of_nonconforming_faces_transfer_their_force_to_contacts",
    ),
    Mutant(
        "bond_area",
        "area of bond points halved",
        "core/bonds/bonded_pairs.hpp",
        "pairs.area.at(0, p) / Number<I>(Real(count))",
        "pairs.area.at(0, p) / Number<I>(Real(2 * count))",
        "tests/core/bonds/test_bonded_pairs.cpp",
    ),
    Mutant(
        "bond_slip",
        "a broken bond point forgets its slip",
        "core/bonds/bond_point.hpp",
        "h.slip1 = select(intact, h.slip1, along1 + shear1 * spring.stiffness.compliance_s);",
        "h.slip1 = select(intact, h.slip1, zero * along1);",
        "tests/core/bonds/test_bond_point.cpp",
    ),
    Mutant(
        "overlap_area",
        "area of an overlap's bond points doubled",
        "core/bonds/bonded_pairs.hpp",
        "pairs.spring(p, point_area[c])",
        "pairs.spring(p, 2 * point_area[c])",
        FAILURE + "test_nonconforming_interface_opens_uniformly",
    ),
    Mutant(
        "normal_sign",
        "normal force pulls",
        "core/contact/force/contact_force.hpp",
        "f.force_n = area * joint.normal;",
        "f.force_n = -area * joint.normal;",
        "tests/core/contact/force/test_contact_force.cpp",
    ),
    Mutant(
        "stress_free_gap",
        "a contact found inside is not free of stress",
        "core/contact/force/contact_force.hpp",
        "return min_of(gap_before + penetration_before, dilated);",
        "return min_of(max_of(gap_before + penetration_before, dilated), dilated);",
        "tests/core/contact/force/test_contact_force.cpp",
    ),
    Mutant(
        "dashpot",
        "energy of the contact dashpot not booked",
        "core/contact/force/contact_force.hpp",
        "f.dashpot = -half * braked *",
        "f.dashpot = zero * braked *",
        "tests/core/contact/force/test_contact_force.cpp",
    ),
    Mutant(
        "edge_friction",
        "friction of semi-edges not booked",
        "core/contact/force/accumulate.hpp",
        "edge_friction[m] += row[6];",
        "",
        "tests/core/contact/force/test_accumulate.cpp",
    ),
    Mutant(
        "edge_node",
        "reaction of a semi-edge on the wrong vertex",
        "core/contact/force/accumulate.hpp",
        "add(sum[k + 1 == count ? 0 : k + 1], -row[5], row);",
        "add(sum[k == 0 ? count - 1 : k - 1], -row[5], row);",
        "tests/core/contact/force/test_accumulate.cpp",
    ),
    Mutant(
        "change_of_face",
        "a contact that changes its face loses its shear",
        "core/contact/force/change_of_target.hpp",
        "s.shear1 = scale * a;",
        "s.shear1 = 0;",
        "tests/core/contact/force/test_change_of_target.cpp",
    ),
    Mutant(
        "mass_row",
        "consistent mass matrix read in the wrong column",
        "core/nodes/central_difference.hpp",
        "a = a + inverse[j] * Row::at(forces);",
        "a = a + inverse[0] * Row::at(forces);",
        "tests/core/diagnostics/test_energy.cpp",
    ),
    Mutant(
        "local_damping",
        "local damping pushes",
        "core/nodes/central_difference.hpp",
        "return v.n[axis] > 0 ? -size : (v.n[axis] < 0 ? size : 0.0);",
        "return v.n[axis] > 0 ? size : (v.n[axis] < 0 ? -size : 0.0);",
        "tests/core/nodes/test_central_difference.cpp",
    ),
    Mutant(
        "checkpoint",
        "a checkpoint leaves out a number",
        "core/model/describe_scalars.hpp",
        'visit(ScalarInfo{.name = "dt_stable", .unit = "s", .meaning = "step that dt grows towards"},'
        "\n        s.dt_stable);",
        "",
        "tests/regression/test_bits.py::test_restored_state_continues_the_growth_of_the_time_step",
    ),
    Mutant(
        "friction",
        "friction coefficient 0.2 % too large",
        "core/interfaces/brittle.hpp",
        "max_of(normal * tan_friction + bond * cohesion",
        "max_of(normal * T(1.002) * tan_friction + bond * cohesion",
        "tests/validation/test_sliding.py::test_acceleration_does_not_depend_on_the_frame",
    ),
    Mutant(
        "cohesion",
        "shear limit without cohesion",
        "core/interfaces/brittle.hpp",
        "max_of(normal * tan_friction + bond * cohesion",
        "max_of(normal * tan_friction",
        FAILURE + "test_shear_failure_at_the_cohesion",
    ),
    Mutant(
        "tension",
        "tension limit ignored",
        "core/interfaces/brittle.hpp",
        "return -elastic > bond * (tensile_strength",
        "return -elastic > bond * (T(1e30) + tensile_strength",
        FAILURE + "test_tensile_failure_at_the_tensile_strength",
    ),
    Mutant(
        "edge_cone",
        "edge contacts whose normal lies outside the cones of the edges",
        "core/contact/narrow_phase/target_edge.hpp",
        "return !(rises(nm, dm, -n)",
        "return (rises(nm, dm, -n)",
        "tests/core/contact/narrow_phase/test_target_edge.cpp",
    ),
    Mutant(
        "lame",
        "Lame constants swapped",
        "core/elements/views.hpp",
        ".materials = {.lambda = m.material_lambda.data(),\n"
        "                        .mu = m.material_mu.data(),",
        ".materials = {.lambda = m.material_mu.data(), .mu = m.material_lambda.data(),",
        "tests/validation/test_elements.py::test_patch_test_gives_uniform_stress",
    ),
    Mutant(
        "mean_dilatation",
        "B-bar left out",
        "core/elements/corotational.hpp",
        "    use_mean_dilatation<Shape>(c, e, strain);",
        "",
        "tests/core/elements/test_corotational.cpp",
    ),
    Mutant(
        "polar",
        "polar rotation with one Newton step fewer",
        "core/base/math.hpp",
        "for (int step = 0; step < 3; ++step)",
        "for (int step = 0; step < 2; ++step)",
        "tests/core/base/test_math.cpp",
    ),
]
"""Faults in the core: those in headers that many files include come last."""

MUTANTS: list[Mutant] = PYTHON + CORE
