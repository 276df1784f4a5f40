"""A result folder opened from Python."""

import numpy as np
import pytest
from scenes import case

import cdem
from cdem import _native

pytest.importorskip("pyvista")
FALL = [{"name": "fall", "mode": "dynamic", "duration": 0.1}]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Results of a box and a wedge that fall."""
    blocks = [
        {"group": "box", "box": {"size": [1, 1, 1], "divisions": [2, 1, 1]}},
        {"group": "chip", "box": {"size": [1, 1, 1], "shape": "tet4"}, "translate": [2, 0, 0]},
    ]
    path = tmp_path_factory.mktemp("open") / "fall.results"
    loads = {"gravity": [0, 0, -10]}
    data = case(blocks, {"box": {}, "chip": {}}, loads=loads, stages=FALL, output={"every": 0.05},
                histories=[{"name": "box", "group": "box", "quantities": ["velocity"]}])  # fmt: skip
    cdem.Simulation(data, threads=1, output=path).run()
    return path


def test_numbers_of_a_run(folder):
    results = cdem.open(folder)
    assert results.summary["status"] == "finished"
    assert results.summary["device"] == f"{_native.device} ({_native.name})"
    assert results.histories["box.velocity_z [m/s]"][-1] == pytest.approx(-1, rel=0.05)
    assert len(results) == len(results.times) == 3
    assert results.times[-1] == pytest.approx(0.1, abs=2e-3)


def test_meshes_of_frames(folder):
    results = cdem.open(str(folder))
    for mesh, fall in (
        (results.volume(-1), 0.05),
        (results.surface(), 0.05),
        (results.volume(0), 0),
    ):
        assert mesh.point_data["displacement"][:, 2] == pytest.approx(-fall, abs=2e-3)
    mesh = results.volume(2)
    assert mesh.n_cells == 2 + 6
    assert mesh.volume == pytest.approx(2, rel=1e-6)
    assert "stress" in mesh.cell_data
    assert list(mesh.field_data["group_names"]) == ["box", "chip"]
    assert results.surface(1).n_cells > 10
    with pytest.raises(cdem.CdemError, match="no frame 3; there are 3"):
        results.volume(3)


def test_histories_as_a_table(folder):
    pandas = pytest.importorskip("pandas")
    table = cdem.open(folder).table()
    assert isinstance(table, pandas.DataFrame)
    assert np.array_equal(table["time [s]"], cdem.open(folder).histories["time [s]"])


def test_a_notebook_shows_the_page_of_the_run(folder):
    page = cdem.open(folder)._repr_html_()
    assert "energy closing error" in page and "&lt;!doctype html&gt;" in page
    assert 'sandbox="allow-scripts allow-downloads"' in page and "<script" not in page


def test_a_notebook_shows_where_a_simulation_is(tmp_path):
    blocks = [{"group": "box", "box": {"size": [1, 1, 1]}}]
    stages = [FALL[0] | {"duration": 0.01}]
    data = case(blocks, {"box": {}}, stages=stages, title="<b>", output={"every": 1})
    sim = cdem.Simulation(data, threads=1, output=tmp_path / "r")
    assert "&lt;b&gt;" in sim._repr_html_() and "<td>fall</td>" in sim._repr_html_()
    sim.run()
    page = sim._repr_html_()
    assert "all stages have ended" in page and f"<td>{sim.step_count:,}</td>" in page
    assert "cdem.open(" in page


def test_other_folders_are_refused(tmp_path):
    with pytest.raises(cdem.CdemError, match="is this a result folder"):
        cdem.open(tmp_path)
