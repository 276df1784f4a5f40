"""Processed records in a result folder, and the motion that they give to nodes."""

import numpy as np
import pytest
from shared.signals import at2, synthetic

from cdem import Case, CaseError, CdemError, Simulation
from cdem.case import waves_schema

CASE = """\
model: {blocks: [{group: rock, box: {size: [1, 1, 1]}}]}
materials: {m: {density: 2600, young_modulus: 1 GPa, poisson_ratio: 0.2}}
groups: {rock: {material: m}}
interfaces: {default: {friction_angle: 30}}
loads: {velocities: [{group: rock, velocity: [1, 0, -0.5], record: k b, stage: shake}]}
records: {k b: {file: k.at2, band: [1 Hz, 15 Hz], baseline: cubic, scale: 0.5}}
stages:
  - {name: wait, mode: dynamic, duration: 50 ms}
  - {name: shake, mode: dynamic, duration: 1.5 s}
time: {step: 1 ms}
output: {frames: false}
"""


@pytest.fixture
def write(tmp_path, monkeypatch):
    """Write the case, changed if asked; returns its name."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "k.at2").write_text(at2(synthetic(duration=1.2)[1], 0.005))

    def write(old="cdem", new="cdem"):
        (tmp_path / "case.yaml").write_text(CASE.replace(old, new, 1))
        return "case.yaml"

    return write


def test_driven_nodes_follow_the_velocity_of_the_record_from_the_begin_of_their_stage(write):
    """At rest before and after it, linear between samples."""
    simulation = Simulation(write())
    record = simulation.case.processed("k b")
    begin, found, expected = 0.05, [], []
    for time in np.arange(0.001, 1.5, 0.0173):
        simulation.run_until(time)
        at = simulation.time - 0.0005 - begin  # a velocity is that of the middle of a step
        speed = float(np.interp(at, record.times, record.velocity, left=0.0, right=0.0))
        expected.append([speed, 0.0, -0.5 * speed])
        found.append(simulation.fields["velocity"].mean(axis=0))
    assert np.abs(np.array(found) - expected).max() < 1e-15
    assert not np.array(found)[:2].any() and not np.array(found)[-8:].any()
    assert np.abs(expected).max() > 0.02


def test_a_resumed_run_gives_the_same_bits_and_filters_nothing(write, monkeypatch):
    """It goes on with the stored record."""
    whole = Simulation(write())
    whole.run()
    first = Simulation("case.yaml", output="out")
    first.run_until(0.6)
    first.checkpoint()
    first.close()
    case, before = Case.load("case.yaml"), first.case.processed("k b").velocity
    monkeypatch.setattr(waves_schema, "process", None)  # must not be called
    again = Simulation(case, output="out", resume=True)
    again.run()
    assert (again.motion == whole.motion).all()
    assert (again.case.processed("k b").velocity == before).all()


@pytest.mark.parametrize("change", ["bits", "text", "gone"])
def test_a_resumed_run_with_another_processed_record_is_refused(write, tmp_path, change):
    """One line says which file and how to go on."""
    first = Simulation(write(), output="out")
    first.run_until(0.1)
    first.checkpoint()
    first.close()
    path = tmp_path / "out/records/k b.csv"
    text = path.read_text()
    if change == "gone":
        path.unlink()
    else:
        path.write_text(text[:-3] + "\n" if change == "bits" else "nothing\n")
    with pytest.raises(CdemError, match=r"records/k b.csv: .*put the file back, or run") as caught:
        Simulation("case.yaml", output="out", resume=True)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("what", ["scale", "samples"])
def test_a_resumed_run_cannot_change_its_record_even_by_force(write, tmp_path, what, force):
    """One line with its place, although the samples are many."""
    first = Simulation(write(), output="out")
    first.run_until(0.1)
    first.checkpoint()
    first.close()
    name = write("scale: 0.5", "scale: 0.6" if what == "scale" else "scale: 0.5")
    if what == "samples":
        (tmp_path / "k.at2").write_text(at2(1.1 * synthetic(duration=1.2)[1], 0.005))
    with pytest.raises(CaseError, match=rf"case.yaml:6:\d+: records.k b.{what}: ") as caught:
        Simulation(name, output="out", resume=True, force=force)
    told = str(caught.value)
    assert "\n" not in told and len(told) < 300 and "run the case again in another folder" in told


def test_overwriting_removes_records_of_the_run_before(write, tmp_path):
    """They are files of cdem."""
    Simulation(write(), output="out").close()
    assert [p.name for p in (tmp_path / "out/records").iterdir()] == ["k b.csv"]
    text = (tmp_path / "case.yaml").read_text()
    (tmp_path / "case.yaml").write_text(text.replace("k b", "k c"))
    Simulation("case.yaml", output="out", overwrite=True).close()
    assert [p.name for p in (tmp_path / "out/records").iterdir()] == ["k c.csv"]


def test_a_script_cannot_change_a_record_in_the_middle_of_a_run(write):
    """Its samples, its use, its stage."""
    simulation = Simulation(write())
    simulation.run_until(0.1)
    for path, value in (
        ("records.k b.scale", 2),
        ("loads.velocities.0", {"group": "rock", "velocity": [1, 0, 0]}),
        ("loads.velocities.0.stage", "wait"),
    ):
        with pytest.raises(CaseError, match=r"can change|cannot change"):
            simulation.set(path, value)
    simulation.set("loads.velocities.0.velocity", [0, 1, 0])  # its factors may change
