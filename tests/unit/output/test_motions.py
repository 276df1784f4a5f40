"""Measures of the motions of a run, from its histories."""

import json

import numpy as np
import pytest
from shared.signals import G, synthetic

from cdem.errors import CaseError, CdemError
from cdem.output.motions import accelerations, measure
from cdem.seismic.measures import measures, newmark_slip, spectrum
from cdem.seismic.processing import of_acceleration

STEP = 0.005


@pytest.fixture
def run(tmp_path):
    """A result folder with a static stage, and one where the synthetic record moves two points."""
    t, a = synthetic()
    v = of_acceleration(a, STEP).velocity
    columns = {
        "time [s]": t + 3, "step": t, "low.velocity_x [m/s]": v, "low.velocity_y [m/s]": 0.5 * v,
        "low.velocity_z [m/s]": 0 * v, "top.acceleration_x [m/s2]": 2 * a, "top.force_x [N]": v,
    }  # fmt: skip
    rows = np.column_stack(list(columns.values()))
    early = [[0.1 * k, k, 9, 9, 9, 9, 9] for k in range(30)]
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in [*early, *rows.tolist()])]
    (tmp_path / "histories.csv").write_text("\n".join(lines) + "\n")
    stages = [{"name": "rest", "mode": "static", "begin": 0.0, "time": 3.0},
              {"name": "shake", "mode": "dynamic", "begin": 3.0, "time": 20.0}]  # fmt: skip
    (tmp_path / "summary.json").write_text(json.dumps({"stages": stages}))
    return tmp_path


def test_a_motion_of_a_run_is_measured_as_the_record_that_it_follows(run):
    """The axis that does not move, and rows of other stages, are left out."""
    found = {
        (name, axis): m for name, axis, m in measure(run, to=None, yields=[], stage=None).measured()
    }
    assert list(found) == [("low", "x"), ("low", "y"), ("top", "x")]
    exact = measures(of_acceleration(synthetic()[1], STEP))
    for key, factor in ((("low", "x"), 1.0), (("low", "y"), 0.5), (("top", "x"), 2.0)):
        assert found[key].pgv == pytest.approx(factor * exact.pgv, rel=1e-9)
        assert found[key].pga == pytest.approx(factor * exact.pga, rel=0.005)
        assert found[key].arias == pytest.approx(factor**2 * exact.arias, rel=0.01)


def test_tables_hold_spectra_slips_and_ratios(run):
    """RotD100 of x and y is that of their sum along its direction; the ratio is 2 where it is loud."""
    found = measure(run, to="low", yields=accelerations("0.1g..0.2g"), stage="shake")
    paths = {path.name: path for path in found.write(run)}
    assert list(paths) == ["measures.csv", "low-spectrum.csv", "low-fourier.csv", "top-spectrum.csv",
                           "top-fourier.csv", "top-over-low.csv", "newmark.csv"]  # fmt: skip
    head, *rows = paths["low-spectrum.csv"].read_text().splitlines()
    assert head.split(",")[0] == "period [s]" and head.endswith(
        "Sa RotD50 [m/s2],Sa RotD100 [m/s2]"
    )
    table = np.array([row.split(",") for row in rows], float)
    exact = spectrum(synthetic()[1], STEP, table[60:, 0])
    np.testing.assert_allclose(table[60:, 1], exact, rtol=0.005)
    np.testing.assert_allclose(table[60:, 4], exact * np.sqrt(1.25), rtol=0.005)
    ratio = np.array(
        [row.split(",") for row in paths["top-over-low.csv"].read_text().splitlines()[1:]], float
    )
    np.testing.assert_allclose(ratio[np.isfinite(ratio[:, 1]) & (ratio[:, 0] < 6), 1], 2, rtol=0.01)
    slips = [row.split(",") for row in paths["newmark.csv"].read_text().splitlines()[1:]]
    assert slips[0][:3] == ["low", "x", "+"] and len(slips) == 6
    a = synthetic()[1]
    assert float(slips[0][3]) == pytest.approx(newmark_slip(a, STEP, 0.1 * G), rel=0.01)
    assert float(slips[1][3]) == pytest.approx(newmark_slip(-a, STEP, 0.1 * G), rel=0.01)
    assert any("Newmark slip" in line for line in found.lines())


def test_waves_of_a_boundary_are_motions_to_compare_with(run):
    """The transfer function to the wave that comes in."""
    text = (run / "histories.csv").read_text()
    (run / "histories.csv").write_text(text.replace("low.velocity", "low.v_up"))
    found = measure(run, to="low.v_up", yields=[], stage=None)
    assert [motion.name for motion in found.motions] == ["low.v_up", "top"]
    assert "top-over-low.v_up.csv" in [path.name for path in found.write(run)]


def test_motions_are_drawn(run):
    """A picture for each history."""
    pytest.importorskip("matplotlib")
    found = measure(run, to="low", yields=[], stage=None)
    found.write(run)
    assert [path.name for path in found.draw(run)] == ["low.png", "top.png"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ({"to": "tip"}, "--to tip: no history of this name with a motion; did you mean top?"),
        ({"stage": "rest"}, "--stage rest: the run has ended these dynamic stages: shake"),
    ],
)
def test_a_name_that_is_not_there_is_told(run, words, said):
    """With those that are."""
    with pytest.raises(CaseError, match=said.replace("?", r"\?")):
        measure(run, **{"to": None, "yields": [], "stage": None} | words)


def test_a_run_without_motions_or_with_few_rows_is_told(run):
    """And how to get some."""
    text = (run / "histories.csv").read_text()
    (run / "histories.csv").write_text(text.replace("velocity", "force").replace("acceler", "x"))
    with pytest.raises(CdemError, match="no history has a velocity or an acceleration"):
        measure(run, to=None, yields=[], stage=None)
    (run / "histories.csv").write_text("\n".join(text.splitlines()[:40]) + "\n")
    with pytest.raises(CdemError, match=r"has 9 rows of histories, .* \(every\)"):
        measure(run, to=None, yields=[], stage=None)


def test_yield_accelerations_are_one_or_a_range():
    """Others are refused with the two ways."""
    assert accelerations(None) == [] and accelerations("0.2 g") == [0.2 * G]
    found = accelerations("0.1g..0.4g")
    assert len(found) == 7 and found[0] == 0.1 * G and found[-1] == pytest.approx(0.4 * G)
    for wrong in ("0.2", "g", "0.4g..0.1g", "0g", "1.2.3g", "0.1g..0.2g..0.3g", ""):
        with pytest.raises(CaseError, match=r"write one acceleration, 0\.2g, or a range"):
            accelerations(wrong)
