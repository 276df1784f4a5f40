"""A case of laws that are built in, or of their copies, which are laws of users."""

FLOW = """\
title: A soft block slides and is squeezed
own_laws: []
model:
  blocks:
    - {group: bed, box: {size: [3, 1, 0.5], divisions: [3, 1, 1]}, translate: [0, 0, -0.5]}
    - {group: block, box: {size: [1, 1, 1], divisions: [2, 2, 2]}}
materials:
  rock: {density: 2500, young_modulus: "1 GPa", poisson_ratio: 0.25}
  soft: {density: 2500, young_modulus: "0.1 GPa", poisson_ratio: 0.25, law: mohr-coulomb,
         cohesion: "2 kPa", friction_angle: 20}
groups:
  bed: {material: rock, fix: [x, y, z]}
  block: {material: soft, velocity: [2, 0.3, 0]}
interfaces: {default: {law: voellmy, friction_angle: 15, turbulence: 500, flow_density: 2500}}
loads:
  gravity: [0, 0, -10]
  surfaces: [{surface: {group: block, normal: [0, 0, 1]}, law: pressure, pressure: 3 kPa}]
stages: [{name: slide, mode: dynamic, duration: "0.15 s"}]
output: {frames: false}
"""


def flow(prefix: str = "", own_laws: str = "[]") -> str:
    """The case with laws of this prefix; `own_laws` are their headers."""
    text = FLOW.replace("mohr-", f"{prefix}mohr-").replace("voellmy", f"{prefix}voellmy")
    text = text.replace("pressure: 3", f"{prefix}pressure: 3")  # its parameter has its name
    text = text.replace("law: pressure", f"law: {prefix}pressure")
    return text.replace("own_laws: []", f"own_laws: {own_laws}")


def differences(one: dict, other: dict) -> list[str]:
    """Names of arrays that are not the same bits; the numbers of laws may differ."""
    assert one.keys() == other.keys()
    return [n for n in one if "law" not in n and one[n].tobytes() != other[n].tobytes()]
