"""`cdem mesh` writes a mesh and says what it holds."""

import json
from pathlib import Path

import pytest
from shared.slopes import slope

from cdem.mesh.mesh_files import read_mesh

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")


def test_the_verb_writes_a_mesh_and_says_what_it_holds(run_cli, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    data = slope(sizes={"body": 20, "far": 50})
    (tmp_path / "slope.yaml").write_text(json.dumps(data))
    status, out, err = run_cli("mesh", "slope.yaml")
    assert (status, err) == (0, "")
    assert out.startswith("slope.msh: ") and "bed: dip 30.000 deg towards 90.000 deg" in out
    mesh = read_mesh("slope.msh")
    assert mesh.group_names == ["bedrock", "slab"]
    status, out, err = run_cli("mesh", "slope.yaml", "-o", "fine.msh", "--set", "sizes.body=12")
    assert (status, err) == (0, "")
    assert len(read_mesh("fine.msh").cells["tet4"]) > 1.5 * len(mesh.cells["tet4"])
    status, out, err = run_cli("mesh", "slope.yaml", "--set", "sizes.bodies=40")
    assert status == 1 and "sizes.bodies" in err and "Traceback" not in err
    data["surface"]["plane"]["through"] = [0, 0, 900]
    (tmp_path / "slope.yaml").write_text(json.dumps(data))
    status, out, err = run_cli("mesh", "slope.yaml")
    assert status == 1 and out == ""
    assert "slope.yaml:1:" in err and "bodies.0.outline: contains no rock" in err
