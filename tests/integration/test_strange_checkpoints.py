"""Checkpoints with a right checksum whose numbers cannot be are refused in one line."""

import json
import math

import numpy as np
import pytest
from shared.cases import FALL

from cdem import Case, CdemError, Simulation
from cdem.run.checkpoint import read_checkpoint, write_checkpoint


def core(**numbers):
    return lambda kept: kept["core"].update(numbers)


def stage(**values):
    return lambda kept: kept["ended_stage"].update(values)


CHANGES = {
    "steps": core(step=2**70),
    "steps of a float": core(step=1.5),
    "negative steps": core(step=-1),
    "time": core(time=math.nan),
    "step": core(dt=0.0),
    "infinite step": core(dt=math.inf),
    "flag": core(stop_due=7.5),
    "frames": lambda kept: kept.update(frames=10**6),
    "rows": lambda kept: kept.update(rows=10**12, frames=10**12),
    "no stages": lambda kept: kept["case"].update(stages=None),
    "stages that are none": lambda kept: kept["case"].update(stages=[None]),
    "no ended stage": lambda kept: kept.update(finished_stages=[]),
    "no begin": lambda kept: kept["finished_stages"][0].pop("begin"),
    "begin": lambda kept: kept["finished_stages"][0].update(begin=math.inf, name="other"),
    "begin of a word": lambda kept: kept["finished_stages"][0].update(begin="0", name="other"),
    "index": lambda kept: kept.update(stage_index=10**9),
    "end": stage(end_time=math.nan),
    "rows of a stage": stage(row_every=0.0),
    "start": stage(start_step=10**9),
    "looks": stage(ways=[0.0]),
}


@pytest.fixture
def results(tmp_path):
    """The folder of a run that has ended."""
    (tmp_path / "case.yaml").write_text(FALL)
    Simulation(Case.load(tmp_path / "case.yaml"), output=tmp_path / "out", threads=1).run()
    return tmp_path / "out"


def resume(folder):
    return Simulation(Case.load(folder.parent / "case.yaml"), output=folder, resume=True, threads=1)


@pytest.mark.parametrize("what", CHANGES)
def test_numbers_that_cannot_be_are_refused(results, what):
    """Steps, times, counts and stages out of any range: one line that says so."""
    arrays, text = read_checkpoint(results / "checkpoint.h5")
    kept = json.loads(text)
    CHANGES[what](kept)
    for _ in range(2):  # so that the one before is of the same kind
        write_checkpoint(results, arrays, json.dumps(kept))
    with pytest.raises(CdemError, match="is damaged") as error:
        resume(results)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "value"),
    [("node.motion", math.nan), ("triangles.status", 9), ("node.body", 10**6), ("node.body", -7)],
)
def test_arrays_that_cannot_be_are_refused(results, name, value):
    """States and indices out of range, and motion that is no number, never reach the core."""
    arrays, text = read_checkpoint(results / "checkpoint.h5")
    assert len(arrays[name]) > 0
    arrays[name][0] = value
    for _ in range(2):
        write_checkpoint(results, arrays, text.decode())
    with pytest.raises(CdemError, match="is damaged"):
        resume(results)


@pytest.mark.parametrize(
    "change",
    [
        lambda array: array.astype(np.float32),
        lambda array: array[:-1],
        lambda array: array * math.nan,
        lambda array: None,
    ],
    ids=["kind", "shape", "no numbers", "gone"],
)
def test_positions_that_the_run_keeps_itself_are_looked_at(results, change):
    """`simulation.reference` in single precision was taken, and the results were others."""
    arrays, text = read_checkpoint(results / "checkpoint.h5")
    arrays["simulation.reference"] = change(arrays["simulation.reference"])
    arrays = {name: array for name, array in arrays.items() if array is not None}
    for _ in range(2):
        write_checkpoint(results, arrays, text.decode())
    with pytest.raises(CdemError, match=r"is damaged \(simulation.reference"):
        resume(results)
