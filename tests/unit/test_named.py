"""Names that users of Python meet: of values, of classes and of the package."""

from __future__ import annotations

import copy
import json
import pickle

import meshio
import numpy as np
import pytest
import yaml
from shared.cases import CUBE

import cdem
from cdem.named import Named


def test_a_missing_name_is_answered_by_those_that_are_there():
    found = Named("field", {"velocity": 1.0, "mass": 2.0})
    with pytest.raises(KeyError, match="no field 'speed'; there are: velocity, mass"):
        found["speed"]
    assert found.get("speed") is None and "speed" not in found
    for same in (copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert same == {"velocity": 1.0, "mass": 2.0} and same.kind == "field"


def test_the_package_shows_its_public_names_alone():
    assert set(dir(cdem)) == {*cdem.__all__, "open"}
    for name in dir(cdem):
        assert getattr(cdem, name)


def test_a_simulation_is_made_of_a_dictionary_and_says_how_it_is():
    simulation = cdem.Simulation(yaml.safe_load(CUBE), threads=1)
    assert repr(simulation.case) == "<Case 'A cube falls': groups cube; stages fall>"
    simulation.step(2)
    assert repr(simulation).startswith(
        "<Simulation 'A cube falls': blocks 1, elements 1; step 2, t "
    )
    with pytest.raises(KeyError, match="no group 'cubes'; there are: cube"):
        simulation.groups["cubes"]
    for values in (simulation.fields, simulation.energies, simulation.contacts):
        with pytest.raises(KeyError, match="there are: "):
            values["nothing"]


def test_a_summary_says_when_where_and_of_which_files(cube_folder, run_cli):
    (cube_folder / "cube.yaml").write_text(CUBE)
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    status, out, _ = run_cli("info", "cube.results", "--json")
    summary = json.loads(out)
    assert status == 0 and summary == json.loads(
        (cube_folder / "cube.results/summary.json").read_text()
    )
    assert summary["host"] and summary["date"][:2] == "20"
    assert summary["inputs"] == cdem.Case.load("cube.yaml").digests()
    assert list(summary["inputs"]) == ["case"] and len(summary["inputs"]["case"]) == 64


def test_digests_are_those_of_values_and_files_wherever_they_lie(tmp_path):
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    text = CUBE.replace("blocks: [{group: cube, box: {size: [1, 1, 1]}}]", "mesh: tet.vtk")
    for folder, size in (("a", 1.0), ("b", 2.0)):
        (tmp_path / folder).mkdir()
        mesh = meshio.Mesh(size * corners, [("tetra", [[0, 1, 2, 3]])])
        meshio.write(tmp_path / folder / "tet.vtk", mesh)
        (tmp_path / folder / "cube.yaml").write_text(text + "\n# a remark\n" * int(size))
    one, other = (cdem.Case.load(tmp_path / name / "cube.yaml").digests() for name in "ab")
    assert list(one) == ["case", "tet.vtk"]
    assert one["case"] == other["case"] and one["tet.vtk"] != other["tet.vtk"]


def test_a_file_that_goes_while_a_run_goes_on_costs_nothing(tmp_path):
    mesh = meshio.Mesh(np.vstack([np.zeros(3), np.eye(3)]), [("tetra", [[0, 1, 2, 3]])])
    meshio.write(tmp_path / "tet.vtk", mesh)
    text = CUBE.replace("blocks: [{group: cube, box: {size: [1, 1, 1]}}]", "mesh: tet.vtk")
    text = text.replace("groups: {cube: {", "groups: {default: {")
    (tmp_path / "cube.yaml").write_text(text)
    simulation = cdem.Simulation(tmp_path / "cube.yaml", threads=1, output=tmp_path / "out")
    digests = simulation.case.digests()
    (tmp_path / "tet.vtk").write_text("another one")
    assert simulation.run() == "finished"
    assert json.loads((tmp_path / "out/summary.json").read_text())["inputs"] == digests


def test_paths_come_as_json(cube_folder, run_cli):
    (cube_folder / "cube.yaml").write_text(CUBE)
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    for command in ("plot", "export"):
        status, out, _ = run_cli(command, "cube.results", "--json")
        assert status == 0
        for path in json.loads(out):
            assert (cube_folder / path).exists()
    results = cdem.open("cube.results")
    with pytest.raises(KeyError, match="no column 'speed'"):
        results.histories["speed"]
