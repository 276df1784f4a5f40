"""`cdem law test`: laboratory tests of one law, against their formulas; and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.study.law_test import lead_law

MC = ["cohesion=1 MPa", "friction_angle=35"]
N = (1 + np.sin(np.radians(35))) / (1 - np.sin(np.radians(35)))
STRENGTH = 2e6 * np.sqrt(N)


@pytest.mark.parametrize(("path", "axial", "to", "within"), [
    ("uniaxial", -STRENGTH, 3e-3, 1e-3), ("triaxial 5 MPa", -N * 5e6 - STRENGTH, 3e-3, 2e-4),
    ("extension 5 MPa", -(5e6 - STRENGTH) / N, 1e-3, 1e-2),  # strain times the pressure counts
])  # fmt: skip
def test_strength_of_a_cube(path, axial, to, within):
    """s1 = N s3 + 2 c sqrt(N)."""
    curve = lead_law("mohr-coulomb", path, MC, to=to)
    assert curve.rows[-1, 1] == pytest.approx(axial, rel=within)
    assert abs(curve.rows[-1, 0]) == pytest.approx(to, rel=0.1)
    assert curve.columns[4:] == ["plastic_shear [1]", "plastic_tension [1]"]
    assert curve.rows[0, 4] == 0 and curve.rows[-1, 4] > 0


def test_oedometer_of_an_elastic_cube():
    """ds / de = lambda + 2 mu = 12 GPa of E = 10 GPa, nu = 0.25."""
    curve = lead_law("elastic", "oedometer", to=1e-3)
    slope = np.polyfit(curve.rows[20:, 0], curve.rows[20:, 1], 1)[0]
    assert slope == pytest.approx(12e9, rel=1e-13)
    np.testing.assert_allclose(curve.rows[:, 3], curve.rows[:, 0], atol=1e-9)


def test_a_weak_plane_lets_the_cube_lean():
    """cj / (sin b cos b - cos^2 b tan(phi_j)) of a plane that dips 60 deg: 3464 Pa (Jaeger)."""
    plane = [
        "joint_cohesion=1e3",
        "joint_friction_angle=30",
        "joint_dip=60",
        "joint_dip_direction=90",
    ]
    curve = lead_law("ubiquitous-joint", "uniaxial",
                     ["cohesion=2e3", "friction_angle=40", "young_modulus=1e7", *plane], to=2e-3)  # fmt: skip
    assert curve.rows[-1, 1] == pytest.approx(-3464.1, rel=5e-3)


def test_a_joint_is_sheared_and_opened():
    """Friction falls to tan(phi_r) sigma over the slip distance; G = T w / 2 in opening."""
    curve = lead_law("slip-weakening", "shear 1 MPa",
                     ["friction_angle=45", "residual_friction_angle=30", "slip_distance=1 mm"],
                     to=2e-3)  # fmt: skip
    assert curve.rows[:, 1].max() == pytest.approx(1e6, rel=3e-3)
    assert curve.rows[-1, 1] == pytest.approx(np.tan(np.radians(30)) * 1e6, rel=2e-6)
    assert curve.rows[-1, 2] == pytest.approx(-1e6, rel=1e-8)
    soft = ["friction_angle=30", "tensile_strength=3e6", "cohesion=6e6", "fracture_energy_1=100",
            "fracture_energy_2=300", "stiffness_n=3e12", "stiffness_s=2e12"]  # fmt: skip
    curve = lead_law("softening", "opening", soft, to=1e-4)
    assert np.trapezoid(curve.rows[:, 1], curve.rows[:, 0]) == pytest.approx(100, rel=0.02)
    assert curve.columns[4:] == ["joint_damage [1]", "joint_opening [m]", "joint_slip [m]"]


# Of rough joints, within 1 %: contacts have their areas to 4 %, and so their pressure. The laws
# themselves are those of the quick problems `barton_curve` and `cy_shear`.
@pytest.mark.slow
def test_a_rough_joint_is_sheared():
    """Peak of 0.9996 MPa under 1 MPa (JRC 10, JCS 50 MPa)."""
    curve = lead_law("barton-bandis", "shear 1 MPa",
                     ["jrc=10", "jcs=50 MPa", "residual_friction_angle=28"], to=2e-3)  # fmt: skip
    assert curve.rows[:, 1].max() == pytest.approx(0.9996e6, rel=1e-2)
    assert curve.rows[-1, 3] - curve.rows[:, 3].min() > 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", ["1e11", "1e12"])
def test_a_rough_joint_yields(stiffness):
    """Friction of tan(30 + 15 exp(-s / R))."""
    curve = lead_law("continuously-yielding", "shear 1 MPa",
                     ["friction_angle=30", "initial_friction_angle=45", "roughness=2 mm",
                      f"stiffness_s={stiffness}"], to=5e-3)  # fmt: skip
    angle = 30 + 15 * np.exp(-curve.rows[-1, 4] / 2e-3)
    assert curve.rows[-1, 1] == pytest.approx(1e6 * np.tan(np.radians(angle)), rel=1e-2)
    assert curve.columns[4:] == ["joint_slip [m]", "joint_reversal [1]", "joint_unloads [1]"]


@pytest.mark.parametrize(("law", "path", "settings", "says"), [
    ("mohr", "uniaxial", [], "no law 'mohr'"),
    ("elastic", "shear 1 MPa", [], "no path 'shear'"),
    ("elastic", "triaxial", [], "takes a pressure"),
    ("elastic", "uniaxial 1 MPa", [], "takes no number"),
    ("elastic", "triaxial 5 m", [], "triaxial 5 m"),
    ("mohr-coulomb", "uniaxial", [], "cohesion: is missing"),
    ("elastic", "uniaxial", ["cohesion=1"], "cohesion"),
    ("brittle", "opening", ["friction_angle"], "write key.path=value"),
])  # fmt: skip
def test_mistakes_are_told(law, path, settings, says):
    with pytest.raises(CaseError, match=says):
        lead_law(law, path, settings)


def test_the_command_prints_a_curve_and_writes_files(run_cli, tmp_path):
    status, out, _ = run_cli("law", "test", "elastic", "--path", "uniaxial", "--to", "0.001",
                             "-o", str(tmp_path / "c.csv"), "--plot", str(tmp_path / "c.png"))  # fmt: skip
    assert status == 0 and "axial stress [Pa]" in out
    rows = np.loadtxt(tmp_path / "c.csv", delimiter=",", skiprows=1)
    assert rows[-1, 1] / rows[-1, 0] == pytest.approx(10e9, rel=0.01)
    assert (tmp_path / "c.png").stat().st_size > 5000
    status, out, _ = run_cli("law", "list")
    assert status == 0 and "mohr-coulomb" in out and "voellmy" in out
    status, _, err = run_cli("law", "test", "elastic", "--path", "uniaxial", "--to", "-1")
    assert status == 1 and "must be above 0" in err
