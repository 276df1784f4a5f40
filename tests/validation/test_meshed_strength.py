"""The first bond of irregular tets breaks at the part of its strength that cdem check tells."""

import numpy as np
import pytest
from scenes import case, irregular_tets

import cdem
from cdem.run.fields import stress_of


def test_the_first_bond_breaks_where_the_report_says(tmp_path):
    """A cube of 384 tets between smooth platens that part: mean stress when the first point breaks.

    2 %: platens hold what lies at them, and half a step's load.
    """
    mesh = irregular_tets(tmp_path / "m.vtk", [1, 1, 1], [4, 4, 4])
    low, high = ({"min": [-1, -1, z - 1e-6], "max": [2, 2, z + 1e-6]} for z in (0, 1))
    sim = cdem.Simulation(
        case(
            [], {"default": {}}, defaults=True, model={**mesh, "split": {"default": "elements"}},
            interfaces={"default": {"friction_angle": 30, "cohesion": 4e6, "tensile_strength": 1e6}},
            loads={
                "gravity": [0, 0, 0],
                "supports": [{"box": low, "fix": ["z"]}, {"point": [0, 0, 0], "fix": ["x", "y"]},
                             {"point": [1, 0, 0], "fix": ["y"]}],
                "velocities": [{"box": high, "components": ["z"], "velocity": [0, 0, 0.005],
                                "history": [[0, 0], [0.004, 1]]}],
            },
            stages=[{"name": "pull", "mode": "dynamic", "duration": 1, "damping": {"mass": 400}}],
        ),
        threads=1,
    )  # fmt: skip
    told = sim.audit.meshed_strength["default"]["brittle_along_xyz"]["tension"][2]
    volume = sim.build.assembly.element_volume["tet4"]
    while not sum(sim.broken.values()):
        sim.step(5)
    stress = volume @ stress_of(sim)[:, 2] / np.sum(volume)
    assert stress == pytest.approx(told * 1e6, rel=0.02)
