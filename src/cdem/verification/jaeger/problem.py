"""Uniaxial strength of rock with a weak plane, by its direction (Jaeger 1960)."""

import numpy as np

from cdem.output.render import snapshot
from cdem.run.fields import stress_of
from cdem.run.law_fields import yielded_of


def theory(rock, angle):
    """Strength [Pa] with this angle between the normal of the plane and the axis [deg]."""
    t = np.tan(np.radians(rock.friction_angle))
    whole = 2 * rock.cohesion * (t + np.sqrt(1 + t * t))
    b, slope = np.radians(angle), np.tan(np.radians(rock.joint_friction_angle))
    per_stress = np.sin(b) * np.cos(b) - np.cos(b) ** 2 * slope
    return min(whole, rock.joint_cohesion / per_stress) if per_stress > 1e-12 else whole


def run(study):
    """Planes of all dips, and one that stands askew to the axes."""
    ours = []
    angles = np.arange(0, 91, 10) if study.full else np.array([0, 30, 40, 45, 50, 60, 80])
    for angle in angles:
        simulation = study.simulate(f"materials.rock.joint_dip={angle}")
        simulation.run()
        exact = theory(simulation.case.materials["rock"], angle)
        ours.append(-stress_of(simulation)[0, 2])
        study.check(f"strength, plane at {angle} deg", unit="Pa", theory=exact, ours=ours[-1],
                    within=5e-3)  # fmt: skip
        slides = exact < theory(simulation.case.materials["rock"], 0)
        study.check(f"slides on the plane, plane at {angle} deg", theory=float(slides),
                    ours=float((yielded_of(simulation)[0] & 16) > 0), absolute=True, within=0)  # fmt: skip
        study.check(f"energy error, plane at {angle} deg", theory=0, absolute=True, within=2e-4,
                    ours=simulation.energies["error"])  # fmt: skip
    dips = np.linspace(0, 90, 181)
    rock = simulation.case.materials["rock"]
    study.curve("Strength by direction of the weak plane", "normal to axis [deg]", "strength [kPa]",
                {"Jaeger": (dips, [theory(rock, d) / 1e3 for d in dips]),
                 ".ours": (angles, np.array(ours) / 1e3)})  # fmt: skip
    study.picture("The cube with a steep plane", snapshot(simulation))
