"""`cdem critical`: the angle of friction and the factor of safety of a block on a slope."""

import json
import math

import numpy as np
import pytest
from scenes import case
from typer.testing import CliRunner

from cdem.cli import app
from cdem.errors import CaseError
from cdem.study.criterion import Criterion
from cdem.study.critical import find_critical, parameter, strength_reduction

SLOPE = 30.0  # [deg]


def block_on_a_slope(friction_angle=45, **more):
    """The block comes to rest with strong friction first; then the last stage decides."""
    t = np.radians(SLOPE)
    return case(
        [
            {"group": "block", "box": {"size": [1, 1, 0.5]}, "translate": [1, 1, 0]},
            {"group": "bed", "box": {"size": [4, 3, 1]}, "translate": [0, 0, -1]},
        ],
        {"block": {}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={"default": {"friction_angle": 60}},
        loads={"gravity": [9.81 * math.sin(t), 0, -9.81 * math.cos(t)]},
        stages=[
            {"name": "settle", "mode": "static"},
            {
                "name": "decide",
                "mode": "static",
                "set": {"interfaces.default.friction_angle": friction_angle},
            },
        ],
        **more,
    )


def test_critical_angle_of_friction():
    """It slides when tan(phi) < tan(slope)."""
    told = []
    found = find_critical(
        block_on_a_slope(),
        parameter("interfaces.default.friction_angle"),
        (50, 10),
        tolerance=0.01,
        threads=1,
        report=lambda trial, stable, failed: told.append((trial.value, stable, failed)),
    )
    assert found.failed <= SLOPE + 0.002 and found.stable >= SLOPE - 0.002
    assert found.stable - found.failed <= 0.01
    assert [t.value for t in found.trials] == [value for value, *_ in told]


def test_factor_of_safety():
    """F = tan(phi) / tan(slope) without cohesion; phi is that of the last stage, not 60 degrees."""
    this = block_on_a_slope(friction_angle=45)
    found = find_critical(this, strength_reduction(), (1, 3), tolerance=0.002, threads=1)
    assert found.value == pytest.approx(1 / math.tan(math.radians(SLOPE)), abs=0.003)


def test_a_search_is_deterministic():
    """The same trials to the last step, on one thread and on two."""
    searches = [
        find_critical(
            block_on_a_slope(), strength_reduction(), (1, 3), tolerance=0.1, threads=threads
        )
        for threads in (1, 1, 2)
    ]
    assert searches[0] == searches[1] == searches[2]


def test_a_parameter_that_makes_another_model():
    """The steepest slope on which friction holds the block: each trial builds its own."""
    model = {"rotate": {"axis": [0, 1, 0], "angle": 0}}
    this = block_on_a_slope(friction_angle=35, model=model)
    this.set("loads.gravity", [0, 0, -9.81])
    found = find_critical(this, parameter("model.rotate.angle"), (33, 38), tolerance=3, threads=1)
    assert (found.stable, found.failed) == (33, 35.5)


def test_another_criterion_is_obeyed():
    """Nothing slides far in 50 steps: there is no rest in so many."""
    found = find_critical(
        block_on_a_slope(),
        parameter("interfaces.default.friction_angle"),
        (50, 10),
        tolerance=10,
        criterion=Criterion(most_steps=50),
        threads=1,
    )
    failed = [trial for trial in found.trials if not trial.stable]
    assert failed and all(trial.steps == 50 for trial in failed)
    assert failed[0].why.startswith("no rest in 50 steps")
    assert Criterion.read(["far=2", "stall_steps=100"]) == Criterion(far=2, stall_steps=100)
    with pytest.raises(CaseError, match="--criterion trvel=1: trvel: unknown key; did you mean"):
        Criterion.read(["trvel=1"])


def test_both_ends_rest():
    with pytest.raises(CaseError, match="both 40 and 50 come to rest"):
        find_critical(
            block_on_a_slope(),
            parameter("interfaces.default.friction_angle"),
            (40, 50),
            tolerance=1,
            threads=1,
        )


def test_from_the_command_line(tmp_path):
    file = tmp_path / "slope.yaml"
    file.write_text(block_on_a_slope().dump())
    words = ["critical", str(file), "--between", "41", "20", "--tolerance", "1", "--threads", "1"]
    done = CliRunner().invoke(
        app, [*words, "--parameter", "interfaces.default.friction_angle", "--json"]
    )
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert found["failed"] < SLOPE < found["stable"]
    assert "stable (" in done.stderr and "fails (" in done.stderr
    assert "a trial fails when a node has moved 2 % of the mean face size" in done.stderr
    wrong = CliRunner().invoke(app, [*words, "--parameter", "materials.rock.densty"])
    assert isinstance(wrong.exception, CaseError)
    assert "did you mean density?" in str(wrong.exception)
