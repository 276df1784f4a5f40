"""Line explosion under the ground (Garvin)."""

from cdem.verification import line_source
from cdem.verification.hexahedra import record

PRESSURE = 1e7  # [Pa]
ALONG, UP = (25.0, 50.0, 75.0, 100.0, 150.0), (0.0, 50.0)  # distances on the ground [m]


def theory(rock, x, t):
    """Horizontal and upward motion of the ground [m], see `line_source.motion`."""
    return line_source.motion(rock, PRESSURE, x, t)


def run(study):
    """The ground at six distances."""
    size = 1.25 if study.full else 2.5
    ground = line_source.half_plane(size, 250.0, 120.0)
    simulation = line_source.shake(study, {"rock": ground}, size, PRESSURE)
    nodes = line_source.at_surface(simulation, "rock", ALONG + UP)
    t, u, _ = record(simulation, nodes, 0.075, every=2)
    rock = simulation.case.materials["granite"]
    shown: dict[str, tuple] = {}
    for k, x in enumerate(ALONG):
        exact = theory(rock, x, t)[0]
        line_source.compare(study, f"u_x at {x:g} m", t, exact, u[:, k, 0], 0.03)
        shown |= {f"{x:g} m": (1e3 * t, 1e3 * exact),
                  f".{x:g} m, cdem": (1e3 * t[::16], 1e3 * u[::16, k, 0])}  # fmt: skip
    for k, x in enumerate(UP, start=len(ALONG)):
        line_source.compare(study, f"u_up at {x:g} m", t, theory(rock, x, t)[1], u[:, k, 1], 0.03)
    study.curve("Horizontal motion of the ground", "time [ms]", "u_x [mm]", shown)
