"""A round hole that is dug out of stressed rock (Kirsch)."""

import tempfile
from pathlib import Path

import meshio
import numpy as np

from cdem.output.render import snapshot
from cdem.run.simulation import Simulation
from cdem.verification.runner import problems

INNER = 1.0  # radius of the hole [m]
STRESS = -1e5  # along x, far away [Pa]


def theory(rock, r, angle, plate):
    """Stress rr, tt, rt [Pa] of an infinite plate with a hole, Kirsch (1898), under the stress STRESS
    along x; and how far the rim moves outwards since the rock was whole [m], plane strain.

    Args:
        plate: `theory` of the problem kirsch, for a tension of 1e5 Pa.
    """
    *stress, radial = plate("plate", rock, r, angle)
    nu, e = rock.poisson_ratio, rock.young_modulus
    # whole rock: e_xx = (1 - nu^2) s / E and e_yy = -nu (1 + nu) s / E
    whole = 1e5 * r * (1 + nu) / e * ((1 - nu) * np.cos(angle) ** 2 - nu * np.sin(angle) ** 2)
    share = STRESS / 1e5
    return np.array(stress) * share, share * (radial - whole)


def plate(ring, cells):
    """The ring of the problem kirsch, and the core inside it."""
    inside = 0.25 * INNER
    rows = round(cells * np.log(INNER / inside) / (np.pi / 2))
    angle = np.linspace(0, np.pi / 2, cells + 1)
    r = inside * (INNER / inside) ** (np.arange(rows) / rows)
    x = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle))], axis=-1).reshape(-1, 2)
    x = np.vstack([[[0.0, 0.0]], x])
    old, more = len(ring.points), len(x)
    depth = ring.points[:, 2].max()
    points = np.vstack([ring.points, *(np.column_stack([x, np.full(more, z)]) for z in (0, depth))])
    layer = old // 2  # of the ring; its first nodes lie on the hole
    i, k = (a.ravel() for a in np.meshgrid(range(rows), range(cells), indexing="ij"))

    def node(row, column, up):
        """Number of a node of the core, or of the ring on its rim."""
        own = old + up * more + 1 + row * (cells + 1) + column
        return np.where(row == rows, up * layer + column, own)

    corners = [(i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)]
    hexahedra = np.column_stack([node(*at, up) for up in (0, 1) for at in corners])
    k = np.arange(cells)
    fan = [(old + up * more + 0 * k, node(0 * k, k, up), node(0 * k, k + 1, up)) for up in (0, 1)]
    wedges = np.column_stack([column for three in fan for column in three])
    kept = dict(zip([block.type for block in ring.cells], ring.cells, strict=True))
    tags = ring.cell_data["gmsh:physical"]
    hexes = kept["hexahedron"].data
    core = 1 + max(int(t.max()) for t in tags)
    names = {name: np.array(tag) for name, tag in ring.field_data.items() if name != "ring"}
    cell_tags = [
        np.concatenate([np.full(len(hexes), core + 1), np.full(len(hexahedra), core)]),
        np.full(cells, core),
        tags[1],
    ]
    return meshio.Mesh(
        points,
        [("hexahedron", np.vstack([hexes, hexahedra])), ("wedge", wedges), ("quad", kept["quad"].data)],
        cell_data={"gmsh:physical": cell_tags, "gmsh:geometrical": cell_tags},
        field_data=names | {"ring": np.array([core + 1, 3]), "core": np.array([core, 3])},
    )  # fmt: skip


def tractions(kirsch, cells, stress):
    """Entries of the case: a stress(angle) -> rr, tt, rt on the middle of every facet of the rim."""
    entries = []
    for n in range(cells):
        angle = (n + 0.5) * np.pi / 2 / cells
        rr, _, rt = stress(angle)
        c, s = np.cos(angle), np.sin(angle)
        entries.append({"surface": f"outer{n}", "traction": [rr * c - rt * s, rr * s + rt * c, 0]})
    return entries


def uniform(angle):
    """Stress rr, tt, rt of the whole plate."""
    c, s = np.cos(angle), np.sin(angle)
    return STRESS * c * c, STRESS * s * s, -STRESS * s * c


def dig(study, kirsch, cells, release):
    """The plate after the hole was dug."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plate.msh"
        meshio.write(path, plate(kirsch.ring(cells), cells), "gmsh22", binary=False)
        case = study.case(f"model.mesh={path}", *release)
        rock = case.materials["rock"]
        case.set("loads.tractions", tractions(kirsch, cells, uniform))
        rim = tractions(kirsch, cells, lambda a: theory(rock, kirsch.OUTER, a, kirsch.theory)[0])
        case.stages[1].set = {"loads.tractions": rim}
        simulation = Simulation(case, threads=study.threads)
    simulation.run()
    return simulation


def run(study):
    """Dug out at once and in ten parts; finer when full."""
    [found] = problems(["kirsch"])
    kirsch = found.module
    ways = {"at once": [], "in ten parts": ["stages.1.release={parts: 10}"]}
    for cells in (8, 16) if study.full else (8,):
        for way, release in ways.items():
            simulation = dig(study, kirsch, cells, release)
            what = f"{cells} cells, {way}"
            rock = simulation.case.materials["rock"]
            start, moved = simulation.build.start_position, simulation.fields["displacement"]
            ring = simulation.build.nodes_of("ring")
            for name, axis, part in (("x", 0, 1.5), ("y", 1, 3.0)):
                place = INNER * np.eye(2)[axis]
                node = ring[np.abs(start[ring, :2] - place).sum(axis=1).argmin()]
                exact = theory(rock, INNER, axis * np.pi / 2, kirsch.theory)[1]
                study.check(f"way of the rim on the {name} axis, {what}", unit="m", theory=exact,
                            ours=moved[node, axis], within=part / cells**2)  # fmt: skip
            r, angle, stress = kirsch.polar_stress(simulation)
            of_ring = r > INNER
            exact = theory(rock, r[of_ring], angle[of_ring], kirsch.theory)[0]
            error = np.sqrt(((stress[:, of_ring] - exact) ** 2).sum(axis=0).mean()) / abs(STRESS)
            study.check(f"root mean square error of the stress, {what}", theory=0, ours=error,
                        within=0.75 / cells**2, absolute=True)  # fmt: skip
    study.picture("The hole, dug out", snapshot(simulation))
