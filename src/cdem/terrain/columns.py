"""Factor of safety of a body by the ordinary method of columns, in closed form.

Hovland (1977): no forces between the columns; each presses on its base with the component of its
weight normal to the base. Below the rigorous factor on a curved base, equal to it on a plane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.terrain.plan import Plan

Floats = NDArray[np.float64]


@dataclass
class Columns:
    """Columns over the triangles of a body.

    Attributes:
        volume: [m3], shape (columns,).
        slope: Gradient of the base in plan [1], shape (columns, 2).
        area: Area of the base in plan [m2].
    """

    volume: Floats
    slope: Floats
    area: Floats


def columns_of(plan: Plan, body: int | None = None) -> Columns:
    """Columns over the bodies of a plan, or over one of them."""
    chosen = plan.triangles[plan.body >= 0 if body is None else plan.body == body]
    corners = plan.points[chosen]
    ab, ac = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    doubled = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    bed = plan.bed[chosen]
    rise_b, rise_c = bed[:, 1] - bed[:, 0], bed[:, 2] - bed[:, 0]
    slope = np.column_stack(
        [ac[:, 1] * rise_b - ab[:, 1] * rise_c, ab[:, 0] * rise_c - ac[:, 0] * rise_b]
    )
    thickness = (plan.ground[chosen] - bed).mean(axis=1)
    return Columns(thickness * doubled / 2, slope / doubled[:, None], doubled / 2)


def ordinary(
    columns: Columns, friction: float, cohesion: float, unit_weight: float
) -> tuple[float, float]:
    """Smallest factor of safety over all directions, in steps of a degree.

    Args:
        columns: The body.
        friction: Friction angle of the base [deg].
        cohesion: Cohesion of the base [Pa].
        unit_weight: Weight of the rock [N/m3].

    Returns:
        The factor, infinite without a driving force; and the azimuth of sliding [deg].
    """
    azimuth = np.radians(np.arange(360))
    fall = -columns.slope @ np.stack([np.sin(azimuth), np.cos(azimuth)])
    weight = columns.volume * unit_weight
    cosine = 1 / np.sqrt(1 + (columns.slope**2).sum(axis=1))
    resisting = (
        weight * cosine * np.tan(np.radians(friction)) + cohesion * columns.area / cosine
    ).sum()
    driving = weight @ (fall / np.sqrt(1 + fall**2))
    worst = int(driving.argmax())
    factor = resisting / driving[worst] if driving[worst] > 0 else np.inf
    return float(factor), float(worst)
