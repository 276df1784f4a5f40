"""What a critical value takes for sliding."""

from types import SimpleNamespace

import numpy as np

from cdem.study.criterion import Criterion
from cdem.study.verdict import LOOK, _Watch


def watch_of(looks):
    """Verdicts on a block of faces of 1 m, of which each look sees a way [m] and a kinetic energy [J]."""
    topology = SimpleNamespace(block_group=np.zeros(1, int), node_block=np.zeros(1, int))
    sim = SimpleNamespace(
        audit=SimpleNamespace(counts={"faces": 1}),
        build=SimpleNamespace(
            arrays={"face.length": np.ones(1)}, topology=topology, group_names=["rock"]
        ),
        core=SimpleNamespace(unbalance_ratio=lambda: 0.1),
        fields={"position": np.zeros((1, 3)), "velocity": np.zeros((1, 3))},
        energies={"kinetic": 0.0},
    )
    watch = _Watch(sim, Criterion())
    for number, (way, kinetic) in enumerate(looks, 1):
        sim.fields["position"] = np.array([[way, 0.0, 0.0]])
        sim.energies["kinetic"] = kinetic
        yield watch.look(number * LOOK)


def test_soft_rock_that_sags_far_before_the_first_look_is_not_sliding():
    assert list(watch_of([(0.3, 10.0), (0.4, 6.0), (0.41, 0.1)])) == [None, None, None]


def test_a_body_that_gains_speed_slides():
    verdicts = list(watch_of([(0.3, 10.0), (0.9, 40.0)]))
    assert verdicts[0] is None
    assert verdicts[1].saw == "sliding"
