"""Strengths of sets from `cdem joints` or a case, with rock bridges."""

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.screening.planes import STEEPEST, read_planes

SETS = """model:
  mesh: any.msh
  joints:
    - {name: bedding, dip: 32, dip_direction: 90, scatter: {fisher: 80}}
    - {name: cross, normal: [0, -1, -0.1], persistence: 0.6}
"""
STRENGTH = """interfaces:
  default: {friction_angle: 45, cohesion: 1 MPa, tensile_strength: 0}
  pairs:
    - {joint: bedding, friction_angle: 25, cohesion: 10 kPa, tensile_strength: 0}
    - {joint: cross, friction_angle: 30, cohesion: 0, tensile_strength: 0}
"""


def read(tmp_path, text):
    path = tmp_path / "joints.yaml"
    path.write_text(text)
    return read_planes(path)


def test_strengths_of_joints_and_rock_bridges(tmp_path):
    (bedding, cross), notes = read(tmp_path, SETS + STRENGTH)
    assert (bedding.friction, bedding.cohesion, bedding.persistence) == (25, 1e4, 1)
    assert (bedding.dip, bedding.dip_direction) == pytest.approx((32, 90))
    # Jennings: 0.6 of the joint, 0.4 of the default
    assert cross.cohesion == pytest.approx(0.4e6)
    assert cross.tangent == pytest.approx(0.6 * np.tan(np.radians(30)) + 0.4)
    assert cross.dip_direction == pytest.approx(0, abs=1e-9) and notes == []


def test_a_set_without_a_pair_has_the_default(tmp_path):
    text = SETS.replace(", persistence: 0.6", "") + STRENGTH.split("  pairs")[0]
    assert [plane.cohesion for plane in read(tmp_path, text)[0]] == [1e6, 1e6]


def test_notes_tell_steep_planes_files_of_discs_and_no_cohesion(tmp_path):
    text = (
        "model: {joints: [{name: a, dip: 90, dip_direction: 10}, "
        "{name: d, discs: {file: d.csv}}]}\n"
        "interfaces: {default: {friction_angle: 30}}\n"
    )
    planes, notes = read(tmp_path, text)
    assert [plane.dip for plane in planes] == pytest.approx([STEEPEST])
    assert planes[0].dip_direction == pytest.approx(10)
    assert [note.split(":")[0] for note in notes] == ["a", "d", "no set has cohesion"]


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (SETS, "joints.yaml:4:7: model.joints.0: bedding has no strength"),
        (SETS.replace("dip: 32", "dip: 95") + STRENGTH, "joints.yaml:4:23: model.joints.0.dip: must"),
        ("model: {mesh: a}\n", "model.joints"),
        (
            SETS + STRENGTH.replace("  default: {friction_angle: 45, cohesion: 1 MPa, tensile_strength: 0}\n", ""),
            "joints.yaml:5:44: model.joints.1.persistence: persistence below 1 needs interfaces.default",
        ),
        (
            "model: {joints: [{name: d, discs: {file: d.csv}}]}\ninterfaces: {default: {friction_angle: 3}}\n",
            "has no set of joints with a direction",
        ),
    ],
)  # fmt: skip
def test_what_is_refused(tmp_path, text, what):
    with pytest.raises(CaseError) as error:
        read(tmp_path, text)
    assert what in str(error.value)
