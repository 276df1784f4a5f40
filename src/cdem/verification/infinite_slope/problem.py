"""Long slope with water that flows parallel to it: factor of safety (Skempton & DeLory 1957)."""

import numpy as np

from cdem.study.critical import find_critical, strength_reduction


def theory(wet, cohesion=5e3, friction=30.0, unit=20e3, thickness=5.0, dip=20.0):
    """F = (c + (gamma h cos^2(b) - p) tan(phi)) / (gamma h sin(b) cos(b))."""
    b = np.radians(dip)
    pressure = 9810 * thickness * np.cos(b) ** 2 if wet else 0.0
    normal = unit * thickness * np.cos(b) ** 2 - pressure
    shear = unit * thickness * np.sin(b) * np.cos(b)
    return (cohesion + normal * np.tan(np.radians(friction))) / shear


def run(study):
    """Strength reduction, dry and with seepage."""
    for name, wet, more in (("dry", False, ["water.fields.0.lift=-100"]), ("seepage", True, [])):
        ours = find_critical(study.case(*more), strength_reduction(), (0.6, 2.5), tolerance=5e-4,
                             threads=study.threads).value  # fmt: skip
        study.check(f"factor of safety, {name}", theory=theory(wet), ours=ours, within=3e-3)
