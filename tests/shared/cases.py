"""Case files that several tests share, as a user would write them."""

INCLINE = """\
cdem: 2
title: Block on an incline
units: SI
model:
  blocks:
    - {group: bed, box: {size: [10, 4, 1], divisions: [10, 4, 1]}}
    - {group: block, polyhedron: {vertices: [[0, 0, 1], [1, 0, 1], [0, 1, 1], [0, 0, 2]]}}
  split: {block: elements, bed: connected}
materials:
  granite: {density: "2.7 t/m3", young_modulus: "50 GPa", poisson_ratio: 0.25, law: elastic}
groups:
  bed: {material: granite, fix: [x, y, z]}
  block:
    material: granite
    velocity: [0, 0, "1 cm/s"]
interfaces:
  default: {friction_angle: "26 deg", stiffness_n: auto, stiffness_s: "5 E/h"}
  pairs:
    - {between: [bed, block], name: base, cohesion: "10 kPa", stiffness_n: "2 GPa/m"}
loads:
  gravity: [0, 0, -9.81]
  tractions:
    - {surface: {group: block, normal: [1, 0, 0]}, traction: [1, 0, 0], history: [[0, 0], [1, 1]]}
  velocities:
    - {surface: lid, components: [x], velocity: [1, 0, 0]}
  supports:
    - {box: {min: [0, 0, 0], max: [1, 1, 1]}, group: bed, fix: [z]}
stages:
  - {name: settle, mode: static, relax: local}
  - {name: slide, mode: dynamic, duration: "2 s", damping: {contact: "10 %"},
     set: {interfaces.base.cohesion: 0, loads.gravity.2: -5}}
contact: {refresh: 50}
histories:
  - {name: toe, point: [0, 0, 0], quantities: [displacement]}
"""
CUBE = """\
title: A cube falls
model: {blocks: [{group: cube, box: {size: [1, 1, 1]}}]}
materials: {rock: {density: 2700, young_modulus: "1 GPa", poisson_ratio: 0.25}}
groups: {cube: {material: rock}}
interfaces: {default: {friction_angle: 30}}
loads: {gravity: [0, 0, -10]}
stages: [{name: fall, mode: dynamic, duration: "5 ms"}]
output: {every: "1 ms"}
"""
# It falls for minutes, and stays far below the wave speed of its rock.
ENDLESS = CUBE.replace("[0, 0, -10]", "[0, 0, -0.001]").replace('"5 ms"', "10000")
WALL = """\
model:
  blocks:
    - {group: base, box: {size: [6, 3, 1], divisions: [6, 3, 1]}}
    - {group: wall, box: {size: [1, 3, 3], divisions: [1, 3, 3], shape: tet4}, translate: [0, 0, 1]}
    - {group: loose, box: {size: [1, 1, 1]}, translate: [3, 1, 1]}
  split: {wall: elements}
materials: {rock: {density: 2700, young_modulus: "1 GPa", poisson_ratio: 0.25}}
groups: {base: {material: rock}, wall: {material: rock}, loose: {material: rock}}
interfaces:
  default: {friction_angle: 30}
  pairs:
    - {between: [wall, wall], cohesion: "1 MPa", tensile_strength: "0.1 MPa"}
    - {between: [wall, base], cohesion: "2 MPa", tensile_strength: "0.5 MPa", friction_angle: 20}
loads:
  supports: [{surface: {group: base, normal: [0, 0, -1]}, fix: [z]}]
  tractions: [{surface: {group: wall, normal: [1, 0, 0]}, traction: [-1000, 0, 0]}]
  velocities: [{group: loose, velocity: [0.1, 0, 0], components: [x]}]
stages: [{name: push, mode: dynamic, duration: "5 ms"}]
output: {every: "1 ms"}
"""
FALL = """\
model: {blocks: [{group: cube, box: {size: [1, 1, 1]}}]}
materials: {rock: {density: 2700, young_modulus: "1 GPa", poisson_ratio: 0.25}}
groups: {cube: {material: rock}}
interfaces: {default: {friction_angle: 30, cohesion: 0}}
loads: {gravity: [0, 0, -10]}
stages: [{name: fall, mode: dynamic, duration: "5 ms"}]
output: {frames: false}
"""
STATIC_FALL = FALL.replace('mode: dynamic, duration: "5 ms"', "mode: static")
SWEPT = """\
title: A cube falls
model: {blocks: [{group: cube, box: {size: [1, 1, 1]}}]}
materials: {rock: {density: 2700, young_modulus: "1 GPa", poisson_ratio: 0.25}}
groups: {cube: {material: rock, velocity: [0, 0, 0]}}
interfaces: {default: {friction_angle: 30}}
loads: {gravity: [0, 0, -10]}
stages: [{name: fall, mode: dynamic, duration: 0.05}]
histories: [{name: top, point: [0, 0, 1], quantities: [displacement]}]
output: {frames: false}
"""
STUDY = """\
case: cube.yaml
parameters:
  groups.cube.velocity.0: [0, 1, 1e6]
  interfaces.default.cohesion: {values: [1, 2], unit: kPa}
keep: true
results: {way: groups.cube.displacement.0, drop: histories.top.displacement_z, both: = way + drop}
plots:
  - {lines: way, x: groups.cube.velocity.0, by: interfaces.default.cohesion, beside: drop}
  - {map: way, x: groups.cube.velocity.0, y: interfaces.default.cohesion}
  - {tornado: way}
"""
