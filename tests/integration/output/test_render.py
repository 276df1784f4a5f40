"""Pictures of results: groups by name, fields that follow from others, cuts, what is said of mistakes."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image
from shared.cases import WALL

import cdem
from cdem.output import painter, render
from cdem.output.reader import SurfaceSeries
from cdem.output.render import can_draw


def has(image, color: str) -> bool:
    rgb = [int(color[i : i + 2], 16) for i in (1, 3, 5)]
    return bool((image == rgb).all(axis=2).any())


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Results of a short run of the pushed wall."""
    if not can_draw():
        pytest.skip("no OpenGL")
    folder = tmp_path_factory.mktemp("wall")
    (folder / "model.yaml").write_text(WALL)
    case = cdem.Case.load(folder / "model.yaml", ["stages.0.duration=0.002", "output.every=0.001"])
    cdem.Simulation(case, output=folder / "r.results", threads=1).run()
    return folder / "r.results"


def test_pictures_of_results_name_the_groups(results, monkeypatch):
    series = SurfaceSeries(results)
    legends = []
    legend = painter.labels
    monkeypatch.setattr(painter, "labels", lambda e, *size: legends.append(e) or legend(e, *size))
    image = render.picture([series[0]], "group", titles=["before"])
    assert [label for label, _ in legends[0]] == ["base", "wall", "loose"]
    rows = len(image) - 28 * 3 - 10
    assert all(has(image[rows:], color) for _, color in legends[0])


def test_stress_lies_on_the_faces_of_its_elements(results):
    volume, surface = cdem.open(results).volume(-1), cdem.open(results).surface(-1)
    frames = render._frames(results, "stress_zz", None)
    carried = frames[len(frames) - 1].cell_data["stress"]
    assert (carried == volume.cell_data["stress"][surface.cell_data["element"]]).all()
    assert np.ptp(carried) > 0


@pytest.mark.parametrize(
    "arguments",
    [
        ["--field", "stress_zz", "--time", "9"],
        ["--field", "sigma_3", "--slice", "y=0.11", "--before-after"],
        ["--slice", "0,0.05,1,0.15", "--time", "0", "--movie"],
    ],
)
def test_pictures_show_something(run_cli, results, arguments):
    status, out, err = run_cli("render", str(results), *arguments)
    assert (status, err) == (0, "")
    for line in out.splitlines():
        image = np.asarray(Image.open(line).convert("RGB"))
        assert (image[50:-90].min(axis=2) < 240).mean() > 0.05


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["--field", "nope"], "no field 'nope' to draw; choose one of: displacement, disp"),
        (["--field", "axial_force"], "the run has no 'axial_force' to draw; choose one of"),
        (["--field", "joint", "--slice", "y=0"], "a slice has no 'joint' to draw; choose"),
        (["--slice", "y=1e6"], "--slice y=1e6: misses the model, which has x from"),
        (["--slice", "y"], "--slice y: give a plane as x=VALUE"),
    ],
)
def test_mistakes_are_one_line(run_cli, results, arguments, said):
    status, out, err = run_cli("render", str(results), *arguments)
    assert (status, out) == (1, "")
    assert err.startswith(said)
    assert err.count("\n") == 1
