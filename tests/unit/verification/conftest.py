"""A problem of a user's own: a cube falls."""

import pytest

CASE = """\
model: {blocks: [{group: cube, box: {size: [1, 1, 1]}}]}
materials: {rock: {density: 2700, young_modulus: "1 GPa", poisson_ratio: 0.25}}
groups: {cube: {material: rock}}
interfaces: {default: {friction_angle: 30}}
loads: {gravity: [0, 0, -10]}
stages: [{name: fall, mode: dynamic, duration: "10 ms"}]
"""
PROBLEM = '''\
"""A cube falls."""

def theory(gravity, time):
    """v = g t, Galilei (1638)."""
    return gravity * time

def run(study):
    """Compare its speed."""
    simulation = study.simulate()
    simulation.run()
    speed = simulation.fields["velocity"][:, 2].mean()
    study.check("speed", theory=theory(-10, simulation.time), ours=speed, within=WITHIN, unit="m/s")
    study.curve("Speed", "t", "v", {"here": ([0, 1], [0, 1]), ".there": ([0], [1])})
'''


@pytest.fixture
def fall(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "fall"
    folder.mkdir()
    (folder / "case.yaml").write_text(CASE)
    (folder / "problem.py").write_text(PROBLEM.replace("WITHIN", "1e-9"))
    (folder / "README.md").write_text("# The falling cube\n\nIt falls with $v = g t$.\n")
    return folder
