"""Sets of joints with their strength, from the file of `cdem joints` or from a case."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError

from cdem.case.bodies_schema import Joint
from cdem.case.explain import explain
from cdem.case.interface_schema import AnyInterface, Interfaces
from cdem.case.reader import load_case_data
from cdem.case.source import Source
from cdem.case.types import Part
from cdem.errors import CaseError
from cdem.joints.directions import NamedPlane, mean_normal, pole

Floats = NDArray[np.float64]

STEEPEST = 89.5
"""Steeper planes get this dip [deg]: heights above a vertical plane are undefined."""


class _Sets(Part):
    joints: list[Joint] = Field(min_length=1, description="Sets of joints")


class _JointedRock(Part):
    """The part of a case used by screening."""

    model: _Sets
    interfaces: Interfaces = Field(Interfaces(), description="Their strength")


@dataclass(frozen=True)
class JointPlane(NamedPlane):
    """A set of joints; each of its planes is as long as a body needs.

    Attributes:
        friction: Friction angle of joint and rock bridges together [deg].
        cohesion: Cohesion of joint and rock bridges together [Pa].
        persistence: Fraction of the area that is joint, not rock bridge [1].
    """

    friction: float
    cohesion: float
    persistence: float = 1.0

    @property
    def tangent(self) -> float:
        """Tangent of the friction angle [1]."""
        return float(np.tan(np.radians(self.friction)))


def read_planes(path: Path) -> tuple[list[JointPlane], list[str]]:
    """Read the sets of a file with `model.joints` and `interfaces`.

    The strength of a set is from the pair of interfaces that names it, else from the default. With
    a persistence k below 1 the rest of the area is rock bridges with the strength of the default:
    c = k c_joint + (1 - k) c_rock, and the same for tan(phi) (Jennings 1970).

    Returns:
        The planes, and messages for the user.

    Raises:
        CaseError: The file is wrong, or a strength is missing; names the place.
    """
    data, source = load_case_data(path, what="joint")
    model = data.get("model")
    part: dict[str, Any] = {"model": {}}
    if isinstance(model, dict) and "joints" in model:
        part["model"]["joints"] = model["joints"]
    if "interfaces" in data:
        part["interfaces"] = data["interfaces"]
    try:
        rock = _JointedRock(**part)
    except ValidationError as error:
        raise explain(error, source, _JointedRock) from None
    planes, notes = [], []
    for number, joint in enumerate(rock.model.joints):
        if joint.discs is not None and joint.discs.file is not None:
            notes.append(f"{joint.name}: ignored: discs from a file have no mean plane")
            continue
        plane = _plane(number, joint, rock.interfaces, source)
        if plane.dip > STEEPEST:
            notes.append(f"{joint.name}: dip set to {STEEPEST:g} deg instead of {plane.dip:.1f}")
            steep = pole(STEEPEST, plane.dip_direction)
            plane = JointPlane(plane.name, steep, plane.friction, plane.cohesion, plane.persistence)
        planes.append(plane)
    if not planes:
        raise CaseError(f"{path}: has no set of joints with a direction")
    if all(plane.cohesion == 0 for plane in planes):
        notes.append(
            "no set has cohesion: the factor does not depend on size, the map shows only directions"
        )
    return planes, notes


def _plane(number: int, joint: Joint, interfaces: Interfaces, source: Source) -> JointPlane:
    named = [pair for pair in interfaces.pairs if pair.joint == joint.name]
    own = named[0] if named else interfaces.default
    where = ("model", "joints", number)
    if own is None:
        raise source.error([(where, f"{joint.name} has no strength: give a pair in interfaces")])
    friction, cohesion = _strength(own)
    if joint.persistence < 1:
        if interfaces.default is None:
            why = "persistence below 1 needs interfaces.default, the strength of rock bridges"
            raise source.error([((*where, "persistence"), why)])
        k = joint.persistence
        of_rock, c_rock = _strength(interfaces.default)
        tangent = k * np.tan(np.radians(friction)) + (1 - k) * np.tan(np.radians(of_rock))
        friction, cohesion = float(np.degrees(np.arctan(tangent))), k * cohesion + (1 - k) * c_rock
    normal = mean_normal(joint)
    upward = normal if normal[2] >= 0 else -normal
    return JointPlane(joint.name, upward, friction, cohesion, joint.persistence)


def _strength(interface: AnyInterface) -> tuple[float, float]:
    """Friction angle [deg] and cohesion [Pa] of an interface."""
    friction = getattr(interface, "friction_angle", None)
    if friction is None:
        raise CaseError(f"law {interface.law} has no friction angle; screening needs one")
    return float(friction), float(getattr(interface, "cohesion", None) or 0.0)
