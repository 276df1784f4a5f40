"""Dry wall in running bond under tilt, out of its plane and in it."""

import numpy as np

from cdem.output.render import snapshot
from cdem.run.simulation import Simulation
from cdem.study.critical import find_critical
from cdem.verification.masonry import block, course, tilt, tilt_limit, turning_limit

DEPTH = 0.1  # [m]


def theory(boxes, friction_angle):
    """Tilt [deg] at which a wall fails in its plane: rigid blocks, head joints without friction.

    The smaller of two limits: a wedge behind a stepped crack turns over the face, by hand
    (`turning_limit`), and the linear programme of forces in balance (`tilt_limit`), which also
    knows mechanisms that slip. Where they agree, nothing slips and the answer is exact.
    """
    return min(turning_limit(boxes), tilt_limit(boxes, friction_angle, 0.0))


def wall(length, courses, block_length=0.2, block_height=0.1):
    """Boxes of a wall in running bond [m], shape (boxes, 5); `length` counts blocks."""
    return [
        (*box, DEPTH)
        for n in range(courses)
        for box in course(n * block_height, 0, length * block_length, block_length, block_height,
                          half=n % 2 == 1)
    ]  # fmt: skip


def settings(boxes, friction_angle):
    """The wall and its friction as values of the case."""
    height = boxes[0][3]
    rows = ["{group: floor, box: {size: [1.6, 0.5, 0.1]}, translate: [-0.5, -0.2, -0.1]}"]
    rows += [block("even" if round(box[1] / height) % 2 else "odd", box) for box in boxes]
    return (
        f"model.blocks=[{', '.join(rows)}]",
        f"interfaces.default.friction_angle={friction_angle}",
    )


def fall(study, angle, azimuth, *values):
    """Pictures of a wall of soft stone that falls: start and two later times."""
    case = study.case(*values, "materials.stone.young_modulus=50 MPa",
                      "stages=[{name: fall, mode: dynamic, duration: 2,"
                      " damping: {contact: 0.2, stiffness: 0.2}}]")  # fmt: skip
    tilt(case, angle, azimuth)
    simulation = Simulation(case, threads=study.threads)
    shown = [snapshot(simulation)]
    for time in (0.4, 0.6):
        simulation.run_until(time)
        shown.append(snapshot(simulation))
    return shown


def run(study):
    """Both ways for one wall; when full, other walls, blocks and friction, and pictures of a fall."""
    boxes = wall(3, 6)
    exact = np.degrees(np.arctan(DEPTH / 0.6))
    found = find_critical(study.case(*settings(boxes, 45)), lambda c, a: tilt(c, a, 90),
                          (exact - 0.4, exact + 0.4), tolerance=0.05, threads=study.threads)  # fmt: skip
    study.check("tilt out of the plane, thickness / height = 1 / 6", unit="deg", theory=exact,
                ours=found.value, within=0.05, absolute=True)  # fmt: skip
    walls = [(3, 6, 0.1, 45)]
    if study.full:
        walls += [(2, 8, 0.1, 45), (3, 8, 0.1, 45), (3, 8, 0.1, 30), (3, 6, 0.15, 30)]
    for length, courses, height, friction in walls:
        boxes = wall(length, courses, block_height=height)
        exact = theory(boxes, friction)
        found = find_critical(study.case(*settings(boxes, friction)), tilt,
                              (exact - 0.4, exact + 0.4), tolerance=0.1, threads=study.threads)  # fmt: skip
        study.check(f"tilt in the plane, {length} long, {courses} high, blocks 0.2 x {height:g} m, "
                    f"friction {friction} deg", unit="deg", theory=exact, ours=found.value,
                    within=0.005)  # fmt: skip
    if not study.full:
        return
    boxes = wall(3, 6)
    study.picture("In the plane, tilted by 32 degrees", *fall(study, 32, 0, *settings(boxes, 45)))
    study.picture("Out of the plane, 12 degrees", *fall(study, 12, 90, *settings(boxes, 45)))
