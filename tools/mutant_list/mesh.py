"""Faults in `src/cdem/mesh`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "path",
        "a bolt along a joint changes sides",
        "src/cdem/mesh/paths.py",
        "best = max(stays,",
        "best = max(here,",
        "tests/unit/mesh/test_paths.py",
    ),
    Mutant(
        "round values",
        "bounds of the step change with the CPU where they are round numbers",
        "src/cdem/mesh/arrays.py",
        "np.ceil(mantissa * 2.0**28 - 2.0**-10)",
        "np.ceil(mantissa * 2.0**28)",
        "tests/regression/test_model_arrays.py",
    ),
    Mutant(
        "matrix product",
        "matrices multiplied by BLAS",
        "src/cdem/mesh/arrays.py",
        'np.einsum("...ij,...jk->...ik", a, b)',
        "a @ b",
        "tests/regression/test_model_arrays.py",
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
        "hourglass",
        "hourglass springs twice as stiff",
        "src/cdem/mesh/element_shapes.py",
        "same_everywhere(np.cbrt(whole)) / 48",
        "same_everywhere(np.cbrt(whole)) / 24",
        "tests/validation/test_elements.py",
    ),
]
