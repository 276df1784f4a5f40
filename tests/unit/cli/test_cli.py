"""The program: exit statuses, what is printed where, and what is imported."""

from __future__ import annotations

import subprocess
import sys

import pytest

from cdem import __version__

pytestmark = pytest.mark.usefixtures("cube_folder")


def test_version_and_help(run_cli):
    assert run_cli("--version") == (0, f"cdem {__version__}\n", "")
    status, out, _ = run_cli("--help")
    assert status == 0
    verbs = (
        "new",
        "check",
        "run",
        "info",
        "plot",
        "render",
        "runout",
        "export",
        "schema",
        "doctor",
    )
    for verb in verbs:
        assert f"  {verb} " in out


@pytest.mark.parametrize(
    "words",
    [
        ["fly"],
        ["run"],
        ["run", "cube.yaml", "--fast"],
        ["run", "cube.yaml", "--threads", "0"],
        ["run", "cube.yaml", "--resume", "--overwrite"],
        ["run", "cube.yaml", "--quiet", "--json"],
        ["export", "cube.results", "--to", "doc"],
        ["new", "inclin"],
    ],
)
def test_wrong_usage_is_status_2(run_cli, words):
    status, out, err = run_cli(*words)
    assert (status, out) == (2, "")
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["check", "none.yaml"], "none.yaml: cannot read the case file: No such file"),
        (["check", "cube.yaml", "--set", "loads.gravty=0"], "loads.gravty: unknown key; did you"),
        (["run", "cube.yaml", "--set", "stages=[]"], "stages: needs at least 1 entry, got 0"),
        (["run", "cube.yaml", "--device", "cuda"], "for a GPU build the core for it, in a clone"),
        (["run", "cube.yaml", "--resume"], "no checkpoint to resume from"),
        (["run", "cube.yaml", "-o", "cube.yaml"], "cube.yaml: is a file"),
        (["info", "nowhere"], "nowhere: no such folder"),
        (["plot", "."], ".: is not a result folder"),
    ],
)
def test_wrong_input_is_status_1_and_one_message(run_cli, cube_folder, words, message):
    status, out, err = run_cli(*words)
    assert (status, out) == (1, "")
    assert message in err
    assert err.count("\n") == 1
    assert [path.name for path in cube_folder.iterdir()] == ["cube.yaml"]  # nothing was written


def test_import_and_help_are_fast():
    code = "import sys, cdem, cdem.cli; print(*sorted(sys.modules))"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    heavy = {"numpy", "h5py", "pydantic", "ruamel.yaml", "meshio", "matplotlib", "pyvista"}
    assert heavy & set(out.stdout.split()) == set()


def test_check_loads_nothing_that_results_need(cube_folder):
    code = """if True:
        import sys
        from cdem import cli
        sys.argv = ["cdem", "check", "cube.yaml"]
        cli.main()
        print(*sys.modules)
    """
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert {"h5py", "filelock", "matplotlib", "pyvista"} & set(out.stdout.split()) == set()
