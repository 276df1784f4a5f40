"""`cdem joints`: sets that a case takes as they are, a picture, and one message for a mistake."""

import json

import pytest
from ruamel.yaml import YAML
from shared.joints import drawn_joints

import cdem
from cdem.joints.directions import dips

SLOPE = ("--slope", "60/090", "--friction", "30")


@pytest.fixture
def table(tmp_path, monkeypatch):
    """Two sets along a scanline, in a folder of their own."""
    monkeypatch.chdir(tmp_path)
    dip, direction = dips(drawn_joints([(35, 90, 80, 60), (80, 10, 60, 40)], uniform=5))
    rows = [
        f"{d:.0f},{a:.0f},{k * 0.4:.1f}"
        for k, (d, a) in enumerate(zip(dip, direction, strict=True))
    ]
    (tmp_path / "joints.csv").write_text("\n".join(["dip,dip_direction,position", *rows]))
    return tmp_path


def test_a_case_takes_the_sets_as_they_are(run_cli, table):
    status, out, err = run_cli("joints", "joints.csv", *SLOPE, "--scanline", "30/270")
    assert (status, err) == (0, "")
    assert "105 joints, 2 sets" in out and "may slide" in out
    assert out.endswith("joints.yaml\njoints.png\n")
    assert (table / "joints.png").read_bytes().startswith(b"\x89PNG")
    part = YAML(typ="safe").load((table / "joints.yaml").read_text())
    part["model"]["blocks"] = [{"group": "rock", "box": {"size": [5, 5, 5]}}]
    part["interfaces"]["default"] = {"friction_angle": 40}
    part["materials"] = {"rock": {"density": 2600, "young_modulus": 1e9, "poisson_ratio": 0.2}}
    part["groups"] = {"rock": {"material": "rock"}}
    part["stages"] = [{"name": "rest", "mode": "static"}]
    simulation = cdem.Simulation(cdem.Case.from_dict(part))
    assert simulation.audit.counts["blocks"] > 4


def test_json_holds_the_numbers(run_cli, table):
    status, out, _ = run_cli("joints", "joints.csv", *SLOPE, "-o", "new.yaml", "--json")
    facts = json.loads(out)
    assert status == 0 and [s["name"] for s in facts["sets"]] == ["set1", "set2"]
    assert facts["sets"][0]["dip"] == pytest.approx(35, abs=2)
    assert facts["shares"]["planar"] > 0.3 and (table / "new.png").is_file()


def test_mistakes_are_one_message(run_cli, table):
    status, _, err = run_cli("joints", "joints.csv", "--slope", "60/090")
    assert status == 2 and "give both --slope" in err
    status, _, err = run_cli("joints", "joints.csv", "--slope", "60-90", "--friction", "30")
    assert status == 2 and "e.g. 60/090; got 60-90" in err
    status, _, err = run_cli("joints", "joints.csv", "--length", "30")
    assert (
        status == 1 and err == "joints.csv: a length needs scanlines: give their trend and plunge\n"
    )
    (table / "joints.yaml").write_text("edited by hand")
    status, _, err = run_cli("joints", "joints.csv")
    assert status == 1 and err.startswith("joints.yaml: exists already; use --overwrite")
    assert run_cli("joints", "joints.csv", "--overwrite")[0] == 0
