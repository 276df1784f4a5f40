"""``cdem benchmark``: what a simulated second costs here, how fast the kernels are, and what part of
the machine's limits that is."""

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
from cdem.case.case import Case
from cdem.mesh.primitives import box
from cdem.model.compensation import bonded_tets
from cdem.model.homogenize import means
from cdem.run.simulation import Simulation

REPEATS = 5
"""Timed runs of a row; the median counts, least and most are shown."""
SECONDS = 0.3
"""Least wall time of a timed run [s]."""
STEPS = 40
"""Least steps of a timed run: as in any run, the first computes all and the last sums up energies."""
SIZES = {"1e4": 6, "1e5": 13, "1e6": 28}
"""Cells in the width of the bars (8 m x m x m cells of 6 tets), by number of tets."""
TRIAD_BYTES = 400_000_000
"""Size of the arrays of the bandwidth test: no cache holds them [B]."""
ROCK = {"density": 2500, "young_modulus": "10 GPa", "poisson_ratio": 0.25}
RUBBLE = 4
"""Cells in the width of the bar that is broken to rubble: 3,072 tets."""
RUBBLE_STEPS = 100
"""Steps of a timed run of rubble: its lists last about 25, and making them takes half the time."""
MOMENTS = (5, 20, 50)
"""When rubble is timed: its tets meet, then part [ms after release]."""
SHAKEN = 4
"""Cells in the width of the irregular bar: 3,072 tets whose corners are moved by up to a quarter."""
CUBE = 6
"""Cells along a cube that is pulled for its Young's modulus."""
COLUMNS = 20
"""Cubes in a row of the wall."""
WALL = 26
"""Rows of cubes in the wall of which a second is measured."""
MIXED = 15
"""Cells in the width of the bar of all shapes: 101,250 elements."""
PHASES = ("refresh", "search", "contact", "element", "node")


@dataclass
class Row:
    """One measurement.

    Attributes:
        name: What is run.
        size: Of what.
        unit: Of the rates.
        rate: Median.
        least: Slowest run.
        most: Fastest run.
        threads: Threads of the core.
        more: Other figures by name.
    """

    name: str
    size: str
    unit: str
    rate: float
    least: float
    most: float
    threads: int
    more: dict[str, float] = field(default_factory=dict)

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
    """Measure everything, row by row, with 1, 2, 4 ... and all threads."""
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
    """CPU seconds of one thread that a simulated second takes at the defaults of either version of the
    case format, and at what accuracy."""
    little = {"time": {"mass_scaling": {"most": 0.001}}}
    overlap = {"contact_stiffness": {"overlap": 1e-3}}
    for version in (1, 2):
        regular = _bar(SIZES["1e4"], "tet4", **_breakable("1 GPa"))
        yield _cost("P2 regular tets", version, regular, error=True)
    with tempfile.TemporaryDirectory() as place:
        for version, more in ((1, {}), (2, {}), (2, little)):
            yield _cost("P2 irregular tets", version, _irregular(Path(place)) | more, error=True)
    for version, law in ((1, {}), (2, {}), (2, overlap)):
        case = _wall(WALL)
        case["interfaces"]["default"] |= law
        yield _cost("P4 wall" + (", overlap 1e-3" if law else ""), version, case)
    for speed in (2, 21):
        for version in (1, 2):
            yield _cost(f"P3 rubble, {speed} m/s", version, _rubble(RUBBLE, speed / 21), 0.005)


def _cost(
    name: str, version: int, case: dict[str, Any], settle: float = 0.0, *, error: bool = False
) -> Row:
    """CPU seconds per simulated second, the step, and the error of Young's modulus of the rock."""
    case = case | {"cdem": version}
    sim, _ = _start(case, 1)
    if settle:
        sim.run_until(settle)
    steps = RUBBLE_STEPS if settle else _steps_for(lambda n: sim.step(n))
    costs = []
    for _ in range(REPEATS):
        began, at = time.process_time(), sim.time
        sim.step(steps)
        costs.append((time.process_time() - began) / (sim.time - at))
    scaled = ", 0.1 % of mass" if "mass_scaling" in case.get("time", {}) else ""
    row = Row(f"{name}, cdem: {version}{scaled}", f"{sim.audit.counts['elements']:,}",
              "CPU s/simulated s", statistics.median(costs), min(costs), max(costs), 1)  # fmt: skip
    row.more["step [us]"] = 1e6 * float(sim.core.scalars()["dt"])
    if error:
        row.more["error of E [%]"] = 100 * _modulus_error(
            version, irregular="mesh" in case["model"]
        )
    return row


def _shaken(folder: Path, size: list[int]) -> str:
    """A mesh file of a box of tets whose inner corners are moved by up to a quarter of a cell."""
    import meshio

    whole = box("bar", [float(n) for n in size], size, shape="tet4")
    points, inner = whole.points, np.ones(whole.points.shape, bool)
    inner &= (points > 1e-9) & (points < np.array(size) - 1e-9)
    points = points + inner * np.random.default_rng(1).uniform(-0.25, 0.25, points.shape)
    path = folder / f"{size[0]}.vtk"
    meshio.write_points_cells(path, points, [("tetra", whole.cells["tet4"])])
    return str(path)


def _irregular(folder: Path) -> dict[str, Any]:
    """The bonded bar of a shaken mesh."""
    case = _bar(SHAKEN, "tet4", **_breakable("1 GPa"))
    mesh = _shaken(folder, [8 * SHAKEN, SHAKEN, SHAKEN])
    case["model"] = {"mesh": mesh, "split": {"default": "elements"}}
    case["groups"] = {"default": case["groups"]["bar"]}
    case["loads"]["supports"][0]["surface"]["group"] = "default"
    return case


def _modulus_error(version: int, *, irregular: bool) -> float:
    """Error of Young's modulus of a cube of bonded tets that is pulled along x, the mean of its inner
    tets and their faces."""
    size, group = [CUBE] * 3, "default" if irregular else "bar"
    with tempfile.TemporaryDirectory() as place:
        model: dict[str, Any] = {"split": {group: "elements"}}
        if irregular:
            model["mesh"] = _shaken(Path(place), size)
        else:
            model["blocks"] = [
                {"group": group, "box": {"size": size, "divisions": size, "shape": "tet4"}}
            ]
        case = {
            "cdem": version,
            "model": model,
            "materials": {"rock": ROCK},
            "groups": {group: {"material": "rock"}},
            "interfaces": {"default": {"friction_angle": 30, **_breakable("1 GPa")["interface"]}},
            "loads": {"tractions": [
                {"surface": {"group": group, "normal": [n, 0, 0]}, "traction": [n * 1e5, 0, 0]}
                for n in (-1, 1)
            ]},
            "stages": [{"name": "pull", "mode": "static", "relax": "adaptive"}],
        }  # fmt: skip
        sim = Simulation(Case.from_dict(case), threads=1)
        sim.run()
    t, made = sim.build.topology, sim.build.compensation.get(group)
    tets = bonded_tets(t, np.arange(len(t.pair_faces)), np.arange(len(t.element_nodes["tet4"])))
    u = sim.fields["displacement"][t.element_nodes["tet4"]].reshape(-1, 12, 1)
    stiffening = 1.0 if made is None else made.stiffening
    strain, stress = means(tets, u, stiffening * 10e9, stiffening * 0.25, tets.inner(2))
    return float((stress[0, 0] - 0.25 * (stress[1, 0] + stress[2, 0])) / strain[0, 0] / 10e9 - 1)


def _bar(m: int, shape: str, **more: Any) -> dict[str, Any]:
    return {
        "model": {
            "blocks": [
                {"group": "bar", "box": {"size": [8 * m, m, m], "divisions": [8 * m, m, m],
                                         "shape": shape}},
            ],
            **more.pop("model", {}),
        },
        "materials": {"rock": ROCK},
        "groups": {"bar": {"material": "rock", "velocity": [1e-3, 0, 0], **more.pop("group", {})}},
        "interfaces": {"default": {"friction_angle": 30, **more.pop("interface", {})}},
        "loads": {"supports": [{"surface": {"group": "bar", "normal": [-1, 0, 0]},
                                "fix": ["x", "y", "z"]}]},
        "stages": [{"name": "run", "mode": "dynamic", "duration": 1e3}],
        **more,
    }  # fmt: skip


def tets_shared(m: int, threads: int) -> Row:
    """P1: one block, no interfaces."""
    sim, start = _start(_bar(m, "tet4"), threads)
    tets = sim.audit.counts["elements"]
    row = _time("P1 tets, shared nodes", f"{tets:,}", "tets/s", sim, tets)
    # gradients, volume, places of nodes, material
    moved: float = 9 * 8 + 8 + 4 * 4 + 4
    # a tile finds its nodes and their rows, reads motion and writes rows; nodes read these
    moved += len(sim.core.rebuilt()["tile.force"]) / 4 / tets * (2 * 4 + 64 + 2 * 32)
    # a node reads six lists and two masses, books work and force, and moves
    moved += len(sim.fields["mass"]) / tets * (6 * 4 + 2 * 8 + 2 * 8 + 32 + 2 * 64)
    row.more["B/tet moved"] = moved
    row.more["of bandwidth"] = row.rate * moved / bandwidth(threads)
    row.more["start-up [s]"] = start
    if m == SIZES["1e4"]:
        row.more["wave speed error [%]"] = 100 * _wave_error(m, {})
    return row


def tets_bonded(m: int, threads: int) -> Row:
    """P2: every interior face a breakable interface, all intact."""
    row, _ = _bonded("P2 tets, all faces bonded", "1 GPa", m, threads)
    if m == SIZES["1e4"]:
        row.more["wave speed error [%]"] = 100 * _wave_error(m, _breakable("1 GPa"))
    return row


def tets_broken(m: int, threads: int) -> Row:
    """P2 on the path that keeps a history: every interface broken, and still where it was."""
    row, sim = _bonded("P2 tets, all faces broken", "0.001 Pa", m, threads)
    bonds = 3 * sim.audit.counts["bonded_pairs"]
    row.more["broken [%]"] = 100 * sum(sim.broken.values()) / bonds
    return row


def _breakable(strength: str) -> dict[str, Any]:
    """Every element a block of its own, bonded to the others by interfaces of one strength."""
    return {
        "model": {"split": {"bar": "elements"}},
        "interface": {"cohesion": strength, "tensile_strength": strength},
    }


def _bonded(name: str, strength: str, m: int, threads: int) -> tuple[Row, Simulation]:
    sim, start = _start(_bar(m, "tet4", **_breakable(strength)), threads)
    counts = sim.audit.counts
    tets = counts["elements"]
    row = _time(name, f"{tets:,}", "tets/s", sim, tets)
    row.more["interfaces/s"] = row.rate * counts["bonded_pairs"] / tets
    row.more["semi-springs/s"] = 6 * row.more["interfaces/s"]  # of two triangles
    row.more["B/tet of model and state"] = sim.audit.memory / tets
    row.more["start-up [s]"] = start
    return row, sim


def _rubble(m: int, speed: float = 1.0) -> dict[str, Any]:
    """The bonded bar with every bond cut, above a plate; it slides and tumbles at 21 m/s (rms)."""
    case = _bar(
        m,
        "tet4",
        model={"split": {"bar": "elements"}},
        group={
            "velocity": [2 * speed, 0, -speed],
            "angular_velocity": [0.5 * speed, speed, 2 * speed],
        },
        interface={"cohesion": "10 Pa", "tensile_strength": "10 Pa"},  # all break at once
    )
    case["model"]["blocks"].append(
        {"group": "plate", "box": {"size": [20 * m, 6 * m, 1]}, "translate": [-4 * m, -3 * m, -1]}
    )
    case["groups"]["plate"] = {"material": "rock", "fix": ["x", "y", "z"]}
    case["loads"] = {"gravity": [0, 0, -9.81]}
    case["stages"][0]["damping"] = {"contact": 0.2, "stiffness": 0.1}
    return case


def rubble(m: int, threads: int) -> Iterator[Row]:
    """P3: the same with every bond cut, while it slides and tumbles on a plate; S: its search."""
    case = _rubble(m)
    sim, start = _start(case, threads)
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
    """S: targets of all semi-springs by the lists, and the making of the lists, from a P3 row."""
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


def _wall(rows: int) -> dict[str, Any]:
    """A running-bond wall of cubes of one element on a floor."""
    blocks: list[dict[str, Any]] = [
        {"group": "cubes", "box": {"size": [1, 1, 1]}, "translate": [i + 0.5 * (j % 2), 0, j]}
        for j in range(rows)
        for i in range(COLUMNS)
    ]
    blocks.append(
        {"group": "floor", "box": {"size": [COLUMNS + 4, 3, 1]}, "translate": [-2, -1, -1]}
    )
    return {
        "model": {"blocks": blocks},
        "materials": {"rock": ROCK},
        "groups": {"cubes": {"material": "rock"},
                   "floor": {"material": "rock", "fix": ["x", "y", "z"]}},
        "interfaces": {"default": {"friction_angle": 30}},
        "loads": {"gravity": [0, 0, -9.81]},
        "stages": [{"name": "rest", "mode": "dynamic", "duration": 1e3,
                    "damping": {"contact": 0.2, "stiffness": 0.1}}],
    }  # fmt: skip


def wall(rows: int, threads: int) -> Row:
    """P4: running-bond wall of cubes of one element, at rest under gravity."""
    case = _wall(rows)
    sim, start = _start(case, threads)
    sim.step(200)
    cubes = rows * COLUMNS
    row = _time("P4 wall of cubes at rest", f"{cubes:,}", "cubes/s", sim, cubes)
    row.more["springs/s"] = row.rate / cubes * sim.audit.counts["semi_springs"]
    row.more["wall time per simulated s"] = cubes / row.rate / float(sim.core.scalars()["dt"])
    row.more["start-up [s]"] = start
    return row


def hexes(threads: int, hexahedra: str) -> Row:
    """Hexahedra that share nodes."""
    m = 23
    sim, start = _start(_bar(m, "hex8", elements={"hexahedra": hexahedra}), threads)
    count = sim.audit.counts["elements"]
    row = _time(f"hexahedra, {hexahedra}", f"{count:,}", "hexes/s", sim, count)
    row.more["start-up [s]"] = start
    return row


def mixed(m: int, threads: int) -> Row:
    """A quarter each of the bar in hexahedra, wedges, pyramids and tets, bonded where they meet."""
    case = _bar(m, "hex8", interface={"cohesion": "1 GPa", "tensile_strength": "1 GPa"})
    case["model"]["blocks"] = [
        {"group": "bar", "translate": [2 * m * i, 0, 0],
         "box": {"size": [2 * m, m, m], "divisions": [2 * m, m, m], "shape": shape}}
        for i, shape in enumerate(("hex8", "wedge6", "pyramid5", "tet4"))
    ]  # fmt: skip
    sim, start = _start(case, threads)
    count = sim.audit.counts["elements"]
    row = _time("mixed mesh", f"{count:,}", "elements/s", sim, count)
    row.more["start-up [s]"] = start
    return row


def _start(data: dict[str, Any], threads: int) -> tuple[Simulation, float]:
    data = data | {"output": {"frames": False}}
    began = time.perf_counter()
    sim = Simulation(Case.from_dict(data), threads=threads)
    start = time.perf_counter() - began
    sim.step(20)
    return sim, start


def _time(
    name: str, size: str, unit: str, sim: Simulation, items: int, steps: int | None = None
) -> Row:
    """Time runs of so many steps, or of as many as take `SECONDS`; rates are items times steps per
    second of wall time. CPU time is that of all threads, of user and system."""
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
    return row


def _steps_for(step: Callable[[int], None]) -> int:
    count = STEPS
    while True:
        began = time.perf_counter()
        step(count)
        spent = time.perf_counter() - began
        if spent > SECONDS:
            return count
        count = max(count + 1, min(8 * count, int(1.2 * SECONDS / max(spent, 1e-6) * count)))


def _wave_error(m: int, more: dict[str, Any]) -> float:
    """Error of the first P mode of the bar, its lateral motion held: a speed with a wrong stiffness
    is worth nothing."""
    group = {"velocity": [1, 0, 0], "fix": ["y", "z"]}
    sim, _ = _start(_bar(m, "tet4", **{**_copy(more), "group": group}), os.cpu_count() or 1)
    x, length = sim.build.start_position[:, 0], 8.0 * m
    weight = sim.fields["mass"] * np.sin(np.pi * x / (2 * length))
    e, nu, rho = 10e9, 0.25, 2500.0
    speed = np.sqrt(e * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho)
    crossings: list[float] = []
    before: tuple[float, float] | None = None
    while len(crossings) < 2:
        sim.step(4)
        now = sim.time, float(weight @ sim.fields["displacement"][:, 0])
        if before is not None and before[1] * now[1] < 0:
            crossings.append(before[0] + before[1] / (before[1] - now[1]) * (now[0] - before[0]))
        before = now
    return float(2 * length / (crossings[1] - crossings[0]) / speed - 1)


def _copy(more: dict[str, Any]) -> dict[str, Any]:
    return {key: dict(value) for key, value in more.items()}


def _short(value: float) -> str:
    for scale, sign in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(value) >= scale:
            return f"{value / scale:.3g} {sign}"
    return f"{value:.3g}"


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
