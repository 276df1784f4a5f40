"""Strengths of a case: divided by a factor of safety, and kept where joints would lose them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from cdem.case.case import Case
from cdem.case.interface_schema import Interface
from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS, Law
from cdem.case.softening import reduced_tables
from cdem.case.types import Part
from cdem.errors import CaseError
from cdem.model.interfaces import name_of

HELD = 0.01
"""Factor at which nothing fails: strengths are a hundred times as high while a model takes up its
loads."""
KEEPS = "residual"
"""Interface law whose joints keep their shear strength, with residual values like the others."""


class StrengthReduction:
    """Divide all strengths of interfaces and materials by the varied factor (tangents of angles).

    Each law declares its strengths. Their values are taken at the first call: from the last stage,
    including its own settings.

    Args:
        keep: Whether joints keep their shear strength as they slip, see `keep_strengths`, which
            must have prepared the case.
    """

    def __init__(self, keep: bool = False) -> None:
        self.keep = keep
        self._whole: dict[str, tuple[Law, Part]] = {}

    def __call__(self, case: Case, factor: float) -> None:
        if factor <= 0:
            raise CaseError(f"a factor of safety must be above 0, got {factor:g}")
        if not self._whole:  # the first trial: full strengths
            self._whole.update(_parts_with_strengths(case))
        for path, (law, part) in self._whole.items():
            reduced = law.reduced(part, factor)
            if self.keep and law.name == KEEPS:
                reduced |= _like_peak(reduced)
            for name, value in (reduced | reduced_tables(part, factor)).items():
                case.set(f"{path}.{name}", value)


def _like_peak(strengths: dict[str, Any]) -> dict[str, Any]:
    """Residual strengths of the law `residual` of which slip takes nothing."""
    return {f"residual_{name}": strengths[name] for name in ("friction_angle", "cohesion")}


def _interfaces(case: Case) -> Iterator[tuple[str, Interface]]:
    """Path in the case and part of each interface."""
    if case.interfaces.default is not None:
        yield "interfaces.default", case.interfaces.default
    for i, pair in enumerate(case.interfaces.pairs):
        yield f"interfaces.pairs.{i}", pair


def _parts_with_strengths(case: Case) -> Iterator[tuple[str, tuple[Law, Part]]]:
    """Path in the case, law and a copy of every interface and material."""
    for path, interface in _interfaces(case):
        yield path, (INTERFACE_LAWS[interface.law], interface.model_copy())
    for name, material in case.materials.items():
        yield f"materials.{name}", (BLOCK_LAWS[material.law], material.model_copy())


def keep_strengths(case: Case) -> tuple[Case, list[str]]:
    """A case whose joints and rock keep their shear strength as they slip (perfectly plastic).

    Interfaces of laws that are Coulomb friction with a bond get the law `residual` with nothing
    lost; a bond that opens loses its tensile strength. Rock does not soften. Rough joints
    (barton-bandis, continuously-yielding) and other own laws stay as they are.

    Returns:
        A copy of the case, and the names of interfaces and materials that may lose strength as
        written.
    """
    kept, last = case.model_copy(deep=True), case.model_copy(deep=True)
    for path, interface in reversed(list(_interfaces(case))):  # pairs inherit from the default
        if _is_coulomb(INTERFACE_LAWS[interface.law]):
            kept.set(path, _kept(interface))
    for stage in case.stages:
        for path, value in stage.set.items():
            last.set(path, value)
    changed = [
        name_of(interface)
        for _, interface in _interfaces(last)
        if _is_coulomb(INTERFACE_LAWS[interface.law]) and _may_lose(interface)
    ]
    for stage in kept.stages:
        stage.set = _kept_settings(stage.set)
    for name, material in kept.materials.items():
        if getattr(material, "softening", None) is not None:
            kept.set(f"materials.{name}.softening", None)
            changed.append(name)
    return kept, changed


def _kept(interface: Interface) -> dict[str, Any]:
    """The values of an interface with the law that keeps strengths."""
    given = interface.model_dump(exclude_unset=True)
    law, own = INTERFACE_LAWS[KEEPS], INTERFACE_LAWS[interface.law]
    for name in {p.name for p in own.parameters} - {p.name for p in law.parameters}:
        given.pop(name, None)
    bond = INTERFACE_LAWS["brittle"].parameters
    given |= {p.name: getattr(interface, p.name) for p in bond} | {"law": KEEPS}
    return given | _like_peak(given)


def _kept_settings(settings: dict[str, Any]) -> dict[str, Any]:
    """Settings of a stage, for interfaces that keep their strengths."""
    known = {p.name for p in INTERFACE_LAWS[KEEPS].parameters} | Interface.model_fields.keys()
    kept = {}
    for path, value in settings.items():
        place, _, name = path.rpartition(".")
        if not place.startswith("interfaces."):
            kept[path] = value
        elif name in ("friction_angle", "cohesion"):
            kept |= {path: value, f"{place}.residual_{name}": value}
        elif name in known and not name.startswith("residual_"):
            kept[path] = value
    return kept


def _may_lose(interface: Interface) -> bool:
    """Whether a slipping joint may lose shear strength."""
    given = vars(interface)
    left = given.get("residual_cohesion", 0.0)
    residual = given.get("residual_friction_angle")
    falls = residual is not None and residual < given["friction_angle"]
    return falls or left < given["cohesion"] or "dynamic_friction_angle" in given


def _is_coulomb(law: Law) -> bool:
    """Whether a law is Coulomb friction with a bond, with or without more."""
    bond = INTERFACE_LAWS["brittle"].parameters
    return law.parameters[: len(bond)] == bond
