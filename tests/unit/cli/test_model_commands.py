"""Verbs that make and look at models."""

from __future__ import annotations

import json

import pytest

from cdem import Case
from cdem.rockfall.rockfall import Rockfall

pytestmark = pytest.mark.usefixtures("cube_folder")


def test_check_reports_and_changes_nothing(run_cli, cube_folder):
    status, out, _ = run_cli("check", "cube.yaml")
    assert status == 0
    assert "A cube falls" in out
    assert json.loads(run_cli("check", "cube.yaml", "--json")[1])["counts"]["nodes"] == 8
    assert [path.name for path in cube_folder.iterdir()] == ["cube.yaml"]


def test_new_lists_and_writes_templates(run_cli, cube_folder):
    status, out, _ = run_cli("new")
    assert status == 0
    names = [line.split()[0] for line in out.splitlines()]
    assert names == [
        "arch",
        "bedded_slope",
        "blast",
        "dam",
        "foliated",
        "incline",
        "landslide",
        "landslide_dem",
        "quake",
        "road_cut",
        "rockfall",
        "rockfall_runs",
        "safety",
        "slope",
        "toppling",
        "tunnel",
        "tunnel_bolts",
        "wall",
        "wedge",
    ]
    for name in names:
        assert run_cli("new", name, "cases")[0] == 0
        if name == "rockfall_runs":
            assert Rockfall.load(cube_folder / "cases" / f"{name}.yaml").title
        elif name != "landslide_dem":  # is to be meshed first
            assert Case.load(cube_folder / "cases" / f"{name}.yaml").title
    assert all(
        (cube_folder / "cases" / file).exists() for file in ("slope.msh", "blast.msh", "valley.asc")
    )
    status, _, err = run_cli("new", "incline", "cases")
    assert status == 1
    assert "cases/incline.yaml: exists already; use --overwrite" in err
    assert run_cli("new", "incline", "cases", "--overwrite")[0] == 0
    assert "did you mean incline?" in run_cli("new", "inclin")[2]


@pytest.mark.parametrize(
    "name",
    [
        "incline",
        "wall",
        "slope",
        "safety",
        "landslide",
        "tunnel",
        "tunnel_bolts",
        "dam",
        "foliated",
        "bedded_slope",
        "blast",
        "arch",
        "rockfall",
        "road_cut",
        "toppling",
        "wedge",
        "landslide_dem",
        "quake",
    ],
)
def test_templates_check(run_cli, name):
    """The commands that `cdem new` names work, in another folder than that of the case."""
    _, said, _ = run_cli("new", name, "cases")
    commands = [line.split()[2:] for line in said.splitlines() if line.startswith("next: cdem")]
    for meshing in commands[:-1]:
        assert run_cli(*meshing)[0] == 0
    assert commands[-1][:2] in (["run", f"cases/{name}.yaml"], ["critical", f"cases/{name}.yaml"])
    name = f"cases/{name}"
    status, out, err = run_cli("check", f"{name}.yaml")
    assert (status, err) == (0, "")
    assert "warning" not in out


def test_schema_is_json(run_cli):
    status, out, _ = run_cli("schema")
    assert status == 0
    assert "materials" in json.loads(out)["properties"]
    assert "parameters" in json.loads(run_cli("schema", "study")[1])["properties"]
    assert "sampling" in json.loads(run_cli("schema", "uncertain")[1])["properties"]
    assert "barriers" in json.loads(run_cli("schema", "rockfall")[1])["properties"]


def test_a_warning_is_told_once_and_strict_refuses_it(run_cli, cube_folder):
    odd = ("--set", "interfaces.default.friction_angle=0.35")
    status, out, err = run_cli("check", "cube.yaml", *odd)
    assert (status, err) == (0, "")
    assert out.count("warning:") == 1
    assert "interfaces.default.friction_angle: 0.35 deg is unusual" in out
    assert json.loads(run_cli("check", "cube.yaml", "--json", *odd)[1])["warnings"]
    status, _, err = run_cli("check", "cube.yaml", "--strict", *odd)
    assert status == 1
    assert "0.35 deg is unusual" in err
    assert err.endswith("1 warning, which --strict does not allow\n")
    assert run_cli("check", "cube.yaml", "--strict")[0] == 0


def test_the_impossible_is_one_line(run_cli):
    status, out, err = run_cli("check", "cube.yaml", "--set", "materials.rock.density=2.7")
    assert (status, out) == (1, "")
    assert err == (
        "--set materials.rock.density=2.7: materials.rock.density: 2.7 kg/m3 is not possible; usual "
        'is 500 kg/m3 to 8000 kg/m3; did you mean "2.7 t/m3"?\n'
    )
