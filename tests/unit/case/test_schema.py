"""Materials, groups, stages, contact and histories: what is refused."""

import pytest


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "density:",
            "densty:",
            "slope.yaml:10:13: materials.granite.densty: unknown key; did you mean density?",
        ),
        (
            "0.25",
            "0.7",
            "slope.yaml:10:59: materials.granite.poisson_ratio: must lie in [0, 0.5) [1], got 0.7",
        ),
        ("0.25", "0.5", "must lie in [0, 0.5)"),
        (
            "law: elastic",
            "law: elastc",
            "must be elastic, mohr-coulomb, ubiquitous-joint, drucker-prager or hoek-brown, got 'elastc'; did you mean elastic?",
        ),
        ("fix: [x, y, z]", "fix: [x, w]", "groups.bed.fix.1: must be x, y or z, got 'w'"),
        (
            "fix: [x, y, z]",
            "fix: x",
            "slope.yaml:12:28: groups.bed.fix: must be a list, e.g. [a, b], got 'x'",
        ),
        ('[0, 0, "1 cm/s"]', "[0, 0]", "groups.block.velocity: needs at least 3 entries, got 2"),
        ("mode: static", "mode: quick", "stages.0.mode: must be static or dynamic, got 'quick'"),
        (
            "mode: static",
            "mode: static, tolerance: 2",
            "stages.0.tolerance: must lie in (0, 1) [1], got 2",
        ),
        (
            "mode: static",
            "mode: static, duration: 2",
            "stages.0: duration has no effect in a static stage",
        ),
        (', duration: "2 s"', "", "slope.yaml:30:5: stages.1: a dynamic stage needs a duration"),
        ("refresh: 50", "refresh: 0", "contact.refresh: must be at least 1, got 0"),
        ("refresh: 50", "refresh: 99999999999", "contact.refresh: must be at most 2000000000, got"),
        ("mode: static", "mode: static, max_steps: 99999999999", "must be at most 2000000000, got"),
        (
            "[10, 4, 1]}}",
            "[10, 4, 100001]}}",
            "box.divisions.2: must be at most 100000, got 100001",
        ),
        ("refresh: 50", "refresh: often", "contact.refresh: must be displacement, got 'often'"),
        ("refresh: 50", "tolerance: atuo", "contact.tolerance: must be a number, got 'atuo'"),
        (
            "quantities: [displacement]",
            "quantities: [energy]",
            "histories.0: energy needs a group, not a point",
        ),
        (
            "quantities: [displacement]",
            "quantities: [velocity, displacement, velocity]",
            "velocity is listed twice",
        ),
        ("cdem: 2\n", "cdem: 3\n", "slope.yaml:1:1: cdem: must be 2, got 3"),
        (
            "materials:\n",
            "materials: 3\nother:\n",
            "slope.yaml:9:1: materials: must be a mapping (key: value), got 3",
        ),
    ],
)
def test_mistakes_are_answered(complaint, old, new, message):
    assert message in complaint(old, new)
