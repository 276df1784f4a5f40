"""Slopes of Mohr-Coulomb rock and soil that slip along curves, in plane strain, one element wide."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import meshio
import numpy as np
from numpy.typing import NDArray

from cdem.verification.slopes.slope import GRAVITY, Slope, sides, static

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Soil:
    """A Mohr-Coulomb material.

    Attributes:
        unit: Unit weight [N/m3].
        cohesion: [Pa].
        friction: Angle [deg].
        cracks: Whether it has no tensile strength.
    """

    unit: float
    cohesion: float
    friction: float
    cracks: bool = False

    def material(self) -> dict[str, Any]:
        """As an entry of `materials`; it does not dilate."""
        return {"law": "mohr-coulomb", "density": self.unit / GRAVITY, "young_modulus": "1 GPa",
                "poisson_ratio": 0.3, "cohesion": self.cohesion,
                "friction_angle": self.friction} | (
                    {"tensile_strength": 0.0} if self.cracks else {})  # fmt: skip


@dataclass(frozen=True)
class Profile:
    """A slope that rises to the right from its toe at the origin.

    Attributes:
        height: [m].
        run: From toe to crest, across [m]; 0: a vertical cut.
        crest: Flat ground behind the crest [m].
        front: Flat ground before the toe [m].
        deep: Depth of the ground below the toe [m]; 0: a rough base at the toe, without a front.
    """

    height: float
    run: float
    crest: float
    front: float = 0.0
    deep: float = 0.0

    def grid(self, rows: int) -> tuple[Floats, NDArray[np.int64]]:
        """Points (x, z) and quadrilaterals, in rows of equal height, of one length in each row."""
        size, back = self.height / rows, self.run + self.crest
        many = round((0.5 * self.run + self.crest) / size)
        under, before = round(self.deep / size), round(self.front / size) if self.deep else 0
        part = np.linspace(0, 1, many + 1)
        points: list[tuple[float, float]] = []
        numbers = -np.ones((under + rows + 1, before + many + 1), int)
        for row in range(under + rows + 1):
            z = (row - under) * size
            start = max(z, 0.0) / self.height * self.run
            if row < under:
                z = -self.deep * (1 - row / under)
            x = start + part * (back - start)
            if row <= under and before:
                x = np.concatenate([np.linspace(-self.front, 0, before + 1)[:-1], x])
            first = len(numbers[row]) - len(x)
            numbers[row, first:] = len(points) + np.arange(len(x))
            points += [(float(at), z) for at in x]
        corners = (numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1])
        quads = np.stack([c.ravel() for c in corners], axis=1)
        return np.array(points), quads[(quads >= 0).all(axis=1)]

    def mesh(self, rows: int, soil_at: Callable[[Floats], list[str]]) -> meshio.Mesh:
        """Hexahedra, one across; `soil_at` names the soils at their middles (x, z)."""
        flat, quads = self.grid(rows)
        width, count = self.height / rows, len(flat)
        points = np.concatenate([np.insert(flat, 1, y, axis=1) for y in (width, 0.0)])
        names = np.array(soil_at(flat[quads].mean(axis=1)))
        soils, number = np.unique(names, return_inverse=True)
        return meshio.Mesh(points, [("hexahedron", np.hstack([quads, quads + count]))],
                           cell_data={"gmsh:physical": [number + 1],
                                      "gmsh:geometrical": [number + 1]},
                           field_data={str(s): np.array([n, 3])
                                       for n, s in enumerate(soils, 1)})  # fmt: skip


def slope(
    name: str, profile: Profile, soils: Mapping[str, Soil], factor: float | tuple[float, float], *,
    rows: int = 12, soil_at: Callable[[Floats], list[str]] | None = None, quick: bool = False,
) -> Slope:  # fmt: skip
    """A slope on a rough base, between smooth ends."""
    width, far = profile.height / rows, 1e4
    back, base = profile.run + profile.crest, -profile.deep

    def held(low: list[float], high: list[float], *fix: str) -> dict[str, Any]:
        return {"box": {"min": low, "max": high}, "fix": list(fix)}

    supports = [
        sides(width),
        held([-far] * 3, [far, far, base + 1e-6], "x", "z"),
        held([back - 1e-6, -far, -far], [far] * 3, "x"),
    ]
    if profile.deep:
        supports.append(held([-far] * 3, [-profile.front + 1e-6, far, far], "x"))
    case = static(name, {}, [], supports, {}, materials={k: s.material() for k, s in soils.items()},
                  groups={k: {"material": k} for k in soils},
                  interfaces={"default": {"friction_angle": 30}})  # fmt: skip
    only = next(iter(soils))
    mesh = profile.mesh(rows, soil_at or (lambda middles: [only] * len(middles)))
    return Slope(name, profile.height, case, factor, 0.05, quick, mesh=mesh)


ACADS = Profile(10.0, 20.0, 20.0, 10.0, 5.0)
"""The profile of examples 1 of ACADS (Giam & Donald 1989): 2:1, ground 5 m below the toe."""


def three_soils(middles: Floats) -> list[str]:
    """Soils of ACADS 1c: the first above a line from the toe, the second above another below it."""
    x, z = middles.T
    upper = np.interp(x, [0, 10, 20, 24, 40], [0, 2, 4, 6, 6])
    lower = np.interp(x, [0, 10, 22, 40], [0, 2, -1, -1])
    return [str(s) for s in np.where(z > upper, "first", np.where(z > lower, "second", "third"))]


def soil() -> list[Slope]:
    """All of them."""
    return [
        slope("soil, 2:1 (Griffiths & Lane 1999, example 1)", Profile(10, 20, 12),
              {"soil": Soil(20e3, 10e3, 20)}, (1.38, 1.40), rows=16),
        slope("soil (ACADS 1a)", ACADS, {"soil": Soil(20e3, 3e3, 19.6)}, (0.985, 1.00)),
        slope("soil, tension crack (ACADS 1b)", ACADS, {"soil": Soil(20e3, 32e3, 10, cracks=True)},
              (1.65, 1.70)),
        slope("soil, three layers (ACADS 1c)", ACADS,
              {"first": Soil(19.5e3, 0.0, 38), "second": Soil(19.5e3, 5.3e3, 23),
               "third": Soil(19.5e3, 7.2e3, 20)}, 1.39, soil_at=three_soils),
        slope("vertical cut in clay", Profile(5, 0, 5, 1.25, 1.25), {"soil": Soil(20e3, 40e3, 0)},
              (3.77 * 0.4, 3.83 * 0.4), rows=32),
    ]  # fmt: skip
