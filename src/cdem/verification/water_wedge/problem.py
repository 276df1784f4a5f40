"""Plane failure with water in a tension crack: factors of safety (Hoek & Bray 1981)."""

import numpy as np

from cdem.study.critical import find_critical, strength_reduction

HEIGHT, FACE, PLANE = 60.0, 50.0, 35.0  # [m, deg]
UNIT, WATER = 26e3, 10e3  # [N/m3]
CRACK = 14.00886  # depth [m]
FOOT = HEIGHT - CRACK


def theory(filled, cohesion=100e3, friction=35.0):
    """Factor of safety with the crack filled to a fraction of its depth; forces per metre of slope."""
    b, depth = np.radians(PLANE), filled * CRACK
    area = FOOT / np.sin(b)
    cut = 1 - (CRACK / HEIGHT) ** 2
    weight = UNIT * HEIGHT**2 / 2 * (cut / np.tan(b) - 1 / np.tan(np.radians(FACE)))
    push, lift = WATER * depth**2 / 2, WATER * depth * area / 2
    normal = weight * np.cos(b) - lift - push * np.sin(b)
    return (cohesion * area + normal * np.tan(np.radians(friction))) / (
        weight * np.sin(b) + push * np.cos(b)
    )


def filled_to(part):
    """The water of the case, as values of it."""
    return [
        f"water.fields.0.level={FOOT + part * CRACK}",
        f"water.fields.1.formula={WATER * part * CRACK} * (z / {FOOT})",
    ]


def run(study):
    """Strength reduction with the crack dry and full; filled by quarters when full."""
    parts, found = (0.0, 0.25, 0.5, 0.75, 1.0) if study.full else (0.0, 1.0), []
    for part in parts:
        ours = find_critical(study.case(*filled_to(part)), strength_reduction(), (0.8, 2.5),
                             tolerance=5e-4, threads=study.threads).value  # fmt: skip
        found.append(ours)
        study.check(f"factor of safety, crack filled to {part:g}", theory=theory(part), ours=ours,
                    within=1e-3)  # fmt: skip
    line = np.linspace(0, 1, 50)
    study.curve("Factor of safety", "filled part of the crack [1]", "factor of safety [1]",
                {"theory": (line, [theory(part) for part in line]), ".cdem": (parts, found)})  # fmt: skip
