"""A run against monitored displacements: values at places and times, and scores."""

from pathlib import Path

import numpy as np
import pytest

import cdem
from cdem.errors import CdemError
from cdem.fit.agreement import Agreement, compare
from cdem.fit.monitored import Monitored
from cdem.fit.sampled import Sampled, _found

FALLING = {
    "model": {"blocks": [{"group": "rock", "box": {"size": [4, 2, 2], "divisions": [2, 1, 1]}}]},
    "materials": {"rock": {"density": 2500, "young_modulus": 1e8, "poisson_ratio": 0.2}},
    "groups": {"rock": {"material": "rock", "velocity": [2, 0, 0]}},
    "loads": {"gravity": [0, 0, 0]},
    "stages": [{"name": "go", "mode": "dynamic", "duration": 0.4}],
    "output": {"every": 0.1},
}


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    """A block that moves east by 2 m/s for 0.4 s."""
    folder = tmp_path_factory.mktemp("moving") / "out"
    cdem.Simulation(cdem.Case.from_dict(FALLING), output=folder).run()
    return folder


def monitored(at, moved, time=None, deviation=None) -> Monitored:
    at, moved = np.array(at, float), np.array(moved, float)
    none = np.full(moved.shape, np.nan)
    times = np.full(len(at), np.nan) if time is None else np.array(time, float)
    names = [str(k) for k in range(len(at))]
    spread = none if deviation is None else np.full(moved.shape, float(deviation))
    return Monitored(Path("prisms.csv"), names, at, times, moved, spread)


def test_the_displacement_at_any_time_is_linear_between_frames(run):
    sampled = Sampled(run, np.array([[1.0, 1.0, 2.0]] * 3))
    found = sampled.at(np.array([0.15, 0.4, np.nan]))
    assert found[:, 0] == pytest.approx([0.3, 0.8, 0.8], abs=5e-3)
    assert sampled.distance == pytest.approx([0, 0, 0], abs=1e-9)


def test_a_place_without_a_height_lies_on_the_surface(run):
    sampled = Sampled(run, np.array([[1.0, 1.0, np.nan], [9.0, 1.0, np.nan], [1.0, 1.0, 2.5]]))
    assert sampled.distance[0] == pytest.approx(0, abs=1e-9)
    assert np.isnan(sampled.distance[1])  # beside the block
    assert sampled.distance[2] == pytest.approx(0.5)


def test_weights_give_back_the_place_inside_every_shape():
    """A linear field is exact: sum of weights times corners is the place itself."""
    import pyvista

    shapes = [
        (pyvista.CellType.TETRA, [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        (
            pyvista.CellType.PYRAMID,
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]],
        ),
        (
            pyvista.CellType.WEDGE,
            [[0, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0, 1], [0, 1, 1], [1, 0, 1]],
        ),
        (
            pyvista.CellType.HEXAHEDRON,
            [
                [0, 0, 0],
                [1, 0, 0],
                [1, 1, 0],
                [0, 1, 0],
                [0, 0, 1],
                [1, 0, 1],
                [1, 1, 1],
                [0, 1, 1],
            ],
        ),
    ]
    for kind, corners in shapes:
        points = np.array(corners, float)
        mesh = pyvista.UnstructuredGrid([len(points), *range(len(points))], [kind], points)
        inside = np.array([[0.2, 0.3, 0.1]])
        distance, nodes, weights = _found(mesh, inside)
        assert distance[0] == pytest.approx(0, abs=1e-9)
        assert weights[0] @ points[np.minimum(nodes[0], len(points) - 1)] == pytest.approx(
            inside[0], abs=1e-6
        )


def test_scores_of_known_residuals():
    seen = monitored([[0, 0, 0]] * 4, [[1, 0, 0, np.nan]] * 4, deviation=0.1)
    seen.moved[:, 0] = [1, 2, 3, 4]
    seen.moved[:, 1:3] = np.nan
    computed = np.full((4, 4), np.nan)
    computed[:, 0] = [2, 4, 6, 8]
    scores = Agreement(seen, computed, []).scores()
    assert list(scores) == ["dx"]
    s = scores["dx"]
    assert s["count"] == 4 and s["bias"] == pytest.approx(2.5)
    assert s["rms"] == pytest.approx(np.sqrt(30 / 4)) and s["factor"] == pytest.approx(0.5)
    assert s["correlation"] == pytest.approx(1) and s["skill"] == pytest.approx(0)
    assert s["chi2"] == pytest.approx(30 / 4 / 0.01)
    assert s["rms_less_bias"] == pytest.approx(np.std([1, 2, 3, 4]))


def test_a_line_of_sight_sees_its_part_of_the_motion(run):
    seen = monitored([[1, 1, 2]], [[np.nan, np.nan, np.nan, 0.5]])
    found = compare(run, seen, np.array([0.6, 0.0, 0.8]))
    assert found.computed[0, 3] == pytest.approx(0.6 * 0.8, abs=5e-3)


def test_rows_that_cannot_be_compared_are_told(run):
    at = [[1, 1, np.nan], [50, 1, np.nan], [1, 1, np.nan], [1, 1, 9]]
    seen = monitored(at, [[0.8, 0, 0, np.nan]] * 4, time=[0.4, 0.4, 9, 0.4])
    found = compare(run, seen)
    assert len(found.computed) == 2
    assert any("1 rows lie outside of the model in plan" in note for note in found.notes)
    assert any("1 rows have times outside of the run, 0 to 0.4" in note for note in found.notes)


@pytest.mark.parametrize(
    "moved, los, message",
    [
        ([np.nan, np.nan, np.nan, 0.5], None, "need its direction, --los"),
        ([0.5, np.nan, np.nan, np.nan], [0.0, 0, 1], "has no displacements along a line of sight"),
    ],
)
def test_a_line_of_sight_and_its_direction_belong_together(run, moved, los, message):
    with pytest.raises(CdemError, match=message):
        compare(run, monitored([[1, 1, 2]], [moved]), None if los is None else np.array(los))


def test_nothing_to_compare_is_one_clear_error(run):
    with pytest.raises(CdemError, match=r"nothing to compare with .* lie outside of the model"):
        compare(run, monitored([[99, 1, np.nan]], [[1, 0, 0, np.nan]]))
