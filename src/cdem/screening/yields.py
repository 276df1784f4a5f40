"""Yield accelerations: the horizontal shaking at which bodies begin to slide."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.screening.sliding import factors

Floats = NDArray[np.float64]

MOST = 10.0
"""Larger accelerations, either way, count as infinite [g]."""


def yield_accelerations(
    normals: Floats, tangents: Floats, cohesive: Floats, still: Floats, shaking: Floats
) -> Floats:
    """Yield acceleration of bodies [g], shape (bodies,): F = 1; infinite if there is none.

    It is the least acceleration from 0 on beyond which the body slides. It is negative for a body
    that slides at rest: the nearest acceleration against its sliding at which it is held. Exact,
    with all changes of mode: the normal forces are linear in the acceleration, so each mode has a
    quadratic equation, and the modes change at roots of linear ones.

    Args:
        normals: Unit normals of the planes, that point into the bodies, shape (planes, 3).
        tangents: Tangents of the friction angles [1], shape (planes,).
        cohesive: Cohesion times area [N], shape (bodies, planes).
        still: Forces without horizontal shaking [N], shape (bodies, 3).
        shaking: Forces of the shaking per g [N], shape (bodies, 3).
    """
    scale = np.linalg.norm(shaking, axis=-1, keepdims=True)
    cohesive, still, shaking = cohesive / scale, still / scale, shaking / scale
    count = len(still)
    some = _roots(normals, tangents, cohesive, still, shaking)
    some = np.where(np.isfinite(some), np.clip(some, -MOST, MOST), MOST)
    ends = np.broadcast_to([-MOST, 0.0, MOST], (count, 3))
    k = np.sort(np.concatenate([some, ends], axis=1), axis=1)
    middle, wide = (k[:, 1:] + k[:, :-1]) / 2, np.diff(k, axis=1) > 0

    def holds(at: Floats) -> NDArray[np.bool_]:
        force = still[:, None] + at[..., None] * shaking[:, None]
        return factors(normals, tangents, cohesive[:, None], force)[0] >= 1

    held = holds(middle)
    slides = wide & ~held & (k[:, :-1] >= 0)
    onset = np.where(slides.any(axis=1), k[np.arange(count), slides.argmax(axis=1)], np.inf)
    rests = wide & held & (k[:, 1:] <= 0)
    last = rests.shape[1] - 1 - rests[:, ::-1].argmax(axis=1)
    back = np.where(rests.any(axis=1), k[np.arange(count), last + 1], -np.inf)
    return np.where(holds(np.zeros((count, 1)))[:, 0], onset, back)


def _roots(
    normals: Floats, tangents: Floats, cohesive: Floats, still: Floats, shaking: Floats
) -> Floats:
    """Accelerations at which a mode may change or F may be 1, shape (bodies, any)."""
    press = [-f @ normals.T for f in (still, shaking)]  # at rest, and per g
    out = [_ratio(press[0], press[1])]
    modes = [(m[None], [p[:, i : i + 1] for p in press], cohesive[:, i : i + 1], tangents[i : i + 1])
             for i, m in enumerate(normals)]  # fmt: skip
    if len(normals) == 2:
        cosine = float(normals[0] @ normals[1])
        inward = [(p - cosine * p[:, ::-1]) / (1 - cosine**2) for p in press]
        out.append(_ratio(inward[0], inward[1]))
        modes.append((normals, inward, cohesive, tangents))
    for beds, push, glue, tangent in modes:
        a, b = push[0] @ tangent + glue.sum(axis=1), push[1] @ tangent
        p, q = still + push[0] @ beds, shaking + push[1] @ beds
        # (a + b k)^2 = |p + q k|^2
        square = b**2 - (q * q).sum(axis=1)
        half = a * b - (p * q).sum(axis=1)
        rest = a**2 - (p * p).sum(axis=1)
        with np.errstate(invalid="ignore"):
            way = -half - np.copysign(np.sqrt(half**2 - square * rest), half)
        out += [_ratio(-way[:, None], square[:, None]), _ratio(-rest[:, None], way[:, None])]
    return np.concatenate(out, axis=1)


def _ratio(constant: Floats, slope: Floats) -> Floats:
    """Roots of constant + slope k; not finite where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return -constant / slope
