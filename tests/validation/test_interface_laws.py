"""Interface laws: direct shear of bonds, and of contacts of all six kinds."""

import numpy as np
import pytest
from scenes import case, digest, simulate

import cdem
from cdem.rows import rows_of
from cdem.run.law_fields import state_of

STIFFNESS = {"stiffness_n": "1e11 Pa/m", "stiffness_s": "1e11 Pa/m"}
CUBES = [
    {"group": "bed", "box": {"size": [1, 1, 1]}, "translate": [0, 0, -1]},
    {"group": "block", "box": {"size": [1, 1, 1]}},
]


class Shear:
    """A cube on another, pressed within 1 ms, then led along x and z by histories of its speed."""

    def __init__(self, law, pressure, along, up=(), step="10 us"):
        """Histories: rows of time [s] and speed [m/s], a straight line between; pressure [Pa]."""
        down = 2 * pressure / 1e11 / 1e-3
        press = [[0, 0], [0.5e-3, -down], [1e-3, 0]]
        drives = [(["x", "y"], [1, 0, 0], along), (["z"], [0, 0, 1], [*press, *up])]
        self.sim = simulate(
            CUBES,
            {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
            interfaces={"default": STIFFNESS | law},
            time={"step": step},
            loads={
                "velocities": [
                    {"group": "block", "components": axes, "velocity": unit, "history": history}
                    for axes, unit, history in drives
                ]
            },
        )

    def tractions(self):
        """Shear and normal traction on the joint of 1 m2 [Pa], compression positive."""
        bed = self.sim.build.nodes_of("bed")
        force = rows_of(self.sim.core, "node.reaction").force[bed].sum(axis=0)
        return abs(force[0]), abs(force[2])


RESIDUAL = {
    "law": "residual",
    "friction_angle": 40,
    "cohesion": "3 MPa",
    "tensile_strength": "1 MPa",
    "residual_friction_angle": 30,
    "residual_cohesion": "1 MPa",
}


def test_residual_strength_after_the_peak():
    """T = (c + sigma tan(phi)) A, then c_r A' + sigma tan(phi_r) A.

    The pair is released after 0.1 % of 0.7 m; A' is the area that the cubes then still have in
    common. The normal springs keep the stiffness of A.
    """
    sigma = 2e6
    slide = [[1e-3, 0], [1.1e-3, 0.1], [0.03, 0.1], [0.0301, 0]]
    lift = [[0.03, 0], [0.0325, 0.4], [0.035, 0]]
    shear = Shear(RESIDUAL, sigma, slide, lift)
    sim = shear.sim
    sim.run_until(1e-3)
    peak, seen = 3e6 + sigma * np.tan(np.radians(40)), 0.0
    while sum(sim.broken.values()) == 0 and sim.time < 2e-3:
        seen = shear.tractions()[0]
        sim.step(1)
    assert seen == pytest.approx(peak, rel=0.03)  # it grows by 2 % in a step
    sim.run_until(0.0299)
    left = sigma * np.tan(np.radians(30))
    common = 1 - sim.fields["displacement"][sim.build.nodes_of("block"), 0].mean()
    assert common < 0.9975
    assert sim.core.fields()["quads.status"][0] == 0
    assert shear.tractions() == pytest.approx((1e6 * common + left, sigma), rel=1e-5)
    assert abs(sim.energies["error"]) < 1e-4
    sim.run_until(0.036)
    assert shear.tractions() == pytest.approx((0, 0), abs=1e-9)


def test_a_softening_bond_keeps_its_slip_and_spends_its_fracture_energy():
    """Sheared, tau = c (1 - s / s_u), s_u = 2 G2 / c; turned back, it unloads by k_s; in the end G2 is lost.

    Tolerance: round-off but for the energy, of which a step of 0.5 um in 300 um takes 1e-5.
    """
    law = {
        "law": "softening",
        "friction_angle": 0,
        "cohesion": "6 MPa",
        "tensile_strength": "3 MPa",
        "fracture_energy_1": 300,
        "fracture_energy_2": 900,
    }
    speeds = [(1e-3, 0), (1.1e-3, 0.05), (4e-3, 0.05), (4.1e-3, 0), (5e-3, 0), (5.2e-3, -0.1),
              (5.4e-3, 0), (6e-3, 0), (6.1e-3, 0.05), (20e-3, 0.05)]  # fmt: skip
    shear = Shear(law, 0, speeds)
    sim = shear.sim
    sim.run_until(4.9e-3)
    slip = state_of(sim, "joint_slip").max()
    held, start = shear.tractions()[0], sim.fields["displacement"][:, 0].max()
    assert slip > 5e-5
    assert held == pytest.approx(6e6 * (1 - slip / (2 * 900 / 6e6)), rel=1e-9)
    sim.run_until(5.9e-3)
    back = start - sim.fields["displacement"][:, 0].max()
    assert back == pytest.approx(2e-5, rel=1e-6)
    assert shear.tractions()[0] == pytest.approx(held - 1e11 * back, rel=1e-9)
    sim.run_until(19e-3)
    assert sim.broken["shear"] == 4
    assert sim.energies["fracture"] == pytest.approx(900, rel=1e-4)
    assert abs(sim.energies["error"]) < 1e-4


@pytest.mark.parametrize("safety", [0.8, 0.4, 0.2, 0.05])
def test_a_bond_struck_within_a_step_misses_half_a_step_of_its_strength(safety):
    """Exact: the law spends c u - c^2 / 2 k of a step u = v dt, of which the step takes c u / 2.

    So c v dt / 2 - c^2 / 2 k is missing, which falls with the step; once u < c / k it is a bend of
    the force within a step. Tolerance: of the softening within the step, u / s_u = 6 %, and the bend.
    """
    c, k, v = 2e5, 5e9, 1.2
    sim = simulate(
        [CUBES[0], {"group": "block", "box": {"size": [1, 1, 0.5]}}],
        {"bed": {"fix": ["x", "y", "z"]}, "block": {"velocity": [v, 0, 0]}},
        interfaces={"default": {
            "law": "softening", "friction_angle": 0, "cohesion": c, "tensile_strength": 1e5,
            "fracture_energy_1": 200, "fracture_energy_2": 500, "stiffness_n": k, "stiffness_s": k,
        }},
        rock={"young_modulus": 2e9}, time={"safety": safety}, elements={"mass": "lumped"},
        loads={"gravity": [0, 0, 0]},
    )  # fmt: skip
    sim.step(1)
    way = v * sim.time
    while sim.energies["fracture"] == 0:
        sim.step(1)
    missing = max(0.0, c * way / 2 - c**2 / (2 * k))
    assert sim.energies["error"] * sim.energies["start"] == pytest.approx(
        missing, rel=0.06, abs=0.04 * c * way
    )


EDGE, VERTEX = 0.5**0.5, 3**0.5
LOWER = {  # the topmost face, edge (along y) or vertex of a cube of 1 m at the origin
    "face": {"translate": [-0.5, -0.5, -1]},
    "edge": {"rotate": {"axis": [0, 1, 0], "angle": 45}, "translate": [-EDGE, -0.5, -EDGE]},
    "vertex": {"rotate": {"axis": [1, -1, 0], "angle": 54.735610317245346},
               "translate": [0, 0, -VERTEX]},
}  # fmt: skip
UPPER = {  # the lowest face, edge (along x) or vertex of a cube of 0.3 m, 20 um inside that
    "face": {"translate": [-0.15, -0.15, -2e-5]},
    "edge": {"rotate": {"axis": [1, 0, 0], "angle": 45}, "translate": [-0.15, 0, -2e-5]},
    "vertex": {"rotate": {"axis": [1, -1, 0], "angle": 54.735610317245346},
               "translate": [0, 0, -2e-5]},
}  # fmt: skip
KINDS = [
    ("face", "face"),
    ("face", "edge"),
    ("face", "vertex"),
    ("edge", "edge"),
    ("edge", "vertex"),
    ("vertex", "vertex"),
]
FALL = {"friction_angle": 40, "residual_friction_angle": 30, "slip_distance": "1 mm"}
BONDED = {"cohesion": "6 MPa", "tensile_strength": "3 MPa"}
LAWS = {
    "brittle": ({"friction_angle": 40}, lambda slip: np.full_like(slip, np.tan(np.radians(40)))),
    "residual": (
        {"law": "residual", "friction_angle": 40, "residual_friction_angle": 30} | BONDED,
        lambda slip: np.full_like(slip, np.tan(np.radians(30))),
    ),
    "slip-weakening": ({"law": "slip-weakening"} | FALL, None),
    "velocity-weakening": (  # fast for its velocity
        {
            "law": "velocity-weakening",
            "friction_angle": 40,
            "dynamic_friction_angle": 30,
            "velocity": 1e-7,
        },
        lambda slip: np.full_like(slip, np.tan(np.radians(30))),
    ),
    "voellmy": (  # so large a turbulence coefficient that speed hardly matters
        {"law": "voellmy", "friction_angle": 40, "turbulence": 1e9, "flow_density": 2000},
        lambda slip: np.full_like(slip, np.tan(np.radians(40))),
    ),
    "softening": (
        {"law": "softening", "fracture_energy_1": 1e4, "fracture_energy_2": 1e4} | FALL | BONDED,
        None,
    ),
    "barton-bandis": (  # walls so strong that the asperities carry 70 degrees at any pressure here
        {
            "law": "barton-bandis",
            "jrc": 12,
            "jcs": "2 GPa",
            "residual_friction_angle": 30,
            "aperture": "5 mm",
            "strength_factor": 3,
        },
        lambda slip: np.tan(np.radians(mobilised(slip))) / 3,
    ),
    "continuously-yielding": (
        {
            "law": "continuously-yielding",
            "friction_angle": 30,
            "initial_friction_angle": 33,
            "roughness": "1 mm",
            "stiffness_s": "3e11 Pa/m",  # it lags by what pressure grows with its rise
        },
        lambda slip: np.tan(np.radians(30 + 3 * np.exp(-slip / 1e-3))),
    ),
}


def mobilised(slip):
    """phi_r + (70 - phi_r) JRC_mob / JRC of the rough joint [deg]; 0.97 mm to the peak."""
    peak = 0.1 / 500 * (12 / 0.1) ** 0.33
    x = slip / peak
    return 30 * np.minimum(x / 0.3, 1) + 40 * np.interp(x, [0.3, 0.6, 1, 2], [0, 0.75, 1, 0.85])


def falling(slip):
    """tan(phi) of FALL after so much slip."""
    peak, left = np.tan(np.radians([40, 30]))
    return left + (peak - left) * np.maximum(1 - slip / 1e-3, 0)


def drawn_over(law, lower, upper):
    """A driven cube that comes down 20 um onto a free one and is drawn over it, step by step."""
    cubes = [
        {"group": "low", "box": {"size": [1, 1, 1]}} | LOWER[lower],
        {"group": "high", "box": {"size": [0.3, 0.3, 0.3]}} | UPPER[upper],
    ]
    cubes[1]["translate"] = (np.array(cubes[1]["translate"]) + [0, 0, 4e-5]).tolist()
    if upper == lower == "vertex":
        cubes[1]["translate"] = [0.01, 0.004, -0.01218]  # edges beside the tips meet
    sim = simulate(
        cubes,
        {"low": {}, "high": {}},
        rock={"density": 8000},
        interfaces={"default": {"stiffness_n": "1e9 Pa/m", "stiffness_s": "1e9 Pa/m"} | law},
        time={"step": "5 us"},
        loads={
            "velocities": [
                {"group": "high", "components": ["z"], "velocity": [0, 0, -0.04],
                 "history": [[0, 0], [1e-3, 1], [2e-3, 0]]},
                {"group": "high", "components": ["x", "y"], "velocity": [0.08, 0.3, 0],
                 "history": [[2e-3, 0], [3e-3, 1]]},
            ]
        },
    )  # fmt: skip
    for _ in range(134):
        sim.step(10)
        yield sim


def contacts_of(sim, law):
    """Rows of the state of all contacts, and what their walls have slipped by a law that keeps it [m]."""
    rows, slips = [], []
    for kind in ("spring", "edge"):
        of_kind = rows_of(sim.core, f"{kind}.state").numbers
        if kind == "spring":
            wall = np.flatnonzero(sim.core.array("spring.target")[0] >= 0)
            of_kind = of_kind[wall]
        else:
            wall = rows_of(sim.core, "edge.contact").mother_side
        rows.append(of_kind)
        slips.append(np.zeros(len(wall)))
        if law in REMEMBERED and len(wall):
            kept, of_law = (
                sim.core.array(f"{kind}.{name}")[0] for name in ("history", "history_law")
            )
            slips[-1] = kept.reshape(len(of_law), -1)[wall, REMEMBERED[law]]
    return np.concatenate(rows), np.concatenate(slips)


REMEMBERED = {  # place of the slip in the history
    "slip-weakening": 0,
    "softening": 2,
    "barton-bandis": 0,
    "continuously-yielding": 0,
}


@pytest.mark.parametrize("lower, upper", KINDS)
@pytest.mark.parametrize("law", LAWS)
def test_a_law_is_the_same_at_all_kinds_of_contacts(law, lower, upper):
    """Shear over normal force of every contact that slides is tan(phi) of the slip of its wall.

    The cube is drawn by 1.5 mm. What a contact slips is what the cube is moved, less the stretch of
    its spring, so both laws of falling friction must give the same. Tolerance: 1e-3; edges share the
    slip of their side.
    """
    given, tangent = LAWS[law]
    tangent = tangent or falling
    seen = []
    for sim in drawn_over(given, lower, upper):
        rows, slip = contacts_of(sim, law)
        normal, shear = rows[:, 0], np.hypot(rows[:, 2], rows[:, 3])
        limit = tangent(slip) * normal
        assert (shear <= limit * (1 + 1e-3)).all()
        seen += list(slip[(normal > 0) & (shear > limit * (1 - 1e-3))])
    assert len(seen) > 100
    if law in REMEMBERED:
        moved = np.hypot(*sim.fields["displacement"][sim.build.nodes_of("high")].mean(axis=0)[:2])
        assert 1e-3 < max(seen) < 1.01 * moved


@pytest.mark.parametrize("lower, upper", KINDS)
@pytest.mark.parametrize("law", list(LAWS)[:6])
def test_a_law_dilates_the_same_at_all_kinds_of_contacts(law, lower, upper):
    """Every contact that slides rises by tan(psi) of its slip, until that is the dilation slip.

    Of laws that keep the slip the rise is that of it, to 1e-3; of the others that of what the cube
    is moved, less the stretch of the spring that slides and what the free cube goes along.
    """
    height = 5e-4 * np.tan(np.radians(10))
    given = LAWS[law][0] | {"dilation_angle": 10, "dilation_slip": 5e-4}
    half, most, error = False, 0.0, 0.0
    for sim in drawn_over(given, lower, upper):
        rows, slip = contacts_of(sim, law)
        risen = rows[rows[:, 0] > 0, 4]
        error = max(error, abs(sim.energies["error"]))
        assert (risen <= height * (1 + 1e-12)).all()
        if len(risen):
            most = max(most, risen.max())
        if law in REMEMBERED and len(risen):
            expected = np.minimum(slip[rows[:, 0] > 0] * np.tan(np.radians(10)), height)
            assert risen == pytest.approx(expected, abs=RISE_ERROR)
        half = half or ((risen > 0.3 * height) & (risen < 0.7 * height)).any()
    assert half
    assert most == pytest.approx(height, rel=1e-9)
    assert error < 1e-3


RISE_ERROR = 1e-6  # [m]


@pytest.mark.parametrize("law", ["brittle", "residual", "slip-weakening"])
def test_bond_points_dilate_and_hand_over_what_they_have_risen(law):
    """sigma = sigma_0 + k_n tan(psi) s_psi under a fixed lid, before the release and after it.

    The fall of tau while it slides is that of the law. Both cubes are rigid.
    """
    laws = {"brittle": {}, "residual": {"law": "residual", "residual_friction_angle": 30},
            "slip-weakening": {"law": "slip-weakening", "residual_friction_angle": 30,
                               "slip_distance": "0.1 mm"}}  # fmt: skip
    given = {"friction_angle": 40, "cohesion": "3 MPa", "tensile_strength": "1 MPa",
             "dilation_angle": 10, "dilation_slip": "0.1 mm"} | laws[law]  # fmt: skip
    slide = [[1e-3, 0], [1.5e-3, 0.5], [0.02, 0.5]]
    shear = Shear(given, 2e6, slide, step="2 us")
    sim = shear.sim
    sigma = 2e6 + 1e11 * np.tan(np.radians(10)) * 1e-4
    tau = sigma * np.tan(np.radians(40 if law == "brittle" else 30))
    sim.run_until(2.1e-3)
    assert sim.core.fields()["quads.status"][0] == 1
    assert shear.tractions() == pytest.approx((tau, sigma), rel=1e-9)
    assert abs(sim.energies["error"]) < 1e-3
    while sim.core.fields()["quads.status"][0]:
        sim.step(1)
    sim.step(1)
    contacts = sim.contacts
    assert contacts["force_n"].sum() == pytest.approx(sigma, rel=1e-9)
    assert np.hypot(*contacts["force"][:, :2].T).sum() == pytest.approx(tau, rel=1e-9)
    assert abs(sim.energies["error"]) < 1e-3


def test_dilation_counts_the_way_back():
    """Led by 1 mm and back, again and again: each way lifts by tan(psi) 1 mm, five ways in all.

    Tolerances: the stretch of the springs before they slip, and the block's own sag.
    """
    sim = simulate(
        CUBES, {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
        interfaces={"default": {"friction_angle": 30, "dilation_angle": 10, "dilation_slip": "5 mm",
                                "stiffness_n": "1e9 Pa/m", "stiffness_s": "1e9 Pa/m"}},
        loads={"gravity": [0, 0, -9.81], "velocities": [
            {"group": "block", "components": ["x", "y"], "velocity": [0.02, 0, 0],
             "history": [[0.05 * (k + late), (-1) ** k] for k in range(8) for late in (0, 0.999)]},
        ]},
        stages=[{"name": "cycles", "mode": "dynamic", "duration": 0.4, "damping": {"contact": 0.5}}],
    )  # fmt: skip
    risen = []
    for way in range(1, 9):
        sim.run_until(0.05 * way)
        risen.append(sim.fields["displacement"][sim.build.nodes_of("block"), 2].mean())
    expected = np.tan(np.radians(10)) * 1e-3 * np.minimum(np.arange(1, 9), 5)
    assert np.array(risen) == pytest.approx(expected, abs=6e-5)


def test_each_pair_of_a_heterogeneous_interface_has_its_own_strength():
    """Sheared under pressure, pairs break at w c + sigma tan(phi); threads change no bit."""
    factors = {}

    def sheared(threads):
        stones = [
            {"group": "low", "box": {"size": [4, 3, 1], "divisions": [4, 3, 1]}},
            {"group": "high", "box": {"size": [4, 3, 1], "divisions": [4, 3, 1]},
             "translate": [0, 0, 1]},
        ]  # fmt: skip
        law = {"friction_angle": 0, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
        sim = cdem.Simulation(
            case(
                stones,
                {"low": {"fix": ["x", "y", "z"]}, "high": {}},
                interfaces={
                    "default": STIFFNESS | law | {"heterogeneity": {"weibull": 3, "seed": 2}}
                },
                time={"step": "1 us"},
                loads={"velocities": [{"group": "high", "velocity": [0.01, 0, 0]}]},
            ),
            threads=threads,
        )
        pairs = sim.build.assembly.counts["quads.count"]
        factors[threads] = sim.build.arrays["quads.strength"][:pairs].copy()
        sim.step(800)
        return sim, sim.core.fields()["quads.bond"].reshape(4, -1)[0, :pairs].copy()

    sim, bond = sheared(1)
    stress = 1e11 * 0.01 * (sim.step_count - 0.5) * 1e-6
    assert (bond > 0).any() and (bond == 0).any()
    assert (bond > 0).tolist() == (factors[1] * 1e6 > stress).tolist()
    other, _ = sheared(3)
    assert digest(other) == digest(sim)
    assert f"strength times {factors[1].min():.3g} .. {factors[1].max():.3g}" in sim.audit.text()
