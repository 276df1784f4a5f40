"""What `--overwrite` replaces, and what it leaves alone."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.usefixtures("cube_folder")
AGAIN = ("run", "cube.yaml", "-o", "out", "--overwrite", "--quiet")


@pytest.fixture
def results(run_cli, cube_folder):
    """A result folder."""
    assert run_cli("run", "cube.yaml", "-o", "out", "--quiet")[0] == 0
    return cube_folder / "out"


def test_results_are_replaced_whatever_a_kill_left_of_them(run_cli, results):
    left = ["checkpoint.h5.tmp", "displacement-0003.png", "history-top.png", "deposit.asc"]
    for name in left:
        (results / name).touch()
    (results / "vtu").mkdir()
    (results / "vtu/frame-0000.vtu").touch()
    assert run_cli(*AGAIN) == (0, "", "")
    names = {path.name for path in results.iterdir()}
    assert names.isdisjoint([*left, "vtu"]) and {".cdem-results", "checkpoint.h5"} <= names


@pytest.mark.parametrize(
    "name", ["thesis.tex", "displacement-holiday.png", "vtu/mine.vtu", "sub/a"]
)
def test_a_result_folder_with_a_file_of_the_user_stays_as_it_is(run_cli, results, name):
    (results / name).parent.mkdir(exist_ok=True)
    (results / name).write_text("mine")
    before = {path: path.stat().st_mtime_ns for path in results.rglob("*")}
    status, _, err = run_cli(*AGAIN)
    assert status == 1 and f"holds {name.split('/')[0]}, which cdem did not write" in err
    assert {path: path.stat().st_mtime_ns for path in results.rglob("*")} == before


def test_a_folder_with_names_of_ours_but_without_the_mark_stays(run_cli, cube_folder):
    """A folder of the user's that holds a case.yaml and a summary.json."""
    (cube_folder / "out").mkdir()
    for name in ("case.yaml", "summary.json", "run.log"):
        (cube_folder / "out" / name).write_text("mine")
    status, _, err = run_cli(*AGAIN)
    assert status == 1 and "is not a result folder" in err
    assert (cube_folder / "out/case.yaml").read_text() == "mine"


def test_the_folder_of_the_case_is_never_replaced(run_cli, results):
    """Not even where it is a result folder whose case is run again."""
    status, _, err = run_cli("run", "out/case.yaml", "-o", "out", "--overwrite")
    assert status == 1 and "out: is the folder of the case" in err
    assert (results / "checkpoint.h5").exists()


def test_a_link_is_removed_and_not_what_it_leads_to(run_cli, results, cube_folder):
    (cube_folder / "photos").mkdir()
    (cube_folder / "photos/frame-0001.vtu").touch()
    (results / "vtu").symlink_to(cube_folder / "photos")
    status, _, err = run_cli(*AGAIN)
    assert status == 1 and "holds vtu, which" in err
    (results / "vtu").unlink()
    (results / "report.html").symlink_to(cube_folder / "cube.yaml")
    assert run_cli(*AGAIN)[0] == 0
    assert (cube_folder / "cube.yaml").stat().st_size > 0
    assert not (results / "report.html").is_symlink()
