"""Table 1 of Feng et al. (2014): tension, cohesion, friction, toppling; strength in bending."""

import numpy as np
import pytest
from scenes import simulate

CUBES = [
    {"group": "base", "box": {"size": [1, 1, 1]}, "translate": [0, 0, -1]},
    {"group": "block", "box": {"size": [1, 1, 1]}},
]


@pytest.mark.parametrize("points", ["vertex", "quadrature"])
def test_tensile_failure_at_the_tensile_strength(points):
    """P_t = T; both sides carry springs of half the area (Fig. 14), so not 2 T.

    Tolerance: the traction grows by 7e-6 of T in a step.
    """
    sim = simulate(
        CUBES,
        {"base": {"fix": ["x", "y", "z"]}, "block": {}},
        interfaces={
            "default": {"friction_angle": 26, "cohesion": "30 kPa", "tensile_strength": "10 kPa"}
        },
        rock={"poisson_ratio": 0.0},
        contact={"bond_points": points},
        loads={
            "tractions": [
                {
                    "surface": {"group": "block", "normal": [0, 0, 1]},
                    "traction": [0, 0, 1e4],
                    "history": [[0, 0], [0.04, 0.9], [0.08, 0.99], [0.48, 1.02]],
                }
            ]
        },
        stages=[{"name": "pull", "mode": "dynamic", "duration": 1, "damping": {"local": 0.8}}],
    )
    while sum(sim.broken.values()) == 0:
        sim.step(1)
        assert sim.time < 0.48
    pulled = 1e4 * np.interp(sim.time, [0, 0.04, 0.08, 0.48], [0, 0.9, 0.99, 1.02])
    assert pulled == pytest.approx(10e3, rel=3e-5)
    assert sim.broken["tension"] > 0
    assert sim.broken["shear"] == 0


def test_shear_failure_at_the_cohesion():
    """P_s = c / (1 + 2 (h/b) tan(phi)) of a block of height h and length b.

    The moment of the traction, P h, pulls the rear half of the area by 2 P h / b: 0.1 %.
    """
    height = 0.001
    sim = simulate(
        [
            {"group": "base", "box": {"size": [1, 1, 1]}, "translate": [0, 0, -1]},
            {"group": "block", "box": {"size": [1, 1, height]}},
        ],
        {"base": {"fix": ["x", "y", "z"]}, "block": {}},
        interfaces={
            "default": {
                "friction_angle": 26,
                "cohesion": "30 kPa",
                "tensile_strength": "30 kPa",
                "stiffness_n": "10 GPa/m",
                "stiffness_s": "10 GPa/m",
            }
        },
        rock={"poisson_ratio": 0.0},
        time={"mass_scaling": {"step": "5 us"}},
        loads={
            "tractions": [
                {
                    "surface": {"group": "block", "normal": [0, 0, 1]},
                    "traction": [3e4, 0, 0],
                    "history": [[0, 0], [0.02, 0.9], [0.05, 0.99], [0.3, 1.01]],
                }
            ]
        },
        stages=[{"name": "push", "mode": "dynamic", "duration": 1, "damping": {"local": 0.8}}],
    )
    while sum(sim.broken.values()) == 0:
        sim.step(10)  # in which the traction grows by 4e-6
        assert sim.time < 0.3
    pushed = 3e4 * np.interp(sim.time, [0, 0.02, 0.05, 0.3], [0, 0.9, 0.99, 1.01])
    assert pushed == pytest.approx(30e3 / (1 + 2 * height * np.tan(np.radians(26))), rel=2e-4)
    assert sim.broken["shear"] > 0


def tilted(phi, slope, size, steps, rock=None, law=None):
    """A block that comes to rest on a bed, under gravity tilted by `slope`."""
    angle = np.radians(slope)
    gravity = 9.81 * np.array([np.sin(angle), 0, -np.cos(angle)])
    sim = simulate(
        [
            {"group": "bed", "box": {"size": [3, 3, 1]}, "translate": [-1, -1, -1]},
            {"group": "block", "box": {"size": size}},
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
        rock=rock,
        interfaces={"default": {"friction_angle": phi, **(law or {})}},
        loads={"gravity": list(gravity)},
        stages=[{"name": "rest", "mode": "dynamic", "duration": 50, "damping": {"local": 0.8}}],
    )
    sim.step(steps)
    return sim


@pytest.mark.parametrize("off, slides", [(-0.002, True), (0.002, False)])
def test_sliding_begins_at_the_friction_angle(off, slides):
    """A low block on a slope of 45 deg slides if phi < 45 deg, and rests if it is larger.

    2e-3 deg leave a net force of 3.5e-5 m g, of which local damping takes 0.8: the block moves on,
    or not at all (2e-13 m of round-off). With contacts of 10 E/h instead of 1 E/h both blocks
    chatter and creep.
    """
    law = {"stiffness_n": "1 E/h", "stiffness_s": "1 E/h"}
    sim = tilted(45 + off, 45.0, [1, 1, 0.4], steps=20000, law=law)
    first, began = sim.fields["displacement"][-8:, 0].mean(), sim.time
    sim.step(10000)
    moved = sim.fields["displacement"][-8:, 0].mean() - first
    pushed = 0.2 * 9.81 * np.sin(np.pi / 4) * np.radians(0.004)  # [m/s2]: 1 - tan(phi) is twice off
    if slides:
        assert moved > 0.5 * pushed * (sim.time - began) ** 2
    else:
        assert abs(moved) < 1e-12


@pytest.mark.parametrize("off, stands", [(-0.01, True), (0.01, False)])
def test_toppling_begins_at_the_ratio_of_width_to_height(off, stands):
    """A 4:1 block topples at atan(1/4) = 14.036 deg: there its uphill edge leaves the bed.

    The bed is fixed at every node, so its surface is z = 0 exactly, and the uphill edge carries
    load as long as it is below that. A softer column bends downhill and topples earlier: 0.01 deg.
    """
    theory = np.degrees(np.arctan(0.25))
    sim = tilted(26, theory + off, [1, 1, 4], steps=90000, rock={"young_modulus": "20 GPa"})
    x = sim.fields["position"]
    nodes = sim.build.nodes_of("block")
    uphill = nodes[(x[nodes, 2] < 1) & (x[nodes, 0] < 0.5)]
    assert len(uphill) == 2
    assert (x[uphill, 2] < 0).all() == stands


def test_unloaded_bond_without_tensile_strength_stays_intact():
    """Departure from Eq. 14 as printed: with T = 0 an unloaded bond does not break at once."""
    sim = simulate(
        CUBES,
        {"base": {"fix": ["x", "y", "z"]}, "block": {}},
        interfaces={"default": {"friction_angle": 26, "cohesion": "30 kPa"}},
    )
    sim.step(100)
    assert sum(sim.broken.values()) == 0


def test_stage_changes_the_strength_of_a_pair_of_groups():
    """A case needs no default interface where every pair of groups that touches has its own."""
    law = {"between": ["base", "block"], "friction_angle": 26, "cohesion": "30 kPa"}
    stage = {"name": "weaker", "mode": "dynamic", "duration": 1e-3}
    sim = simulate(
        CUBES,
        {"base": {"fix": ["x", "y", "z"]}, "block": {}},
        interfaces={"pairs": [law]},
        stages=[stage | {"set": {"interfaces.pairs.0.cohesion": "10 kPa"}}],
    )
    assert sim.run() == "finished"
    assert sum(sim.broken.values()) == 0


@pytest.mark.parametrize("low, high", [((1, 1, 1), (2, 2, 1)), ((2, 2, 1), (3, 3, 1))])
def test_nonconforming_interface_opens_uniformly(low, high):
    """Over a 1:2 and a 2:3 interface the stress is uniform and the jump is traction / k_n.

    The bond points carry the true overlap area, so neither stiffness nor strength depends on which
    side is meshed finer. Tolerances: round-off of the area; the unbalance ratio of 1e-8 at which
    the stage ends.
    """
    traction, k_n = 1e4, 1e11
    sim = simulate(
        [
            {
                "group": "base",
                "box": {"size": [1, 1, 1], "divisions": low},
                "translate": [0, 0, -1],
            },
            {"group": "block", "box": {"size": [1, 1, 1], "divisions": high}},
        ],
        {"base": {"fix": ["x", "y", "z"]}, "block": {}},
        interfaces={
            "default": {"friction_angle": 26, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
        },
        rock={"poisson_ratio": 0.0},
        loads={
            "tractions": [
                {"surface": {"group": "block", "normal": [0, 0, 1]}, "traction": [0, 0, traction]}
            ]
        },
        stages=[{"name": "pull", "mode": "static", "tolerance": 1e-8}],
    )
    assert sim.build.arrays["overlaps.point_area"].sum() == pytest.approx(1, abs=1e-15)
    assert sim.run() == "converged"
    nodes = sim.build.nodes_of("block")
    bottom = nodes[sim.build.start_position[nodes, 2] < 1e-9]
    jump = sim.fields["displacement"][bottom, 2]
    np.testing.assert_allclose(jump, traction / k_n, rtol=5e-8)


@pytest.mark.parametrize("divisions", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_bending_strength_of_vertex_bonds(divisions):
    """Springs at the corners are a trapezoidal rule: they bear (1 + 2 / n^2) T b^3 / 6 in bending.

    Tolerance: the interface stays plane, for its stiffness is 0.002 of that of the blocks.
    """
    n, strength = divisions, 10e3
    share = (1 + 2 / n**2) / 6  # of 1e4, when the bonds should break
    curve = [0, 4, 4 + 16 * share], [0, 0.8 * share, 1.2 * share]  # at last by 1/40 in a second
    shape = {"size": [1, 1, 1], "divisions": [n, 1, 1]}
    sim = simulate(
        [
            {"group": "base", "box": shape, "translate": [0, 0, -1]},
            {"group": "block", "box": shape},
        ],
        {"base": {"fix": ["x", "y", "z"]}, "block": {}},
        interfaces={
            "default": {
                "friction_angle": 26,
                "cohesion": "1 MPa",
                "tensile_strength": strength,
                # soft against the blocks, so that the interface stays plane
                "stiffness_n": "0.002 E/h",
                "stiffness_s": "0.002 E/h",
            }
        },
        rock={"poisson_ratio": 0.0},
        loads={
            # a couple: up on one half side, down on the other, growing slowly
            "tractions": [
                {
                    "surface": {"group": "block", "normal": [sign, 0, 0]},
                    "traction": [0, 0, -sign * 1e4],
                    "history": np.transpose(curve).tolist(),
                }
                for sign in (1, -1)
            ]
        },
        stages=[{"name": "bend", "mode": "dynamic", "duration": 50, "damping": {"local": 0.8}}],
    )
    while sum(sim.broken.values()) == 0:
        sim.step(5)
        assert sim.time < curve[0][-1]
    moment = 1e4 * np.interp(sim.time, *curve)  # force 1 m2 x traction on either side, 1 m apart
    assert moment == pytest.approx(share * strength, rel=5e-4)


def test_bonded_vertices_under_an_overhanging_side_have_no_contact():
    """The vertices of the bond do not touch the larger bed too: the bond carries all the weight."""
    fall = np.tan(np.radians(35))

    def slice_(x0, x1, y0, y1, low, high):
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        return {"vertices": [[x, y, z - fall * x] for z in (low, high) for x, y in corners]}

    sim = simulate(
        [
            {"group": "bed", "polyhedron": slice_(-2, 10, -1, 5, -5, 0)},
            {"group": "slice", "polyhedron": slice_(0, 8, 0, 4, 0, 5)},
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "slice": {}},
        interfaces={
            "default": {"friction_angle": 25, "cohesion": "10 MPa", "tensile_strength": "10 MPa"}
        },
        loads={"gravity": [0, 0, -9.81]},
        contact={"check": True},
        stages=[{"name": "rest", "mode": "static", "relax": "adaptive", "tolerance": 1e-4}],
    )
    sim.run()
    assert sum(sim.broken.values()) == 0
    assert len(sim.contacts["kind"]) == 0
