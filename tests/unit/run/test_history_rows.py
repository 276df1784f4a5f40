"""Rows of the histories of dynamic stages: when they come, and accelerations between them."""

import numpy as np
import pytest
from shared.signals import synthetic

from cdem import Case, CaseError, Simulation
from cdem.output.reader import read_histories
from cdem.run.stages import row_every

STAGES = [{"name": "fall", "mode": "dynamic", "duration": 0.2}]


def case(*entries, stages=STAGES, **more):
    """A cube that falls, with histories."""
    return Case.from_dict({
        "model": {"blocks": [{"group": "rock", "box": {"size": [1, 1, 1]}}]},
        "materials": {"r": {"density": 2500, "young_modulus": "1 GPa", "poisson_ratio": 0.25}},
        "groups": {"rock": {"material": "r"}},
        "loads": {"gravity": [0, 0, -10]},
        "stages": list(stages),
        "histories": list(entries),
        "time": {"step": 1e-4},
        "output": {"every": 0.05},
    } | more)  # fmt: skip


def entry(name="a", **more):
    return {"name": name, "group": "rock", "quantities": ["velocity", "acceleration"]} | more


def times(folder):
    """Times of the rows [s]."""
    return read_histories(folder)["time [s]"]


def frames(folder):
    """Number of frames."""
    return len(list((folder / "frames").glob("frame-*.vtkhdf")))


@pytest.mark.parametrize(
    ("entries", "every"),
    [([entry()], 0.005), ([entry(every="2 ms")], 0.002), ([entry(every=0.02)], 0.02),
     ([entry(every=0.02), entry("b", every=0.003), entry("c")], 0.003), ([entry(every=9)], 0.05)],
)  # fmt: skip
def test_rows_come_at_the_shortest_time_asked_for_and_frames_as_before(tmp_path, entries, every):
    """By default ten rows a frame; frames come with the row at or after their time."""
    Simulation(case(*entries), output=tmp_path / "out").run()
    found = times(tmp_path / "out")
    np.testing.assert_allclose(np.diff(found)[:-1], every, atol=1.1e-4)
    assert found[-1] == pytest.approx(0.2, abs=1.1e-4)
    assert frames(tmp_path / "out") == 5


def test_a_record_that_acts_gives_its_own_step_to_the_rows(tmp_path):
    """From the begin of its stage on; before it, ten rows a frame."""
    record = {"samples": synthetic(duration=0.2)[1], "unit": "m/s2", "step": 0.002}
    driven = {"group": "rock", "velocity": [1, 0, 0], "record": "k", "stage": "shake"}
    stages = [*STAGES, {"name": "shake", "mode": "dynamic", "duration": 0.1}]
    shaken = case(entry(), stages=stages, records={"k": record}, loads={"velocities": [driven]},
                  waves={"allow_coarse": True})  # fmt: skip
    Simulation(shaken, output=tmp_path / "out").run()
    steps = np.diff(times(tmp_path / "out"))
    np.testing.assert_allclose(steps[:39], 0.005, atol=1.1e-4)
    np.testing.assert_allclose(steps[-49:-1], 0.002, atol=1.1e-4)


def test_the_record_of_a_base_gives_its_step_too():
    """As one of driven nodes."""
    record = {"samples": synthetic(duration=0.2)[1], "unit": "m/s2", "step": 0.002}
    base = {"name": "base", "surface": {"group": "rock", "normal": [0, 0, -1]}, "quiet": True,
            "stage": "shake", "input": {"record": "k", "direction": [1, 0, 0]}}  # fmt: skip
    stages = [*STAGES, {"name": "shake", "mode": "dynamic", "duration": 0.2}]
    shaken = case(entry(), stages=stages, records={"k": record}, boundaries=[base])
    assert row_every(shaken, 0, 0.05) == 0.005
    assert row_every(shaken, 1, 0.05) == 0.002


def test_an_acceleration_is_the_change_of_velocity_since_the_row_before(tmp_path):
    """Free fall: -10 m/s2, 0 in the first row; times the row it gives the velocity to the bit."""
    Simulation(case(entry()), output=tmp_path / "out").run()
    rows = read_histories(tmp_path / "out")
    v, a, t = (rows[k] for k in ("a.velocity_z [m/s]", "a.acceleration_z [m/s2]", "time [s]"))
    assert a[0] == 0
    np.testing.assert_allclose(a[1:], np.diff(v) / np.diff(t), rtol=1e-13)
    np.testing.assert_allclose(a[2:], -10, rtol=1e-9)


def test_accelerations_of_a_resumed_run_have_the_same_bits(tmp_path):
    """Stopped in a stage, and between two."""
    stages = [*STAGES, {"name": "on", "mode": "dynamic", "duration": 0.1}]
    whole = case(entry(every=0.003), stages=stages)
    Simulation(whole, output=tmp_path / "whole").run()
    first = Simulation(whole, output=tmp_path / "cut")
    first.run_until(0.1)
    first.checkpoint()
    first.close()
    again = Simulation(whole, output=tmp_path / "cut", resume=True)
    again.run_stage("fall")
    again.close()
    Simulation(whole, output=tmp_path / "cut", resume=True).run()
    texts = [(tmp_path / name / "histories.csv").read_bytes() for name in ("whole", "cut")]
    assert texts[0] == texts[1]


@pytest.mark.parametrize(
    ("every", "told"), [("0 s", "must be above 0"), ("1 m", "wrong dimension; use one of: s, ms")]
)
def test_a_wrong_time_between_rows_is_told(every, told):
    """With its place."""
    with pytest.raises(CaseError, match=rf"histories.0.every: .*{told}"):
        case(entry(every=every))


def test_an_acceleration_needs_a_group_or_a_point():
    """Bolts have none."""
    with pytest.raises(CaseError, match="acceleration needs a group or a point"):
        case({"name": "a", "bolt": "b", "quantities": ["acceleration"]})
