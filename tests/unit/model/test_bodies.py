"""The groups of a case and those of its model."""

import meshio
import pytest

import cdem
from cdem.model.bodies import check_groups, read_model


def test_a_mesh_without_groups_is_explained(tmp_path):
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]
    meshio.write_points_cells(tmp_path / "a.vtk", points, [("tetra", [[0, 1, 2, 3]])])
    path = tmp_path / "case.yaml"
    path.write_text(
        "model: {mesh: a.vtk}\n"
        "materials: {m: {density: 2500, young_modulus: 1e9, poisson_ratio: 0.2}}\n"
        "groups: {rock: {material: m}}\n"
        "stages: [{name: fall, mode: dynamic, duration: 1}]\n"
    )
    case = cdem.Case.load(path)
    names = read_model(case).group_names
    with pytest.raises(cdem.CaseError, match=r"has: default; elements without a group in the"):
        check_groups(case, names)
