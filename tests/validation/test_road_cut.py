"""The template of a road cut: a planar slide with water and anchors, by limit equilibrium."""

from pathlib import Path

import numpy as np
import pytest

import cdem
from cdem import Case
from cdem.study.critical import find_critical, strength_reduction

TEMPLATE = Path(cdem.__file__).parent / "templates/road_cut.yaml"
BED, STEEP = np.radians(35), np.radians(80)
EXIT, TOP = (
    np.array([41.2, 2.0]),
    np.array([10.0, 30.0]),
)  # where the bedding and the joint come out
SLAB = np.array([30.5517, 28.6207])  # where the joint at the crest comes out
ANCHORS = 4 * 1.15e6 / 3  # four rows at yield, every 3 m [N/m]


def by_hand(cohesion, lift, *, friction=30, top=TOP, anchored=ANCHORS):
    """Factor of safety of the body on the lowest bedding plane, in front of a steep joint."""
    down = np.array([np.cos(BED), -np.sin(BED)])
    normal = np.array([np.sin(BED), np.cos(BED)])
    up_joint = np.array([-np.cos(STEEP), np.sin(STEEP)])
    along = np.linalg.solve(np.column_stack([-down, up_joint]), top - EXIT)[0]
    corner = EXIT - along * down
    x, z = np.array([corner, EXIT, *([[30, 30]] if top is TOP else []), top]).T
    weight = 2600 * 9.81 * 0.5 * abs(x @ np.roll(z, -1) - z @ np.roll(x, -1))

    def water(start, end):
        x, z = (start + np.linspace(0, 1, 20001)[:, None] * (end - start)).T
        head = 8 + lift + np.tan(np.radians(30)) * (38.8 - x) - z
        return 9810 * np.maximum(head, 0).mean() * np.linalg.norm(end - start)

    push = water(corner, top) * np.array([np.sin(STEEP), np.cos(STEEP)])
    anchors = anchored * np.array([-1, -0.18]) / np.hypot(1, 0.18)
    force = push + anchors - [0, weight]
    pressed = -(force @ normal) - water(corner, EXIT)
    return (cohesion * along + pressed * np.tan(np.radians(friction))) / (force @ down)


@pytest.mark.slow
@pytest.mark.parametrize("cohesion", [40e3, 20e3])
def test_the_factor_of_the_template_is_that_of_limit_equilibrium(cohesion):
    """Anchors yield before the body slides, so they count with their yield force."""
    case = Case.load(TEMPLATE)
    for name in ("cohesion", "residual_cohesion"):
        case.set(f"interfaces.bedding.{name}", cohesion)
    hand = by_hand(cohesion, 0)
    found = find_critical(case, strength_reduction(keep=True), None, tolerance=0.01, threads=1)
    assert 0.5 * (found.stable + found.failed) == pytest.approx(hand, rel=0.01)


def test_the_figures_of_the_template():
    """Those of docs/howto/road_cut.md."""
    assert by_hand(40e3, 0) == pytest.approx(1.375, abs=5e-4)
    assert by_hand(20e3, 0) == pytest.approx(1.207, abs=5e-4)
    assert by_hand(40e3, 3) == pytest.approx(1.209, abs=5e-4)
    assert by_hand(40e3, 0, top=SLAB, anchored=0) == pytest.approx(0.880, abs=5e-4)
    assert by_hand(0, 0, friction=45, top=SLAB, anchored=0) == pytest.approx(0.955, abs=5e-4)


@pytest.mark.slow
def test_the_slab_without_anchors_or_cohesion_is_that_of_limit_equilibrium():
    """Its toe lifts off, which costs cohesion, but no friction."""
    case = Case.load(TEMPLATE)
    case.set("bolts", [])
    case.set("histories", [])
    for name, value in {"cohesion": 0, "residual_cohesion": 0, "friction_angle": 45}.items():
        case.set(f"interfaces.bedding.{name}", value)
    hand = by_hand(0, 0, friction=45, top=SLAB, anchored=0)
    found = find_critical(case, strength_reduction(keep=True), None, tolerance=0.01, threads=1)
    assert 0.5 * (found.stable + found.failed) == pytest.approx(hand, rel=0.005)
