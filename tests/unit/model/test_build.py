"""Which arrays of the core a stage hands over: pinned by name, for stages of every kind."""

import pytest
from scenes import case

import cdem
from cdem.model.build import change

OF_WATER = ("water.", "wet_")
"""Arrays of water, of which a dry case hands over none, or empty ones."""
BOX = [{"group": "a", "box": {"size": [2, 2, 2]}}]
TWO = BOX + [{"group": "b", "box": {"size": [2, 2, 2]}, "translate": [2, 0, 0]}]
FALL = {"loads": {"gravity": [0, 0, -9.81]}}
STAGES = [{"name": "one", "mode": "static"}, {"name": "two", "mode": "dynamic", "duration": 1.0}]
"""Two stages, of which the second changes something."""


def second(**more):
    """The stages, the second with more keys."""
    return [STAGES[0], STAGES[1] | more]


def weight():
    """Gravity alone."""
    return case(BOX, {"a": {}}, stages=second(), **FALL)


def traction():
    """A load that follows a curve."""
    load = {"surface": {"group": "a", "normal": [0, 0, 1]}, "traction": [0, 0, -1e5],
            "history": [[0, 0], [0.5, 1]], "stage": "two"}  # fmt: skip
    return case(BOX, {"a": {"fix": ["x"]}}, stages=second(), loads={"tractions": [load]})


def rising_water():
    """A reservoir that rises around two bonded blocks with pores."""
    reservoir = {"level": [[0, 0], [0.5, 1.5]], "stage": "two"}
    bonded = {"default": {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}}
    return case(
        TWO, {"a": {"fix": ["x", "y", "z"]}, "b": {}}, stages=second(), rock={"biot": 0.7},
        interfaces=bonded, water={"reservoir": reservoir}, **FALL,
    )  # fmt: skip


def bolts():
    """A bolt that the second stage installs."""
    bar = {"area": 5e-4, "young_modulus": 2e11, "yield_force": 2e5,
           "grout": {"stiffness": 1e8, "strength": 2e5}}  # fmt: skip
    bolt = {
        "name": "b",
        "type": "bar",
        "points": [[0.5, 0.9, 1.1], [3.7, 0.9, 1.1]],
        "install": "two",
    }
    return case(
        TWO, {"a": {"fix": ["x", "y", "z"]}, "b": {}}, stages=second(),
        bolt_types={"bar": bar}, bolts=[bolt],
    )  # fmt: skip


def backfill():
    """A group that is dug out and comes back."""
    stages = [*second(remove=["b"]), {"name": "three", "mode": "static", "add": ["b"]}]
    return case(TWO, {"a": {"fix": ["x", "y", "z"]}, "b": {}}, stages=stages, **FALL)


def materials():
    """Weak rock whose cohesion the second stage lowers."""
    weak = {"law": "mohr-coulomb", "friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e5}
    stages = second(set={"materials.rock.cohesion": 1e5})
    return case(BOX, {"a": {}}, stages=stages, rock=weak, **FALL)


CASES = {
    make.__name__: make for make in (weight, traction, rising_water, bolts, backfill, materials)
}


@pytest.fixture(scope="module", params=CASES)
def built(request):
    """The build of each case, as its second stage has it."""
    sim = cdem.Simulation(CASES[request.param](), threads=1)
    for path, value in sim.case.stages[1].set.items():
        sim.case.set(path, value)
    return sim.build


ALWAYS = """
load.curve load.first load.force
mass.inverse mass.matrix material.lambda material.mu material.parameters
node.block node.block_count node.block_first node.frequency_squared node.gravity_mass
node.inverse_mass_bound node.least_mass node.lumped_frequency_squared node.mass
node.mass_axis_stride node.mass_row_first node.place
overlaps.stiffness overlaps.strength quads.stiffness quads.strength triangles.stiffness
triangles.strength
support.component support.curve support.row support.velocity
"""
"""What every stage hands over that sets anything."""
WATER = """
water.biot water.field_curve water.fields water.node_field water.node_kept
wet_quads.aperture wet_quads.bonded wet_quads.face wet_quads.joint wet_quads.kept wet_quads.mate
wet_quads.nodes wet_quads.open wet_quads.pair wet_quads.pair_first
wet_triangles.aperture wet_triangles.bonded wet_triangles.face wet_triangles.joint
wet_triangles.kept wet_triangles.mate wet_triangles.nodes wet_triangles.open wet_triangles.pair
wet_triangles.pair_first
"""
PLACES = """
face.area face.height face.length face.radius face.reach face.stiffness
hex8.gradient hex8.hourglass hex8.material hex8.volume
pyramid5.gradient pyramid5.hourglass pyramid5.material pyramid5.volume
tet4.gradient tet4.hourglass tet4.material tet4.volume
wedge6.gradient wedge6.hourglass wedge6.material wedge6.volume
material.law
overlaps.area quads.area triangles.area
"""
"""What follows besides where groups come in."""


def handed_over(built, **how):
    """Names of the arrays that a stage hands over; without those of water in a dry case."""
    dry = built.case.water is None
    return {key for key in change(built, **how) if not (dry and key.startswith(OF_WATER))}


def test_a_stage_hands_over_what_it_may_change(built):
    always = ALWAYS + (WATER if built.case.water is not None else "")
    assert handed_over(built) == set(always.split())
    assert handed_over(built, places=True) == set((always + PLACES).split())
