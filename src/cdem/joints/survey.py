"""Evaluation of a table of measured joints: sets, their spacing, and possible failures on a slope."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cdem.errors import CaseError
from cdem.joints.kinematics import Shares, Slope, shares
from cdem.joints.measured import Measured
from cdem.joints.scanlines import LEAST_SINE, Frequency, frequencies, terzaghi
from cdem.joints.sets import Fit, fit_sets, given_sets

ASSUMED_FRICTION = 30.0


@dataclass(frozen=True)
class Survey:
    """Results for a table of joints.

    Attributes:
        source: Name of its file.
        measured: The joints.
        fit: Their sets.
        frequencies: Spacing of each set, None for a set without; None without scanlines.
        slope: The slope, if one is given.
        shares: Fractions that may fail on it.
        remarks: Comments for the file of sets.
    """

    source: str
    measured: Measured
    fit: Fit
    frequencies: Sequence[Frequency | None] | None
    slope: Slope | None
    shares: Shares | None
    remarks: Sequence[str] = ()

    def frequency(self, k: int) -> Frequency | None:
        """Spacing of a set by its place, if it has one."""
        return self.frequencies[k] if self.frequencies else None

    @classmethod
    def of(
        cls,
        path: Path,
        measured: Measured,
        *,
        count: int | None = None,
        length: float | None = None,
        slope: Slope | None = None,
    ) -> Survey:
        """Find the sets, their spacing, and possible failures.

        Args:
            path: File of the table.
            measured: Its joints.
            count: Number of sets; None for the smallest BIC, or the sets of the table.
            length: Total length of scanlines [m].
            slope: A slope to assess.

        Raises:
            CaseError: There are not this many sets, or scanlines have no length.
        """
        weights = terzaghi(measured)
        if length is not None and weights is None:
            raise CaseError(f"{path}: a length needs scanlines: give their trend and plunge")
        try:
            if measured.set_of is not None and count is None:
                fit = given_sets(measured.normals, measured.set_of, weights)
            else:
                fit = fit_sets(measured.normals, count, weights)
            means = np.array([s.normal for s in fit.sets])
            dense = frequencies(measured, means, fit.membership, length)
        except CaseError as error:
            raise CaseError(f"{path}: {error}") from None
        fail = None if slope is None else shares(slope, measured.normals, means, fit.membership)
        return cls(path.name, measured, fit, dense, slope, fail)

    def as_dict(self) -> dict[str, Any]:
        """All results except the joints, ready for JSON."""
        sets = []
        for k, s in enumerate(self.fit.sets):
            facts: dict[str, Any] = {"name": s.name, "dip": s.dip, "dip_direction": s.dip_direction}
            facts |= {"kappa": s.kappa, "a95": s.a95, "share": s.share}
            dense = self.frequency(k)
            sets.append(facts | (asdict(dense) if dense else {}))
        out: dict[str, Any] = {"joints": len(self.measured.dip), "sets": sets}
        out |= {"background": self.fit.background, "bic": self.fit.bic}
        out["slope"] = asdict(self.slope) if self.slope else None
        return out | {"shares": asdict(self.shares) if self.shares else None}

    def text(self) -> str:
        """The sets and possible failures as text."""
        lines = [f"note: {note}" for note in self.measured.notes]
        lines += [self._headline(), *self._table(), *self._kinematics()]
        return "\n".join(lines)

    def _headline(self) -> str:
        number, count = len(self.measured.dip), len(self.fit.sets)
        kind = f"{count} set{'s' * (count != 1)}"
        rest = f"{100 * self.fit.background:.0f} % in none"
        if not self.fit.bic:
            return f"{number} joints, {kind} named in the table, {rest}"
        bic = ", ".join(f"{n}: {value:.0f}" for n, value in self.fit.bic.items())
        return f"{number} joints, {kind}, {rest} (BIC by number of sets: {bic})"

    def _table(self) -> list[str]:
        sets = self.fit.sets
        width = max(4, *(len(s.name) for s in sets))
        head = f"  {'set':<{width}}  dip/direction  share   kappa    a95"
        lines = [head + ("   spacing     P32  joints" if self.frequencies else "")]
        for k, s in enumerate(sets):
            row = f"  {s.name:<{width}}  {plane_text(s.dip, s.dip_direction):>13}  "
            row += f"{100 * s.share:3.0f} %  {s.kappa:6.1f}  {s.a95:5.1f}"
            if f := self.frequency(k):
                row += f"  {f.spacing:6.3g} m  {f.p32:6.3g}  {f.count:6.0f}"
            lines.append(row)
        for s, f in zip(sets, self.frequencies or [], strict=False):
            if f and f.blind:
                angle = np.degrees(np.arcsin(LEAST_SINE))
                lines.append(
                    f"note: {s.name} lies within {angle:.1f} deg of the scanlines, which hardly "
                    f"intersect it: "
                    "its spacing is a guess"
                )
        return lines

    def _kinematics(self) -> list[str]:
        if self.slope is None or self.shares is None:
            return []
        slope, fail, sets = self.slope, self.shares, self.fit.sets
        lines = [
            f"slope {plane_text(slope.dip, slope.dip_direction)}, friction {slope.friction:g} deg, "
            f"lateral limit {slope.lateral:g} deg:"
        ]
        for kind, whole, parts in (
            ("planar", fail.planar, fail.planar_of),
            ("toppling", fail.toppling, fail.toppling_of),
        ):
            of = ", ".join(f"{s.name} {100 * p:.0f} %" for s, p in zip(sets, parts, strict=True))
            lines.append(f"  {kind:<9} {100 * whole:3.0f} % of joints ({of})")
        lines.append(f"  {'wedge':<9} {100 * fail.wedge:3.0f} % of the intersections of all pairs")
        for i, j, plunge, trend, slides in fail.wedges:
            lines.append(
                f"    {sets[i].name} and {sets[j].name} meet along "
                f"{plane_text(plunge, trend)}: {'may slide' if slides else 'no'}"
            )
        return lines

    def yaml(self) -> str:
        """The part of a case with these sets: `model.joints` and `interfaces.pairs`."""
        friction = self.slope.friction if self.slope else ASSUMED_FRICTION
        lines = [
            f"# {self._headline()}",
            f"# from {self.source}. Copy these lines into a case; cdem screen reads them too.",
            *(f"# {remark}" for remark in self.remarks),
            "model:",
            "  joints:",
        ]
        for k, s in enumerate(self.fit.sets):
            row = f"name: {_quoted(s.name)}, dip: {s.dip:.1f}, dip_direction: {s.dip_direction:.1f}"
            if dense := self.frequency(k):
                row += f", spacing: {dense.spacing:.4g}"
            row += f", scatter: {{fisher: {s.kappa:.4g}}}"
            lines.append(
                f"    - {{{row}}}   # a95 {s.a95:.1f} deg, {100 * s.share:.0f} % of joints"
            )
        if not all(map(self.frequency, range(len(self.fit.sets)))):
            lines.append("    # without a spacing each set is one plane through its origin")
        lines += ["interfaces:", "  pairs:"]
        assumed = "cohesion" if self.slope else "friction and cohesion"
        for s in self.fit.sets:
            strength = f"friction_angle: {friction:g}, cohesion: 0, tensile_strength: 0"
            name = f"joint: {_quoted(s.name)}"
            lines.append(f"    - {{{name}, {strength}}}   # ASSUMED: {assumed}")
        return "\n".join(lines) + "\n"


def plane_text(dip: float, direction: float) -> str:
    """Dip and dip direction, or plunge and trend, in geologists' notation.

    Example:
        >>> plane_text(33.44, 9.26)
        '33.4/009.3'
    """
    return f"{dip:.1f}/{round(direction, 1) % 360:05.1f}"


def _quoted(name: str) -> str:
    """A name in YAML that reads back as text, even if it looks like a number or a truth value."""
    return name if re.fullmatch(r"set\d+", name) else json.dumps(name, ensure_ascii=False)
