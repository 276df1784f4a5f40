"""Sliding: a = g (sin t - cos t tan phi), Feng et al. (2014), Eq. 15, whatever the bed's mesh."""

import numpy as np
import pytest
from scenes import mean_velocity, simulate, turn

from cdem.rows import rows_of

GRAVITY = 9.81


def slide(bed, slope, phi, *, size=(1, 1, 0.4), divisions=(1, 1, 1), start=(1.37, 1.503, 0), time=0.5,
          rotation=None, rock=None, law=None, after=0.1):  # fmt: skip
    """Acceleration of a block down the slope, fitted after `after`, that of theory [m/s2], and the run."""
    angle = np.radians(slope)
    gravity = GRAVITY * np.array([np.sin(angle), 0, -np.cos(angle)])
    down = np.array([1.0, 0, 0])
    more = {}
    if rotation is not None:
        axis, degrees = rotation
        gravity, down = turn(axis, degrees) @ gravity, turn(axis, degrees) @ down
        more["model"] = {"rotate": {"axis": list(axis), "angle": degrees}}
    sim = simulate(
        [
            *bed,
            {"group": "block", "box": {"size": size, "divisions": divisions}, "translate": start},
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
        interfaces={"default": {"friction_angle": phi, **(law or {})}},
        rock=rock,
        loads={"gravity": list(gravity)},
        stages=[
            {
                "name": "slide",
                "mode": "dynamic",
                "duration": 9,
                "damping": {"contact": 0.1, "stiffness": 0.2},
            }
        ],
        **more,
    )
    times, speeds = [], []
    while sim.time < time:
        sim.step(200)
        if sim.time > after:
            times.append(sim.time)
            speeds.append(mean_velocity(sim, "block") @ down)
    theory = GRAVITY * (np.sin(angle) - np.cos(angle) * np.tan(np.radians(phi)))
    return np.polyfit(times, speeds, 1)[0], theory, sim


def plate(divisions, **more):
    box = {"size": [8, 4, 1], "divisions": list(divisions), **more}
    return [{"group": "bed", "box": box, "translate": [0, 0, -1]}]


BEDS = {
    "one face": plate((1, 1, 1)),
    "10 x 8 hexahedra": plate((10, 8, 1), size=[4, 4, 1]),
    "756 tets": plate((14, 9, 1), size=[4, 3, 1], shape="tet4"),
}


FLUSH = [
    {"group": "bed", "box": {"size": [0.5, 4, 1]}, "translate": [0.5 * i, 0, -1]} for i in range(16)
]


@pytest.mark.parametrize(
    "bed", ["one face", *(pytest.param(bed, marks=pytest.mark.slow) for bed in list(BEDS)[1:])]
)
def test_acceleration_does_not_depend_on_the_mesh_of_the_bed(bed):
    """Tolerance: vibration that is left at the start of the fit, 1e-6.

    Problem `sliding` has all beds within 5e-5; the bed of hexahedra is in the test below.
    """
    measured, theory, _ = slide(BEDS[bed], 30, 10, rock={"young_modulus": "2 GPa"})
    assert measured == pytest.approx(theory, rel=5e-6)


def test_acceleration_does_not_depend_on_the_frame():
    """The bed of 10 x 8 hexahedra rotated by 77 degrees; tolerance as above."""
    measured, theory, _ = slide(BEDS["10 x 8 hexahedra"], 30, 10, rotation=([1, 2, 3], 77.0),
                                rock={"young_modulus": "2 GPa"})  # fmt: skip
    assert measured == pytest.approx(theory, rel=5e-6)


@pytest.mark.parametrize("bed", ["one face", "10 x 8 hexahedra"])
def test_dilating_joint_rises_by_tan_psi_times_slip(bed):
    """The block rises by tan(psi) times the dilation slip, over any seams, and stays there.

    (On a steep slope the block flies off its asperities and bounces.) Tolerances: vibration after
    the rise, 1.3e-5 of the acceleration; the penetration under the block's weight.
    """
    axis, degrees = [1, 2, 3], 77.0
    law = {
        "dilation_angle": 8,
        "dilation_slip": 0.01,
        "stiffness_n": "1 E/h",
        "stiffness_s": "1 E/h",
    }
    measured, theory, sim = slide(BEDS[bed], 12, 10, rotation=(axis, degrees), law=law, after=0.3)
    assert measured == pytest.approx(theory, rel=5e-5)
    block = sim.build.nodes_of("block")
    height = np.sort((sim.fields["position"] @ turn(axis, degrees))[block, 2])[:4]
    penetration = 1e-5
    assert height == pytest.approx(0.01 * np.tan(np.radians(8)), abs=penetration)
    assert abs(sim.energies["error"]) < 3e-6


def test_acceleration_over_separate_flush_blocks():
    """Tolerance: the block chatters as it crosses seams; by round-off the fit is off by 4e-6 to 7e-5."""
    measured, theory, _ = slide(FLUSH, 35, 20, rock={"young_modulus": "2 GPa"})
    assert measured == pytest.approx(theory, rel=3e-4)


@pytest.mark.slow
def test_acceleration_of_a_meshed_block_over_flush_blocks():
    """A block of 2 x 2 x 2 elements; tolerance as above."""
    measured, theory, _ = slide(FLUSH, 35, 20, divisions=(2, 2, 2))
    assert measured == pytest.approx(theory, rel=3e-4)


@pytest.mark.parametrize("down, within", [(1e-6, 1e-4), pytest.param(1e-5, 5e-4, marks=pytest.mark.slow), pytest.param(1e-4, 2e-3, marks=pytest.mark.slow)])  # fmt: skip
def test_acceleration_over_small_steps_down(down, within):
    """A step down each metre. Tolerance: the vibration that a step causes grows with its height."""
    bed = [
        {"group": "bed", "box": {"size": [1, 4, 1]}, "translate": [i, 0, -1 - down * i]}
        for i in range(4)
    ]
    measured, theory, _ = slide(bed, 35, 20, rock={"young_modulus": "2 GPa"})
    assert measured == pytest.approx(theory, rel=within)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["rail", "turned rail"])
def test_acceleration_on_rails_touched_by_edges_alone(kind):
    """Fig. 18: a slider lies across rails that run down the slope; theta 45, phi 30: 2.9315 m/s2.

    (With the paper's g = 9.8 that is 2.928.) Tolerance: sliding edges chatter, which is chaotic; by
    round-off a fit over 0.7 s is off by 2e-5 to 8e-5. Problem `crossed` has the rail within 2e-4.
    """
    rail = {"size": [12, 0.3, 0.3]}
    if kind == "rail":
        beds = [{"group": "bed", "box": rail, "translate": [-1, y, -0.3]} for y in (0.5, 3.5)]
    else:  # standing on an edge
        half = 0.3 / np.sqrt(2)
        beds = [
            {
                "group": "bed",
                "box": rail,
                "rotate": {"axis": [1, 0, 0], "angle": 45},
                "translate": [-1, y, -2 * half],
            }
            for y in (0.5, 3.5)
        ]
    measured, theory, _ = slide(beds, 45, 30, size=(1, 5, 0.4), start=(0.3, -0.4, 0), time=0.8)
    assert measured == pytest.approx(theory, rel=3e-4)


def test_acceleration_over_a_slightly_uneven_bed(monkeypatch):
    """Facets tilted by up to about 1 degree at random: the block does not catch on their edges.

    Tolerance: the mean slope under the block differs from that of the bed by some 0.1 degrees.
    """
    from cdem.model import build

    flat = build.read_model

    def uneven(case, more):
        model = flat(case)
        bed = np.unique(model.cells["tet4"])
        top = bed[np.abs(model.points[bed, 2]) < 1e-9]
        height = 8 / 28 * np.tan(np.radians(1))
        model.points[top, 2] += np.random.default_rng(5).uniform(-0.5, 0.5, len(top)) * height
        return model

    monkeypatch.setattr(build, "read_model", uneven)
    measured, theory, _ = slide(BEDS["756 tets"], 30, 10, start=(1.37, 1.503, 0.004))
    assert measured == pytest.approx(theory, rel=0.02)


@pytest.mark.parametrize(
    "bed, within",
    [
        pytest.param("10 x 8 hexahedra", 1e-4, marks=pytest.mark.slow),
        ("756 tets", 0.01),
        ("flush blocks", 2e-5),
    ],
)
def test_contact_force_is_continuous_at_seams(bed, within):
    """A vertex that moves on to the next facet keeps its normal and shear force.

    Tolerance: what the force changes by in any step, most on tets, whose areas differ. The sum over
    the block may still jump when a loaded vertex of the bed comes out from under it: by its share
    of the weight, here up to 9 %.
    """
    slope = np.radians(30)
    gravity = GRAVITY * np.array([np.sin(slope), 0, -np.cos(slope)])
    box = {"size": [1, 1, 0.4]}
    sim = simulate(
        [
            *(BEDS.get(bed) or FLUSH),
            {"group": "block", "box": box, "translate": [1.37, 1.503, 0]},
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
        # at 10 E/h friction makes a block chatter: its modes and those of the contacts couple
        interfaces={
            "default": {"friction_angle": 10, "stiffness_n": "1 E/h", "stiffness_s": "1 E/h"}
        },
        rock={"young_modulus": "2 GPa"},
        loads={"gravity": list(gravity)},
        stages=[
            {
                "name": "slide",
                "mode": "dynamic",
                "duration": 9,
                "damping": {"contact": 0.1, "stiffness": 0.2},
            }
        ],
    )
    while sim.time < 0.1:
        sim.step(100)
    weight = 2500 * 0.4 * GRAVITY * np.cos(slope)
    nodes, face_nodes = sim.build.nodes_of("block"), sim.build.topology.face_nodes
    exposed = sim.core.array("search.exposed_face")[0].copy()
    seams = change_at_seam = change_of_sum = let_go = 0.0
    before = None
    while sim.time < 0.4:
        sim.step(1)
        target = sim.core.array("spring.target")[0].copy()
        force = rows_of(sim.core, "spring.reaction").force.copy()
        total = -rows_of(sim.core, "node.reaction").force[:, 2].sum()
        if before is not None:
            last_target, last_force, last_total = before
            moved_on = (target != last_target) & (target >= 0) & (last_target >= 0)
            for slot in np.flatnonzero(moved_on):
                if face_nodes[exposed[slot // 4], slot % 4] in nodes:
                    seams += 1
                    change = np.linalg.norm(force[slot] - last_force[slot])
                    change_at_seam = max(change_at_seam, change / np.linalg.norm(last_force[slot]))
            ended = np.flatnonzero((target < 0) & (last_target >= 0))
            of_block = np.isin(face_nodes[exposed[ended // 4], ended % 4], nodes)
            size = np.linalg.norm(last_force[ended[of_block]], axis=1)
            let_go = max(let_go, size.max(initial=0.0) / weight)
            change_of_sum = max(change_of_sum, abs(total - last_total) / weight)
        before = target, force, total
    assert seams >= 3
    assert let_go < 1e-4  # a vertex lost 0.5 % where it was over one block, indented over the next
    assert change_at_seam < within
    assert change_of_sum < 0.09


def test_ridge_that_steepens_holds_a_bar(monkeypatch):
    """A bar slides along a ridge that is too flat for edge contacts and steepens.

    On the flat part the ridge enters the bar, deeper than the entry depth. Where it steepens edge
    contacts must hold the bar, whose ends lie below the plane of the other side.
    """
    from cdem.model import build

    flat = build.read_model

    def ridge(case, more):
        model = flat(case)
        bed = np.unique(model.cells["tet4"])
        top = bed[np.abs(model.points[bed, 2]) < 1e-9]
        x, y = model.points[top, :2].T
        slope = np.radians(np.interp(y, [0, 20], [1.2, 4]))  # of either side
        model.points[top, 2] -= np.abs(x) * np.tan(slope)
        return model

    monkeypatch.setattr(build, "read_model", ridge)
    sim = simulate(
        [
            {
                "group": "bed",
                "box": {"size": [40, 60, 4], "divisions": [2, 3, 1], "shape": "tet4"},
                "translate": [-20, -20, -4],
            },
            {"group": "bar", "box": {"size": [16, 3, 3]}, "translate": [-8, -2, -0.1]},
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "bar": {"velocity": [0, 10, 0]}},
        rock={"young_modulus": "2 GPa"},
        loads={"gravity": [0, 0, -GRAVITY]},
        stages=[
            {
                "name": "slide",
                "mode": "dynamic",
                "duration": 9,
                "damping": {"contact": 0.3, "stiffness": 0.2},
            }
        ],
    )
    nodes = sim.build.nodes_of("bar")
    while sim.time < 2.8:
        sim.step(500)
    centre = sim.fields["position"][nodes].mean(axis=0)
    assert centre[1] > 24
    # half its height above the ridge, less what the flattest edge hides: 4 m tan 2.56 degrees
    assert 1.5 - 8 * np.tan(np.radians(1.28)) - 0.02 < centre[2] < 1.5


def test_bonded_bed_acts_as_one_surface():
    """A hull with a raised bow slides over separate bonded tets as over one block.

    The corners of single tets would stick into the bow and throw the block back. Tolerance:
    vibration, as above.
    """
    slope, phi = np.radians(30), 10
    hull = [[x, y, z] for y in (0, 0.8) for x, z in ((0, 0.4), (0.3, 0), (0.9, 0), (1.3, 0.4))]
    sim = simulate(
        [
            {
                "group": "bed",
                "box": {"size": [5, 3, 0.5], "divisions": [10, 6, 1], "shape": "tet4"},
                "translate": [0, 0, -0.5],
            },
            {"group": "block", "polyhedron": {"vertices": hull}, "translate": [1.37, 1.103, 0]},
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
        interfaces={
            "default": {"friction_angle": phi, "stiffness_n": "1 E/h", "stiffness_s": "1 E/h"},
            "pairs": [
                {
                    "between": ["bed", "bed"],
                    "friction_angle": 45,
                    "cohesion": "1 GPa",
                    "tensile_strength": "1 GPa",
                }
            ],
        },
        loads={"gravity": [GRAVITY * np.sin(slope), 0, -GRAVITY * np.cos(slope)]},
        stages=[
            {
                "name": "slide",
                "mode": "dynamic",
                "duration": 9,
                "damping": {"contact": 0.1, "stiffness": 0.2},
            }
        ],
        model={"split": {"bed": "elements"}},
    )
    times, speeds = [], []
    while sim.time < 0.4:
        sim.step(100)
        if sim.time > 0.1:
            times.append(sim.time)
            speeds.append(mean_velocity(sim, "block")[0])
    theory = GRAVITY * (np.sin(slope) - np.cos(slope) * np.tan(np.radians(phi)))
    assert np.polyfit(times, speeds, 1)[0] == pytest.approx(theory, rel=2e-6)
    assert len(sim.core.fields()["edge.contact"]) == 0
