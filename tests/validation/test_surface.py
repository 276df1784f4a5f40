"""Surface laws: pressure that follows its face; a spherical cavity against Sharpe and Blake."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
from scenes import case, digest, simulate
from scipy.linalg import expm

import cdem
from cdem.rows import rows_of

CUBE = [{"group": "a", "box": {"size": [1, 1, 1], "divisions": [2, 2, 2]}}]
AXES = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]


def pressures(group, value, normals=AXES):
    """Entries that press on faces of a group which look along these normals."""
    return [{"surface": {"group": group, "normal": n}, "pressure": value} for n in normals]


def momenta(sim):
    """Linear momentum, and the angular one about the origin."""
    mass = sim.fields["mass"][:, None]
    x, v = sim.fields["position"], sim.fields["velocity"]
    return (mass * v).sum(axis=0), (mass * np.cross(x, v)).sum(axis=0)


@pytest.mark.parametrize("shape", ["hex8", "tet4", "wedge6"])
def test_a_body_that_is_pressed_all_around_gets_no_momentum_however_it_turns(shape):
    """Over a closed surface p n integrates to zero, and so does x times p n."""
    box = {"size": [1, 0.7, 0.5], "divisions": [2, 2, 2], "shape": shape}
    sim = simulate(
        [{"group": "a", "box": box, "rotate": {"axis": [1, 2, 3], "angle": 0}}],
        {"a": {"velocity": [3, -1, 2], "angular_velocity": [20, -9, 12]}},
        rock={"young_modulus": 1e10}, elements={"mass": "lumped"},
        loads={"surfaces": pressures("a", "20 MPa")},
    )  # fmt: skip
    before = momenta(sim)
    sim.step(500)
    linear, angular = momenta(sim)
    force = np.abs(rows_of(sim.core, "node.surface").force).max() * sim.time
    # reached 4e-13 of the impulse of a node
    assert np.abs(linear - before[0]).max() < 2e-12 * force
    assert np.abs(angular - before[1]).max() < 2e-12 * force
    assert sim.energies["surface"] > 1e3
    assert abs(sim.energies["error"]) < 2e-3  # reached 5.2e-4; a tenth with half the step


def test_the_bulk_modulus_follows_from_the_volume_under_pressure():
    """dV / V = -p / K, p = 1 kPa: small strain."""
    sim = simulate(
        CUBE, {"a": {}}, rock={"young_modulus": 1e9, "poisson_ratio": 0.2},
        loads={"surfaces": pressures("a", 1e3)},
        stages=[{"name": "rest", "mode": "static", "tolerance": 1e-8, "relax": "adaptive"}],
    )  # fmt: skip
    sim.run()
    low, high = sim.fields["position"].min(axis=0), sim.fields["position"].max(axis=0)
    bulk = 1e9 / (3 * (1 - 2 * 0.2))
    assert np.prod(high - low) - 1 == pytest.approx(-1e3 / bulk, rel=1e-5)


def test_thrust_follows_a_body_that_spins():
    """v = -F / (m w) (sin w t, 1 - cos w t): a force through the centre, against a turning normal."""
    spin, pressure = 30.0, 1e4
    sim = simulate(
        CUBE, {"a": {"angular_velocity": [0, 0, spin]}}, rock={"young_modulus": 1e10},
        loads={"surfaces": pressures("a", pressure, [[1, 0, 0]])},
    )  # fmt: skip
    mass = sim.fields["mass"].sum()
    while sim.time < 0.15:  # 4.5 rad
        sim.step(50)
        turned = spin * (
            sim.time - 0.5 * sim.core.scalars()["dt_last"]
        )  # velocities lag half a step
        expected = -pressure / (mass * spin) * np.array([np.sin(turned), 1 - np.cos(turned), 0])
        got = momenta(sim)[0] / mass
        # reached 1.3e-3, in proportion to the step: the first one does not turn yet
        assert np.abs(got - expected).max() < 5e-3 * pressure / (mass * spin)


def test_a_run_in_parts_and_with_threads_has_the_bits_of_one():
    entries = pressures("a", "5 MPa", AXES[:3])
    entries[0] |= {"history": [[0, 0], [1e-3, 1], [4e-3, -0.5]]}
    loads = {"surfaces": entries, "gravity": [0, 0, -9.81]}
    whole = simulate(CUBE, {"a": {"angular_velocity": [0, 9, 0]}}, loads=loads)
    parts = cdem.Simulation(whole.case, threads=2)
    whole.step(100)
    for steps in (1, 30, 69):
        parts.step(steps)
    assert digest(parts) == digest(whole)


# ------------------------------------------------------------------ a cavity (waves in full space)

ROCK = {"density": 2600, "young_modulus": 30e9, "poisson_ratio": 0.25}
LAMBDA = MU = 12e9  # [Pa], of E and nu
P_SPEED, S_SPEED = np.sqrt(3 * MU / 2600), np.sqrt(MU / 2600)
PEAK, FALL, RISE = 100e6, 0.5e-3, 0.1e-3  # [Pa], times of two exponentials [s]
SIZE = 1 / 17  # of a cell along the way [m]
OUTER = 1 + 37 * SIZE  # radius of the model: its edge is not heard before the peaks at 2 m [m]


def blast(t):
    """Two exponentials with a peak of 1 at 0.2012 ms."""
    peak = np.log(FALL / RISE) / (1 / RISE - 1 / FALL)
    return (np.exp(-t / FALL) - np.exp(-t / RISE)) / (np.exp(-peak / FALL) - np.exp(-peak / RISE))


def sharpe(radius, times):
    """Displacement [m] and velocity [m/s] at a radius, since the wave came; cavity of 1 m.

    Sharpe (1942), Blake (1952): u = d(f(t - (r - a) / c_p) / r)/dr, and on the wall
    f'' + 2 alpha f' + w0^2 f = -a p / rho, w0 = 2 c_s / a, alpha = 2 c_s^2 / (a c_p). Exact for a
    pressure that is linear between the times.
    """
    w0, alpha, dt = 2 * S_SPEED, 2 * S_SPEED**2 / P_SPEED, times[1] - times[0]
    p = PEAK * blast(times)
    system = np.zeros((4, 4))
    system[0, 1] = system[2, 3] = 1
    system[1, :3] = -(w0**2), -2 * alpha, -1 / ROCK["density"]
    step = expm(system * dt)
    f = np.zeros((len(times), 2))
    for i in range(len(times) - 1):
        f[i + 1] = (step @ [*f[i], p[i], (p[i + 1] - p[i]) / dt])[:2]
    second = -p / ROCK["density"] - 2 * alpha * f[:, 1] - w0**2 * f[:, 0]
    u = -f[:, 0] / radius**2 - f[:, 1] / (radius * P_SPEED)
    return u, -f[:, 1] / radius**2 - second / (radius * P_SPEED)


def octant(path, size, across):
    """Write an eighth of a hollow sphere of hexahedra, its wall a surface; `across` cells an edge."""
    radii = np.linspace(1, OUTER, round((OUTER - 1) / size) + 1)
    tangent = np.tan(np.linspace(0, np.pi / 4, across + 1))
    u, v = (grid.ravel() for grid in np.meshgrid(tangent, tangent, indexing="ij"))
    plane = np.stack([np.ones_like(u), u, v], axis=1)
    plane /= np.linalg.norm(plane, axis=1)[:, None]
    directions = np.concatenate([np.roll(plane, k, axis=1) for k in range(3)])
    unique, place = np.unique(directions.round(9), axis=0, return_inverse=True)
    cell = np.arange((across + 1) ** 2).reshape(across + 1, across + 1)
    quad = np.stack([cell[:-1, :-1], cell[1:, :-1], cell[1:, 1:], cell[:-1, 1:]], axis=-1)
    quads = place.ravel()[np.concatenate([quad.reshape(-1, 4) + k * cell.size for k in range(3)])]
    count = len(unique)
    points = np.concatenate([r * unique for r in radii])
    hexes = np.concatenate(
        [np.hstack([quads + i * count, quads + (i + 1) * count]) for i in range(len(radii) - 1)]
    )
    tags = [np.full(len(hexes), 1), np.full(len(quads), 2)]
    meshio.write(
        path,
        meshio.Mesh(
            points,
            [("hexahedron", hexes), ("quad", quads)],
            cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
            field_data={"rock": np.array([1, 3]), "wall": np.array([2, 2])},
        ),
        "gmsh22",
        binary=False,
    )


def test_a_blast_in_a_spherical_cavity_sends_the_wave_of_sharpe(tmp_path):
    """Peaks of displacement and velocity at 1 and 2 m; cells of 0.06 m, history from a file.

    Radial columns of this size err by 0.5 to 1.5 % in displacement and 1.4 to 6 % in velocity.
    """
    octant(tmp_path / "octant.msh", SIZE, 6)
    times = np.linspace(0, 1.5e-3, 301)
    rows = "\n".join(f"{1e3 * t:.9g}, {f:.9g}" for t, f in zip(times, blast(times), strict=True))
    (tmp_path / "blast wave.csv").write_text(f"time [ms], factor\n{rows}\n")
    model = case(
        [], {"rock": {}}, materials={"rock": ROCK}, model={"mesh": str(tmp_path / "octant.msh")},
        loads={
            "surfaces": [{"surface": "wall", "pressure": "100 MPa",
                          "history": {"file": str(tmp_path / "blast wave.csv")}}],
            "supports": [
                {"box": {"min": [-1e-9 if a == k else -9 for a in range(3)],
                         "max": [1e-9 if a == k else 9 for a in range(3)]}, "fix": [axis]}
                for k, axis in enumerate("xyz")
            ],
        },
    )  # fmt: skip
    sim = cdem.Simulation(model, threads=1)
    start = sim.build.start_position
    radius = np.linalg.norm(start, axis=1)
    along = start / radius[:, None]
    levels = [np.abs(radius - r) < 1e-6 for r in (1, 2)]
    seen = []
    while sim.time < 0.75e-3:
        sim.step(2)
        seen.append([
            (sim.fields[name] * along)[level].sum(axis=1).mean()
            for level in levels for name in ("displacement", "velocity")
        ])  # fmt: skip
    fine = np.linspace(0, 1.5e-3, 30001)
    most = np.abs(np.array(seen)).max(axis=0)
    exact = np.array([np.abs(q).max() for r in (1, 2) for q in sharpe(r, fine)])
    assert exact == pytest.approx(
        [2.22718e-3, 8.2699, 0.81297e-3, 3.5720], rel=1e-4
    )  # computed before
    errors = most / exact - 1
    assert np.abs(errors[[0, 2]]).max() < 0.02, errors
    assert np.abs(errors[[1, 3]]).max() < 0.07, errors
    assert abs(sim.energies["error"]) < 1e-3


# ------------------------------------------------------------------ quiet faces

WAVE_ROCK = {"density": 2500, "young_modulus": 1.2e9, "poisson_ratio": 0.2}  # not 0.25: L = G there
P_WAVE, S_WAVE = np.sqrt(4e9 / 3 / 2500), np.sqrt(0.5e9 / 2500)
CELLS, PER_WAVE = 100, 10


def column(axis, shape="hex8"):
    """A bar of cells of 1 m along x in which a burst of waves along an axis runs up from x = 0.

    Both ends are quiet; the traction of the foot is 2 z v_up.
    """
    speed = P_WAVE if axis == "x" else S_WAVE
    period = PER_WAVE / speed
    times = np.linspace(0, 8 * period, 801)
    burst = np.sin(2 * np.pi * times / period) * 0.5 * (1 - np.cos(np.pi * times / (4 * period)))
    foot = {"surface": {"group": "bar", "normal": [-1, 0, 0]}}
    head = {"surface": {"group": "bar", "normal": [1, 0, 0]}}
    traction = [2 * 2500 * speed * 1e-3 if axis == own else 0 for own in "xyz"]
    loads = {
        "tractions": [foot | {"traction": traction, "history": list(zip(times, burst, strict=True))}],
        "supports": [{"box": {"min": [-9, -9, -9], "max": [999, 9, 9]},
                      "fix": [a for a in "xyz" if a != axis]}],
    }  # fmt: skip
    ends = [{"name": "foot", "quiet": True} | foot, {"name": "head", "quiet": True} | head]
    bar = {"size": [CELLS, 1, 1], "divisions": [CELLS, 1, 1], "shape": shape}
    duration = (2 * CELLS + 8 * PER_WAVE) / speed + 4 * period
    stages = [{"name": "shake", "mode": "dynamic", "duration": duration}]
    model = case([{"group": "bar", "box": bar}], {"bar": {}}, materials={"rock": WAVE_ROCK},
                 loads=loads, boundaries=ends, stages=stages, elements={"mass": "lumped"})  # fmt: skip
    return cdem.Simulation(model, threads=1), speed


def reflected(axis, shape="hex8"):
    """Amplitude that comes back, over that which came; the simulation, and c dt / h."""
    sim, speed = column(axis, shape)
    middle = np.abs(sim.build.start_position[:, 0] - CELLS / 2) < 1e-6
    seen = []
    while sim.stage_index == 0 and sim.time < sim.case.stages[0].duration:
        sim.step(2)
        seen.append((sim.time, sim.fields["velocity"][middle, "xyz".index(axis)].mean()))
    times, v = np.array(seen).T
    came = times < (CELLS / 2 + 9 * PER_WAVE) / speed
    assert np.abs(v[came]).max() == pytest.approx(1e-3, rel=0.03)
    return np.abs(v[~came]).max() / np.abs(v[came]).max(), sim, speed * sim.core.scalars()["dt"]


def formula(courant, per_wave=PER_WAVE):
    """What a lumped column with an implicit dashpot at its end sends back, by the discrete wave."""
    half_step = np.pi * courant / per_wave  # w dt / 2
    half_cell = np.arcsin(np.sin(half_step) / courant)  # k h / 2
    sums = np.cos(half_cell) + np.cos(half_step)
    return abs(np.cos(half_cell) - np.cos(half_step)) / sums


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_quiet_face_sends_back_what_the_discrete_wave_says(axis):
    """P 1.0 % and S 2.0 % with ten cells a wave length; the work of the dashpots closes the ledger."""
    back, sim, courant = reflected(axis)
    assert back == pytest.approx(formula(courant), rel=0.1)
    energies = sim.energies
    assert energies["radiated"] > 0.99 * energies["external"] > 0
    assert abs(energies["error"]) < 1e-6


def test_quiet_faces_lean_at_any_angle_and_add_up():
    """Dashpots are a matrix: a cube turned anyhow, with all faces quiet, loses its motion alike."""
    ends = []
    for turn in ({"axis": [0, 0, 1], "angle": 0}, {"axis": [1, 2, 3], "angle": 50}):
        r = rotation(turn)
        faces = [
            {"name": f"side{i}", "surface": {"group": "a", "normal": list(r @ n)}, "quiet": True}
            for i, n in enumerate(AXES)
        ]
        sim = simulate(
            [CUBE[0] | {"rotate": turn}], {"a": {"velocity": list(r @ [1.0, 0.2, 0.1])}},
            rock=WAVE_ROCK, boundaries=faces, elements={"mass": "lumped"},
        )  # fmt: skip
        sim.step(40)
        ends.append(momenta(sim)[0] @ r)
        assert abs(sim.energies["error"]) < 1e-6
        assert 0 < np.linalg.norm(ends[-1]) < 0.9 * 2500
    assert np.abs(ends[0] - ends[1]).max() < 1e-9 * 2500


def rotation(turn):
    """Matrix of a rotation about an axis by an angle [deg] (Rodrigues)."""
    axis = np.array(turn["axis"], float) / np.linalg.norm(turn["axis"])
    angle = np.radians(turn["angle"])
    cross = np.cross(np.eye(3), axis)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def test_quiet_faces_are_boundaries():
    faces = [{"surface": {"group": "a", "normal": [0, 0, -1]}, "law": "quiet"}]
    with pytest.raises(cdem.errors.CaseError, match=r"quiet faces are boundaries; write bound"):
        case(CUBE, {"a": {}}, loads={"surfaces": faces})
