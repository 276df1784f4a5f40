"""`cdem joints`: sets that a case takes as they are, a picture, and one message for a mistake."""

import json

import numpy as np
import pytest
from ruamel.yaml import YAML
from shared.joints import drawn_joints
from shared.outcrops import blocky

import cdem
from cdem.joints.directions import dips
from cdem.joints.disc_files import read_rows

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


@pytest.fixture
def cloud(tmp_path, monkeypatch):
    """A small outcrop at map coordinates, in a folder with a space."""
    folder = tmp_path / "an outcrop"
    folder.mkdir()
    monkeypatch.chdir(folder)
    points = blocky(size=4.0, density=900, seed=5).points + [512_000, 5_123_000, 1_200]
    np.savetxt(folder / "wall.xyz", points, "%.3f")
    return folder


def test_joints_of_a_cloud(run_cli, cloud, quick_pictures):
    status, out, err = run_cli("joints", "wall.xyz", "--extract", "--sets", "3", *SLOPE)
    assert (status, err) == (0, "")
    assert "3 sets" in out and "planar" in out and "facets  planes" in out
    assert out.endswith("wall.yaml\nwall.png\nwall.facets.csv\nwall.facets.png\n")
    assert (cloud / "wall.facets.png").read_bytes().startswith(b"\x89PNG")
    part = YAML(typ="safe").load((cloud / "wall.yaml").read_text())
    assert len(part["model"]["joints"]) == 3
    assert 0.3 < part["model"]["joints"][0]["spacing"] < 1.5
    # the table of facets is one of joints, with the same sets, and one of discs
    status, out, _ = run_cli("joints", "wall.facets.csv", "-o", "again.yaml", "--json")
    again = json.loads(out)
    assert status == 0 and len(again["sets"]) == 3
    for first, second in zip(part["model"]["joints"], again["sets"], strict=True):
        assert second["dip"] == pytest.approx(first["dip"], abs=0.1)
    notes = []
    rows = read_rows(cloud / "wall.facets.csv", notes)
    assert len(rows) == again["joints"]
    assert rows[0][0] == pytest.approx([512_000, 5_123_000, 1_200], abs=3)


def test_json_of_a_cloud(run_cli, cloud, quick_pictures):
    status, out, _ = run_cli("joints", "wall.xyz", "--extract", "--sets", "3", "--json")
    facts = json.loads(out)
    assert (
        status == 0 and facts["facets"] > 10 and facts["resolution"] == pytest.approx(0.03, rel=0.2)
    )
    row = facts["sets"][0]
    assert row["planes"] > 2 and row["area"] > 1 and 0 < row["persistence"] <= 1
    assert row["length"]["traces"] == row["facets"] >= row["length"]["seen"] / 2


def test_facets_without_sets_are_kept(run_cli, cloud):
    status, out, err = run_cli("joints", "wall.xyz", "--extract", "--sets", "9")
    assert status == 1 and out == "" and err.count("\n") == 1
    assert "in a column 'set' of wall.facets.csv, which has the facets" in err
    assert (cloud / "wall.facets.csv").read_text().startswith("x,y,z,dip,dip_direction,radius,")
    assert not (cloud / "wall.yaml").exists()


def test_clouds_and_tables_are_told_apart(run_cli, cloud):
    (cloud / "t.csv").write_text("dip,dip_direction\n3,4\n")
    assert run_cli("joints", "wall.xyz")[2] == (
        "wall.xyz: is a point cloud; find the joints in it with --extract\n"
    )
    for words, status, told in (
        (("t.csv", "--extract"), 1, "leave out --extract"),
        (("t.csv", "--angle", "12"), 2, "belong to --extract"),
        (("wall.xyz", "--extract", "--scanline", "5/5"), 2, "belong to tables"),
        (("wall.xyz", "--extract", "--angle", "80"), 2, "--angle must lie in 1 to 45"),
        (("wall.xyz", "--extract", "--resolution", "-1"), 2, "--resolution"),
        (("wall.xyz", "--extract", "--resolution", "5 m"), 1, "points are left at a resolution"),
        (("wall.xyz", "--extract", "--smallest", "1e4"), 1, "no facet has 1e+04 m2"),
        (("none.laz", "--extract"), 1, "no such file"),
    ):
        code, out, err = run_cli("joints", *words)
        assert (code, out) == (status, "") and told in " ".join(err.split()), words
    (cloud / "wall.facets.csv").write_text("mine")
    assert "exists already" in run_cli("joints", "wall.xyz", "--extract")[2]
