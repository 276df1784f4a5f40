"""Options of the core: formulation, contact, time step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cdem.case.case import Case
from cdem.case.schema import Material

BOND_INDENTATION = {"vertex": (0.0, 0.0), "quadrature": (0.5, 1 - 1 / np.sqrt(3))}
"""Positions of bond points, on triangles and on quadrilaterals: at the vertices, or at points that
integrate a linear stress exactly (method of the theory page on bonds)."""


def pairs_loose_joints(case: Case) -> bool:
    """Whether joints without strength begin as broken pairs: they then carry the traction of
    initial stress, water reaches all their faces, and added groups lie on the present rock."""
    adds = any(stage.add for stage in case.stages)
    return bool(case.initial_stress) or case.water is not None or adds


def rescales_moduli(case: Case) -> bool:
    """Whether a stage gives the rock other moduli under stress: it then needs an initial strain."""
    given = (stage.damping.maxwell for stage in case.stages)
    return any(maxwell is not None and maxwell.reference != "static" for maxwell in given)


def options_of(case: Case, materials: Sequence[Material]) -> dict[str, Any]:
    """Options of the core by name, for a model of these materials."""
    contact = case.contact
    nu = [m.poisson_ratio for m in materials]
    wave = max(
        np.sqrt(m.young_modulus * (1 - n) / (m.density * (1 + n) * (1 - 2 * n)))
        for m, n in zip(materials, nu, strict=True)
    )
    triangle, quad = BOND_INDENTATION[contact.bond_points]
    automatic = contact.tolerance == "auto"
    return {
        "formulation": case.elements.formulation,
        "indentation": contact.indentation,
        "action": 0.0 if contact.action == "vertex" else contact.indentation,
        "tolerance": 0.1 * contact.indentation if automatic else contact.tolerance,
        "bond_indentation_triangle": triangle,
        "bond_indentation_quad": quad,
        "semi_edges": contact.edges,
        "initial_stress": bool(case.initial_stress) or rescales_moduli(case),
        "loose_pairs": pairs_loose_joints(case),
        "lumped_while_bonded": case.moved_masses == "lumped-while-bonded",
        "check_search": contact.check,
        "rebuild_interval": 0 if contact.refresh == "displacement" else int(contact.refresh),
        "step_safety": case.time.safety,
        "step_given": 0.0 if case.time.step == "auto" else case.time.step,
        "speed_limit": float(wave),  # no rock moves faster than its P wave
        "gravity": [float(g) for g in case.loads.gravity],
    }
