"""`cdem compare`: scores, a table and a picture from a run, and one message for a mistake."""

import json
from pathlib import Path

import pytest
from shared.cases import CUBE

PRISMS = "point,x,y,z,time,dx [mm],dz [mm]\nA,0.5,0.5,1,0.002,0,-0.02\nA,0.5,0.5,1,0.004,0,-0.08\n"


@pytest.fixture
def folder(tmp_path, monkeypatch, run_cli):
    """A cube that fell for 5 ms, and prisms on it."""
    folder = tmp_path / "my slope"
    folder.mkdir()
    monkeypatch.chdir(folder)
    Path("cube.yaml").write_text(CUBE)
    Path("prisms.csv").write_text(PRISMS)
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    return folder


def test_scores_table_and_picture(run_cli, folder):
    status, out, err = run_cli("compare", "cube.results", "prisms.csv")
    assert (status, err) == (0, "")
    assert out.endswith("compare/prisms.csv\ncube.results/compare/prisms.json\n"
                        "cube.results/compare/prisms.png\n")  # fmt: skip
    told = json.loads(Path("cube.results/compare/prisms.json").read_text())
    assert told["scores"]["dz"]["skill"] > 0.95  # it falls by 5 t^2; frames are 1 ms apart
    assert told["scores"]["all"]["count"] == 4
    rows = Path("cube.results/compare/prisms.csv").read_text().splitlines()
    assert rows[0].startswith("name,x [m],y [m],z [m],time [s],monitored_dx [m]")
    assert len(rows) == 3
    assert Path("cube.results/compare/prisms.png").read_bytes().startswith(b"\x89PNG")


def test_json(run_cli, folder):
    status, out, _ = run_cli("compare", "cube.results", "prisms.csv", "-o", "there", "--json")
    assert status == 0 and json.loads(out)["scores"]["dz"]["count"] == 2
    assert (folder / "there" / "prisms.png").is_file()


@pytest.mark.parametrize(
    "words, status, message",
    [
        (("none", "prisms.csv"), 1, "none"),
        (("cube.results", "none.csv"), 1, "none.csv"),
        (("cube.results", "cube.yaml"), 1, "cube.yaml"),
        (("cube.results", "."), 1, "."),
        (("cube.results", "prisms.csv", "--los", "1,2,3"), 2, "--los takes a unit vector"),
        (("cube.results", "prisms.csv", "--los", "0,0,1"), 1, "no displacements along a line"),
        (("cube.results", "prisms.csv", "--unit", "mm"), 1, "leave --unit out"),
        (("cube.results", "prisms.csv", "--start", "2024-01-01"), 1, "leave --start out"),
    ],
)
def test_a_mistake_is_one_message(run_cli, folder, words, status, message):
    got, out, err = run_cli("compare", *words)
    assert got == status and not out
    assert message in err and "Traceback" not in err
    if status == 1:
        assert len(err.strip().splitlines()) == 1
