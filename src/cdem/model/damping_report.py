"""What the damping of rock does in each stage: its ratio, and the step with and without it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cdem.case.damping_schema import Maxwell, Rayleigh
from cdem.case.schema import Stage
from cdem.model.build import Build
from cdem.model.damping import Branches, branches_of, damping_of, is_lumped, rayleigh_factors
from cdem.model.wave_frequencies import record_frequencies

AWAY = 5.0
"""The ratio of Rayleigh damping is told at its frequency and, without a record, at this multiple of
it."""
MOSTLY = 0.99
"""Part of the strain energy in elements below which the undamped rest is told."""
DECADE = 10.0
"""The band offered in place of Rayleigh damping: so many times below and above its frequency."""


@dataclass(frozen=True)
class RockDamping:
    """Damping of rock in a stage.

    Attributes:
        stage: Name of the stage.
        kind: "rayleigh" or "maxwell".
        ratios: Ratio by frequency [Hz]: at the frequency of Rayleigh damping, and at those of records; at
            the extremes in the band of Maxwell branches.
        without: Step without this damping, safety included [s].
        step: The same with it [s].
        instead: Step with Maxwell branches in place of Rayleigh's stiffness part [s], or None.
        band: Their band [Hz].
        stiffness: Storage moduli at the ends of a band over the moduli of the case, or None.
        share: Least part of the strain energy in motion that is in elements, not in bonds and joints.
    """

    stage: str
    kind: str
    ratios: dict[float, float]
    without: float
    step: float
    instead: float | None = None
    band: tuple[float, float] | None = None
    stiffness: tuple[float, float] | None = None
    share: float = 1.0

    def as_dict(self) -> dict[str, Any]:
        """Ready for JSON."""
        return vars(self) | {"ratios": [list(pair) for pair in self.ratios.items()]}

    def lines(self) -> Iterator[str]:
        """Lines for the report."""
        ratios = ", ".join(f"{100 * xi:.3g} % at {f:.4g} Hz" for f, xi in self.ratios.items())
        yield f"  damping of stage {self.stage}, {self.kind}: {ratios}"
        yield f"    step {self.step:.4g} s with it, {self.without:.4g} s without"
        if self.stiffness is not None and self.band is not None:
            ends = zip(self.stiffness, self.band, strict=True)
            moduli = ", ".join(f"{m:.4g} at {f:.4g} Hz" for m, f in ends)
            yield f"    moduli of the rock in motion over those of the case: {moduli}"
            if self.share < MOSTLY:
                yield (
                    f"    bonds and joints are not damped by it: where they have "
                    f"{100 * (1 - self.share):.3g} % of the strain energy, the ratio is "
                    f"{self.share:.3g} times this"
                )
        elif self.instead is not None and self.band is not None:
            low, high = self.band
            xi = next(iter(self.ratios.values()))
            yield (
                f"    Maxwell would take {self.instead:.4g} s, and keep the ratio from {low:.4g} to "
                f"{high:.4g} Hz: maxwell: {{ratio: {xi:g}, band: [{low:g}, {high:g}]}}"
            )


def rock_dampings(build: Build, interfaces: Sequence[dict[str, Any]]) -> list[RockDamping]:
    """The stages whose damping acts on the rock.

    Args:
        build: The model.
        interfaces: Its bonded interfaces, see `bonded_interfaces`.
    """
    found = []
    for index, stage in enumerate(build.case.stages):
        if stage.damping.rayleigh is not None:
            waves = record_frequencies(build.case, index) or ()
            found.append(_of_rayleigh(build, stage, stage.damping.rayleigh, waves))
        elif stage.damping.maxwell is not None:
            found.append(_of_maxwell(build, stage, stage.damping.maxwell, interfaces))
    return found


def _of_rayleigh(
    build: Build, stage: Stage, rayleigh: Rayleigh, waves: Sequence[float]
) -> RockDamping:
    factors, f = rayleigh_factors(rayleigh), rayleigh.frequency
    away = waves or [AWAY * f if rayleigh.part == "both" else f / AWAY]
    instead = band = None
    if rayleigh.part == "both":
        band = (f / DECADE, f * DECADE)
        branches = branches_of(Maxwell(ratio=rayleigh.ratio, band=list(band)))
        instead = _step(build, stage, branches=branches)
    return RockDamping(
        stage=stage.name,
        kind="rayleigh",
        ratios={at: factors.ratio(at) for at in (f, *away)},
        without=_step(build, stage),
        step=_step(build, stage, mass=factors.mass, time=factors.stiffness),
        instead=instead,
        band=band,
    )


def _share(build: Build, interfaces: Sequence[dict[str, Any]], moduli: float) -> float:
    """Least part of the strain energy that is in elements, under stress that is uniform.

    Args:
        build: The model.
        interfaces: Its bonded interfaces.
        moduli: Moduli of the rock in motion over those of the case.
    """
    softer = [1.0, *(made_up.stiffening for made_up in build.compensation.values())]
    for row in interfaces:
        if not set(row["between"]) <= build.compensation.keys():
            most = max(row["compliance_percent"], row["shear_compliance_percent"])
            softer.append(1 + most / 100)
    return 1 / (1 + moduli * (max(softer) - 1))


def _of_maxwell(
    build: Build, stage: Stage, maxwell: Maxwell, interfaces: Sequence[dict[str, Any]]
) -> RockDamping:
    branches, (low, high) = branches_of(maxwell), maxwell.band
    middle = branches.part * branches.storage(float(np.sqrt(low * high)))
    f = np.geomspace(low, high, 200)
    ratios = branches.ratio(f)
    ends = sorted((int(ratios.argmin()), int(ratios.argmax())))
    return RockDamping(
        stage=stage.name,
        kind="maxwell",
        ratios={float(f[k]): float(ratios[k]) for k in ends},
        without=_step(build, stage),
        step=_step(build, stage, branches=branches),
        band=(low, high),
        stiffness=(branches.part * branches.storage(low), branches.part * branches.storage(high)),
        share=_share(build, interfaces, middle),
    )


def _step(
    build: Build,
    stage: Stage,
    *,
    mass: float = 0.0,
    time: float = 0.0,
    branches: Branches = Branches(),  # noqa: B008
) -> float:
    """Step of a stage with this damping of the rock, safety included [s]."""
    local, own, stiffness, contact = damping_of(stage)
    own -= rayleigh_factors(stage.damping.rayleigh).mass
    # the moduli of the model are those of its materials: their part goes into the weights
    weight = [branches.part * branches.stiffer - 1.0, 0.0, 0.0]
    limit = build.core.stable_step(
        [local, own + mass, stiffness, contact], time, weight, [0.0, 0.0, 0.0], is_lumped(stage)
    )
    given = build.case.time.step
    return float(given) if given != "auto" else float(build.case.time.safety * limit)
