"""The table of verbs is that of their code, and help reads the table alone."""

import re
import subprocess
import sys

import pytest
from typer.main import get_command

from cdem.cli import app
from cdem.cli.verbs import VERBS


@pytest.mark.parametrize("name", VERBS)
def test_the_line_of_a_verb_begins_its_help(name):
    command = get_command(app).commands[name]
    words = " ".join(command.help.split())
    assert command.name == name
    assert re.match(r".+?\.(?= |$)", words)[0] == VERBS[name][1]


def test_help_names_all_verbs_and_imports_none():
    code = """if True:
        import sys
        from cdem import cli
        sys.argv = ["cdem", "--help"]
        try:
            cli.main()
        finally:
            print(*sys.modules, file=sys.stderr)
    """
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    listed = done.stdout.partition("Commands:")[2].partition("\n\n")[0]
    assert re.findall(r"^  (\w+) ", listed, re.M) == list(VERBS)
    assert "cdem.cli.verbs" in done.stderr.split()
    assert "_commands" not in done.stderr


def test_a_verb_that_is_not_there_is_told_of_its_neighbour(run_cli):
    status, _, err = run_cli("chek")
    assert status == 2 and "Did you mean 'check'" in err
