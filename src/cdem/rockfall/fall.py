"""One run: a block falls over the ground, window by window, each by an ordinary simulation.

The cost of a step grows with the faces of the model, also of those that are fixed and far away.
So each simulation holds the ground around the block only. Where the block comes near the edge of
this window, the next simulation begins: with the block without stress, in the place, attitude,
velocity and spin that it has.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.errors import UnstableError
from cdem.mesh.primitives import outward_faces, polyhedron
from cdem.rockfall.ground import NAME, Ground
from cdem.rockfall.rigid import Motion, RigidBlock
from cdem.rows import rows_of
from cdem.run.rest import Motion as OfRest
from cdem.run.rest import Quiet
from cdem.run.simulation import Simulation

Floats = NDArray[np.float64]
GRAVITY = 9.81
BLOCK = "block"
CELLS, SIZES = 8.0, 10.0
"""Least width of a window, in cells and in radii of the block."""
FREE = 0.01
"""Change of velocity between two samples, less that of free fall, up to which a block flies: part of
g."""
STIFFER, TRIES = 4.0, 3
"""Factor of stiffness after a block has penetrated the ground, and most trials."""
BELOW = 0.5
"""Depth of the centre below the ground, in radii, at which a block has fallen through."""
AT_REST, LEFT, OVER, THROUGH, FAILED = (
    "at rest", "left the terrain", "duration reached", "fell through the ground", "failed",
)  # fmt: skip
ORIGIN = 10_000.0
"""Places in a simulation count from multiples of it: coordinates of maps have seven digits [m]."""
COLUMNS = (
    "time", "x", "y", "z", "vx", "vy", "vz", "wx", "wy", "wz", "rotation", "bottom", "top",
)  # fmt: skip
"""A sample: centre [m], velocity [m/s], spin [rad/s], energy of rotation [J], lowest and highest
corner relative to the centre [m]."""


@dataclass(frozen=True)
class Physics:
    """Properties of all runs.

    Attributes:
        density: Of the block [kg/m3].
        modulus: Contact stiffness times the radius of the block [Pa].
        stiffening: Young's modulus of the block over `modulus` [1].
        contacts: Interface of the block with each zone of the ground: keys of a case.
        sample: Time between two samples [s].
        duration: Longest time [s].
    """

    density: float
    modulus: float
    contacts: list[dict[str, Any]]
    sample: float
    duration: float
    stiffening: float = 3.0


@dataclass(frozen=True)
class Boulder:
    """A block at its start.

    Attributes:
        vertices: Corners of a convex body [m], shape (corners, 3).
        velocity: [m/s].
        spin: [rad/s].
        faces: Corners of each face, outward; by default they are found.
    """

    vertices: Floats
    velocity: Floats
    spin: Floats = field(default_factory=lambda: np.zeros(3))
    faces: list[list[int]] | None = None


@dataclass
class Fall:
    """The result of one run.

    Attributes:
        status: How it ended.
        samples: Columns `COLUMNS`, shape (samples, columns).
        mass: Of the block [kg].
        volume: Of the block [m3].
        radius: Distance of its farthest corner from its centre [m].
        windows: Number of simulations.
        touching: Number of windows that began with the block on the ground.
        lost: Energy left out between windows: vibration, and penetration of such [J].
        modulus: Of the contacts in the end [Pa].
        steps: Steps of all simulations.
        why: The error of a run that failed.
    """

    status: str
    samples: Floats
    mass: float
    volume: float
    radius: float
    windows: int = 0
    touching: int = 0
    lost: float = 0.0
    modulus: float = 0.0
    steps: int = 0
    why: str = ""


def fall(ground: Ground, boulder: Boulder, physics: Physics) -> Fall:
    """Let a block fall until it rests, leaves the ground, or its time is over.

    A block that penetrates the ground falls again on ground four times as stiff.

    Args:
        ground: The ground.
        boulder: The block.
        physics: Densities, contacts and times.
    """
    for trial in range(TRIES):
        run = _Run(ground, boulder, physics, STIFFER**trial * physics.modulus)
        run.execute()
        if run.out.status not in (THROUGH, FAILED):
            break
    return run.out


def case_of(
    body: dict[str, Any], physics: Physics, radius: float, modulus: float, zones: list[str],
    motion: tuple[Floats, Floats],
) -> Case:  # fmt: skip
    """The case of a window: a loose block on zones of fixed ground.

    Args:
        body: Corners and faces of the block, as `polyhedron` of a case.
        physics: Densities, contacts and times.
        radius: Of the block [m].
        modulus: Of the contacts [Pa].
        zones: Groups of the ground.
        motion: Velocity [m/s] and spin [rad/s] of the block.
    """
    velocity, spin = (row.tolist() for row in motion)
    pairs: list[dict[str, Any]] = [
        {
            "between": [BLOCK, zone],
            "contact_stiffness": modulus / radius,
            "cohesion": 0.0,  # or the block would stick to ground that it touches at the start
            "tensile_strength": 0.0,
            **physics.contacts[int(zone.removeprefix(f"{NAME}_"))],
        }
        for zone in zones
    ]
    seams = {"friction_angle": 30.0, "cohesion": 1e9, "tensile_strength": 1e9}
    rock = {"density": physics.density, "poisson_ratio": 0.25}
    return Case.from_dict(
        {
            "model": {
                "blocks": [{"group": BLOCK, "polyhedron": body}],
                "split": dict.fromkeys(zones, "one"),
            },
            "materials": {"rock": rock | {"young_modulus": physics.stiffening * modulus}},
            "groups": {
                BLOCK: {"material": "rock", "velocity": velocity, "angular_velocity": spin},
                **{zone: {"material": "rock", "fix": ["x", "y", "z"]} for zone in zones},
            },
            "interfaces": {"default": seams, "pairs": pairs},
            "loads": {"gravity": [0, 0, -GRAVITY]},
            "stages": [{"name": "fall", "mode": "dynamic", "duration": physics.duration}],
            "output": {"every": physics.duration},
        }
    )


class _Run:
    """A run with one stiffness."""

    def __init__(self, ground: Ground, boulder: Boulder, physics: Physics, modulus: float) -> None:
        self._ground, self._boulder, self._physics = ground, boulder, physics
        self._faces = boulder.faces or outward_faces(boulder.vertices, None)
        mesh = polyhedron(BLOCK, boulder.vertices, self._faces)
        self._body = RigidBlock(mesh.points, mesh.cells["tet4"], physics.density)
        self._position = self._velocity = mesh.points
        self._quiet, self._time = Quiet(), 0.0
        self._rows: list[Floats] = []
        self._before: Motion | None = None
        body = self._body
        self.out = Fall(
            "", np.zeros((0, len(COLUMNS))), body.mass, body.volume, body.radius, modulus=modulus
        )

    def execute(self) -> None:
        """Run window after window."""
        arm = self._position - self._position.mean(axis=0)
        centre = self._body.motion(self._position, 0 * arm).centre
        velocity = self._boulder.velocity + np.cross(self._boulder.spin, self._position - centre)
        motion = replace(
            self._body.motion(self._position, velocity),  # without the rounding of its sums
            velocity=self._boulder.velocity,
            spin=self._boulder.spin,
        )
        self._velocity = velocity
        self._note(motion, self._position)
        try:
            while not self.out.status:
                motion = self._window(motion)
        except (UnstableError, np.linalg.LinAlgError) as error:
            self.out.status, self.out.why = FAILED, str(error)
        self.out.samples = np.array(self._rows)

    def _note(self, motion: Motion, position: Floats) -> None:
        z = position[:, 2] - motion.centre[2]
        self._rows.append(
            np.array(
                [self._time, *motion.centre, *motion.velocity, *motion.spin, motion.rotation,
                 z.min(), z.max()]
            )
        )  # fmt: skip

    def _window(self, motion: Motion) -> Motion:
        """One simulation; returns the motion at its end."""
        low, high = self._edges(motion)
        window, (low, high) = self._ground.window(low, high)
        origin = np.array([*(ORIGIN * np.floor(low / ORIGIN)), 0.0])
        window.points = window.points - origin
        begin, points = self._time, self._position - origin
        vertices = points[: len(self._boulder.vertices)]
        body = {"vertices": vertices.tolist(), "faces": self._faces}
        case = case_of(
            body, self._physics, self._body.radius, self.out.modulus, window.group_names,
            (motion.velocity, motion.spin),
        )  # fmt: skip
        sim = Simulation(case, threads=1, more=window)
        nodes = _places(sim, points)
        rows_of(sim.core, "node.motion").velocity[nodes] = self._velocity
        self.out.windows += 1
        self._before = None
        last = motion

        def look(sim: Simulation) -> bool:
            nonlocal last
            self._time = begin + sim.time
            rows = rows_of(sim.core, "node.motion")
            self._position = rows.position[nodes] + origin
            last = self._body.motion(self._position, rows.velocity[nodes])
            self._note(last, self._position)
            self.out.status = self._end(last)
            return bool(self.out.status) or self._leaves(last, low, high)

        sim.every(self._physics.sample, look)
        sim.run()
        self.out.steps += sim.step_count
        if not self.out.status:
            self._pass_on(sim, last)
        return last

    def _pass_on(self, sim: Simulation, last: Motion) -> None:
        """Take the block as rigid to the next window."""
        energies = sim.energies
        whole = energies["kinetic"] + energies["strain"]
        self.out.lost += whole - last.translation - last.rotation
        self._position = self._body.placed(self._position)
        self._velocity = last.velocity + np.cross(last.spin, self._position - last.centre)

    def _end(self, motion: Motion) -> str:
        """How the run ends now, or nothing."""
        xy = motion.centre[:2]
        height = float(self._ground.height(xy))
        if not np.isfinite(height):
            return LEFT
        if motion.centre[2] < height - BELOW * self._body.radius:
            return THROUGH
        energy = motion.translation + motion.rotation
        speed = float(np.sqrt(2 * energy / self._body.mass))
        self._quiet.look(
            self._time, OfRest(np.array([speed]), np.array([energy]), motion.centre[None])
        )
        if self._quiet.rests:
            return AT_REST
        return OVER if self._time >= self._physics.duration else ""

    def _edges(self, motion: Motion) -> tuple[Floats, Floats]:
        """Corners of the next window: around the block, most of it ahead [m]."""
        step = float(self._ground.step.max())
        half = 0.5 * max(CELLS * step, SIZES * self._body.radius)
        speed = float(np.linalg.norm(motion.velocity[:2]))
        ahead = min(1.0, speed) * (half - 2 * self._margin) / max(speed, 1e-9)
        middle = motion.centre[:2] + max(ahead, 0.0) * motion.velocity[:2]
        return middle - half, middle + half

    @property
    def _margin(self) -> float:
        """Least distance of the centre from the edge of the window [m]."""
        return self._body.radius + 0.5 * float(self._ground.step.max())

    def _leaves(self, motion: Motion, low: Floats, high: Floats) -> bool:
        """Whether the next window is due: at the edge, near the ground, best in flight."""
        before, self._before = self._before, motion
        xy = motion.centre[:2]
        left = float(min((xy - low).min(), (high - xy).min()))
        inner = 1.5 * self._margin
        if left > inner or self._beside_terrain(xy, low, high, inner):
            return False
        fly = motion.velocity * self._physics.sample
        reach = self._body.radius + float(np.linalg.norm(fly))
        bottom = motion.centre[2] - reach + min(0.0, fly[2])
        if bottom > self._ground.highest(xy, reach + float(self._ground.step.max())):
            return False  # high above: no ground is needed yet
        if before is None:
            return False
        change = motion.velocity - before.velocity + [0, 0, GRAVITY * self._physics.sample]
        flies = float(np.linalg.norm(change)) < FREE * GRAVITY * self._physics.sample
        if flies or left <= self._margin:
            self.out.touching += not flies
            return True
        return False

    def _beside_terrain(self, xy: Floats, low: Floats, high: Floats, inner: float) -> bool:
        """Whether the near edges of the window are edges of the terrain, with nothing beyond."""
        tiny = 1e-6 * self._ground.step
        at_west, at_east = low <= self._ground.low + tiny, high >= self._ground.high - tiny
        near_west, near_east = xy - low <= inner, high - xy <= inner
        return not bool((near_west & ~at_west | near_east & ~at_east).any())


def _places(sim: Simulation, points: Floats) -> NDArray[np.intp]:
    """Nodes of the block at these points: a simulation has an order of its own."""
    nodes = sim.groups[BLOCK].nodes
    away = np.abs(sim.fields["position"][nodes][:, None] - points[None]).max(axis=2)
    return nodes[away.argmin(axis=0)]
