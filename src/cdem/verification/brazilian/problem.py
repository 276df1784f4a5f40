"""Brazilian disc: stress at the centre, splitting along the diameter and through irregular meshes."""

import numpy as np

from cdem.output.render import snapshot
from cdem.rows import rows_of
from cdem.run.fields import stress_of
from cdem.verification import plane

RADIUS, DEPTH, HALF = 0.5, 0.5, np.radians(7.5)  # [m]; half of the loaded arc [rad]


def theory(load):
    """Stress at the centre [Pa], across and along the loaded diameter, Hondros (1959).

    A pressure p along two opposite arcs of 2 HALF, whose resultant is the load 2 p R t sin(HALF)
    (Australian Journal of Applied Science 10, 243). For a narrow arc it is 2 P / (pi D t) across.
    """
    pressure = load / (2 * RADIUS * DEPTH * np.sin(HALF))
    return 2 * pressure / np.pi * np.array([np.sin(2 * HALF) - HALF, -np.sin(2 * HALF) - HALF])


def under_jaws(x, force):
    """The same under pairs of opposite forces along chords at x, for jaws that press unevenly.

    Two simple radial distributions for each pair, and an even tension that frees the rim between
    them (Timoshenko & Goodier 1951, art. 37).
    """
    sine2 = (x / RADIUS) ** 2
    part = force * np.sqrt(1 - sine2) / (np.pi * RADIUS * DEPTH)
    return np.array([(part * (1 - 4 * sine2)).sum(), (part * (4 * sine2 - 3)).sum()])


def rings(count):
    """Concentric rings of 6, 12, 18 ... points; sides of triangles lie along the loaded diameter."""
    rows = [[0.0, 0.0]]
    for ring in range(1, count + 1):
        angle = np.pi / 2 + 2 * np.pi * np.arange(6 * ring) / (6 * ring)
        r = RADIUS * ring / count
        rows += list(r * np.column_stack([np.cos(angle), np.sin(angle)]))
    points = np.array(rows)
    points[np.abs(points[:, 0]) < 1e-9, 0] = 0
    return points, plane.delaunay(points)


def irregular(count, seed):
    """Scattered points; the same number on the rim as `rings`."""
    rim = rings(count)[0][-6 * count :]
    spacing = RADIUS / count
    points = plane.scatter(rim, spacing, seed, lambda x: np.hypot(*x.T) < RADIUS - 0.5 * spacing)
    return points, plane.delaunay(points)


def squeeze(study, points, triangles):
    """Stress at the centre of a whole disc under an even pressure of 1 MPa, and the load [N]."""
    rim = np.flatnonzero(np.hypot(*points.T) > RADIUS - 1e-9)
    rim = rim[np.argsort(np.arctan2(points[rim, 1], points[rim, 0]))]
    facets = np.column_stack([rim, np.roll(rim, -1)])
    out = points[facets].mean(axis=1)
    out /= np.linalg.norm(out, axis=1)[:, None]
    loaded = np.abs(out[:, 1]) > np.cos(HALF)
    tractions = ", ".join(f"{{surface: facet{i}, traction: [{-1e6 * x:.9g}, 0, {-1e6 * z:.9g}]}}"
                          for i, (x, z) in enumerate(out[loaded]))  # fmt: skip
    simulation = plane.simulate(
        study, points, triangles, "model.split.rock=one",
        f"loads={{tractions: [{tractions}], supports: "
        "[{point: [0, 0, -0.5], fix: [x, z]}, {point: [0, 0, 0.5], fix: [x]}]}",
        "stages.0={name: squeeze, mode: static, relax: adaptive, tolerance: 1e-7}",
        depth=DEPTH, sides={f"facet{i}": [facet] for i, facet in enumerate(facets[loaded])},
    )  # fmt: skip
    simulation.run()
    x = simulation.build.start_position[simulation.build.topology.element_nodes["wedge6"]]
    near = (np.hypot(x[..., 0], x[..., 2]) < 1e-9).any(axis=1)
    volume = simulation.build.assembly.element_volume["wedge6"][near]
    stress = volume @ stress_of(simulation)[near] / volume.sum()
    return stress[[0, 2]], 2e6 * RADIUS * DEPTH * np.sin(HALF)


def settings(count, speed=0.01):
    """Stiffness of the bonds, 10 E over the spacing of the mesh, and the speed of the jaw [m/s]."""
    law = [f"interfaces.default.stiffness_{way}={100 * count / RADIUS} GPa/m" for way in "ns"]
    return [*law, f"loads.velocities.0.velocity=[0, 0, {-speed}]"]


def halves(study, count):
    """A disc of two halves, bonded along the loaded diameter alone."""
    points, triangles = rings(count)
    left = points[triangles][:, :, 0].mean(axis=1) < 0
    groups = ", ".join(f"{name}: {{material: rock, fix: [y]}}" for name in ("left", "right"))
    return plane.simulate(
        study, points, triangles, *settings(count), f"groups={{{groups}}}", "model.split={}",
        depth=DEPTH, groups=np.where(left, "left", "right").tolist(),
    )  # fmt: skip


def press(simulation, down_to=0.9):
    """Time [s], load [N], tension at the centre [Pa]; how far from it bonds broke first, over R.

    Load and tension (of a whole disc) follow from the forces on the lower jaw, which is at
    rest. Ends when the load has fallen to a fraction of its peak.
    """
    start = simulation.build.start_position
    jaw = np.flatnonzero(start[:, 2] < -RADIUS * np.cos(HALF) + 1e-5)
    rows, peak, place = [], 0.0, None
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(20)
        force = simulation.fields["reaction"][jaw, 2]
        rows.append((simulation.time, force.sum(), under_jaws(start[jaw, 0], force)[0]))
        peak = max(peak, rows[-1][1])
        if place is None and sum(simulation.broken.values()):
            place = np.linalg.norm(broken_places(simulation), axis=1).mean()
        if place is not None and rows[-1][1] < down_to * peak:
            break
    return *np.array(rows).T, place


def broken_places(simulation):
    """Middles of the faces with broken bonds over the radius, x and z, shape (faces, 2)."""
    bond = rows_of(simulation.core, "quads.bond").numbers
    faces = simulation.build.assembly.pair_faces["quads"][(bond < 0.5).any(axis=1), 0]
    x = simulation.build.start_position[simulation.build.topology.face_nodes[faces]].mean(axis=1)
    return x[:, [0, 2]] / RADIUS


def elastic(study):
    """Whole discs; the error falls with the square of the size of the elements."""
    within, found = {8: (0.08, 0.015), 16: (0.02, 0.004), 32: (0.005, 0.001)}, []
    for count in (8, 16, 32) if study.full else (8, 16):
        stress, load = squeeze(study, *rings(count))
        exact = theory(load)
        for k, way in enumerate(("across", "along")):
            study.check(f"stress {way} the centre, {count} rings", unit="Pa", theory=exact[k],
                        ours=stress[k], within=within[count][k])  # fmt: skip
        found.append(stress)
    for k, way in enumerate(("across", "along")):
        study.check(f"stress {way} the centre, extrapolated from the last two", unit="Pa",
                    theory=exact[k], ours=(4 * found[-1][k] - found[-2][k]) / 3, within=4e-3)  # fmt: skip
    if study.full:
        h = 1 / np.array([8, 16, 32])
        error = np.abs(np.array(found) / exact - 1)
        study.curve("Error of the stress at the centre", "element over radius [1]", "error [1]",
                    {".across": (h, error[:, 0]), ".along": (h, error[:, 1]),
                     "second order": (h, error[-1, 0] * (h / h[-1]) ** 2)}, log=True)  # fmt: skip


def split(study, name, simulation, within, *, even=True):
    """Check one disc that splits; only an even mesh must begin to do so inside.

    Returns its load over time, and its strength relative to its bonds.
    """
    strength = simulation.case.interfaces.default.tensile_strength
    time, load, tension, place = press(simulation)
    peak = load.argmax()
    study.check(f"tension at the centre when it splits, {name}", unit="Pa", theory=strength,
                ours=tension[peak], within=within)  # fmt: skip
    study.check(f"the same from the load by Hondros, {name}", unit="Pa", theory=strength,
                ours=theory(load[peak])[0], within=within + 0.05)  # fmt: skip
    study.check(f"broken bonds, from the loaded diameter over R, {name}", theory=0, absolute=True,
                ours=np.abs(broken_places(simulation)[:, 0]).mean(), within=0.2)  # fmt: skip
    if even:
        study.check(f"first broken bond, from the centre over R, {name}", theory=0, absolute=True,
                    ours=place, within=0.5)  # fmt: skip
    return (time, load), tension[peak] / strength


def run(study):
    """The whole disc, one of two halves, and discs with every element a block."""
    elastic(study)
    for count, within in [(8, 0.03), (16, 0.02)][: 2 if study.full else 1]:
        split(study, f"two halves, {count} rings", halves(study, count), within)
    for speed in (0.01, 0.005, 0.02) if study.full else ():
        simulation = plane.simulate(study, *rings(8), *settings(8, speed), depth=DEPTH)
        split(study, f"8 rings, jaw at {1000 * speed:g} mm/s", simulation, 0.03)
    lines, found = {}, []
    meshes = [(8, 1), (8, 2), (8, 3), (8, 4), (16, 1), (16, 2)] if study.full else [(8, 1)]
    for count, seed in meshes:
        simulation = plane.simulate(study, *irregular(count, seed), *settings(count), depth=DEPTH)
        name = f"irregular, {2 * count} elements across, seed {seed}"
        lines[name], strength = split(study, name, simulation, 0.2, even=False)
        found.append((2 * count, strength))
        shown = [snapshot(simulation)]
    study.curve("Load on irregular discs", "time [s]", "load [N]", lines)
    study.curve("Strength of irregular discs", "elements across [1]", "over that of a bond [1]",
                {".cdem": tuple(np.transpose(found))})  # fmt: skip
    if study.full:
        press(simulation, 0.3)
        shown.append(snapshot(simulation))
        study.picture("The last of them just after its peak, and later", *shown, field="damage")
