"""Columns and discs of irregular tets: strength reported by cdem check, and strength of bonds."""

import tempfile
from pathlib import Path

import meshio
import numpy as np

from cdem.run.fields import stress_of
from cdem.terrain.heights import extra
from cdem.verification import plane
from cdem.verification.brazilian.problem import DEPTH as DISC
from cdem.verification.brazilian.problem import HALF, RADIUS, irregular, rings, under_jaws

DEPTH = 1.0  # of columns, which are 1 m wide and 2 m high  [m]
THIN = 0.3  # of discs  [m]
WITHIN, SPLIT = 0.1, 0.3
WAYS = {"tension": 1, "compression": -1}
KINDS = ("shaken", "scattered", "netgen")


def theory(law):
    """Uniaxial strength of even rock with the strengths of bonds [Pa]: in tension, in compression."""
    phi = np.radians(law.friction_angle)
    return law.tensile_strength, 2 * law.cohesion * np.cos(phi) / (1 - np.sin(phi))


# ---------------------------------------------------------------------- meshes


def tets(points, triangles, layers, depth, shake, seed):
    """Tets of a plane mesh, extruded along y; points that are not on the surface are moved at random.

    Each prism is divided along the diagonals that begin at the lower of two numbers below.
    """
    count, y = len(points), np.linspace(0, depth, layers + 1)
    x = np.concatenate([np.insert(points, 1, level, axis=1) for level in y])
    sides = np.sort(np.concatenate([triangles[:, [a, (a + 1) % 3]] for a in range(3)]), axis=1)
    sides, used = np.unique(sides, axis=0, return_counts=True)
    inner = np.ones((layers + 1, count, 3), bool)
    inner[:, np.unique(sides[used == 1])] = [False, True, False]
    inner[[0, -1], :, 1] = False
    spacing = np.sqrt(2 * np.abs(areas(points, triangles)).mean())
    random = np.random.default_rng(seed)
    x += inner.reshape(-1, 3) * random.uniform(-shake, shake, x.shape) * spacing
    low = (np.sort(triangles, axis=1) + count * np.arange(layers)[:, None, None]).reshape(-1, 3)
    prism = np.concatenate([low, low + count], axis=1)
    return x, outward(
        x, np.concatenate([prism[:, c] for c in ((0, 1, 2, 5), (0, 1, 4, 5), (0, 3, 4, 5))])
    )


def areas(points, triangles):
    """Of triangles in a plane [m2]."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def outward(x, cells):
    """The same tets, all correctly oriented."""
    a, b, c, d = (x[cells[:, k]] for k in range(4))
    turned = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) < 0
    cells[turned] = cells[turned][:, [0, 2, 1, 3]]
    return cells


def column(kind, across):
    """1 m x 1 m x 2 m, with this number of elements across."""
    if kind == "netgen":
        shape = extra("netgen.csg")
        return by_netgen(
            shape.OrthoBrick(shape.Pnt(-0.5, 0, -1), shape.Pnt(0.5, DEPTH, 1)), 1 / across
        )
    h = 1 / across
    x, z = np.linspace(-0.5, 0.5, across + 1), np.linspace(-1, 1, 2 * across + 1)
    grid = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)
    if kind == "shaken":
        return tets(grid, plane.delaunay(grid), across, DEPTH, 0.2, 1)
    rim = (np.abs(grid) > [0.5 - 1e-9, 1 - 1e-9]).any(axis=1)
    points = plane.scatter(
        grid[rim], h, 1, lambda p: (np.abs(p) < [0.5 - 0.5 * h, 1 - 0.5 * h]).all(axis=1)
    )
    return tets(points, plane.delaunay(points), across, DEPTH, 0.1, 1)


def disc(kind, count):
    """1 m across, with this number of elements in its radius."""
    if kind == "netgen":
        s = extra("netgen.csg")
        body = s.Cylinder(s.Pnt(0, -1, 0), s.Pnt(0, 1, 0), RADIUS)
        body = (
            body
            * s.Plane(s.Pnt(0, 0, 0), s.Vec(0, -1, 0))
            * s.Plane(s.Pnt(0, THIN, 0), s.Vec(0, 1, 0))
        )
        return by_netgen(body, RADIUS / count)
    layers = max(2, round(THIN / RADIUS * count))
    shaken = kind == "shaken"
    points, triangles = rings(count) if shaken else irregular(count, 1)
    return tets(points, triangles, layers, THIN, 0.15 if shaken else 0.1, 1)


def by_netgen(body, size):
    """Points and tets of a body of netgen."""
    extra("netgen.meshing").SetMessageImportance(0)
    geometry = extra("netgen.csg").CSGeometry()
    geometry.Add(body)
    made = geometry.GenerateMesh(maxh=size)
    points = np.array([p.p for p in made.Points()])
    cells = np.array([[v.nr - 1 for v in e.vertices] for e in made.Elements3D()])
    return points, outward(points, cells)


def simulate(study, mesh, *settings):
    """A simulation of bonded tets."""
    points, cells = mesh
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.vtk"
        meshio.write_points_cells(path, points, [("tetra", cells)], file_format="vtk")
        return study.simulate("model.blocks=[]", f"model.mesh={path}", *settings)


# ---------------------------------------------------------------------- tests


def uniaxial(study, mesh, way, *settings):
    """Greatest mean stress of a column that is pulled (way 1) or pressed (-1) [Pa]."""
    speed = 0.02 if way > 0 else -0.05
    sim = simulate(study, mesh, f"loads.velocities.0.velocity=[0, 0, {speed}]", *settings)
    volume = sim.build.assembly.element_volume["tet4"]
    return peak(sim, lambda: way * (volume @ stress_of(sim)[:, 2]) / volume.sum())


def brazilian(study, mesh, *settings):
    """Tension at the centre of a disc when it splits, from the forces on its lower jaw [Pa]."""
    jaw = RADIUS * np.cos(HALF) - 1e-5
    sim = simulate(
        study, mesh, "groups.default.fix=[y]", "loads.velocities.0.velocity=[0, 0, -0.03]",
        f"loads.supports=[{{box: {{min: [-1, -1, -1], max: [1, 1, {-jaw}]}}, fix: [z]}},"
        " {point: [0, 0, -0.5], fix: [x]}]",
        f"loads.velocities.0.box={{min: [-1, -1, {jaw}], max: [1, 1, 1]}}", *settings,
    )  # fmt: skip
    start = sim.build.start_position
    held = np.flatnonzero(start[:, 2] < -jaw)
    per_depth = DISC / THIN

    def tension():
        return per_depth * under_jaws(start[held, 0], sim.fields["reaction"][held, 2])[0]

    return peak(sim, tension)


def peak(simulation, load):
    """The peak of a load; ends when bonds have broken and it has fallen to 0.9 of the peak."""
    most, now = 0.0, 0.0
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(10)
        now = load()
        most = max(most, now)
        if sum(simulation.broken.values()) and now < 0.9 * most:
            break
    return most


def told(study, mesh):
    """Strength of a mesh as reported by cdem check."""
    alone = simulate(study, mesh, "loads={gravity: [0, 0, 0]}")
    return alone.audit.meshed_strength["default"]


def softening(energies):
    """Settings of a law with these fracture energies [J/m2]."""
    return [
        "interfaces.default.law=softening",
        *(f"interfaces.default.fracture_energy_{i}={g:.6g}" for i, g in enumerate(energies, 1)),
    ]


def run(study):
    """Brittle bonds have the reported strength; with the reported energies, their own."""
    for kind in KINDS if study.full else KINDS[1:2]:
        for across in (4, 6) if study.full else (4,):
            columns(study, f"{kind}, {across} across", column(kind, across))
    for kind in KINDS if study.full else ():
        split(study, f"{kind}, 16 across", disc(kind, 8))


def columns(study, name, mesh):
    """Pull and press one mesh: brittle, softening and, as recommended, with stronger bonds."""
    law, of = study.case().interfaces.default, told(study, mesh)
    parts = {what: of["strength_along_xyz"][what][2] for what in WAYS}
    soft = softening(of["fracture_energies"])
    calibrated = [
        f"interfaces.default.tensile_strength={law.tensile_strength / parts['tension']:.9g}",
        f"interfaces.default.cohesion={law.cohesion / parts['compression']:.9g}",
    ]
    for (what, way), strength in zip(WAYS.items(), theory(law), strict=True):
        for bonds, theirs, settings in (
            ("brittle, as told", parts[what] * strength, []),
            ("softening", strength, soft),
            ("calibrated", strength, calibrated),
        )[: 3 if study.full else 2]:
            study.check(f"strength in {what}, {bonds}, {name}", theory=theirs, unit="Pa",
                        ours=uniaxial(study, mesh, way, *settings), within=WITHIN)  # fmt: skip


def split(study, name, mesh):
    """Split one disc."""
    of, strength = told(study, mesh), study.case().interfaces.default.tensile_strength
    for bonds, theirs, settings in (
        ("brittle, as told", of["strength_along_xyz"]["tension"][0] * strength, ()),
        ("softening", strength, softening(of["fracture_energies"])),
    ):
        study.check(f"tension when a disc splits, {bonds}, {name}", theory=theirs, unit="Pa",
                    ours=brazilian(study, mesh, *settings), within=SPLIT)  # fmt: skip
