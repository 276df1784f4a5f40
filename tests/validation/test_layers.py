"""Layers under gravity at rest: the vertical stress is the weight of the rock above, sum of rho g h."""

import numpy as np
import pytest

import cdem
from cdem.run.fields import stress_of
from cdem.terrain import Landslide, make_mesh, write

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")
GRAVITY = 9.81  # [m/s2]
DENSITY = {"soil": 1900.0, "weathered": 2200.0, "shale": 2500.0, "granite": 2700.0}  # [kg/m3]
BASES = {"soil": 90.0, "weathered": 60.0, "shale": 40.0, "granite": 0.0}  # [m]
MODULUS = {"soil": "0.5 GPa", "weathered": "2 GPa", "shale": "8 GPa", "granite": "30 GPa"}


def weight_above(z):
    """Vertical stress [Pa] at heights, shape (points,); positive in tension."""
    stress, top = np.zeros(len(z)), 100.0
    for name, base in BASES.items():
        stress -= DENSITY[name] * GRAVITY * np.clip(top - z, 0, top - base)
        top = base
    return stress


def level(z):
    return {"plane": {"dip": 0, "dip_direction": 0, "through": [0, 0, z]}}


def test_the_vertical_stress_at_rest_is_the_weight_above(tmp_path):
    layers = [{"group": name, "base": level(z)} for name, z in BASES.items() if z]
    solid = make_mesh(
        Landslide(
            terrain=level(100),
            extent={"x": [0, 40], "y": [0, 40], "base": 0},
            layers=layers,
            bedrock="granite",
            sizes={"body": 10, "far": 20},
        )
    )
    write(solid, tmp_path / "layers.msh")
    sides = {"S": "y", "N": "y", "E": "x", "W": "x"}
    supports = [{"surface": f"fix_side_{side}", "fix": [axis]} for side, axis in sides.items()]
    case = {
        "model": {"mesh": str(tmp_path / "layers.msh")},
        "materials": {
            name: {"density": density, "young_modulus": MODULUS[name], "poisson_ratio": 0.25}
            for name, density in DENSITY.items()
        },
        "groups": {name: {"material": name} for name in DENSITY},
        "interfaces": {
            "default": {"friction_angle": 30, "cohesion": "1 GPa", "tensile_strength": "1 GPa"}
        },
        "loads": {
            "gravity": [0, 0, -GRAVITY],
            "supports": [{"surface": "fix_base", "fix": ["x", "y", "z"]}, *supports],
        },
        "stages": [{"name": "rest", "mode": "static"}],
    }
    simulation = cdem.Simulation(cdem.Case.from_dict(case), threads=1)
    assert simulation.run() == "converged"
    stress = stress_of(simulation)[:, 2]
    build = simulation.build
    z = build.start_position[build.topology.element_nodes["tet4"], 2].mean(axis=1)
    expected = weight_above(z)
    # mean over slices: each tet has one stress
    for low in range(0, 100, 20):
        some = (z >= low) & (z < low + 20)
        assert stress[some].mean() == pytest.approx(expected[some].mean(), rel=0.003), low
