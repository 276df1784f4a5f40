"""Options that several commands share."""

import pytest
from typer.main import get_command

from cdem.cli import app

NEW_LAW = ("law", "new", "my-clay", "--kind", "block")
TOLD = "warning: --force is now --overwrite; the next version refuses it\n"


@pytest.mark.parametrize("words", [("new", "incline"), NEW_LAW])
def test_one_word_replaces_files_and_the_earlier_word_names_it(run_cli, cube_folder, words):
    assert run_cli(*words)[0] == 0
    status, out, err = run_cli(*words)
    assert (status, out) == (1, "") and "exists already; use --overwrite" in err
    status, out, err = run_cli(*words, "--overwrite")
    assert (status, err) == (0, "")
    assert run_cli(*words, "--force") == (0, out, TOLD)


def test_help_says_force_only_where_a_case_has_changed():
    commands = get_command(app).commands
    shown = [*commands.items(), *((f"law {n}", c) for n, c in commands["law"].commands.items())]
    words = {
        name: {word for p in command.params if not getattr(p, "hidden", False) for word in p.opts}
        for name, command in shown
    }
    assert [name for name in words if "--force" in words[name]] == ["run"]
    replacing = {name for name in words if "--overwrite" in words[name]}
    assert replacing == {"new", "site", "joints", "rockfall", "law new", "run"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--force",), "--force goes with --resume; --overwrite replaces results"),
        (("--resume", "--overwrite"), "--resume and --overwrite exclude one another"),
        (("--quiet", "--json"), "--quiet and --json exclude one another"),
    ],
)
def test_options_of_run_that_do_not_go_together(run_cli, cube_folder, words, said):
    status, out, err = run_cli("run", "cube.yaml", *words)
    assert (status, out) == (2, "") and said in " ".join(err.split())
