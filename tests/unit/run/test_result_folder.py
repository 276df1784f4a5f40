"""The result folder: what it guards, and which checkpoints it refuses."""

from __future__ import annotations

import h5py
import meshio
import pytest
from shared.cases import CUBE

import cdem

pytestmark = pytest.mark.usefixtures("cube_folder")


def test_a_folder_of_other_things_is_never_overwritten(run_cli, cube_folder):
    (cube_folder / "mine").mkdir()
    (cube_folder / "mine/thesis.tex").touch()
    status, _, err = run_cli("run", "cube.yaml", "-o", "mine", "--overwrite")
    assert status == 1
    assert "is not a result folder (.cdem-results is missing), so it is not overwritten" in err
    assert (cube_folder / "mine/thesis.tex").exists()


def test_a_checkpoint_of_another_mesh_is_refused(run_cli):
    """As many nodes, at other places."""
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    status, _, err = run_cli(
        "run", "cube.yaml", "--resume", "--set", "model.blocks.0.box.size=[1, 1, 1.5]"
    )
    assert status == 1
    assert "belongs to another model, with other elements or groups, other initial" in err


def test_a_checkpoint_of_other_elements_between_the_same_nodes_is_refused(run_cli, tmp_path):
    """A block of two wedges, cut along the other diagonal of its top."""
    points = [[x, y, z] for z in (0, 1) for x, y in [(0, 0), (1, 0), (1, 1), (0, 1)]]
    for name, (a, b) in {"one": ([0, 1, 2], [0, 2, 3]), "other": ([0, 1, 3], [1, 2, 3])}.items():
        wedges = [[*a, *(i + 4 for i in a)], [*b, *(i + 4 for i in b)]]
        meshio.write_points_cells(tmp_path / f"{name}.vtk", points, [("wedge", wedges)])
    block = "blocks: [{group: cube, box: {size: [1, 1, 1]}}]"
    text = CUBE.replace(block, "mesh: one.vtk").replace("{cube:", "{default:")
    (tmp_path / "cube.yaml").write_text(text)
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    status, _, err = run_cli("run", "cube.yaml", "--resume", "--set", "model.mesh=other.vtk")
    assert status == 1
    assert "with other elements or groups" in err
    assert run_cli("run", "cube.yaml", "--resume", "--quiet")[0] == 0


def test_a_run_that_is_let_go_lists_all_of_its_frames(cube_folder, monkeypatch):
    """The list of frames is written now and then only while it runs."""
    monkeypatch.setattr("cdem.run.frame_files.LIST_PATIENCE", 1e9)
    case = cdem.Case.load(cube_folder / "cube.yaml")
    sim = cdem.Simulation(case, threads=1, output=cube_folder / "out")
    sim.run_until(0.5 * case.stages[0].duration)
    path = cube_folder / "out/frames.vtkhdf"
    steps = "VTKHDF/Steps"
    with h5py.File(path, locking=False) as file:
        assert file[steps].attrs["NSteps"] == 1
    sim.close()
    with h5py.File(path) as file:
        assert file[steps].attrs["NSteps"] == sim.results.frames > 2
