"""Strength of bonded irregular tets, as a fraction of the strength of their bonds, from elastic
stress.

In irregular tets connected by springs the tractions of bonds scatter about the tractions of the
mean
stress: forces that the balance of nodes leaves free run from bond to bond around every edge. Brittle
rock breaks with its most loaded bonds, at a fraction f0 of its strength that does not depend on the
stiffness of bonds. With fracture energies, other bonds take over first:
    f = f0 + 1.5 (1 - f0) D / (D + D0),    D = 2 G1 k / T^2 or 2 G2 k / (c (c - c_r))

D is the displacement of a bond while it breaks, over its displacement up to its strength. 1.5 and
D0 were fitted to runs of pulled and pressed columns (docs/decisions/0045-strength-as-meshed.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.interface_schema import Interface
from cdem.case.laws import INTERFACE_LAWS
from cdem.errors import ModelError
from cdem.mesh.arrays import lengths
from cdem.mesh.topology import Topology
from cdem.model.build import Build
from cdem.model.compensation import (
    DIRECTIONS,
    ElasticState,
    around_the_middle,
    bonded_tets,
    counted_tets,
    elements_of_blocks,
    surrounded,
)
from cdem.model.homogenize import BondedTets, displacements, jumps
from cdem.model.interfaces import interfaces_of, strength_factors_of, that_may_break
from cdem.rows import rows_of

Floats = NDArray[np.float64]

STRENGTHS = ("friction_angle", "cohesion", "tensile_strength")
"""Parameters that a law must have."""
HALFWAY = (6.0, 9.0)
"""D0 in tension and in compression."""
GAIN = 1.5
"""Strength that bonds with much fracture energy regain, over the deficit of brittle ones."""
WANTED = (10.0, 22.0)
"""Recommended D in tension and in compression: f is 0.93 to 1.05 there. With more, a Brazilian
disc, which splits at 0.95 to 1.25 of T, becomes too strong."""
LEAST = 0.9
"""Fraction of the strength below which the report suggests remedies."""
WAYS = ("tension", "compression")
TINY = 1e-300
ALONG_XYZ = [int(DIRECTIONS[:, axis].argmax()) for axis in range(3)]
"""Indices of the axes in `compensation.DIRECTIONS`."""


def meshed_strengths(build: Build) -> dict[str, dict[str, Any]]:
    """Strength in its mesh over the strength of its law, for each group of bonded tets.

    Only for groups in which every element is a tet and a block, and whose bonds have cohesion and
    tensile strength that rock may have. Six uniform stresses act on up to
    `compensation.MOST_TETS` tets around the middle of each; 13 uniaxial stresses are combined from
    these.

    Returns:
        strength: Fraction of the uniaxial strength of uniform rock: for "tension" and "compression"
            the
            smallest and the largest among the directions of the load [1], shape (2,).
        strength_along_xyz: The same along the axes [1], shape (3,).
        brittle, brittle_along_xyz: The same for brittle bonds.
        faces: Number of bonds in the sample.
        ductility: D of tension and compression, 0 for brittle bonds [1].
        fracture_energies: G1 and G2 that give the group the strength of its bonds [J/m2].
    """
    laws, interface_of = interfaces_of(build.case, build.group_names)
    breaks = that_may_break(build.case)
    out = {}
    for group, name in enumerate(build.group_names):
        number = interface_of[group, group]
        held = len(build.case.groups[name].fix) == 3
        if held or number < 0 or not (breaks[number] and build.bonded[group, group]):
            continue
        law = _strengths_of(laws[number])
        pairs = _pairs_of_tets(build.topology, group)
        if law is None or not surrounded(build.topology, pairs).any():
            continue
        with suppress(ModelError):  # no equilibrium for very flat meshes; a run does not need it
            out[name] = _of_group(build, name, pairs, laws[number], law)
    return out


def _pairs_of_tets(t: Topology, group: int) -> NDArray[np.intp]:
    """Pairs of faces inside a group with every element a tet and a block, else none."""
    pairs = np.flatnonzero((t.face_kind[t.pair_faces] == group).all(axis=1))
    single = (elements_of_blocks(t)[t.block_group == group] == 1).all()
    tets = (t.face_element[t.pair_faces[pairs]] < len(t.element_nodes["tet4"])).all()
    return pairs if single and tets else pairs[:0]


def _strengths_of(law: Interface) -> dict[str, float] | None:
    """Parameters of a law with all strengths of a Coulomb bond, or None."""
    numbers = INTERFACE_LAWS[law.law].numbers(law)
    if not numbers.keys() >= set(STRENGTHS):
        return None
    return numbers if min(numbers["cohesion"], numbers["tensile_strength"]) > 0 else None


def _of_group(
    build: Build,
    name: str,
    pairs: NDArray[np.intp],
    interface: Interface,
    law: dict[str, float],
) -> dict[str, Any]:
    t, made_up = build.topology, build.compensation.get(name)
    if made_up and made_up.state:
        state, stiffness = made_up.state, made_up.stiffness
    else:
        state, stiffness = _elastic_state(build, name, pairs)
    tets = state.tets
    some = np.flatnonzero(state.counted[tets.tet].any(axis=1))
    weakness = np.ones(len(tets.pair))
    factors = strength_factors_of(interface)
    if factors is not None:
        weakness = 1 / factors(t.pair_faces[tets.pair])
    brittle = brittle_parts(
        state.tractions[some],
        _normals(tets)[some],
        weakness[some],
        *(law[key] for key in STRENGTHS),
    )
    ductility = _ductility(law, stiffness)
    bears = [borne(f, d, half) for f, d, half in zip(brittle, ductility, HALFWAY, strict=True)]
    return {
        "brittle": _ranges(brittle),
        "brittle_along_xyz": _along_xyz(brittle),
        "strength": _ranges(bears),
        "strength_along_xyz": _along_xyz(bears),
        "faces": len(some),
        "ductility": ductility,
        "fracture_energies": _energies(law, stiffness),
    }


def borne(brittle: Floats, ductility: float, halfway: float) -> Floats:
    """f of f0, D and D0, see above; directions in which brittle bonds are already strong keep f0."""
    return brittle + GAIN * np.maximum(1 - brittle, 0) * ductility / (ductility + halfway)


def _ranges(parts: Sequence[Floats]) -> dict[str, list[float]]:
    return {way: [float(p.min()), float(p.max())] for way, p in zip(WAYS, parts, strict=True)}


def _along_xyz(parts: Sequence[Floats]) -> dict[str, list[float]]:
    return {way: p[ALONG_XYZ].tolist() for way, p in zip(WAYS, parts, strict=True)}


def brittle_parts(
    tractions: Floats,
    normals: Floats,
    weakness: Floats,
    tan_friction: float,
    cohesion: float,
    tensile_strength: float,
) -> tuple[Floats, Floats]:
    """Uniaxial strengths of brittle bonds, over the strength of uniform rock.

    Rock in tension breaks with its first bond. Rock in compression survives one, which keeps its
    friction, and breaks with the second.

    Args:
        tractions: Tractions at the points of the bonds under `homogenize.STATES` of 1 Pa, on the
            face with
            the opposite normal, shape (faces, 3, xyz, 6).
        normals: Unit normals, shape (faces, xyz).
        weakness: 1 over the factor on the strength of each bond, shape (faces,).
        tan_friction: Tangent of the friction angle.
        cohesion: Cohesion [Pa].
        tensile_strength: Tensile strength [Pa].

    Returns:
        Strengths in tension and in compression along each of `compensation.DIRECTIONS` [1].
    """
    root = np.sqrt(1 + tan_friction**2)
    even = (
        min(tensile_strength, 2 * cohesion * (root - tan_friction)),
        2 * cohesion * (root + tan_friction),
    )
    found = np.zeros((2, len(DIRECTIONS)))
    for number, direction in enumerate(DIRECTIONS):
        traction = tractions @ direction
        normal = np.einsum("fpx,fx->fp", traction, normals)
        shear = lengths(traction - normal[:, :, None] * normals[:, None])
        for way, (sign, strength) in enumerate(zip((1, -1), even, strict=True)):
            opens = sign * normal / tensile_strength
            slips = (shear + sign * normal * tan_friction) / cohesion
            used = np.sort(np.maximum(opens, slips).max(axis=1) * weakness)[-1 - way :]
            found[way, number] = 1 / max(used[0] * strength, TINY)
    return found[0], found[1]


def _normals(tets: BondedTets) -> Floats:
    return tets.vectors / lengths(tets.vectors)[:, None]


def _elastic_state(build: Build, name: str, pairs: NDArray[np.intp]) -> tuple[ElasticState, float]:
    """State of a group whose bonds have the stiffness of the case, and their mean k_n [Pa/m]."""
    t, rock = build.topology, build.case.materials[build.case.groups[name].material]
    tets = bonded_tets(t, pairs, around_the_middle(t, pairs, surrounded(t, pairs)))
    first = build.assembly.pair_faces["triangles"][:, 0]
    place = np.zeros(len(t.face_nodes), np.intp)
    place[first] = np.arange(len(first))
    stiffness = rows_of(build.core, "triangles.stiffness").normal[place[t.pair_faces[tets.pair, 0]]]
    mean = float(stiffness.mean())
    u = displacements(tets, rock.young_modulus, rock.poisson_ratio, mean)
    return ElasticState(tets, mean * jumps(tets, u), counted_tets(tets)), mean


def _ductility(law: dict[str, float], stiffness: float) -> list[float]:
    energies = (law.get("fracture_energy_1", 0.0), law.get("fracture_energy_2", 0.0))
    return [
        2 * stiffness * energy / square
        for energy, square in zip(energies, _squares(law), strict=True)
    ]


def _energies(law: dict[str, float], stiffness: float) -> list[float]:
    return [
        wanted * square / (2 * stiffness)
        for wanted, square in zip(WANTED, _squares(law), strict=True)
    ]


def _squares(law: dict[str, float]) -> tuple[float, float]:
    """T^2, and c times its loss [Pa2]."""
    lost = law["cohesion"] - (law["residual_cohesion"] if "fracture_energy_2" in law else 0.0)
    return law["tensile_strength"] ** 2, max(law["cohesion"] * lost, TINY)


def strength_text(strengths: dict[str, dict[str, Any]]) -> list[str]:
    """Lines of the report on the result of `meshed_strengths`."""
    lines = ["", "  strength as meshed, as a fraction of the bond strength"] if strengths else []
    for name, of in strengths.items():
        brittle, all_of = (_words(of[key]) for key in ("brittle", "strength"))
        if not any(of["ductility"]):
            lines.append(f"    {name}: {all_of}, by direction of the load: bonds are brittle")
        else:
            lines.append(f"    {name}: about {all_of}, by direction of the load; brittle {brittle}")
        if min(of["strength"][way][0] for way in WAYS) < LEAST:
            g1, g2 = of["fracture_energies"]
            lines.append(
                "      irregular tets overload some bonds: divide tensile_strength and cohesion by "
                "these fractions, "
                f"or use law softening with fracture_energy_1 of about {g1:.3g} and fracture_energy_2 of "
                f"about {g2:.3g} J/m2"
            )
    return lines


def _words(parts: dict[str, list[float]]) -> str:
    return ", ".join(f"{low:.2f} .. {high:.2f} in {way}" for way, (low, high) in parts.items())
