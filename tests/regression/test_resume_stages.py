"""A run that is stopped at the end or in the middle of any stage goes on to the same bytes."""

import h5py
import pytest
from shared.stopped import StagesOf, content

from cdem import Case, Simulation

ROCK = {"density": 2600, "young_modulus": "2 GPa", "poisson_ratio": 0.2}
DOWN = [0, 0, -9.81]


def box(group, size, at=(0, 0, 0), **more):
    """A box of a group."""
    return {"group": group, "box": {"size": list(size), **more}, "translate": list(at)}


def held(low, high, axes):
    """A support of all nodes in a box."""
    return {"box": {"min": list(low), "max": list(high)}, "fix": axes}


def on_ground(blocks, stages, **more):
    """Blocks of group `block` on held ground."""
    return {
        "cdem": 2,
        "model": {"blocks": blocks},
        "materials": {"r": dict(ROCK)},
        "groups": {"ground": {"material": "r", "fix": ["x", "y", "z"]}, "block": {"material": "r"}},
        "interfaces": {
            "default": {"friction_angle": 35},
            "pairs": [{"between": ["ground", "block"], "name": "base", "friction_angle": 20}],
        },
        "loads": {"gravity": DOWN},
        "output": {"every": 0.02},
        "stages": stages,
    } | more


def dynamic(name, duration=0.06, **more):
    return {"name": name, "mode": "dynamic", "duration": duration} | more


def static(name, steps=100, **more):
    """By steps alone, so that there are enough to stop in their middle."""
    way = {"relax": "adaptive", "tolerance": 1e-3, "max_steps": steps}
    return {"name": name, "mode": "static"} | way | more


def dam():
    """Water that rises while a static stage runs, and the load of a curve."""
    case = on_ground(
        [box("ground", [6, 6, 1], [0, 0, -1], divisions=[2, 2, 1]),
         box("block", [2, 2, 3], [2, 2, 0], divisions=[2, 2, 2], shape="tet4")],
        [static("rest"), dynamic("fill"), static("stand", set={"interfaces.base.friction_angle": 40})],
        water={
            "fields": [{"name": "up", "interface": "base", "formula": "9810*3*max(0,1-(x-2)/2)",
                        "history": [[0, 0], [0.05, 1]], "stage": "rest"}],
            "reservoir": {"box": {"min": [-1, -1, -1], "max": [2.01, 9, 9]},
                          "level": [[0, 0], [0.05, 3]], "stage": "rest"},
        },
    )  # fmt: skip
    case["loads"]["tractions"] = [
        {"surface": {"group": "block", "normal": [0, 0, 1]}, "traction": [2000, 0, 0],
         "history": [[0, 0], [0.03, 1], [0.05, 0.2]], "stage": "rest"}
    ]  # fmt: skip
    return case


def shaken():
    """Curves and surface laws that count from stages: static ones, and those with what comes and goes."""
    wait = {"history": [[0, 0.2], [0.013, 1], [0.03, 0.5], [0.07, 0]]}
    case = on_ground(
        [box("ground", [6, 6, 1], [0, 0, -1], divisions=[2, 2, 1]),
         box("block", [2, 2, 3], [2, 2, 0], divisions=[2, 2, 2], shape="tet4"),
         box("fill", [1, 2, 1], [4, 2, 0])],
        [static("rest"), dynamic("go", 0.0301), static("dig", remove=["fill"]),
         dynamic("shake", 0.0402, set={"interfaces.base.friction_angle": 40}),
         dynamic("back", 0.05, add=["fill"])],
        water={
            "fields": [{"interface": "base", "level": [[0, 1], [0.02, 2]], "stage": "go"} | wait],
            "reservoir": {"box": {"min": [-1, -1, -1], "max": [2.01, 9, 9]}, "stage": "rest",
                          "level": [[0, 0], [0.003, 1], [0.05, 3]]},
        },
    )  # fmt: skip
    case["groups"]["fill"] = {"material": "r"}
    case["loads"]["tractions"] = [
        {"surface": {"group": "block", "normal": [0, 0, 1]}, "traction": [2000, 0, 0]}
        | wait | {"stage": stage} for stage in ("dig", "shake", "back")
    ]  # fmt: skip
    case["loads"]["velocities"] = [
        {"surface": {"group": "ground", "normal": [0, 0, -1]}, "velocity": [0.3, 0, 0],
         "components": ["x"], "stage": "shake", "history": [[0, 0], [0.01, 1], [0.02, 0]]}
    ]  # fmt: skip
    case["loads"]["surfaces"] = [
        {"surface": {"group": "fill", "normal": [0, 0, 1]}, "pressure": "5 kPa"},
        {"surface": {"group": "block", "normal": [1, 0, 0]}, "pressure": "9 kPa", "stage": "go"}
        | wait,
    ]
    case["boundaries"] = [
        {"name": "side", "surface": {"group": "block", "normal": [0, 1, 0]}, "quiet": True,
         "stage": "back"},
    ]  # fmt: skip
    return case


def bolted():
    """Bolts that come and go."""
    bolt = {"plate": True, "points": [[2.6, 2.1, 3], [2.9, 2.1, 0.6]], "type": "b"}
    return on_ground(
        [box("ground", [6, 4, 2], divisions=[3, 2, 1], shape="tet4"),
         box("block", [2, 2, 1], [2, 1, 2], divisions=[2, 2, 1], shape="tet4")],
        [static("rest"), dynamic("hold"), dynamic("go")],
        bolt_types={
            "a": {"area": "900 mm2", "compressive_force": 0, "yield_force": "1.4 MN",
                  "young_modulus": "195 GPa",
                  "grout": {"stiffness": "110 MN/m2", "strength": "0.3 MN/m"}},
            "b": {"area": "491 mm2", "dowel": True, "rupture_strain": 0.1, "yield_force": "30 kN",
                  "young_modulus": "200 GPa",
                  "grout": {"stiffness": "110 MN/m2", "strength": "0.05 MN/m"}},
        },
        bolts=[
            bolt | {"name": "p", "remove": "go"},
            {"name": "q", "install": "hold", "free_length": "1.2 m", "plate": True, "type": "a",
             "points": [[3.3, 1.7, 3], [3.0, 1.7, 0.5]], "pretension": "20 kN"},
        ],
        histories=[{"bolt": "q", "name": "q", "quantities": ["axial_force", "slip", "plate_force"]}],
        loads={"gravity": [6, 0, -7.5]},
    )  # fmt: skip


def dug(stages):
    """A tunnel in rock under stress, with a joint."""
    around = [[x, 0, z] for x in (-4, 0, 4) for z in (-4, 0, 4) if (x, z) != (0, 0)]
    return {
        "cdem": 2,
        "model": {
            "blocks": [box("tunnel", [4, 2, 4], divisions=[2, 1, 2])]
            + [box("rock", [4, 2, 4], at) for at in around],
            "joints": [{"dip": 60, "dip_direction": 90, "group": "rock", "name": "e",
                        "origin": [3.6, 0, 4], "spacing": 4}],
        },
        "materials": {"r": dict(ROCK), "concrete": {**ROCK, "young_modulus": "5 GPa"}},
        "groups": {"rock": {"material": "r"}, "tunnel": {"material": "r"}},
        "initial_stress": [{"k0": [0.4, 0.5], "surface": "58 m", "vertical": "overburden"}],
        "interfaces": {
            "default": {"cohesion": "5 MPa", "friction_angle": 45, "tensile_strength": "3 MPa"},
            "pairs": [{"friction_angle": 25, "joint": "e", "name": "e"}],
        },
        "loads": {"gravity": DOWN, "supports": [
            held([-5, -1, -4.001], [9, 3, -3.999], ["z"]),
            held([-4.001, -1, -5], [-3.999, 3, 9], ["x"]),
            held([7.999, -1, -5], [8.001, 3, 9], ["x"]),
            held([-5, -0.001, -5], [9, 0.001, 9], ["y"]),
            held([-5, 1.999, -5], [9, 2.001, 9], ["y"])]},
        "output": {"every": 0.02},
        "stages": stages,
    }  # fmt: skip


def tunnel():
    """What is dug out lets go in parts, over time, and at once."""
    return dug([
        static("in"),
        static("dig", remove=["tunnel"], release={"parts": 2, "to": 0.5}, reset_displacement=True),
        dynamic("open", release={"over": 0.03}),
        static("last", release={"to": 1}),
    ])  # fmt: skip


def blown():
    """What is dug out lets go at once while the rock moves."""
    return dug([static("in"), dynamic("dig", 0.02, remove=["tunnel"]), dynamic("on", 0.02)])


def lining():
    """A lining that comes in while the rock still bears a part."""
    return dug([
        static("in"),
        static("dig", remove=["tunnel"], release={"to": 0.5}),
        static("line", add=["tunnel"], set={"groups.tunnel.material": "concrete"}),
        static("load", release={"to": 1}),
    ])  # fmt: skip


def soft():
    """Bonds that soften and break, a bed that asks for areas, blocks that leave the domain, maps."""
    case = on_ground(
        [box("ground", [6, 4, 1], [0, 0, -1], divisions=[3, 2, 1]),
         box("block", [1, 2, 2], [4.2, 1, 0.05], divisions=[1, 2, 2], shape="tet4")],
        [static("rest", 60), dynamic("slide", 0.3), dynamic("fall", 0.3)],
        loads={"gravity": [9, 0, -6]},
        output={"every": 0.05, "maps": {"cell": "0.5 m"}},
    )  # fmt: skip
    case["model"]["split"] = {"block": "elements"}
    case["model"]["domain"] = {"min": [-1, -1, -3], "max": [6, 5, 5]}
    case["groups"]["block"]["velocity"] = [6, 0, 0]
    case["interfaces"]["pairs"][0] |= {"law": "voellmy", "turbulence": 300, "flow_density": 2000}
    case["interfaces"]["pairs"].append(
        {"between": ["block", "block"], "friction_angle": 30, "cohesion": "20 kPa",
         "tensile_strength": "5 kPa", "law": "softening", "fracture_energy_1": 5,
         "fracture_energy_2": 20}
    )  # fmt: skip
    return case


def yielding():
    """Rock that flows, with nodal means, pressed into the ground."""
    case = on_ground(
        [box("ground", [4, 4, 1], [0, 0, -1], divisions=[2, 2, 1]),
         box("block", [2, 2, 2], [1, 1, 0], divisions=[2, 2, 2], shape="tet4")],
        [static("rest"), dynamic("press", 0.04), static("stand", 200)],
    )  # fmt: skip
    case["materials"]["soil"] = {"density": 2000, "young_modulus": "50 MPa", "poisson_ratio": 0.3,
                                 "law": "mohr-coulomb", "friction_angle": 20,
                                 "cohesion": "5 kPa"}  # fmt: skip
    case["groups"]["block"] = {"material": "soil"}
    case["loads"]["tractions"] = [
        {"surface": {"group": "block", "normal": [0, 0, 1]}, "traction": [0, 0, "-20 kPa"]}
    ]
    return case


def quake():
    """Ground at rest that is shaken between quiet sides and a free field, held, and shaken again."""

    def face(*normal):
        return {"surface": {"group": "block", "normal": list(normal)}}

    case = on_ground(
        [box("block", [4, 4, 2], divisions=[4, 2, 2]),
         box("block", [4, 4, 2], [0, 0, 2], divisions=[4, 2, 2])],
        [static("rest"), dynamic("shake", 0.03, damping={"maxwell": {"ratio": 0.03, "band": [2, 99]}}),
         static("stand", 40),
         dynamic("again", 0.02, damping={"rayleigh": {"ratio": 0.03, "frequency": 20}})],
        records={"r": {"samples": [0, 1, 3, 1, -2, -4, -1, 1, 3, 1, 0, -1, 0], "step": 0.003,
                       "unit": "m/s", "scale": 0.02}},
        waves={"allow_coarse": True},
    )  # fmt: skip
    del case["groups"]["ground"], case["interfaces"]["pairs"]
    case["loads"]["supports"] = [
        face(0, 0, -1) | {"fix": ["x", "y", "z"]},
        *(face(s, 0, 0) | {"fix": ["x"]} for s in (-1, 1)),
        *(face(0, s, 0) | {"fix": ["y"]} for s in (-1, 1)),
    ]
    given = {"record": "r", "direction": [2, 0, 1]}
    case["boundaries"] = [
        face(0, 0, -1) | {"name": "base", "quiet": True, "stage": "shake", "input": given},
        face(-1, 0, 0) | {"name": "west", "free_field": {"base": "base"}, "stage": "shake"},
        face(1, 0, 0) | {"name": "east", "quiet": True, "stage": "shake"},
        face(0, 1, 0) | {"name": "north", "quiet": True, "stage": "again"},
    ]
    return case


SCENES = {
    f.__name__: f for f in (dam, shaken, bolted, tunnel, blown, lining, soft, yielding, quake)
}
SLOW = ("dam", "tunnel", "lining", "soft", "yielding")
"""What "dam" has is in "shaken" too: a reservoir, water in a joint and a load that rise in stages."""


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in SCENES]
)
def test_a_run_goes_on_from_every_stage_to_the_same_bytes(name, tmp_path):
    """Frames, histories, maps and summary are those of the unbroken run: killed at any stage's end."""
    runs = StagesOf(SCENES[name](), tmp_path)
    for where, leave in runs.stops():
        assert runs.differing(leave) == [], where


def test_a_run_that_stops_shows_where_it_is(tmp_path):
    """Its last frame is of the moment of the stop; going on in the same process drops it."""
    runs = StagesOf(SCENES["dam"](), tmp_path)
    simulation = Simulation(Case.load(runs.case), output=tmp_path / "broken", threads=1)
    simulation.run_stage("rest")
    left = iter([False, False, True])
    assert simulation.run(should_stop=lambda: next(left)) == "stopped"
    with h5py.File(tmp_path / "broken/frames.vtkhdf") as file:
        assert file["VTKHDF/Steps/Values"][-1] == simulation.time
    simulation.run()
    assert content(tmp_path / "broken") == runs.whole
