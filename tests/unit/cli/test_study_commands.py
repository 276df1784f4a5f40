"""The verbs that run a case many times: what they are given."""

import json
import re

import pytest
from shared.cases import SWEPT

pytestmark = pytest.mark.usefixtures("cube_folder")


@pytest.mark.parametrize("given", [["20,50", "--json"], ["20", "fifty"], ["1", "nan"]])
def test_between_takes_two_numbers(run_cli, given):
    status, _, err = run_cli("critical", "cube.yaml", "--factor", "--between", *given)
    # the text is wrapped and framed
    assert status == 2
    assert "--between takes two numbers with a space" in " ".join(err.replace("│", " ").split())


def _warnings(err: str) -> list[str]:
    lines = [line for line in err.splitlines() if line.startswith("warning: ")]
    return [line.removeprefix("warning: ") for line in lines]


def _told_by_check(run_cli, case):
    status, out, _ = run_cli("check", case, "--json")
    assert status == 0
    return _warnings("".join(f"warning: {text}\n" for text in json.loads(out)["warnings"]))


def test_runs_sweeps_and_searches_tell_the_warnings_of_check(run_cli, cube_folder):
    """Of the case (a density of 27 kg/m3) and of the model (a history off it); each once, all the same."""
    odd = SWEPT.replace("2700", "27").replace("[0, 0, 1]", "[0, 0, 9]")
    (cube_folder / "cube.yaml").write_text(odd)
    (cube_folder / "slab.yaml").write_text(
        odd.replace(
            "stages: [{name: fall, mode: dynamic, duration: 0.05}]",
            "stages: [{name: rest, mode: static}]",
        )
    )
    study = "case: cube.yaml\nparameters: {groups.cube.velocity.0: [0, 1]}\n"
    (cube_folder / "study.yaml").write_text(study)
    told, of_slab = (_told_by_check(run_cli, name) for name in ("cube.yaml", "slab.yaml"))
    assert len(told) >= 2 and all(re.match(r"cube\.yaml:[0-9]+:[0-9]+: ", text) for text in told)
    assert _warnings(run_cli("run", "cube.yaml")[2]) == told
    for _ in "first", "again, from results that are there":
        status, _, err = run_cli("sweep", "study.yaml", "--workers", "1")
        assert (status, _warnings(err)) == (0, told)
    assert _warnings(run_cli("sweep", "study.yaml", "--quiet")[2]) == []
    (cube_folder / "study.yaml").write_text("case: cube.yaml\nset: {materials.rock.density: 26}\n"
                                            "parameters: {groups.cube.velocity.0: [0, 1]}\n")  # fmt: skip
    status, _, err = run_cli("sweep", "study.yaml", "--workers", "1", "-o", "other")
    assert status == 0
    assert any(re.match(r"study\.yaml:2:\d+: materials", text) for text in _warnings(err))
    _, _, err = run_cli("critical", "slab.yaml", "--factor")
    assert _warnings(err) == of_slab
