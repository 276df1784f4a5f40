"""Circular hole: thick cylinder (Lamé) and stressed plate (Kirsch)."""

import tempfile
from pathlib import Path

import meshio
import numpy as np

from cdem.output.render import snapshot
from cdem.run.fields import stress_of, visible_faces

INNER, OUTER, STRESS = 1.0, 4.0, 1e5  # radii [m]; pressure in the hole, or tension far away [Pa]
SHOWN = "von Mises stress [Pa]"


def theory(kind, rock, r, angle):
    """Stress rr, tt, rt [Pa] and radial displacement [m] at polar places, plane strain.

    "pressure": STRESS inside a cylinder that is free outside, Lamé (1852). "plate": an infinite plate
    under the tension STRESS along x, Kirsch (1898, Z. Ver. dt. Ing. 42, 797).
    """
    nu, shear = rock.poisson_ratio, rock.young_modulus / (2 * (1 + rock.poisson_ratio))
    q = (INNER / r) ** 2
    if kind == "pressure":
        mean = STRESS / ((OUTER / INNER) ** 2 - 1)
        part = mean * (OUTER / r) ** 2
        radial = r / (2 * shear) * (mean * (1 - 2 * nu) + part)
        return mean - part, mean + part, 0 * r, radial
    c, s, half = np.cos(2 * angle), np.sin(2 * angle), STRESS / 2
    radial = half * r / (2 * shear) * (1 - 2 * nu + q + c * (1 + 4 * (1 - nu) * q - q * q))
    return (
        half * (1 - q) + half * (1 - 4 * q + 3 * q * q) * c,
        half * (1 + q) - half * (1 + 3 * q * q) * c,
        -half * (1 + 2 * q - 3 * q * q) * s,
        radial,
    )


def ring(cells):
    """A quarter ring of `cells` hexahedra along the hole, every facet of its rims a surface."""
    rows = round(cells * np.log(OUTER / INNER) / (np.pi / 2))  # so that cells are nearly square
    angle = np.linspace(0, np.pi / 2, cells + 1)
    r = INNER * (OUTER / INNER) ** (np.arange(rows + 1) / rows)
    x = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle))], axis=-1).reshape(-1, 2)
    layer = len(x)
    points = np.vstack([np.column_stack([x, np.full(layer, z)]) for z in (0, INNER / cells)])
    i, k = (a.ravel() for a in np.meshgrid(range(rows), range(cells), indexing="ij"))
    first = i * (cells + 1) + k
    low = np.column_stack([first, first + cells + 1, first + cells + 2, first + 1])
    k = np.arange(cells)
    rims = np.concatenate([k, rows * (cells + 1) + k])
    facets = np.column_stack([rims, rims + 1, rims + 1 + layer, rims + layer])
    names = {f"{rim}{n}": (1 + n + cells * (rim == "outer"), 2)
             for rim in ("inner", "outer") for n in range(cells)}  # fmt: skip
    tags = [np.zeros(len(low), int), 1 + np.arange(2 * cells)]
    return meshio.Mesh(
        points, [("hexahedron", np.column_stack([low, low + layer])), ("quad", facets)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"ring": np.array([0, 3])} | {n: np.array(tag) for n, tag in names.items()},
    )  # fmt: skip


def tractions(kind, rock, cells):
    """Entries of the case: the exact stress on the middle of every facet of the rims."""
    entries = []
    for rim, radius, sign in (("inner", INNER, -1), ("outer", OUTER, 1)):
        for n in range(cells):
            angle = (n + 0.5) * np.pi / 2 / cells
            rr, _, rt, _ = theory(kind, rock, radius, angle)
            c, s = np.cos(angle), np.sin(angle)
            x, y = sign * (rr * c - rt * s), sign * (rr * s + rt * c)
            entries.append(f"{{surface: {rim}{n}, traction: [{x:.9g}, {y:.9g}, 0]}}")
    return f"loads.tractions=[{', '.join(entries)}]"


def load(study, kind, cells, hexahedra):
    """The ring at rest under its tractions."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "ring.msh"
        meshio.write(path, ring(cells), "gmsh22", binary=False)
        mesh = f"model.mesh={path}"
        rock = study.case(mesh).materials["rock"]
        simulation = study.simulate(mesh, tractions(kind, rock, cells),
                                    f"elements.hexahedra={hexahedra}")  # fmt: skip
    simulation.run()
    return simulation


def polar_stress(simulation):
    """Radius and angle of the middle of every hexahedron, and its mean stress rr, tt, rt [Pa]."""
    nodes = simulation.build.topology.element_nodes["hex8"]
    x, y, _ = simulation.build.start_position[nodes].mean(axis=1).T
    angle = np.arctan2(y, x)
    xx, yy, _, xy, _, _ = stress_of(simulation)[-len(nodes) :].T  # they come last
    c, s = np.cos(angle), np.sin(angle)
    return np.hypot(x, y), angle, np.array([
        xx * c * c + yy * s * s + 2 * xy * c * s, xx * s * s + yy * c * c - 2 * xy * c * s,
        (yy - xx) * c * s + xy * (c * c - s * s),
    ])  # fmt: skip


def concentration(cells, r, angle, hoop):
    """Hoop stress where the hole meets the y axis, over STRESS, from the six nearest elements.

    Parabolas in 1 / r^2, which the exact stresses are, lead from three elements to the rim; the
    stress is even about the axis, so two columns lead on to the axis.
    """
    rim = []
    for column in (0.5, 1.5):
        some = np.flatnonzero(abs(angle - np.pi / 2 * (1 - column / cells)) < 1e-6)
        near = some[np.argsort(r[some])[:3]]
        rim.append(np.polyval(np.polyfit(r[near] ** -2, hoop[near], 2), INNER**-2))
    return (rim[0] + (rim[0] - rim[1]) / 8) / STRESS


def compare(study, kind, cells, hexahedra):
    """Check one ring; its errors of displacement and stress, and the simulation."""
    simulation = load(study, kind, cells, hexahedra)
    rock = simulation.case.materials["rock"]
    axis = np.abs(simulation.build.start_position[:, :2] - [INNER, 0]).sum(axis=1).argmin()
    ours = simulation.fields["displacement"][axis, 0]
    radial = theory(kind, rock, INNER, 0.0)[3]
    r, angle, stress = polar_stress(simulation)
    exact = np.array(theory(kind, rock, r, angle)[:3])
    error = np.sqrt(((stress - exact) ** 2).sum(axis=0).mean()) / STRESS
    top = theory(kind, rock, INNER, np.pi / 2)[1] / STRESS
    what = f"{kind}, {cells} cells, {hexahedra} hexahedra"
    # all errors are of second order; see README.md
    second = {"full": 1.0, "one-point": 2.0}[hexahedra] / cells**2
    study.check(f"displacement of the hole, {what}", unit="m", theory=radial, ours=ours,
                within=second)  # fmt: skip
    study.check(f"hoop stress of the hole, {what}", theory=top,
                ours=concentration(cells, r, angle, stress[1]), within=second)  # fmt: skip
    study.check(f"root mean square error of the stress, {what}", theory=0,
                ours=error, within=0.75 * second, absolute=True)  # fmt: skip
    return abs(ours / radial - 1), error, simulation


def with_stress(simulation):
    """The surface with von Mises' stress."""
    surface = snapshot(simulation)
    s = stress_of(simulation)
    normal, shear = s[:, :3], s[:, 3:]
    mises = ((normal - normal[:, [1, 2, 0]]) ** 2).sum(axis=1) / 2 + 3 * (shear**2).sum(axis=1)
    elements = simulation.build.topology.face_element[visible_faces(simulation)[0]]
    surface.cell_data[SHOWN] = np.sqrt(mises)[elements]
    return surface


def run(study):
    """Both loads; finer meshes and one-point hexahedra when full."""
    kinds = {"pressure": "pressure in the hole", "plate": "plate under tension along x"}
    for kind, title in kinds.items():
        for hexahedra in ("full", "one-point") if study.full else ("full",):
            meshes = (8, 16, 32) if study.full else (8, 16)
            rows = [compare(study, kind, cells, hexahedra) for cells in meshes]
            if study.full:
                h, (displacement, stress) = (
                    1 / np.array(meshes),
                    np.transpose([r[:2] for r in rows]),
                )
                study.curve(f"Errors, {title}, {hexahedra} hexahedra", "1 / cells [1]", "error [1]", {
                    ".displacement": (h, displacement), ".stress": (h, stress),
                    "second order": (h, stress[-1] * (h / h[-1]) ** 2)}, log=True)  # fmt: skip
        simulation = rows[1][2]
        r, angle, stress = polar_stress(simulation)
        top = angle > np.pi / 2 * (1 - 1 / 16)
        line = np.linspace(INNER, OUTER, 100)
        exact = theory(kind, simulation.case.materials["rock"], line, angle[top].max())
        study.curve(f"Stress beside the y axis, {title}, 16 cells", "radius [m]", "stress over the load [1]", {
            "radial": (line, exact[0] / STRESS), ".radial, cdem": (r[top], stress[0, top] / STRESS),
            "hoop": (line, exact[1] / STRESS), ".hoop, cdem": (r[top], stress[1, top] / STRESS)})  # fmt: skip
        study.picture(f"von Mises' stress, {title}", with_stress(simulation), field=SHOWN)
