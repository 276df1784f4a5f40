"""Both factors of the worst bodies, without a cluster."""

from dataclasses import replace

import numpy as np
import pytest
from shared.hills import frustum, joint

from cdem.errors import MeshError
from cdem.screening import cases, confirm
from cdem.screening.bodies import Ground, Limits
from cdem.screening.fos_map import screen
from cdem.study.plan import plan
from cdem.study.results_table import Table

pytest.importorskip("netgen", reason="needs the extra 'terrain'")

SETS = (joint("J1", 55, 135, 30, 20e3), joint("J2", 55, 225, 30, 20e3))


@pytest.fixture(scope="module")
def found():
    return screen(Ground(frustum(4.0)), SETS, Limits(2000, 1e5, 26e3))


def test_studies_and_what_becomes_of_them(found, tmp_path, monkeypatch):
    asked = []

    def run_studies(studies, **how):
        asked.extend(studies)
        tables = [Table(study, plan(study, folder)) for study, folder in studies]
        for table, value in zip(tables, (0.9, None), strict=True):
            critical = {"value": value, "stable": value, "failed": value, "trials": []}
            done = {"status": "found", "critical": critical}
            table.runs[0].result = done if value else {"error": "both rest; give a wider range"}
        return tables

    write_case, failing = cases.write_case, 2

    def write(body, number, *rest):
        if number == failing:
            raise MeshError("the body is too narrow for its mesh")
        return write_case(body, number, *rest)

    monkeypatch.setattr(confirm, "run_studies", run_studies)
    monkeypatch.setattr(confirm, "write_case", write)
    monkeypatch.setattr(cases, "ACROSS", 3.0)
    one, two, three = confirm.confirm(found, 3, tmp_path / "confirm")
    closed = [body.factor for body in found.bodies[:3]]
    assert (one.computed, one.closed, one.why) == (0.9, closed[0], "")
    assert np.isnan(two.computed) and "too narrow" in two.text()
    assert np.isnan(three.computed) and "both rest" in three.text()
    assert one.text().endswith(f"computed 0.900 ({90 / closed[0] - 100:+.1f} %)")
    study, folder = asked[1]
    assert folder == tmp_path / "confirm/runs/body3" and study.critical.factor
    assert study.critical.between == pytest.approx([0.5 * closed[2], 2 * closed[2]])


def test_a_body_that_lifts_off_is_not_computed(found, tmp_path, monkeypatch):
    monkeypatch.setattr(confirm, "run_studies", lambda studies, **how: [])
    lifted = replace(found, bodies=[replace(found.bodies[0], factor=0.0, kind="lifts")])
    (one,) = confirm.confirm(lifted, 1, tmp_path / "confirm")
    assert "not computed: it lifts off" in one.text()
