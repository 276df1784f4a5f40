"""The verbs that run a case many times: what they are given."""

import pytest

pytestmark = pytest.mark.usefixtures("cube_folder")


@pytest.mark.parametrize("given", [["20,50", "--json"], ["20", "fifty"], ["1", "nan"]])
def test_between_takes_two_numbers(run_cli, given):
    status, _, err = run_cli("critical", "cube.yaml", "--factor", "--between", *given)
    # the text is wrapped and framed
    assert status == 2
    assert "--between takes two numbers with a space" in " ".join(err.replace("│", " ").split())
