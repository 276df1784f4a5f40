"""``cdem benchmark``: cost of a simulated second, speed of the kernels, and this speed as a
fraction of the machine's limits."""

from __future__ import annotations

import os
import platform
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from cdem._native import core as native
from cdem._native import name as native_name
from cdem._version import __version__
from cdem.rows import rows_of
from cdem.run.simulation import Simulation
from cdem.tools import benchmark_cases as cases
from cdem.tools.benchmark_errors import modulus_error, wave_error

REPEATS = 5
"""Timed runs per row; the median counts, minimum and maximum are shown."""
SECONDS = 0.3
"""Shortest wall time of a timed run [s]."""
STEPS = 40
"""Fewest steps of a timed run: as in any run, the first computes everything and the last sums energies."""
SIZES = {"1e4": 6, "1e5": 13, "1e6": 28}
"""Cells across the bars (8 m x m x m cells of 6 tets), by number of tets."""
TRIAD_BYTES = 400_000_000
"""Size of the arrays of the bandwidth test, too large for any cache [B]."""
RUBBLE = 4
"""Cells across the bar that is broken to rubble: 3,072 tets."""
RUBBLE_STEPS = 100
"""Steps of a timed run of rubble: its lists last about 25 steps, and making them takes half the time."""
MOMENTS = (5, 20, 50)
"""Times of measuring rubble: its tets meet, then part [ms after release]."""
SHAKEN = 4
"""Cells across the irregular bar: 3,072 tets with corners moved by up to a quarter."""
WALL = 26
"""Rows of cubes in the wall for the cost of a simulated second."""
MIXED = 15
"""Cells across the bar of all shapes: 101,250 elements."""
PHASES = ("refresh", "search", "contact", "element", "node")


@cache
def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


@dataclass
class Row:
    """One measurement.

    Attributes:
        name: Name of the scene.
        size: Its size.
        unit: Unit of the rates.
        rate: Median rate.
        least: Rate of the slowest run.
        most: Rate of the fastest run.
        threads: Threads of the core.
        more: Other figures by name.
        kernels: Set of kernels that ran.
        processor: Name of the processor.
    """

    name: str
    size: str
    unit: str
    rate: float
    least: float
    most: float
    threads: int
    more: dict[str, float] = field(default_factory=dict)
    kernels: str = native_name
    processor: str = field(default_factory=_processor)

    def text(self) -> str:
        """One line."""
        more = ", ".join(f"{key} {_short(value)}" for key, value in self.more.items())
        return (
            f"{self.name:<34}{self.size:>10}{self.threads:>4}{_short(self.rate):>10} {self.unit}"
            f" ({_short(self.least)} .. {_short(self.most)})" + (f"; {more}" if more else "")
        )


@cache
def bandwidth(threads: int) -> float:
    """Measured bandwidth of a triad [B/s]; once for each number of threads."""
    native.set_threads(threads)
    return native.measure_bandwidth(TRIAD_BYTES)


def machine(threads: int) -> dict[str, Any]:
    """Name of the machine, and its measured bandwidth [B/s] and peak of multiply-adds [flop/s]."""
    limits: dict[str, Any] = {
        "cdem": f"{__version__} ({native_name})",
        "processor": _processor(),
        "cores": os.cpu_count(),
    }
    for count in _counts(threads):
        limits[f"bandwidth, {count} threads"] = bandwidth(count)
        native.set_threads(count)
        limits[f"multiply-adds, {count} threads"] = native.measure_flops()
    return limits


def _counts(threads: int) -> list[int]:
    """Numbers of threads to measure with."""
    return sorted({threads, *(2**k for k in range(threads.bit_length()))} - {0})


def run(sizes: list[str], threads: int) -> Iterator[Row]:
    """Measure all rows with 1, 2, 4 ... and all threads."""
    counts = _counts(threads)
    yield from seconds()
    for size in sizes:
        for count in counts:
            yield tets_shared(SIZES[size], count)
        for count in counts:
            yield tets_bonded(SIZES[size], count)
        for count in counts:
            yield tets_broken(SIZES[size], count)
    for m in (RUBBLE, SIZES["1e4"]) if "1e6" in sizes else (RUBBLE,):
        for count in counts:
            yield from rubble(m, count)
    for rows in (26, 208) if "1e5" in sizes else (26,):
        for count in counts:
            yield wall(rows, count)
    for hexahedra in ("full", "one-point"):
        yield hexes(threads, hexahedra)
    yield mixed(MIXED, threads)


def seconds() -> Iterator[Row]:
    """CPU seconds of one thread per simulated second, plain and with defaults, and the
    accuracy."""
    little = {"time": {"mass_scaling": {"most": 0.001}}}
    overlap = {"contact_stiffness": {"overlap": 1e-3}}
    for plain in (True, False):
        regular = cases.bar(SIZES["1e4"], "tet4", **cases.breakable("1 GPa"))
        yield _cost("P2 regular tets", plain, regular, error=True)
    with tempfile.TemporaryDirectory() as place:
        for plain, more in ((True, {}), (False, {}), (False, little)):
            shaken = cases.irregular(SHAKEN, Path(place)) | more
            yield _cost("P2 irregular tets", plain, shaken, error=True)
    for plain, law in ((True, {}), (False, {}), (False, overlap)):
        case = cases.wall(WALL)
        case["interfaces"]["default"] |= law
        yield _cost("P4 wall" + (", overlap 1e-3" if law else ""), plain, case)
    for speed in (2, 21):
        for plain in (True, False):
            yield _cost(f"P3 rubble, {speed} m/s", plain, cases.rubble(RUBBLE, speed / 21), 0.005)


def _cost(
    name: str, plain: bool, case: dict[str, Any], settle: float = 0.0, *, error: bool = False
) -> Row:
    """CPU seconds per simulated second, the step, and the error of Young's modulus of the rock."""
    case = cases.plain(case) if plain else case
    sim, _ = cases.start(case, 1)
    if settle:
        sim.run_until(settle)
    steps = RUBBLE_STEPS if settle else _steps_for(lambda n: sim.step(n))
    costs = []
    for _ in range(REPEATS):
        began, at = time.process_time(), sim.time
        sim.step(steps)
        costs.append((time.process_time() - began) / (sim.time - at))
    scaled = ", 0.1 % of mass" if "mass_scaling" in case.get("time", {}) else ""
    row = Row(f"{name}, {'plain' if plain else 'defaults'}{scaled}", f"{sim.audit.counts['elements']:,}",
              "CPU s/simulated s", statistics.median(costs), min(costs), max(costs), 1)  # fmt: skip
    row.more["step [us]"] = 1e6 * float(sim.core.scalars()["dt"])
    row.more |= _conditions(sim)
    if error:
        row.more["error of E [%]"] = 100 * modulus_error(plain, irregular="mesh" in case["model"])
    return row


def tets_shared(m: int, threads: int) -> Row:
    """P1: one block, no interfaces."""
    sim, start = cases.start(cases.bar(m, "tet4"), threads)
    tets = sim.audit.counts["elements"]
    row = _time("P1 tets, shared nodes", f"{tets:,}", "tets/s", sim, tets)
    # gradients, volume, places of nodes, material
    moved: float = 9 * 8 + 8 + 4 * 4 + 4
    # a tile reads its nodes, rows and motion, and writes rows; nodes read these
    moved += len(rows_of(sim.core, "tile.force").numbers) / tets * (2 * 4 + 64 + 2 * 32)
    # a node reads six lists and two masses, sums work and force, and moves
    moved += len(sim.fields["mass"]) / tets * (6 * 4 + 2 * 8 + 2 * 8 + 32 + 2 * 64)
    row.more["B/tet moved"] = moved
    row.more["of bandwidth"] = row.rate * moved / bandwidth(threads)
    row.more["start-up [s]"] = start
    if m == SIZES["1e4"]:
        row.more["wave speed error [%]"] = 100 * wave_error(m, {})
    return row


def tets_bonded(m: int, threads: int) -> Row:
    """P2: every interior face a breakable interface, all intact."""
    row, _ = _bonded("P2 tets, all faces bonded", "1 GPa", m, threads)
    if m == SIZES["1e4"]:
        row.more["wave speed error [%]"] = 100 * wave_error(m, cases.breakable("1 GPa"))
    return row


def tets_broken(m: int, threads: int) -> Row:
    """P2 with history: every interface broken, but still in its place."""
    row, sim = _bonded("P2 tets, all faces broken", "0.001 Pa", m, threads)
    bonds = 3 * sim.audit.counts["bonded_pairs"]
    row.more["broken [%]"] = 100 * sum(sim.broken.values()) / bonds
    return row


def _bonded(name: str, strength: str, m: int, threads: int) -> tuple[Row, Simulation]:
    sim, start = cases.start(cases.bar(m, "tet4", **cases.breakable(strength)), threads)
    counts = sim.audit.counts
    tets = counts["elements"]
    row = _time(name, f"{tets:,}", "tets/s", sim, tets)
    row.more["interfaces/s"] = row.rate * counts["bonded_pairs"] / tets
    row.more["semi-springs/s"] = 6 * row.more["interfaces/s"]  # of two triangles
    row.more["B/tet of model and state"] = sim.audit.memory / tets
    row.more["start-up [s]"] = start
    return row, sim


def rubble(m: int, threads: int) -> Iterator[Row]:
    """P3: the same with every bond broken, sliding and tumbling on a plate; S: its search."""
    case = cases.rubble(m)
    sim, start = cases.start(case, threads)
    tets = sim.audit.groups["bar"]["elements"]
    bonds = 3 * sim.audit.counts["bonded_pairs"]
    for moment in MOMENTS:
        sim.run_until(moment / 1e3)
        refreshes, steps, began = int(sim.core.scalars()["rebuilds"]), sim.step_count, sim.time
        name = f"P3 tets, broken, at {moment} ms"
        row = _time(name, f"{tets:,}", "tets/s", sim, tets, RUBBLE_STEPS)
        done = sim.step_count - steps
        row.more["from [ms]"], row.more["to [ms]"] = 1e3 * began, 1e3 * sim.time
        row.more["broken [%]"] = 100 * sum(sim.broken.values()) / bonds
        row.more["refreshes per 1000 steps"] = (
            1000 * (int(sim.core.scalars()["rebuilds"]) - refreshes) / done
        )
        row.more["B/tet of model and state"] = sim.audit.memory / tets
        row.more["start-up [s]"] = start
        yield row
        yield _search(row, refreshes, done, sim)


def _search(row: Row, refreshes: int, steps: int, sim: Simulation) -> Row:
    """S: targets of all semi-springs by the lists, and the rebuild of the lists, from a P3 row."""
    springs = 3 * len(sim.core.fields()["search.exposed_face"])  # all faces are triangles
    tets = sim.audit.groups["bar"]["elements"]
    made = int(sim.core.scalars()["rebuilds"]) - refreshes
    per_step = tets / row.rate  # wall time of a step [s]
    share = row.more["search [%]"] / 100
    scale = springs / tets / share
    s = Row("S search of the same", f"{springs:,}", "springs/s", scale * row.rate,
            scale * row.least, scale * row.most, row.threads)  # fmt: skip
    spent = row.more["refresh [%]"] / 100 * per_step * steps
    s.more["lists [us per spring and refresh]"] = 1e6 * spent / max(made, 1) / springs
    s.more["refreshes per 1000 steps"] = row.more["refreshes per 1000 steps"]
    return s


def wall(rows: int, threads: int) -> Row:
    """P4: running-bond wall of cubes of one element, at rest under gravity."""
    case = cases.wall(rows)
    sim, start = cases.start(case, threads)
    sim.step(200)
    cubes = rows * cases.COLUMNS
    row = _time("P4 wall of cubes at rest", f"{cubes:,}", "cubes/s", sim, cubes)
    row.more["springs/s"] = row.rate / cubes * sim.audit.counts["semi_springs"]
    row.more["wall time per simulated s"] = cubes / row.rate / float(sim.core.scalars()["dt"])
    row.more["start-up [s]"] = start
    return row


def hexes(threads: int, hexahedra: str) -> Row:
    """Hexahedra that share nodes."""
    m = 23
    sim, start = cases.start(cases.bar(m, "hex8", elements={"hexahedra": hexahedra}), threads)
    count = sim.audit.counts["elements"]
    row = _time(f"hexahedra, {hexahedra}", f"{count:,}", "hexes/s", sim, count)
    row.more["start-up [s]"] = start
    return row


def mixed(m: int, threads: int) -> Row:
    """A quarter each of the bar in hexahedra, wedges, pyramids and tets, bonded to each other."""
    sim, start = cases.start(cases.mixed(m), threads)
    count = sim.audit.counts["elements"]
    row = _time("mixed mesh", f"{count:,}", "elements/s", sim, count)
    row.more["start-up [s]"] = start
    return row


def _time(
    name: str, size: str, unit: str, sim: Simulation, items: int, steps: int | None = None
) -> Row:
    """Time runs of a given number of steps, or of as many as take `SECONDS`; rates are items times
    steps per second of wall time. CPU time is user and system time of all threads."""
    steps = steps or _steps_for(lambda n: sim.step(n))
    before = np.array(sim.core.seconds())
    walls, cpus = [], []
    for _ in range(REPEATS):
        began, worked = time.perf_counter(), time.process_time()
        sim.step(steps)
        walls.append((time.perf_counter() - began) / steps)
        cpus.append((time.process_time() - worked) / steps)
    spent = np.array(sim.core.seconds()) - before
    rates = [items / wall for wall in walls]
    row = Row(name, size, unit, statistics.median(rates), min(rates), max(rates), sim.threads)
    row.more["wall [us/step]"] = 1e6 * statistics.median(walls)
    row.more["CPU [us/step]"] = 1e6 * statistics.median(cpus)
    for phase, part in zip(PHASES, spent / spent.sum(), strict=True):
        row.more[f"{phase} [%]"] = 100 * part
    row.more |= _conditions(sim)
    return row


def _conditions(sim: Simulation) -> dict[str, float]:
    """Damping of a run, which sets its step, and its closing error of energy."""
    damping = sim.case.stages[-1].damping
    assert damping.contact is not None  # the case has filled it in
    return {
        "damping, contact": damping.contact,
        "damping, stiffness": damping.stiffness,
        "energy error [%]": 100 * sim.energies["error"],
    }


def _steps_for(step: Callable[[int], None]) -> int:
    count = STEPS
    while True:
        began = time.perf_counter()
        step(count)
        spent = time.perf_counter() - began
        if spent > SECONDS:
            return count
        count = max(count + 1, min(8 * count, int(1.2 * SECONDS / max(spent, 1e-6) * count)))


def _short(value: float) -> str:
    for scale, sign in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(value) >= scale:
            return f"{value / scale:.3g} {sign}"
    return f"{value:.3g}"
