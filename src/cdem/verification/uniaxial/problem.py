"""Uniaxial compression of jointed, regular and irregular bonded specimens (Jaeger, Coulomb)."""

import numpy as np

from cdem.output.render import snapshot
from cdem.run.fields import stress_of
from cdem.verification import plane

HEIGHT, WIDTH, DEPTH = 2.0, 1.0, 0.5  # [m]


def theory(law, angle=None):
    """Strength [Pa]: of a single plane of weakness, or of rock that is weak in every direction.

    A plane whose normal is at `angle` [deg] to the load slips at 2 c / ((1 - tan phi cot angle)
    sin 2 angle), Jaeger (1960, Geological Magazine 97, 65). The weakest is at 45 + phi / 2, where
    that is Coulomb's 2 c cos phi / (1 - sin phi).
    """
    phi = np.radians(law.friction_angle)
    b = np.pi / 4 + phi / 2 if angle is None else np.radians(angle)
    return 2 * law.cohesion / ((1 - np.tan(phi) / np.tan(b)) * np.sin(2 * b))


def jointed(study, angle):
    """Two blocks with one joint between them, half as wide as the others."""
    half = WIDTH / 4
    low, high = HEIGHT / 2 + half * np.tan(np.radians(angle)) * np.array([-1, 1])
    points = [[-half, 0], [half, 0], [half, high], [-half, low], [half, HEIGHT], [-half, HEIGHT]]
    groups = ", ".join(f"{name}: {{material: rock, fix: [y]}}" for name in ("lower", "upper"))
    return plane.simulate(
        study, np.array(points), np.array([[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]]),
        f"groups={{{groups}}}", "model.split={}", "loads.supports.1.point=[-0.25, 0, 0]",
        depth=DEPTH, groups=["lower", "lower", "upper", "upper"],
    )  # fmt: skip


def regular(angle, across):
    """Rows of triangles with sides along x and at nearly `angle` to it; also the actual angle."""
    side = WIDTH / across
    rows = 2 * round(HEIGHT / (side * np.tan(np.radians(angle))))
    points, triangles, first = [], [], [0]
    for row in range(rows + 1):
        inner = np.arange(across + 1) * side if row % 2 == 0 else (np.arange(across) + 0.5) * side
        x = np.unique([0, *inner, WIDTH]) - WIDTH / 2
        points += [(v, row * HEIGHT / rows) for v in x]
        first.append(len(points))
    for row in range(rows):
        a, b = first[row : row + 2]  # of the row with fewer points, and the other
        a, b = (a, b) if row % 2 == 0 else (b, a)
        some = [(a + i, a + i + 1, b + i + 1) for i in range(across)]
        some += [(b + i + 1, b + i, a + i) for i in range(across + 1)]
        triangles += some if row % 2 == 0 else [t[::-1] for t in some]
    return np.array(points), np.array(triangles), np.degrees(np.arctan(2 * HEIGHT / rows / side))


def irregular(spacing, seed):
    """Scattered points, triangulated; a spacing apart along the rim."""
    n, m = round(WIDTH / spacing), round(HEIGHT / spacing)
    across, up = np.linspace(-0.5, 0.5, n + 1) * WIDTH, np.linspace(0, HEIGHT, m + 1)[1:-1]
    rim = [(x, z) for x in across for z in (0, HEIGHT)]
    rim += [(x, z) for x in (-WIDTH / 2, WIDTH / 2) for z in up]

    def inside(x):
        away = np.minimum(WIDTH / 2 - np.abs(x[:, 0]), HEIGHT / 2 - np.abs(x[:, 1] - HEIGHT / 2))
        return away > 0.5 * spacing

    points = plane.scatter(np.array(rim), spacing, seed, inside)
    return points, plane.delaunay(points)


def weakest_bond(points, triangles, law):
    """Mean stress [Pa] at which the first bond of an irregular specimen of stiff bonds breaks.

    Elements carry the same stress s as whole rock. The bonds around an inner vertex then carry
    t_i = s n_i + c / A_i with n_i the normals of the facets there, turning the same way round, A_i
    their areas, and c the one force that may run around the vertex in a ring: balance does not know
    it. Compatibility does: the jumps t_i / k around the vertex sum to zero, which gives
    c = -s sum(n_i) / sum(1 / A_i), whatever the stiffness k. In a regular mesh sum(n_i) = 0.
    """
    sides = np.concatenate([triangles[:, [a, (a + 1) % 3]] for a in range(3)])
    sides, count = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    inner = np.ones(len(points), bool)
    inner[sides[count == 1]] = False  # the bonds of a vertex on the rim are no ring
    a, b = np.concatenate([sides[count == 2], sides[count == 2][:, ::-1]]).T
    along = points[b] - points[a]
    length = np.linalg.norm(along, axis=1)
    normal = np.column_stack([-along[:, 1], along[:, 0]]) / length[:, None]
    even = normal * [0, -1]  # traction of a mean stress of 1
    total, weight = np.zeros_like(points), np.zeros(len(points))
    np.add.at(total, a, even)
    np.add.at(weight, a, 1 / length)
    ring = np.zeros_like(points)
    ring[inner] = -total[inner] / weight[inner, None]
    traction = even + ring[a] / length[:, None]
    traction[(points[a, 1] == 0) | (points[a, 1] == HEIGHT)] = 0  # a platen fixes all its corners
    pull = (traction * normal).sum(axis=1)
    shear = np.linalg.norm(traction - pull[:, None] * normal, axis=1)
    slip = (shear + pull * np.tan(np.radians(law.friction_angle))).max()
    return 1 / max(slip / law.cohesion, pull.max() / law.tensile_strength)


def press(simulation, down_to=0.9):
    """Shortening over height, mean stress [Pa] and kinetic over strain energy until it has failed.

    The mean is over the volume, which is load over area but for waves. It has failed when the
    stress has fallen to a fraction of its peak.
    """
    volume = simulation.build.assembly.element_volume["wedge6"]
    upper = np.flatnonzero(simulation.build.start_position[:, 2] > HEIGHT - 1e-6)[0]
    rows, peak = [], 0.0
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(2)
        stress = -volume @ stress_of(simulation)[:, 2] / volume.sum()
        short = -simulation.fields["displacement"][upper, 2] / HEIGHT
        energies = simulation.energies
        rows.append((short, stress, energies["kinetic"] / energies["strain"]))
        peak = max(peak, stress)
        if sum(simulation.broken.values()) and stress < down_to * peak:
            break
    return np.array(rows).T


def settings(spacing, stiffness=10, speed=0.005):
    """Stiffness of the bonds in E / spacing, and the speed of the platen [m/s]."""
    law = [f"interfaces.default.stiffness_{way}={stiffness * 10 / spacing} GPa/m" for way in "ns"]
    return [*law, f"loads.velocities.0.velocity=[0, 0, {-speed}]"]


def joints(study, law):
    """Jaeger's curve."""
    found = []
    for angle in range(40, 80, 5) if study.full else (50, 60):
        found.append((angle, press(jointed(study, angle))[1].max()))
        study.check(f"strength, joint at {angle} deg", unit="Pa", theory=theory(law, angle),
                    ours=found[-1][1], within=2e-3)  # fmt: skip
    smooth = np.linspace(38, 77, 100)
    study.curve("One joint", "angle of its normal to the load [deg]", "strength [Pa]",
                {"Jaeger (1960)": (smooth, [theory(law, b) for b in smooth]),
                 ".cdem": tuple(np.transpose(found))})  # fmt: skip


def rows(study, law):
    """Regular specimens: every facet of two directions reaches its strength at once."""
    more = [(60, 10, 0.0025), (50, 10, 0.005), (50, 40, 0.005), (70, 10, 0.005)]
    for angle, stiffness, speed in [(60, 10, 0.005)] + more * study.full:
        points, triangles, true = regular(angle, 4)
        simulation = plane.simulate(
            study, points, triangles, *settings(0.2, stiffness, speed), depth=DEPTH
        )
        _, stress, kinetic = press(simulation)
        name = (
            f"facets at {true:.1f} deg, k = {stiffness} E / 0.2 m, platen at {1000 * speed:g} mm/s"
        )
        study.check(f"strength, {name}", unit="Pa", theory=theory(law, true), ours=stress.max(),
                    within=5e-3 if stiffness == 10 else 2e-3)  # fmt: skip
        study.check(f"kinetic over strain energy at the peak, {name}", theory=0, absolute=True,
                    ours=kinetic[stress.argmax()], within=2e-4)  # fmt: skip


def run(study):
    """One joint, regular and irregular specimens; the latter against their mesh."""
    law = study.case().interfaces.default
    joints(study, law)
    rows(study, law)
    cases = [(0.25, 1, 10)]
    if study.full:
        cases += [(0.25, 1, 40), (0.25, 2, 10), (0.125, 1, 10), (0.125, 2, 10), (0.125, 2, 40)]
    lines, found = {}, []
    for spacing, seed, stiffness in cases:
        points, triangles = irregular(spacing, seed)
        simulation = plane.simulate(
            study, points, triangles, *settings(spacing, stiffness), depth=DEPTH
        )
        short, stress, _ = press(simulation)
        name = f"spacing {spacing} m, seed {seed}, k = {stiffness} E / spacing"
        study.check(f"strength, {name}", unit="Pa", theory=weakest_bond(points, triangles, law),
                    ours=stress.max(), within=0.02 if stiffness == 10 else 0.01)  # fmt: skip
        lines[name] = short, stress
        found.append((spacing, stress.max() / theory(law)))
    study.curve("Irregular specimens", "shortening over height [1]", "mean stress [Pa]", lines)
    spread = []
    for h in (0.25, 0.125, 0.0625)[: 3 if study.full else 1]:
        for seed in range(1, 9):
            points, triangles = irregular(h, seed)
            spread.append((h, weakest_bond(points, triangles, law) / theory(law)))
    study.curve("Strength of irregular specimens", "spacing [m]", "over Coulomb's [1]",
                {".weakest bond, eight meshes": tuple(np.transpose(spread)),
                 ".cdem": tuple(np.transpose(found))})  # fmt: skip
    shown = [snapshot(simulation)]
    if study.full:
        press(simulation, 0.3)
        shown.append(snapshot(simulation))
        study.picture("The last of them just after its peak, and broken", *shown, field="damage")
