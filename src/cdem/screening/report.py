"""The report of a screening: lines of text, and the same numbers for JSON."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from cdem.joints.survey import plane_text
from cdem.screening.confirm import Confirmed
from cdem.screening.fos_map import MODES, FosMap
from cdem.screening.planes import JointPlane
from cdem.screening.probability import Probability, standard_error
from cdem.screening.products import BODIES, SHOWN
from cdem.screening.shaking import Shaken
from cdem.units import coordinates

WORDS = {
    "both": "slides on both planes",
    "first": "slides on one of two planes",
    "second": "slides on one of two planes",
    "plane": "slides on a single plane",
    "lifts": "lifts off",
}


def text(
    found: FosMap, planes: Sequence[JointPlane], notes: Sequence[str], system: str | None
) -> str:
    """The results as text."""
    limits, grid = found.limits, found.ground.grid
    rows, columns = grid.values.shape
    lines = [f"note: {note}" for note in notes]
    if system is None:
        lines.append("note: the ground has no map projection, so the maps have none")
    lines.append(
        f"{rows} x {columns} cells of {grid.step[0]:g} m; volumes from {limits.smallest:g} to "
        f"{limits.largest:g} m3; {limits.unit_weight / 1e3:.1f} kN/m3, {found.loads.text()}"
    )
    for plane in planes:
        lines.append(
            f"  {plane.name}: {plane_text(plane.dip, plane.dip_direction)}, friction "
            f"{plane.friction:.1f} deg, cohesion {plane.cohesion / 1e3:g} kPa, persistence "
            f"{plane.persistence:g}"
        )
    lines.append(
        f"{found.count:,} bodies at {found.tried:,} points; they cover "
        f"{100 * np.isfinite(found.factor).mean():.1f} % of the map; {found.profiles.count:,} profiles "
        "of plane failure"
    )
    if found.count and found.at_limit > 0.5 * found.count:
        share = 100 * found.at_limit / found.count
        lines.append(
            f"note: {share:.0f} % of the bodies are near the largest volume, which limits "
            f"the result"
        )
    if found.bodies:
        lines.append("  no.     factor  volume [m3]  planes, mode, and point where they daylight")
    for number, body in enumerate(found.bodies[:SHOWN], 1):
        lines.append(
            f"  {number:3}  {body.factor:9.3f}  {body.volume:11,.0f}  {body.name}, "
            f"{WORDS[body.kind]}, ({coordinates(body.point.round(1))})"
        )
    left = len(found.bodies) - SHOWN
    return "\n".join([*lines, f"  ... and {left} more in {BODIES}"] if left > 0 else lines)


def facts(found: FosMap) -> dict[str, Any]:
    """The results, ready for JSON."""
    return {
        "bodies_found": found.count,
        "points": found.tried,
        "covered": float(np.isfinite(found.factor).mean()),
        "profiles": found.profiles.count,
        "loads": {
            "kh": found.loads.kh,
            "kv": found.loads.kv,
            "water": None if found.loads.level is not None else found.loads.share,
            "water_table": found.loads.level is not None,
            "crack": found.loads.crack,
        },
        "bodies": [
            {
                "planes": body.name,
                "mode": MODES[body.kind],
                "fos": finite([body.factor])[0],
                "volume": body.volume,
                "areas": list(body.areas),
                "water_heads": [found.loads.share * head for head in body.heads],
                "point": body.point.tolist(),
            }
            for body in found.bodies
        ],
    }


def shaken_text(shaken: Shaken) -> str:
    """Yield accelerations and displacements as text."""
    lines = shaken.lines()
    if len(shaken.listed_yields):
        lines.append("  no.  yield acceleration [g]  displacement [m]")
    for number, (least, slip) in enumerate(
        zip(shaken.listed_yields[:SHOWN], shaken.listed_slips[:SHOWN], strict=True), 1
    ):
        moved = f"{slip:16.3g}" if np.isfinite(slip) else f"{'moves at rest':>16}"
        lines.append(f"  {number:3}  {least:22.3f}  {moved}")
    return "\n".join(lines)


def chance_text(chance: Probability) -> str:
    """The probability of failure as text."""
    uncertain, count = chance.uncertain, chance.count
    lines = [f"{count:,} samples, {uncertain.sampling.method}, seed {uncertain.sampling.seed}:"]
    for name, values in chance.columns.items():
        spread = values.std(ddof=1) if count > 1 else 0.0
        lines.append(f"  {uncertain.label(name)}: mean {values.mean():.4g}, deviation {spread:.3g}")
    failed = float((chance.lowest < 1).mean())
    lines += [
        f"some body has F < 1: probability {_with_error(failed, count)}",
        f"unstable share of the map: mean {100 * chance.unstable.mean():.2f} %, at most "
        f"{100 * chance.unstable.max(initial=0.0):.2f} %",
    ]
    if uncertain.turns:
        known = chance.lowest[np.isfinite(chance.lowest)]
        mean = f"{known.mean():.3f}" if len(known) else "unknown"
        lines.append(f"lowest F: mean {mean}; each sample has bodies of its own, so none is listed")
    elif len(chance.listed):
        lines.append("  no.  probability, with standard error  mean F  reliability index")
    for number, (p, mean, index) in enumerate(chance.listed[:SHOWN].tolist(), 1):
        if not math.isnan(p):
            lines.append(f"  {number:3}  {_with_error(p, count):32}  {mean:6.3f}  {index:17.2f}")
    order = chance.influence()
    lines.append(f"rank correlation with {chance.target[0]}:")
    lines += [f"  {uncertain.label(name)}: {value:+.2f}" for name, value in order.items()]
    return "\n".join(lines)


def _with_error(probability: float, count: int) -> str:
    """A probability with its standard error; with a limit where all samples agree."""
    if 0 < probability < 1:
        return f"{probability:.3f} +- {standard_error(probability, count):.3f}"
    limit = min(3 / count, 1.0)  # the rule of three: 95 % of independent samples
    if probability == 0:
        return f"0, below {limit:.2g} with 95 %"
    return f"1, above {1 - limit:.2g} with 95 %"


def shaken_facts(shaken: Shaken) -> dict[str, Any]:
    """Yield accelerations and displacements, ready for JSON."""
    quake = shaken.quake
    return {
        "pga": quake.pga,
        "magnitude": quake.magnitude,
        "record": None if quake.name is None else str(quake.name),
        "moving_at_rest": shaken.moving,
        "yield": finite(shaken.listed_yields),
        "newmark": finite(shaken.listed_slips),
        "largest_newmark": finite(
            [np.max(shaken.slip, where=np.isfinite(shaken.slip), initial=0.0)]
        )[0],
    }


def chance_facts(chance: Probability) -> dict[str, Any]:
    """The probability of failure, ready for JSON."""
    p, mean, index = chance.listed.T
    failed = float((chance.lowest < 1).mean())
    return {
        "samples": chance.count,
        "probability": failed,
        "standard_error": standard_error(failed, chance.count),
        "lowest_fos": finite(chance.lowest),
        "unstable_share": finite(chance.unstable),
        "influence": dict(
            zip(chance.influence(), finite(chance.influence().values()), strict=True)
        ),
        "bodies": {
            "probability": finite(p),
            "standard_error": finite(np.sqrt(p * (1 - p) / chance.count)),
            "mean_fos": finite(mean),
            "reliability": finite(index),
        },
    }


def confirmed_facts(one: Confirmed) -> dict[str, Any]:
    """Both factors of a body, ready for JSON."""
    return vars(one) | {"computed": finite([one.computed])[0]}


def finite(values: Iterable[float]) -> list[float | None]:
    """Numbers for JSON, which has no nan and no infinity."""
    return [float(v) if math.isfinite(v) else None for v in values]
