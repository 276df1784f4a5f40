"""Bolts of a case in the rock: their nodes, their crossings of joints, their arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.bolts_schema import Bolts, BoltType, Fixture
from cdem.case.case import Case
from cdem.errors import CaseError
from cdem.mesh.paths import Pass, passes, walk, weights_in
from cdem.mesh.topology import Topology
from cdem.model.bolt_places import Polyline, polylines
from cdem.model.flat_arrays import Floats, Ints
from cdem.model.module import Built, Module, Parts

HOSTS = 8
"""Most rock nodes around a point of a bolt."""
MOST_CELLS = 4000
"""Most nodes of a bolt."""
LEAST_CELLS = 8
"""Fewest parts of a bolt."""
CELLS_PER_LENGTH = 8
"""Parts per length over which the force of an elastic bolt falls to 1/e."""
SHORT = 0.1
"""Paths in a block shorter than this fraction of a part go to the next block."""
SLACK = 1e-3
"""Allowed gap at joints and outside the rock at heads, relative to a bolt's length."""
FIXTURE_LENGTH = 0.1
"""Length of bolt with the default stiffness of a plate or an anchor [m]."""
NEVER = 1e300
"""A limit that is never reached."""


@dataclass
class Crossing:
    """A crossing from one block to another: the bar across it, and the place [m]."""

    bar: int
    sides: tuple[Pass, Pass]
    place: Floats
    grouted: bool


@dataclass
class Bolt:
    """One bolt, divided into nodes.

    Attributes:
        name: Its name.
        entry: Number of its entry in the case.
        kind: Its type.
        length: Length [m].
        places: Positions of its nodes [m].
        hosts: Elements around them.
        grouted: Grouted length of each node [m].
        crossings: Joints that it crosses.
    """

    name: str
    entry: Bolts
    kind: BoltType
    length: float
    places: list[Floats] = field(default_factory=list)
    hosts: list[Pass] = field(default_factory=list)
    grouted: list[float] = field(default_factory=list)
    crossings: list[Crossing] = field(default_factory=list)

    def add(self, line: Polyline, at: float, host: Pass, grouted: float) -> None:
        """Add a node at a length along the bolt, in an element."""
        self.places.append(line.at(at))
        self.hosts.append(host)
        self.grouted.append(grouted)


@dataclass
class BoltModel(Module):
    """All bolts of a model, and the arrays of the core.

    Attributes:
        bolts: One by one, in the order of the core.
        arrays: Flat arrays by name; none where there are no bolts.
    """

    name = "bolts"
    bolts: list[Bolt] = field(default_factory=list)
    arrays: dict[str, NDArray] = field(default_factory=dict)

    @classmethod
    def of(cls, case: Case, t: Topology, names: list[str]) -> BoltModel:
        """Cut the bolts of a case into nodes, and make the arrays of the core.

        Raises:
            CaseError: A bolt is not in the rock.
        """
        if not case.bolts:
            return cls()
        bolts = [
            _cut(case, t, line, case.bolt_types[case.bolts[line.entry].type])
            for line in polylines(case, t, names)
        ]
        rock = [case.materials[case.groups[name].material] for name in names]
        return cls(bolts, _arrays(case, t, bolts, np.array([m.young_modulus for m in rock])))

    @property
    def first(self) -> Ints:
        """First node of each bolt, and total number."""
        return self.arrays["bolts.first"] if self.bolts else np.zeros(1, np.int32)

    def add_arrays(self, parts: Parts) -> None:
        if self.bolts:
            parts.assembly.counts["bolts.count"] = len(self.bolts)
            parts.assembly.arrays |= self.arrays

    def corner_nodes(self) -> Ints:
        return self.arrays["bolts.hosts"] if self.bolts else super().corner_nodes()

    def node_stiffness(self, nodes: int) -> Floats:
        """Largest stiffness of bolts at each rock node, installed or not [N/m], shape (nodes,)."""
        total = super().node_stiffness(nodes)
        if self.bolts:
            owner, weights = self.arrays["bolts.hosts"], self.arrays["bolts.weights"]
            shares = np.repeat(self.arrays["bolts.stiffness"], HOSTS) * np.abs(weights)
            np.add.at(total, owner[owner >= 0], shares[owner >= 0])
        return total

    def joined_blocks(self) -> Ints:
        """Pairs of blocks joined by a bolt at the start, shape (pairs, 2)."""
        if not self.bolts:
            return super().joined_blocks()
        pairs = [
            [side.block for side in crossing.sides]
            for bolt, waits in zip(self.bolts, self.arrays["bolts.waits"], strict=True)
            for crossing in bolt.crossings
            if not waits
        ]
        return np.array(pairs, np.int32).reshape(-1, 2)

    def numbers(self, name: str) -> list[int]:
        """Bolts of an entry of the case, or one bolt by its own name."""
        return [i for i, b in enumerate(self.bolts) if name in (b.name, b.entry.name)]

    def flags(self, stage: str, when: str) -> NDArray[np.int8]:
        """1 for the bolts that a stage installs or removes."""
        return np.array([getattr(b.entry, when) == stage for b in self.bolts], np.int8)

    def report(self, build: Built) -> dict[str, dict[str, Any]]:
        """Data on bolts for the audit, by type."""
        out: dict[str, dict[str, Any]] = {}
        for bolt, first in zip(self.bolts, self.first, strict=False):
            of = out.setdefault(
                bolt.entry.type,
                {"bolts": 0, "length": 0.0, "nodes": 0, "crossings": 0, "shortest": np.inf, "stiffness": 0.0},
            )  # fmt: skip
            parts = np.linalg.norm(np.diff(bolt.places, axis=0), axis=1)
            stiffness = self.arrays["bolts.stiffness"][first : first + len(bolt.places)]
            of["bolts"] += 1
            of["length"] += bolt.length
            of["nodes"] += len(bolt.places)
            of["crossings"] += len(bolt.crossings)
            of["shortest"] = min(of["shortest"], float(parts.min(initial=np.inf)))
            of["stiffness"] = max(of["stiffness"], float(stiffness.max(initial=0.0)))
        return out

    def lines(self, report: dict[str, dict[str, Any]]) -> list[str]:
        """Bolts by type."""
        lines = ["", "  bolts"] if report else []
        for name, of in report.items():
            count = "1 bolt" if of["bolts"] == 1 else f"{of['bolts']:,} bolts"
            lines.append(
                f"    {name}: {count}, {of['length']:.6g} m, {of['nodes']:,} nodes, parts of "
                f"{of['shortest']:.3g} m or more, {of['crossings']:,} crossings of joints; up to "
                f"{of['stiffness']:.3g} N/m on the rock"
            )
        return lines


def part_length(kind: BoltType, length: float) -> float:
    """Longest part of a bolt [m]."""
    parts = [length / LEAST_CELLS]
    if kind.grout is not None:
        axial = kind.area * kind.young_modulus
        parts.append(float(np.sqrt(axial / kind.grout.stiffness)) / CELLS_PER_LENGTH)
    return min(parts)


# ---------------------------------------------------------------------- along a bolt


def _cut(case: Case, t: Topology, line: Polyline, kind: BoltType) -> Bolt:
    """Divide a bolt into nodes: at the middle of parts of even length, none of which crosses a joint."""
    entry = case.bolts[line.entry]
    bolt = Bolt(line.name, entry, kind, line.length)
    part = part_length(kind, line.length)
    runs = _runs(_inside(case, t, line), SHORT * part)
    if line.length / part > MOST_CELLS:
        raise CaseError(
            f"{case.where(line.path)}: {line.path}: {line.name} is {line.length:.4g} m long and needs "
            f"{line.length / part:.0f} nodes, more than {MOST_CELLS:,}; its grout is too stiff for its "
            "steel (force per length and slip [N/m2])"
        )
    if entry.plate is not None:
        bolt.add(line, 0.0, runs[0][0], 0.0)
    for i, run in enumerate(runs):
        if i:
            at = run[0].first
            bar, sides = len(bolt.places) - 1, (runs[i - 1][-1], run[0])
            bolt.crossings.append(Crossing(bar, sides, line.at(at), at >= entry.free_length))
        _add_run(bolt, line, run, part)
    if entry.anchor is not None:
        bolt.add(line, line.length, runs[-1][-1], 0.0)
    return bolt


def _add_run(bolt: Bolt, line: Polyline, run: list[Pass], part: float) -> None:
    """Nodes of a bolt in one block: grouted parts, and one node for an ungrouted length."""
    grout_from = bolt.entry.free_length if bolt.kind.grout is not None else np.inf
    first, last = run[0].first, run[-1].last
    middle = min(max(first, grout_from), last)
    for a, b, grouted in ((first, middle, False), (middle, last, True)):
        if b - a <= 0:
            continue
        count = max(1, int(np.ceil((b - a) / part - 1e-9))) if grouted else 1
        for k in range(count):
            at = a + (b - a) * (k + 0.5) / count
            host = next((p for p in run if p.last >= at), run[-1])
            bolt.add(line, at, host, (b - a) / count if grouted else 0.0)


def _inside(case: Case, t: Topology, line: Polyline) -> list[Pass]:
    """Elements along a bolt; the whole bolt must be in the rock."""
    found: list[Pass] = []
    for k in range(len(line.points) - 1):
        found += passes(t, line.points[k], line.points[k + 1], line.starts[k])
    slack = SLACK * line.length
    path = list(walk(found, line.length, 1e-9 * line.length))
    at = 0.0
    for p in path:
        if p.first - at > slack:
            break
        at = p.last
    if line.length - at > slack:
        where = ", ".join(f"{x:.4g}" for x in line.at(at))
        raise CaseError(
            f"{case.where(line.path)}: {line.path}: {line.name} is outside the rock "
            f"{at:.4g} m from its head, at [{where}], of {line.length:.4g} m; move it, or shorten it"
        )
    return path


def _runs(path: list[Pass], short: float) -> list[list[Pass]]:
    """Parts of a path in one block each; very short parts go to the block before."""
    runs: list[list[Pass]] = []
    for p in path:
        if runs and runs[-1][-1].block == p.block:
            runs[-1].append(p)
        else:
            runs.append([p])
    kept: list[list[Pass]] = []
    for run in runs:
        if run[-1].last - run[0].first < short and len(runs) > 1:
            continue
        if kept and kept[-1][-1].block == run[0].block:
            kept[-1] += run
        else:
            kept.append(run)
    return kept or runs


# ---------------------------------------------------------------------- arrays


def _fixture(fixture: Fixture | None, axial: float) -> tuple[float, float]:
    """Stiffness [N/m] and limit [N] of a plate or an anchor."""
    if fixture is None:
        return 0.0, 0.0
    return fixture.stiffness or axial / FIXTURE_LENGTH, fixture.strength or NEVER


def _dowel(kind: BoltType, crossing: Crossing, young: Floats) -> tuple[float, float]:
    """Stiffness [N/m] and limit [N] of a bolt at a joint."""
    if kind.dowel is None or not crossing.grouted or kind.grout is None:
        return 0.0, 0.0
    bending = kind.young_modulus * kind.area**2 / (4 * np.pi)  # E I of a round bar
    ground = min(young[side.group] for side in crossing.sides)
    beam = bending * (ground / (4 * bending)) ** 0.75
    return kind.dowel.stiffness or float(beam), kind.dowel.strength or 0.5 * kind.yield_force


def _arrays(case: Case, t: Topology, bolts: list[Bolt], young: Floats) -> dict[str, NDArray]:
    """Flat arrays of the core, by name."""
    rows: dict[str, list[Any]] = {
        key: [] for key in ("properties", "grout", "end", "crossing_bar", "dowel", "stiffness")
    }
    points: list[tuple[Pass, Floats]] = []
    sides: list[tuple[Pass, Floats]] = []
    side_stiffness: list[float] = []
    first, crossing_first = [0], [0]
    for bolt in bolts:
        kind, axial = bolt.kind, bolt.kind.area * bolt.kind.young_modulus
        crush = kind.yield_force if kind.compressive_force is None else kind.compressive_force
        rupture = NEVER if kind.rupture_strain is None else kind.rupture_strain
        rows["properties"] += [axial, kind.yield_force, crush, rupture, bolt.entry.pretension]
        node = first[-1]
        grout, end = _springs(bolt, axial)
        rows["grout"].append(grout)
        rows["end"].append(end)
        rows["stiffness"].append(_node_stiffness(bolt, axial, grout[:, 0] + end[:, 0]))
        points += zip(bolt.hosts, bolt.places, strict=True)
        for crossing in bolt.crossings:
            dowel = _dowel(kind, crossing, young)
            rows["crossing_bar"].append(node + crossing.bar)
            rows["dowel"] += dowel
            sides += [(side, crossing.place) for side in crossing.sides]
            side_stiffness += [dowel[0]] * 2
        first.append(node + len(bolt.hosts))
        crossing_first.append(crossing_first[-1] + len(bolt.crossings))
    rows["stiffness"].append(side_stiffness)
    hosts, weights = _located(t, points + sides)
    begins = case.stages[0].name
    arrays: dict[str, NDArray] = {
        "first": np.array(first, np.int32),
        "crossing_first": np.array(crossing_first, np.int32),
        "waits": np.array([b.entry.install not in (None, begins) for b in bolts], np.int8),
        "crossing_bar": np.array(rows["crossing_bar"], np.int32),
        "hosts": hosts.ravel(),
        "weights": weights.ravel(),
        "properties": np.array(rows["properties"], float),
        "dowel": np.array(rows["dowel"], float),
    }
    for key in ("grout", "end", "stiffness"):
        arrays[key] = np.concatenate(rows[key]).ravel()
    return {f"bolts.{key}": value for key, value in arrays.items()}


def _springs(bolt: Bolt, axial: float) -> tuple[Floats, Floats]:
    """Stiffness [N/m] and limit [N] of grout, and of plate and anchor, by node."""
    grouted = np.array(bolt.grouted)
    grout, end = np.zeros((len(grouted), 2)), np.zeros((len(grouted), 2))
    if bolt.kind.grout is not None:
        grout[:, 0] = bolt.kind.grout.stiffness * grouted
        grout[:, 1] = bolt.kind.grout.strength * grouted
    end[-1] = _fixture(bolt.entry.anchor, axial)
    if bolt.entry.plate is not None:
        end[0] = _fixture(bolt.entry.plate, axial)
    return grout, end


def _node_stiffness(bolt: Bolt, axial: float, springs: Floats) -> Floats:
    """Largest stiffness of a bolt node on the rock [N/m].

    Along the bolt: its springs, which are in series with its bars. Across it: the force of its bars
    turns with them.
    """
    places = np.array(bolt.places)
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
    crush = bolt.kind.compressive_force
    force = max(bolt.kind.yield_force, bolt.kind.yield_force if crush is None else crush)
    bars, turning = np.zeros(len(places)), np.zeros(len(places))
    for side in (slice(None, -1), slice(1, None)):
        bars[side] += axial / lengths
        turning[side] += force / lengths
    return np.minimum(springs, bars) + turning


def _located(t: Topology, points: list[tuple[Pass, Floats]]) -> tuple[NDArray[np.int32], Floats]:
    """Nodes of the rock and weights of each point, shape (points, 8)."""
    hosts = np.full((len(points), HOSTS), -1, np.int32)
    weights = np.zeros((len(points), HOSTS))
    for k, (host, place) in enumerate(points):
        nodes, shares = weights_in(t, host.shape, host.element, place)
        hosts[k, : len(nodes)] = nodes
        weights[k, : len(nodes)] = shares
    return hosts, weights
