"""Natural frequencies of a free beam: bending (Timoshenko), torsion, longitudinal."""

import numpy as np

from cdem.output.render import snapshot
from cdem.rows import rows_of

LENGTH, SIDE = 10.0, 1.0  # [m]
SPEED = 1e-3  # of the greatest motion at the start [m/s]
PERIODS = 4  # over which a frequency is measured
NAMES = {"full": "full hexahedra", "one-point": "one-point hexahedra",
         "lumped": "full hexahedra, lumped masses"}  # fmt: skip
# Frequencies with n elements in the height are too high by about these numbers over n^2; README.md
ERRORS = {
    ("bending", "full"): 0.055, ("bending", "one-point"): 0.0275, ("bending", "wedge6"): 0.3,
    ("bending", "pyramid5"): 0.5, ("bending", "tet4"): 2.0,
    ("torsion", "full"): 0.45, ("torsion", "one-point"): 1.4, ("torsion", "wedge6"): 1.7,
    ("torsion", "pyramid5"): 1.1, ("torsion", "tet4"): 3.0,
}  # fmt: skip


def theory(kind, rock):
    """Lowest frequency of a beam with free ends [Hz].

    "bending": Timoshenko's beam, frequency equation of Huang (1961, J. Appl. Mech. 28, 579), with the
    shear coefficient 5 (1 + nu) / (6 + 5 nu) of a rectangle. "torsion": Saint-Venant's torsion of a
    square, J = 0.140577 b^4. "longitudinal": a rod with the lateral inertia of Love (1927, art. 278).
    """
    e, nu, rho = rock.young_modulus, rock.poisson_ratio, rock.density
    shear, gyration = e / (2 * (1 + nu)), SIDE**2 / 12  # radius of gyration squared
    if kind == "torsion":
        return np.sqrt(0.140577 * 6 * shear / rho) / (2 * LENGTH)
    if kind == "longitudinal":
        lateral = (np.pi * nu / LENGTH) ** 2 * 2 * gyration
        return np.sqrt(e / rho / (1 + lateral)) / (2 * LENGTH)
    r2 = gyration / LENGTH**2
    s2 = r2 * e / (5 * (1 + nu) / (6 + 5 * nu) * shear)

    def equation(b):
        root = np.sqrt((r2 - s2) ** 2 + 4 / b**2)
        alpha, beta = (b * np.sqrt((root + sign * (r2 + s2)) / 2) for sign in (-1, 1))
        mixed = b * (b * b * r2 * (r2 - s2) ** 2 + 3 * r2 - s2) / np.sqrt(1 - b * b * r2 * s2)
        return 2 - 2 * np.cosh(alpha) * np.cos(beta) + mixed * np.sinh(alpha) * np.sin(beta)

    low, high = 15.0, 4.7300407**2  # the upper end is Euler and Bernoulli's beam
    while high - low > 1e-9:
        b = 0.5 * (low + high)
        low, high = (b, high) if equation(low) * equation(b) > 0 else (low, b)
    return low * np.sqrt(e * gyration / rho) / LENGTH**2 / (2 * np.pi)


def shape(kind, x):
    """About the motion of points `x` in a mode, shape (points, 3)."""
    motion, along = np.zeros_like(x), x[:, 0] / LENGTH
    if kind == "torsion":
        motion[:, 1] = -np.sin(np.pi * along) * x[:, 2]
        motion[:, 2] = np.sin(np.pi * along) * x[:, 1]
    elif kind == "longitudinal":
        motion[:, 0] = np.sin(np.pi * along)
    else:  # Euler and Bernoulli's, about the middle of the beam
        k = 4.7300407
        share = np.cos(k / 2) / np.cosh(k / 2)
        motion[:, 2] = np.cos(k * along) + share * np.cosh(k * along)
        slope = k / LENGTH * (share * np.sinh(k * along) - np.sin(k * along))
        motion[:, 0] = -x[:, 2] * slope
    return motion / np.linalg.norm(motion, axis=1).max()


def frequency(simulation, kind):
    """Frequency from the zero crossings of the modal motion, over `PERIODS` [Hz]."""
    motion = shape(kind, simulation.build.start_position)
    rows_of(simulation.core, "node.motion").velocity[:] = SPEED * motion
    weight = simulation.fields["mass"][:, None] * motion
    period = 1 / theory(kind, simulation.case.materials["rock"])
    steps = max(1, int(period / 64 / simulation.core.scalars()["dt"]))  # about 64 rows a period
    crossings: list[float] = []
    before = None
    while len(crossings) <= 2 * PERIODS:
        simulation.step(steps)
        now = simulation.time, (weight * simulation.fields["displacement"]).sum()
        if before is not None and before[1] * now[1] < 0:
            share = before[1] / (before[1] - now[1])
            crossings.append(before[0] + share * (now[0] - before[0]))
        before = now
    return PERIODS / (crossings[-1] - crossings[0])


def mode(simulation, kind):
    """The surface when the motion is greatest, drawn as if it were 1 m at most."""
    simulation.run_until(simulation.time + 0.25 / theory(kind, simulation.case.materials["rock"]))
    surface = snapshot(simulation)
    drawn = surface.point_data["displacement"]
    drawn = drawn / np.linalg.norm(drawn, axis=1).max()
    surface.points, surface.point_data["displacement"] = surface.points + drawn, drawn
    return surface


def within(kind, mesh, cells):
    """Tolerance of the frequency, relative; see README.md."""
    if kind != "longitudinal":
        return ERRORS[kind, mesh] / cells**2
    return 4e-3 / cells**2 if mesh in ("lumped", "tet4") else 0.03 / cells**4 + 1e-5


def run(study):
    """Hexahedra of either integration, ever smaller; all shapes, and lumped masses, when full."""
    cells = (2, 4, 8) if study.full else (2, 4)
    shown = []
    for kind in ("bending", "torsion", "longitudinal"):
        meshes: dict[str, tuple[int, ...]] = {"full": cells, "one-point": cells}
        if study.full:
            meshes |= {"wedge6": (4,), "pyramid5": (4,), "tet4": (4,)}
            meshes |= {"lumped": cells} if kind == "longitudinal" else {}
        lines = {}
        for mesh, numbers in meshes.items():
            errors = []
            for n in numbers:
                simulation = beam(study, mesh, n)
                exact = theory(kind, simulation.case.materials["rock"])
                ours = frequency(simulation, kind)
                study.check(f"{kind}, {NAMES.get(mesh, mesh)}, {n} in the height", unit="Hz",
                            theory=exact, ours=ours, within=within(kind, mesh, n))  # fmt: skip
                errors.append(abs(ours / exact - 1))
                if (mesh, n) == ("full", 4):
                    shown.append(mode(simulation, kind))
            h = 1 / np.array(numbers)
            lines[f".{NAMES.get(mesh, mesh)}"] = h, errors
            if mesh == ("lumped" if kind == "longitudinal" else "full"):
                lines["second order"] = h, errors[-1] * (h / h[-1]) ** 2
        if study.full:
            study.curve(f"Error of the frequency, {kind}", "element over height [1]", "error [1]",
                        lines, log=True)  # fmt: skip
    study.picture("The modes, their greatest motion drawn as 1 m", *shown)


def beam(study, mesh, cells):
    """The beam of one kind of element, `cells` in the height."""
    shape = "hex8" if mesh in NAMES else mesh
    box = f"{{size: [10, 1, 1], divisions: [{10 * cells}, {cells}, {cells}], shape: {shape}}}"
    one_point = "one-point" if mesh == "one-point" else "full"
    return study.simulate(f"model.blocks.0.box={box}", f"elements.hexahedra={one_point}",
                          f"elements.mass={'lumped' if mesh == 'lumped' else 'exact'}")  # fmt: skip
