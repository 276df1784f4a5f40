"""Wedges between two joints: dry, with cohesion, with water, with an anchor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.verification.slopes.planes import WATER, joint, tan
from cdem.verification.slopes.second import between_two
from cdem.verification.slopes.second import wedge as by_angles
from cdem.verification.slopes.slope import Slope, below, rock, static

Floats = NDArray[np.float64]

UNIT = 26e3  # [N/m3]


@dataclass(frozen=True)
class Plane:
    """A joint.

    Attributes:
        dip: [deg].
        direction: Of the dip, clockwise from north [deg].
        friction: Angle [deg].
        cohesion: [Pa].
    """

    dip: float
    direction: float
    friction: float
    cohesion: float = 0.0

    @property
    def normal(self) -> Floats:
        """Upward unit normal."""
        d, a = np.radians([self.dip, self.direction])
        return np.array([np.sin(d) * np.sin(a), np.sin(d) * np.cos(a), np.cos(d)])


@dataclass(frozen=True)
class Wedge:
    """A wedge below a flat top and a face that dips east, from the toe of the slope at x = 0.

    Attributes:
        height: Of the slope [m].
        face: Dip of the face [deg].
        first: One joint.
        second: The other; both meet in the face at a seventh of the height.
    """

    height: float
    face: float
    first: Plane
    second: Plane

    @property
    def corners(self) -> Floats:
        """Where both joints meet in the face; crest on each joint; rear [m], shape (4, 3)."""
        front = Plane(self.face, 90.0, 0.0).normal
        top, start = np.array([0.0, 0.0, 1.0]), self.height / 7
        foot = np.array([-start / tan(self.face), 0.0, start])
        a, b = self.first.normal, self.second.normal
        rows = [(a, front, top), (b, front, top), (a, b, top)]
        rest = [
            np.linalg.solve(row, [row[0] @ foot, row[1] @ foot if row[1] is b else 0, self.height])
            for row in rows
        ]
        return np.array([foot, *rest])

    @property
    def volume(self) -> float:
        """[m3]."""
        foot, *rest = self.corners
        return float(abs(np.linalg.det(np.array(rest) - foot))) / 6

    @property
    def areas(self) -> tuple[float, float]:
        """Of both joints [m2]."""
        foot, crest_a, crest_b, rear = self.corners
        each = (np.cross(crest - foot, rear - foot) for crest in (crest_a, crest_b))
        a, b = (float(np.linalg.norm(n)) / 2 for n in each)
        return a, b

    def factor(self, level: float = 0.0, pull: Floats | None = None) -> float:
        """Factor of safety (Hoek & Bray 1981, chapter 8), from the balance of all forces.

        W + pull + N_a n_a + N_b n_b - S line = 0; joints carry (N - U) tan(phi) + c A along the
        line of their intersection. Water up to a level wets a triangle at the foot of each joint
        that is similar to the whole; its mean pressure is a third of that at the foot.

        Args:
            level: Height of the water in both joints [m]; below the foot: dry.
            pull: Force of an anchor on the wedge [N].
        """
        foot, _, _, rear = self.corners
        line = (foot - rear) / np.linalg.norm(foot - rear)
        load = np.array([0, 0, -UNIT * self.volume]) + (0 if pull is None else pull)
        a, b = self.first, self.second
        n_a, n_b, drive = np.linalg.solve(np.column_stack([a.normal, b.normal, -line]), -load)
        head = max(level - foot[2], 0.0)
        wet = (head / (self.height - foot[2])) ** 2
        holds = 0.0
        for plane, normal, area in zip((a, b), (n_a, n_b), self.areas, strict=True):
            lift = WATER * head / 3 * wet * area
            assert normal > lift  # it slides on both joints
            holds += (normal - lift) * tan(plane.friction) + plane.cohesion * area
        return float(holds / drive)

    def by_angles(self, level: float = 0.0) -> float:
        """The factor from angles between lines, without an anchor."""
        high = 6 / 7 * self.height
        head = max(level - self.height / 7, 0.0)
        mean = WATER * head / 3 * (head / high) ** 2
        joints = self.first, self.second
        return by_angles(
            [p.normal for p in joints],
            [(tan(p.friction), p.cohesion) for p in joints],
            Plane(self.face, 90.0, 0.0).normal,
            high,
            UNIT,
            (mean, mean),
        )

    def case(self, title: str, **more: Any) -> dict[str, Any]:
        """The block of a slope around the wedge, held at its foot, its ends and its back."""
        corners, far, margin = self.corners, 1e4, 0.3 * self.height
        low, high = corners[:, 1].min() - margin, corners[:, 1].max() + margin
        back, crest = corners[:, 0].min() - margin, -self.height / tan(self.face)
        profile = [(0.0, 0.0), (crest, self.height), (back, self.height), (back, 0.0)]
        block = {"vertices": [[x, y, z] for y in (low, high) for x, z in profile]}
        named = (("a", self.first), ("b", self.second))
        joints = [{"name": name, "dip": p.dip, "dip_direction": p.direction,
                   "origin": corners[0].tolist()} for name, p in named]  # fmt: skip
        ends = [
            below(0.01),
            {"box": {"min": [-far] * 3, "max": [back + 0.01, far, far]}, "fix": ["x", "y", "z"]},
            {"box": {"min": [-far] * 3, "max": [far, low + 0.01, far]}, "fix": ["x", "y", "z"]},
            {"box": {"min": [-far, high - 0.01, -far], "max": [far] * 3}, "fix": ["x", "y", "z"]},
        ]
        return static(title, {"blocks": [{"group": "rock", "polyhedron": block}], "joints": joints},
                      [joint(name, p.friction, p.cohesion) for name, p in named], ends, rock(UNIT),
                      **more)  # fmt: skip


def wet(name: str, wedge: Wedge, level: float) -> Slope:
    """Water in both joints up to a level."""
    water = {"fields": [{"interface": key, "level": level, "wet": "always"} for key in "ab"]}
    return Slope(name, wedge.height, wedge.case(name, water=water), wedge.factor(level),
                 second=wedge.by_angles(level))  # fmt: skip


def anchored(name: str, wedge: Wedge, force: float) -> Slope:
    """An anchor from the face through the wedge, 10 degrees downwards, locked as it yields [N]."""
    foot, crest_a, crest_b, rear = wedge.corners
    head = (0.4 * foot + 0.3 * crest_a + 0.3 * crest_b) + [0, 0, 0]
    a = np.radians(10.0)
    way = np.array([-np.cos(a), 0.0, -np.sin(a)])
    length = abs(rear[0] - head[0]) + 0.1 * wedge.height
    strand = {"area": "2000 mm2", "young_modulus": "195 GPa", "yield_force": force,
              "compressive_force": 0}  # fmt: skip
    bolt = {"name": "anchor", "type": "strand", "plate": True, "anchor": True, "pretension": force,
            "points": [head.tolist(), (head + length * way).tolist()]}  # fmt: skip
    case = wedge.case(name, bolt_types={"strand": strand}, bolts=[bolt])
    load = force * way - [0, 0, UNIT * wedge.volume]
    joints = wedge.first, wedge.second
    second = between_two(load, [p.normal for p in joints], [tan(p.friction) for p in joints])
    return Slope(name, wedge.height, case, wedge.factor(pull=force * way), second=second)


def wedges() -> list[Slope]:
    """All of them."""
    steep = Wedge(20, 65, Plane(50, 45, 30, 20e3), Plane(55, 130, 25, 30e3))
    askew = Wedge(80, 65, Plane(47, 52, 30), Plane(70, 148, 20))
    held = Wedge(20, 65, Plane(47, 52, 30, 25e3), Plane(70, 148, 20, 15e3))
    loose = Wedge(40, 65, Plane(50, 45, 35), Plane(55, 130, 35))
    small = Wedge(20, 65, Plane(50, 45, 35), Plane(55, 130, 35))
    bound = Wedge(40, 65, Plane(50, 45, 35, 60e3), Plane(55, 130, 35, 60e3))
    flat = Wedge(20, 70, Plane(45, 105, 20), Plane(70, 20, 30))
    dry = [("wedge, friction alone", loose), ("wedge, 30 and 20 degrees of friction", askew),
           ("wedge, nearly all on one joint", flat),
           ("wedge, cohesion", steep), ("wedge, cohesion, one joint steep", held)]  # fmt: skip
    return [
        *(
            Slope(name, w.height, w.case(name), w.factor(), quick=w is steep, second=w.by_angles())
            for name, w in dry
        ),
        wet("wedge, cohesion, water at three quarters of the height", bound, 30.0),
        anchored("wedge, friction, an anchor", small, 2e6),
    ]
