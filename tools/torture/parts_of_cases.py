"""Small cases that together name every field of the schema, and every law."""

from __future__ import annotations

import math
from typing import Any

SOLID = """\
cdem: 2
title: Rock with water, bolts and stress of every kind
units: SI
crs: EPSG:32632
model:
  blocks:
    - {group: low, box: {size: [4, 2, 1], divisions: [2, 1, 1]}}
    - {group: rock, box: {size: [4, 2, 2], divisions: [2, 1, 1], shape: tet4, cells: alike}, translate: [0, 0, 1]}
    - {group: late, box: {size: [1, 1, 1]}, translate: [1, 0, 3],
       rotate: {axis: [0, 0, 1], angle: 0, origin: [0, 0, 0]}}
    - {group: plug, polyhedron: {vertices: [[9, 0, 0], [10, 0, 0], [9, 1, 0], [9, 0, 1]],
       faces: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]}}
    - {group: plug, file: cube.obj, scale: 0.5, translate: [12, 0, 0]}
  split: {low: one, rock: connected, plug: elements}
  rotate: {axis: [0, 0, 1], angle: 0}
  translate: [0, 0, 0]
  domain: {min: [-9, null, -9], max: [30, 30, 30]}
materials:
  stiff: {density: 2700, saturated_density: 2750, young_modulus: 1 GPa, poisson_ratio: 0.25, biot: 1}
  soft: {density: 2500, young_modulus: 1 GPa, poisson_ratio: 0.3, law: mohr-coulomb,
    cohesion: 1 MPa, friction_angle: 30, tensile_strength: 0.5 MPa, dilation_angle: 5,
    softening: {cohesion: [[0, 1 MPa], [1, 0]], friction_angle: [[0, 30], [1, 25]],
      dilation_angle: [[0, 5], [1, 0]], fracture_energy: 1e5}}
  weak: {density: 2500, young_modulus: 1 GPa, poisson_ratio: 0.3, law: ubiquitous-joint,
    cohesion: 1 MPa, friction_angle: 30, joint_dip: 30, joint_dip_direction: 90,
    joint_cohesion: 1e5, joint_friction_angle: 20, joint_dilation_angle: 2,
    joint_tensile_strength: 1e4,
    softening: {tensile_strength: [[0, 1 MPa], [1, 0]], joint_cohesion: [[0, 1e5], [1, 0]],
      joint_friction_angle: [[0, 20], [1, 10]], joint_dilation_angle: [[0, 2], [1, 0]],
      joint_tensile_strength: [[0, 1e4], [1, 0]]}, tensile_strength: 1 MPa}
  broken: {density: 2500, young_modulus: 1 GPa, poisson_ratio: 0.3, law: hoek-brown,
    uniaxial_strength: 50 MPa, mb: 1, s: 0.01, a: 0.5}
groups:
  low: {material: stiff, fix: [x, y, z], gravity: false}
  rock: {material: soft}
  late: {material: weak}
  plug: {material: weak, velocity: [0.1, 0, 0], angular_velocity: [0, 0, 1]}
interfaces:
  default: {friction_angle: 30, stiffness_n: auto, stiffness_s: 2 E/h,
    contact_stiffness: {overlap: 0.01, impact: 0.02, speed: 1},
    restitution: {normal: 0.5, tangential: 0.9}, rolling_resistance: 0.1}
  pairs:
    - {between: [low, rock], name: base, cohesion: 1e5, tensile_strength: 1e4,
       heterogeneity: {weibull: 5, seed: 1}, restitution: 0.9, contact_stiffness: 1e9}
initial_stress:
  - {vertical: overburden, surface: 50, k0: [0.5, 0.7], azimuth: 30}
  - {groups: [rock], stress: [-1e5, -1e5, -2e5, 0, 0, 0], origin: [0, 0, 3],
     gradient: {x: [0, 0, 0, 0, 0, 0], y: [0, 0, 0, 0, 0, 0], z: [1e4, 1e4, 2e4, 0, 0, 0]}}
  - {box: {min: [0, 0, 0], max: [9, 9, 1]}, principal: {values: [-1e5, -2e5, -3e5],
     trends: [0, 90, 0], plunges: [0, 0, 90]}}
water:
  density: 1000
  fields:
    - {name: table, groups: [rock], plane: {point: [0, 0, 2], dip: 10, dip_direction: 90},
       seepage: parallel, lift: 0.1, history: [[0, 0], [1, 1]], stage: on, wet: always, aperture: 0.01}
    - {interface: base, level: [[0, 1], [1, 2]], wet: broken}
    - {groups: [late], formula: "9810 * max(0, 4 - z)"}
    - {groups: [plug], ru: 0.2}
    - {groups: [low], table: pressures.csv}
  reservoir: {level: [[0, 1], [1, 3]], box: {min: [-1, -1, -1], max: [0.1, 9, 9]}}
bolt_types:
  bar: {area: 5 cm2, young_modulus: 200 GPa, yield_force: 200 kN, compressive_force: 10 kN,
    rupture_strain: 0.1, grout: {stiffness: 1e8, strength: 1e5},
    dowel: {stiffness: 1e7, strength: 1e5}}
bolts:
  - {name: one, type: bar, points: [[1, 1, 3], [1, 1, 0.5]], free_length: 0.5, plate: true,
     anchor: {stiffness: 1e8, strength: 1e5}, pretension: 10 kN, install: dig, remove: end}
  - {name: grid, type: bar, pattern: {surface: {group: rock, normal: [0, 0, 1]}, spacing: [1.5, 1],
     length: 2, direction: [0, 0, -1], box: {min: [-9, -9, -9], max: [9, 9, 9]}}, plate: {stiffness: 1e8, strength: 1e5}}
  - {name: ring, type: bar, rings: {axis: [[2, 0, 2], [2, 2, 2]], spacing: 1, count: 3,
     angles: [90, 270], inside: late, length: 0.8}}
records:
  file: {file: wave.csv, kind: velocity, scale: 0.5, band: [1 Hz, 20 Hz], baseline: cubic}
  listed: {samples: [0, 1, 3, 2, 0, -1, -2, -1, 0, 0, 0, 0], step: 1 ms, unit: cm/s2, baseline: none}
loads:
  gravity: [0, 0, -9.81]
  tractions: [{surface: {group: rock, normal: [0, 0, 1]}, traction: [0, 0, -1e4],
    history: [[0, 0], [1, 1]], stage: rest}]
  blasts:
    - {surface: {group: late, normal: [0, 0, 1]}, stage: on, delay: 1e-3, pressure: {peak: 1e4, rise: 1, fall: 2},
       detonation: {from: [0, 0, 3], speed: 4000}}
    - {surface: {group: late, normal: [0, 0, 1]}, stage: on, pressure: {table: [[0, 0], [1, 1e4]]}}
    - {surface: {group: late, normal: [0, 0, 1]}, stage: on,
       pressure: {friedlander: {peak: 1e4, duration: 1, decay: 1, suction: true}}}
    - {surface: {group: late, normal: [0, 0, 1]}, stage: on, pressure: {rise: 1, fall: 2},
       explosive: {density: 850, speed: 4000, diameter: 0.05, hole: 0.089}}
  velocities:
    - {group: plug, velocity: [0.1, 0, 0], components: [x], history: [[0, 0], [1, 1]]}
    - {point: [0, 0, 3], velocity: [0, 0, 0]}
    - {point: [4, 2, 3], velocity: [1, 0, 0], record: file, stage: end}
    - {box: {min: [3.9, -1, 2.9], max: [9, 9, 3.1]}, velocity: [0, 0, 0]}
    - {surface: {group: late, normal: [0, 0, 1]}, velocity: [0, 0, 0]}
  supports:
    - {surface: {group: rock, normal: [1, 0, 0]}, fix: [x]}
    - {point: [0, 0, 1], group: rock, fix: [y]}
    - {box: {min: [0, 0, 0], max: [0.1, 9, 9]}, fix: [x, y]}
stages:
  - {name: rest, mode: static, tolerance: 1e-4, relax: kinetic, max_steps: 100,
     damping: {local: 0.5, mass: 0, stiffness: 0.01, contact: 0.1}}
  - {name: dig, mode: static, remove: [rock], release: {parts: 3, to: 0.5}, add: [late],
     reset_displacement: true}
  - {name: on, mode: dynamic, duration: 0.01, release: {over: 0.005, to: 1}}
  - {name: end, mode: dynamic, duration: 1, until: rest, set: {interfaces.base.friction_angle: 20}}
contact: {indentation: 0.01, tolerance: 0.001, refresh: 50, action: indented, edges: false,
  bond_points: quadrature, check: true}
elements: {formulation: corotational, mass: lumped, hexahedra: one-point, tetrahedra: full,
  strain_limit: 0.3}
waves: {allow_coarse: true}
time: {step: auto, safety: 0.7, mass_scaling: {most: 0.01, step: 1e-4}, energy_error: any}
output: {every: 0.001, fields: [displacement, velocity], checkpoint_every: 100, frames: false,
  maps: {cell: 0.5, groups: [plug]}}
histories:
  - {name: a, group: plug, quantities: [centroid, displacement, velocity, energy, force, water_force]}
  - {name: b, point: [0, 0, 3], quantities: [displacement]}
  - {name: c, bolt: one, quantities: [axial_force, slip, plate_force]}
"""
JOINTS = """\
model:
  blocks: [{group: a, box: {size: [2, 2, 2]}}, {group: b, box: {size: [2, 2, 2]}, translate: [9, 0, 0]},
    {group: b, file: cube.stl, size: 1, translate: [15, 0, 0]}]
  joints:
    - {name: planes, group: a, dip: 40, dip_direction: 90, spacing: 1.5, origin: [0, 0, 0],
       persistence: 0.8, scatter: {fisher: 100}, seed: 3}
    - {name: few, group: b, normal: [1, 0, 0.2], discs: {count: 2, radius: 0.8}, bridge: rock}
    - {name: uniform, group: b, dip: 0, dip_direction: 0, seed: 2, scatter: {fisher: 200},
       discs: {density: 0.1, radius: {uniform: {min: 0.3, max: 0.8}}}}
    - {name: power, group: b, dip: 10, dip_direction: 0,
       discs: {count: 2, radius: {power: {min: 0.3, max: 0.8, exponent: 3}}}}
    - {name: log, group: b, dip: 90, dip_direction: 0,
       discs: {count: 1, radius: {lognormal: {mean: 0.5, deviation: 0.2, max: 1}}}}
    - {name: read, discs: {file: discs.csv}}
  thinnest: 0.05
materials: {rock: {density: 2700, young_modulus: 1 GPa, poisson_ratio: 0.25}}
groups: {a: {material: rock}, b: {material: rock}}
interfaces:
  default: {friction_angle: 30}
  pairs: [{joint: rock, cohesion: 1e6, tensile_strength: 1e5}, {joint: planes, name: wet, friction_angle: 20}]
loads: {gravity: [0, 0, -9.81]}
water: {fields: [{surface: heights.asc, lift: 1, interface: wet}]}
stages: [{name: d, mode: dynamic, duration: 0.01}]
"""
WAVES = """\
model:
  blocks:
    - {group: rock, box: {size: [4, 2, 4], divisions: [2, 1, 2]}}
    - {group: table, box: {size: [1, 1, 1]}, translate: [20, 0, 0]}
materials: {rock: {density: 2500, young_modulus: 1 GPa, poisson_ratio: 0.25}}
groups: {rock: {material: rock}, table: {material: rock}}
interfaces: {default: {friction_angle: 30}}
records:
  motion: {file: wave.csv, kind: velocity, band: [1 Hz, 20 Hz], baseline: cubic}
boundaries:
  - {name: base, surface: {group: [rock], normal: [0, 0, -1]}, quiet: true, stage: shake,
     input: [{record: motion, direction: [1, 0, 0], kind: compliant, motion: outcrop},
       {record: motion, direction: [0, 0, 1], motion: upgoing}]}
  - {name: west, surface: {group: rock, normal: [-1, 0, 0]}, free_field: {base: base}, stage: shake}
  - {name: east, surface: {group: rock, normal: [1, 0, 0]}, free_field: {base: base}, stage: shake}
  - {name: far, surface: {group: rock, normal: [0, 1, 0]}, quiet: true, stage: again}
  - {name: floor, surface: {group: table, normal: [0, 0, -1]}, stage: shake,
     input: {record: motion, direction: [0, 1, 0], kind: rigid}}
loads:
  gravity: [0, 0, -9.81]
  supports:
    - {surface: {group: rock, normal: [0, 0, -1]}, fix: [x, y, z]}
    - {surface: {group: table, normal: [0, 0, -1]}, fix: [x, y, z]}
    - {surface: {group: rock, normal: [1, 0, 0]}, fix: [x]}
    - {surface: {group: rock, normal: [-1, 0, 0]}, fix: [x]}
stages:
  - {name: rest, mode: static, max_steps: 50}
  - {name: shake, mode: dynamic, duration: 2, damping: {rayleigh: {ratio: 0.05, frequency: 3 Hz, part: mass}}}
  - {name: again, mode: dynamic, duration: 0.01,
     damping: {maxwell: {ratio: 0.05, band: [0.5 Hz, 20 Hz], reference: static}}}
histories:
  - {name: base, boundary: base, quantities: [v_base, v_up, v_down], every: 1 ms}
  - {name: crest, point: [0, 0, 4], quantities: [velocity, acceleration]}
"""
FIT = """\
# Which frictions made this deposit?
fit: 1
title: a fit
study: study.yaml
seed: 3
observed:
  - {outline: {file: mapped.gpkg, layer: affected}, deviation: "4 m", length: 30}
  - {thickness: deposit.tif, deviation: "0.5 m"}
  - {front: front.csv, deviation: "2 m"}
  - {runout: deposit.length, value: 90.5, deviation: 2}
  - {result: travel, value: 44, deviation: 1}
"""
"""A fit with observations of every kind."""
BESIDE = {
    "pressures.csv": "x,y,z,pressure\n0,0,0,1e4\n9,0,0,1e4\n0,9,0,1e4\n0,0,9,0\n9,9,9,0\n",
    "factor.csv": "time [ms], factor [%]\n0, 0\n5, 100\n",
    "wave.csv": "time [s], velocity [cm/s]\n"
    + "".join(f"{0.02 * i:.2f}, {math.sin(0.6 * i):.3f}\n" for i in range(64)),
    "discs.csv": "x,y,z,dip,dip_direction,radius\n1,1,1,30,90,1\n",
    "study.yaml": "case: cube.yaml\nparameters: {materials.rock.density: [2600, 2700]}\n",
    "heights.asc": "ncols 3\nnrows 3\nxllcorner -5\nyllcorner -5\ncellsize 10\n" + "1 1 1\n" * 3,
}
"""Small files that the cases name."""
USUAL = {"deg": 25, "Pa": 1e5, "1": 1, "m": 0.01, "J/m2": 50, "m/s": 1, "m/s2": 500, "kg/m3": 2000}
"""Values of parameters by unit."""
OF_LAWS: dict[str, dict[str, Any]] = {
    "hoek-brown": {"uniaxial_strength": 5e7, "gsi": 50, "mi": 10, "disturbance": 0.5},
    "residual": {"residual_cohesion": 1e4},
    "softening": {"residual_cohesion": 1e4},
    "barton-bandis": {"jrc": 8, "jcs": 5e7, "uniaxial_strength": 6e7, "aperture": 1e-4},
    "continuously-yielding": {"initial_friction_angle": 45},
}
"""Values that the usual ones do not suit."""
IN_PARTS = {"mb", "s", "a"}
"""Parameters that do not go with others of their law: `SOLID` has them."""


def of_laws() -> dict[str, dict[str, Any]]:
    """A case for each law, by its name: every parameter is given."""
    from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS
    from cdem.case.surface_schema import OF_ENTRIES

    found = {}
    for laws, place, name in (
        (BLOCK_LAWS, "materials", "rock"),
        (INTERFACE_LAWS, "interfaces", "default"),
    ):
        for law in laws.values():
            case = _two_blocks()
            if laws is INTERFACE_LAWS:
                case["interfaces"]["default"] = {}
            case[place][name] |= {"law": law.name}
            case[place][name] |= {
                p.name: _value(p) for p in law.parameters if p.name not in IN_PARTS
            }
            case[place][name] |= OF_LAWS.get(law.name, {})
            found[law.name] = case
    for law in OF_ENTRIES.values():
        case = _two_blocks()
        entry = {"surface": {"group": "high", "normal": [0, 0, 1]}, "law": law.name}
        entry |= {p.name: _value(p) for p in law.parameters}
        named = entry | {"history": {"file": "factor.csv"}, "stage": "move"}
        case["loads"] = case.get("loads", {}) | {"surfaces": [entry, named]}
        found[law.name] = case
    return found


def _value(parameter: Any) -> Any:
    """A usual value of a parameter, of a word the first."""
    if parameter.choices:
        return parameter.choices.split()[0]
    default = parameter.default
    return default if default and math.isfinite(default) else USUAL[parameter.unit]


def _two_blocks() -> dict[str, Any]:
    blocks = [
        {"group": "low", "box": {"size": [2, 2, 1]}},
        {"group": "high", "box": {"size": [1, 1, 1], "shape": "tet4"}, "translate": [0, 0, 1]},
    ]
    stages: list[dict[str, Any]] = [
        {"name": "rest", "mode": "static", "max_steps": 10},
        {"name": "move", "mode": "dynamic", "duration": 0.01},
    ]
    return {
        "model": {"blocks": blocks},
        "materials": {"rock": {"density": 2600, "young_modulus": 1e9, "poisson_ratio": 0.25}},
        "groups": {
            "low": {"material": "rock", "fix": ["x", "y", "z"]},
            "high": {"material": "rock"},
        },
        "interfaces": {"default": {"friction_angle": 30}},
        "loads": {"gravity": [0, 0, -9.81]},
        "stages": stages,
    }
