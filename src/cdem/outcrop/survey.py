"""What an outcrop tells of its joints: sets, spacing, trace lengths, areas, persistence."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.joints.directions import dips
from cdem.joints.kinematics import Slope
from cdem.joints.measured import Measured
from cdem.joints.scanlines import Frequency
from cdem.joints.survey import Survey
from cdem.outcrop.extraction import Extraction
from cdem.outcrop.joint_planes import Spacing, joint_planes, spacing_of
from cdem.outcrop.persistence import areal_persistence
from cdem.outcrop.traces import Length, ends_seen, mean_length

FEW_ENDS = 20
"""Fewer seen ends make the mean length uncertain by more than a fifth."""
FEW_PLANES = 5
"""Fewer joints make a mean spacing uncertain by about a half."""


@dataclass(frozen=True)
class Exposure:
    """What is seen of a set.

    Attributes:
        name: Name of the set.
        facets: Number of its facets.
        area: Their area [m2].
        spacing: Distances of its joints.
        length: Lengths of its facets along strike.
        persistence: Share of its planes that is seen as facets [1].
    """

    name: str
    facets: int
    area: float
    spacing: Spacing
    length: Length
    persistence: float


@dataclass(frozen=True)
class OutcropSurvey:
    """Facets of a cloud with their sets.

    Attributes:
        survey: The sets, as of a table of joints.
        found: The facets.
        exposures: Of each set, in its order.
        set_of: Number of each facet's set, -1 for none, shape (facets,).
        joint: Number of each facet's joint within its set, -1 for none, shape (facets,).
        seen: Whether the ends of facets along strike are seen, shape (facets, 2).
    """

    survey: Survey
    found: Extraction
    exposures: list[Exposure]
    set_of: NDArray[np.int64]
    joint: NDArray[np.int64]
    seen: NDArray[np.bool_]

    @classmethod
    def of(
        cls, path: Path, found: Extraction, *, count: int | None = None, slope: Slope | None = None
    ) -> OutcropSurvey:
        """Find the sets of facets, each of which counts once, and measure them.

        Args:
            path: File of the cloud.
            found: Its facets.
            count: Number of sets; None for the smallest BIC.
            slope: A slope to assess.

        Raises:
            CaseError: There are not this many sets.
        """
        facets, x = found.facets, found.points
        survey = Survey.of(path, Measured(*dips(facets.normals)), count=count, slope=slope)
        set_of = survey.fit.membership.argmax(axis=1)
        set_of[set_of == len(survey.fit.sets)] = -1
        joint, seen = np.full(len(facets), -1), ends_seen(x, facets, found.resolution)
        exposures, middle = [], (x.max(axis=0) + x.min(axis=0)) / 2
        for k, s in enumerate(survey.fit.sets):
            own = np.flatnonzero(set_of == k)
            some = facets.some(own)
            joint[own] = joint_planes(some, found.tolerance)
            spacing = spacing_of(some, joint[own], s.normal, middle)
            exposures.append(
                Exposure(
                    s.name,
                    len(own),
                    float(some.areas.sum()),
                    spacing,
                    mean_length(some.lengths[:, 0], seen[own]),
                    areal_persistence(x, some, joint[own], spacing.persistent),
                )
            )
        return cls(_with_spacing(survey, exposures), found, exposures, set_of, joint, seen)

    def as_dict(self) -> dict[str, Any]:
        """All results except facets, ready for JSON; null for unknown numbers."""
        out = self.survey.as_dict()
        for row, exposure in zip(out["sets"], self.exposures, strict=True):
            for key in ("count", "blind"):
                row.pop(key, None)
            row |= asdict(exposure)
            row["spacing"] = exposure.spacing.persistent
            row["spacing_exposed"] = exposure.spacing.exposed
            row["planes"] = exposure.spacing.planes
        out["facets"] = out.pop("joints")
        for key in ("resolution", "noise", "tolerance", "angle", "smallest"):
            out[key] = getattr(self.found, key)
        out["points"] = len(self.found.points)
        return dict(json.loads(json.dumps(out, default=float), parse_constant=lambda _: None))

    def text(self) -> str:
        """The sets and what is seen of them, as text."""
        found = self.found
        part = sum(len(m) for m in found.facets.members) / len(found.points)
        lines = [f"note: {note}" for note in found.notes]
        lines.append(
            f"noise {1000 * found.noise:.2g} mm; facets: {len(found.facets)} of at least "
            f"{found.smallest:.3g} m2, within {found.angle:g} deg and {1000 * found.tolerance:.2g} mm of "
            f"their plane; {100 * part:.0f} % of the points"
        )
        lines += [self.survey.text(), *self._table(), *self._doubts()]
        return "\n".join(lines)

    def _table(self) -> list[str]:
        width = max(4, *(len(e.name) for e in self.exposures))
        lines = [
            f"  {'set':<{width}}  facets  planes      area   spacing   exposed    length      seen  "
            "ends  persistence"
        ]
        for e in self.exposures:
            lines.append(
                f"  {e.name:<{width}}  {e.facets:6d}  {e.spacing.planes:6d}  {e.area:5.4g} m2"
                f"  {_metres(e.spacing.persistent)}  {_metres(e.spacing.exposed)}"
                f"  {_metres(e.length.mean)}  {_metres(e.length.naive)}  {e.length.seen:4d}  "
                f"{100 * e.persistence:9.0f} %".replace("nan %", "  ?")
            )
        return lines

    def _doubts(self) -> list[str]:
        lines = []
        for e in self.exposures:
            if e.spacing.planes < FEW_PLANES:
                lines.append(
                    f"note: {e.name} has {e.spacing.planes} planes: its spacing is a guess"
                )
            if e.length.seen < FEW_ENDS:
                lines.append(
                    f"note: {e.name} shows {e.length.seen} ends of facets: its length is a guess"
                )
        return lines


def _with_spacing(survey: Survey, exposures: list[Exposure]) -> Survey:
    """The survey with the spacing of its sets, and remarks for its file."""
    remarks = [
        f"{e.name}: {e.facets} facets on {e.spacing.planes} planes, {e.area:.4g} m2; mean length "
        f"along strike {_metres(e.length.mean).strip()} ({e.length.seen} ends seen)"
        + (f"; persistence {e.persistence:.2f} or more" if math.isfinite(e.persistence) else "")
        for e in exposures
    ]
    dense = [
        Frequency(e.spacing.persistent, 1 / e.spacing.persistent, e.facets, False)
        if e.spacing.persistent > 0
        else None
        for e in exposures
    ]
    return replace(survey, frequencies=dense, remarks=remarks)


def _metres(value: float) -> str:
    return f"{value:6.3g} m" if math.isfinite(value) else "       ?"
