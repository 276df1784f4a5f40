"""Scenes of several stages whose whole state is pinned: damping, water, excavation, flow, a domain."""

from __future__ import annotations

import hashlib
import json

import numpy as np
import yaml

import cdem

SOAKED = """
title: A bonded dam on a held bed; its reservoir rises, water in the base joint and in pores
model:
  blocks:
    - {group: ground, box: {size: [6, 4, 1], divisions: [3, 2, 1]}, translate: [0, 0, -1]}
    - {group: dam, box: {size: [2, 2, 3], divisions: [2, 2, 2], shape: tet4}, translate: [2, 1, 0]}
  split: {dam: elements}
materials: {r: {density: 2600, poisson_ratio: 0.2, young_modulus: 0.2 GPa, biot: 0.6}}
groups: {dam: {material: r}, ground: {material: r, fix: [x, y, z]}}
interfaces:
  default: {friction_angle: 35, cohesion: 40 kPa, tensile_strength: 10 kPa}
  pairs: [{between: [ground, dam], friction_angle: 30, name: base}]
loads: {gravity: [0, 0, -9.81]}
water:
  fields:
    - {interface: base, name: up, formula: "9810 * 3 * max(0, 1 - (x - 2) / 2)",
       history: [[0, 0], [0.05, 1]], stage: fill}
  reservoir: {box: {min: [-1, -1, -1], max: [2.01, 9, 9]}, level: [[0, 0], [0.05, 3]], stage: fill}
stages:
  - {name: rest, mode: static, relax: adaptive, tolerance: 0.01}
  - {name: fill, mode: dynamic, duration: 0.08, damping: {local: 0.1}}
"""

DUG = """
title: A room is dug, let go over time and lined; bolts hold its roof, one is cut
model:
  blocks:
    - {group: room, box: {size: [2, 2, 2]}}
    - {group: spare, box: {size: [2, 2, 2]}, translate: [2, 0, 0]}
    - {group: rock, box: {size: [2, 2, 2]}, translate: [-2, 0, 0]}
    - {group: rock, box: {size: [2, 2, 2]}, translate: [4, 0, 0]}
    - {group: roof, box: {size: [8, 2, 2], divisions: [4, 1, 1]}, translate: [-2, 0, 2]}
    - {group: rock, box: {size: [8, 2, 2], divisions: [4, 1, 1]}, translate: [-2, 0, -2]}
materials:
  r: {density: 2600, poisson_ratio: 0.2, young_modulus: 0.2 GPa}
  fill: {density: 2000, poisson_ratio: 0.2, young_modulus: 0.05 GPa}
groups: {rock: {material: r}, roof: {material: r}, room: {material: r}, spare: {material: r}}
interfaces: {default: {friction_angle: 35, cohesion: 0.3 MPa, tensile_strength: 0.2 MPa}}
loads:
  gravity: [0, 0, -9.81]
  supports:
    - {surface: {group: rock, normal: [0, 0, -1]}, fix: [x, y, z]}
bolt_types:
  bar: {area: 5 cm2, young_modulus: 200 GPa, yield_force: 60 kN,
        grout: {stiffness: 1.0e+8, strength: 3.0e+3}}
bolts:
  - {name: cut, type: bar, points: [[1, 1, 3.8], [1, 1, 0.3]]}
  - {name: late, type: bar, points: [[3, 1, 3.9], [3, 1, -1.5]], install: dig}
stages:
  - {name: rest, mode: static, tolerance: 0.01}
  - {name: dig, mode: static, tolerance: 0.01, remove: [room], release: {parts: 2, to: 0.5}}
  - {name: line, mode: dynamic, duration: 0.03, add: [room], set: {groups.room.material: fill},
     release: {over: 0.02}}
  - {name: more, mode: dynamic, duration: 0.02, remove: [spare], release: {over: 0.01}}
"""

FLOWING = """
title: Weak rock flows under its weight; loose elements of it fall on the heap; a cube of them sags
model:
  blocks:
    - {group: heap, box: {size: [2, 2, 1], divisions: [3, 3, 2], shape: tet4}}
    - {group: bricks, box: {size: [2, 2, 0.5], divisions: [2, 2, 1]}, translate: [0, 0, 1.02]}
    - {group: cube, box: {size: [4, 4, 4], divisions: [4, 4, 4], shape: tet4}, translate: [0, 4, 0]}
  split: {bricks: elements, cube: elements}
materials:
  soft: {law: mohr-coulomb, density: 2000, poisson_ratio: 0.3, young_modulus: 20 MPa,
         friction_angle: 20, cohesion: 2 kPa, tensile_strength: 1 kPa}
groups:
  heap: {material: soft}
  bricks: {material: soft, velocity: [0, 0, -3]}
  cube: {material: soft}
interfaces:
  default: {friction_angle: 20}
  pairs: [{between: [cube, cube], friction_angle: 20, cohesion: 1 MPa, tensile_strength: 1 MPa}]
elements: {tetrahedra: nodal-mean}
loads:
  gravity: [2, 0, -9.81]
  supports:
    - {surface: {group: heap, normal: [0, 0, -1]}, fix: [x, y, z]}
    - {surface: {group: cube, normal: [-1, 0, 0]}, fix: [x, y, z]}
stages:
  - {name: fall, mode: dynamic, duration: 0.05, damping: {contact: 0.1}}
  - {name: go on, mode: dynamic, duration: 0.05, set: {materials.soft.cohesion: 1 kPa}}
output: {every: 0.05}  # rows of histories are steps apart: the fused kernel runs in between
"""

LEAVING = """
title: Blocks slide off a table, and out of the domain
model:
  blocks:
    - {group: table, box: {size: [6, 4, 1]}, translate: [0, 0, -1]}
    - {group: train, box: {size: [1, 1, 1], divisions: [2, 2, 2], shape: tet4}, translate: [4.9, 1.5, 0]}
    - {group: train, box: {size: [1, 1, 1]}, translate: [3.8, 1.4, 0]}
  domain: {min: [null, null, -1.2], max: [8.0, null, null]}
  split: {train: elements}
materials: {rock: {density: 2700, young_modulus: 5 MPa, poisson_ratio: 0.25}}
groups:
  table: {material: rock, fix: [x, y, z]}
  train: {material: rock, velocity: [4, 0, 0]}
interfaces: {default: {friction_angle: 5, cohesion: 30 kPa, tensile_strength: 10 kPa}}
loads: {gravity: [0, 0, -9.81]}
stages:
  - {name: slide, mode: dynamic, duration: 0.3, damping: {contact: 0.2, stiffness: 0.1}}
  - {name: go on, mode: dynamic, duration: 0.3, damping: {contact: 0.2, stiffness: 0.1}}
"""

PRESSED = """
title: Gas presses on a bonded wall in water, and on what is dug out and added; another waits
model:
  blocks:
    - {group: bed, box: {size: [6, 3, 1], divisions: [3, 2, 1]}, translate: [0, 0, -1]}
    - {group: wall, box: {size: [1, 3, 2], divisions: [1, 3, 2], shape: tet4}, translate: [2, 0, 0]}
    - {group: plug, box: {size: [1, 1, 1]}, translate: [4, 1, 0]}
    - {group: late, box: {size: [1, 1, 1], shape: wedge6}, translate: [4, 1, 1]}
  split: {wall: elements}
materials: {r: {density: 2600, poisson_ratio: 0.2, young_modulus: 0.1 GPa}}
groups:
  bed: {material: r, fix: [x, y, z]}
  wall: {material: r}
  plug: {material: r}
  late: {material: r}
interfaces: {default: {friction_angle: 35, cohesion: 60 kPa, tensile_strength: 30 kPa}}
loads:
  gravity: [0, 0, -9.81]
  surfaces:
    - {surface: {group: wall, normal: [-1, 0, 0]}, pressure: 40 kPa,
       history: [[0, 0], [0.02, 1], [0.06, 0.2]], stage: blow}
    - {surface: {group: plug, normal: [1, 0, 0]}, pressure: -5 kPa}
    - {surface: {group: late, normal: [0, -1, 0]}, pressure: 10 kPa}
    - {surface: {group: wall, normal: [0, 0, 1]}, pressure: 10 kPa, stage: go on}
water: {reservoir: {level: 1.0}}
stages:
  - {name: rest, mode: static, relax: adaptive, tolerance: 0.01, max_steps: 400}
  - {name: blow, mode: dynamic, duration: 0.06, remove: [late]}
  - {name: go on, mode: dynamic, duration: 0.04, remove: [plug], add: [late],
     set: {loads.surfaces.2.pressure: 30 kPa}}
"""

DAMPED = """
title: Pillars of all shapes of elements, one of bonded blocks, shake with damping that changes
model:
  blocks:
    - {group: rock, box: {size: [1, 1, 2], divisions: [1, 1, 2], shape: hex8}}
    - {group: rock, box: {size: [1, 1, 2], divisions: [1, 1, 2], shape: pyramid5}, translate: [2, 0, 0]}
    - {group: rock, box: {size: [1, 1, 2], divisions: [1, 1, 2], shape: wedge6}, translate: [4, 0, 0]}
    - {group: bonded, box: {size: [1, 1, 2], divisions: [1, 1, 2], shape: tet4}, translate: [6, 0, 0]}
    - {group: bonded, box: {size: [1, 1, 2], divisions: [1, 1, 2], shape: hex8}, translate: [8, 0, 0]}
  split: {bonded: elements}
materials: {r: {density: 2600, poisson_ratio: 0.2, young_modulus: 0.2 GPa}}
groups: {rock: {material: r}, bonded: {material: r}}
interfaces: {default: {friction_angle: 35, cohesion: 1 GPa, tensile_strength: 1 GPa}}
loads:
  gravity: [0, 0, -9.81]
  supports:
    - {surface: {group: rock, normal: [0, 0, -1]}, fix: [x, y, z]}
    - {surface: {group: bonded, normal: [0, 0, -1]}, fix: [x, y, z]}
  tractions:
    - {surface: {group: rock, normal: [0, 0, 1]}, traction: [100 kPa, 0, 0],
       history: [[0, 0], [0.005, 1], [0.01, 0]], stage: shake}
    - {surface: {group: bonded, normal: [0, 0, 1]}, traction: [0, 100 kPa, 0],
       history: [[0, 0], [0.005, 1], [0.01, 0]], stage: shake}
stages:
  - {name: rest, mode: static, relax: adaptive, tolerance: 0.01}
  - {name: shake, mode: dynamic, duration: 0.03,
     damping: {maxwell: {ratio: 0.1, band: [10, 1000], reference: 100}}}
  - {name: ring, mode: dynamic, duration: 0.01, damping: {rayleigh: {ratio: 0.1, frequency: 60}}}
  - {name: end, mode: dynamic, duration: 0.01, damping: {maxwell: {ratio: 0.05, band: [10, 1000]}}}
"""

SHAKEN = """
title: Ground in two bonded layers stands, is shaken and blasted between quiet faces and free fields
model:
  blocks:
    - {group: low, box: {size: [4, 2, 2], divisions: [4, 2, 2]}}
    - {group: top, box: {size: [4, 2, 2], divisions: [4, 2, 2], shape: tet4}, translate: [0, 0, 2]}
    - {group: loose, box: {size: [1, 1, 1]}, translate: [1, 0.5, 4]}
materials:
  r: {density: 2600, poisson_ratio: 0.2, young_modulus: 0.2 GPa}
  s: {density: 2000, poisson_ratio: 0.3, young_modulus: 0.1 GPa}
groups: {low: {material: r}, top: {material: s}, loose: {material: s}}
interfaces:
  default: {friction_angle: 35, cohesion: 1 GPa, tensile_strength: 1 GPa}
  pairs: [{between: [top, loose], friction_angle: 20, cohesion: 0, tensile_strength: 0}]
records:
  r: {samples: [0, 1, 3, 1, -2, -4, -1, 1, 3, 1, 0, -1, 0], step: 0.003, unit: m/s, scale: 0.05}
waves: {allow_coarse: true}
loads:
  gravity: [0, 0, -9.81]
  supports:
    - {surface: {group: low, normal: [0, 0, -1]}, fix: [x, y, z]}
    - {surface: {group: [low, top], normal: [-1, 0, 0]}, fix: [x]}
    - {surface: {group: [low, top], normal: [1, 0, 0]}, fix: [x]}
  blasts:
    - {surface: {group: loose, normal: [1, 0, 0]}, stage: again, delay: 3 ms,
       pressure: {peak: 0.1 MPa, rise: 1 ms, fall: 4 ms}}
boundaries:
  - {name: base, surface: {group: low, normal: [0, 0, -1]}, quiet: true, stage: shake,
     input: {record: r, direction: [2, 0, 1]}}
  - {name: west, surface: {group: [low, top], normal: [-1, 0, 0]}, free_field: {base: base}, stage: shake}
  - {name: east, surface: {group: [low, top], normal: [1, 0, 0]}, quiet: true, stage: shake}
stages:
  - {name: rest, mode: static, relax: adaptive, tolerance: 0.01}
  - {name: shake, mode: dynamic, duration: 0.04, damping: {maxwell: {ratio: 0.03, band: [2, 100]}}}
  - {name: stand, mode: static, relax: adaptive, max_steps: 30}
  - {name: again, mode: dynamic, duration: 0.03, damping: {rayleigh: {ratio: 0.03, frequency: 20}}}
"""

STAGED = {
    "damped": DAMPED,
    "shaken": SHAKEN,
    "soaked": SOAKED,
    "dug": DUG,
    "flowing": FLOWING,
    "leaving": LEAVING,
    "pressed": PRESSED,
}


def run_stages(name: str, threads: int) -> cdem.Simulation:
    """The finished simulation of one of them."""
    case = cdem.Case.from_dict({"cdem": 2} | yaml.safe_load(STAGED[name]))
    simulation = cdem.Simulation(case, threads=threads)
    simulation.run()
    return simulation


def digest_of_state(sim: cdem.Simulation) -> str:
    """Hash of all that a checkpoint keeps; empty arrays, of what the case has not, do not count."""
    whole = hashlib.sha256(json.dumps(sim.core.scalars()).encode())
    for name, values in sorted(sim.core.fields().items()):
        if len(values):
            whole.update(name.encode() + np.ascontiguousarray(values).tobytes())
    return whole.hexdigest()[:32]
