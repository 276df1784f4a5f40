"""Holes of blasts: rings that a detonation reaches, faces around them, distance of quiet faces."""

import numpy as np
import pytest
from scenes import case

from cdem import Simulation
from cdem.errors import CaseError
from cdem.model.blast_doubts import bend
from cdem.model.blasts import ring_of
from cdem.model.build import build
from cdem.rows import rows_of
from cdem.verification.hexahedra import extruded, walls, write

PULSE = {"peak": "20 MPa", "rise": "9 ms", "fall": "20 ms"}
STAGES = [{"name": "blow", "mode": "dynamic", "duration": 0.2}]


def pipe(path, around, outer=12.0, layers=1):
    """Write a pipe of rock of 1 m with `around` faces along its wall, an end at z = 0."""
    angle = np.linspace(0, 2 * np.pi, around + 1)[:-1]
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    k = np.arange(around)
    after = (k + 1) % around
    radii = 1 + (outer - 1) * np.arange(9) / 8
    plane = np.concatenate([r * circle for r in radii])
    ring = np.column_stack([k, k + around, after + around, after])
    quads = np.concatenate([ring + i * around for i in range(8)])
    points, cells = extruded(plane, quads, 1.0)
    sides = np.column_stack([after, k])
    wall, far = walls(sides, len(plane)), walls(sides[:, ::-1] + 8 * around, len(plane))
    up = np.arange(layers)[:, None, None] * len(plane)
    heights = np.repeat(np.arange(layers + 1.0), len(plane))
    points = np.column_stack([np.tile(plane, (layers + 1, 1)), heights])
    parts = [(part + up).reshape(-1, part.shape[1]) for part in (cells, wall, far)]
    write(path, points, {"rock": parts[0]}, {"wall": parts[1], "far": parts[2]})


def blast(path, *, quiet=False, **changes):
    """The pipe with a blast."""
    loads = {"blasts": [{"surface": "wall", "pressure": PULSE} | changes]}
    far = [{"name": "far", "surface": "far", "quiet": True}] if quiet else []
    return case([], {"rock": {}}, model={"mesh": str(path)}, loads=loads, stages=STAGES,
                boundaries=far,
                waves={"allow_coarse": True})  # fmt: skip


def doubts(model):
    """Warnings of the audit about blasts."""
    return [w for w in Simulation(model, threads=1).audit.warnings if "loads.blasts" in w]


@pytest.mark.parametrize("around", [6, 10, 24])
def test_faces_around_a_hole_are_counted_by_their_angles(tmp_path, around):
    pipe(tmp_path / "pipe.msh", around, layers=2)
    t = build(blast(tmp_path / "pipe.msh")).topology
    angle, radius = bend(t, t.surfaces["wall"])
    assert 360 / angle == pytest.approx(around)
    assert radius == pytest.approx(np.cos(np.pi / around), rel=1e-6)  # to the middle of a face
    flat = t.surfaces["wall"][:1]
    assert bend(t, flat) == (0, 0)


def test_a_hole_of_few_faces_is_refused_and_of_hardly_enough_is_told(tmp_path):
    pipe(tmp_path / "a b.msh", 6)
    with pytest.raises(
        CaseError, match=r"loads\.blasts\.0: the hole has about 6 faces .* mesh it finer"
    ):
        Simulation(blast(tmp_path / "a b.msh"))
    pipe(tmp_path / "pipe.msh", 10)
    (told,) = doubts(blast(tmp_path / "pipe.msh"))
    assert "loads.blasts.0: the hole has about 10 faces around it" in told
    pipe(tmp_path / "pipe.msh", 16)
    assert not doubts(blast(tmp_path / "pipe.msh", quiet=True))


def test_quiet_faces_near_a_hole_are_told(tmp_path):
    pipe(tmp_path / "pipe.msh", 16, outer=8.0)
    assert not doubts(blast(tmp_path / "pipe.msh"))
    (told,) = doubts(blast(tmp_path / "pipe.msh", quiet=True))
    assert (
        "a quiet surface is 7.85 m from the axis of the hole, 8 of its radii; move it to at least"
        in told
    )


def test_a_rise_too_fast_for_the_mesh_of_the_hole_is_told(tmp_path):
    """c_s 1265 m/s, 1 ms: 1.26 m, of faces of 1 m along the hole; ten elements need 7.9 ms."""
    pipe(tmp_path / "pipe.msh", 16)
    fast = PULSE | {"rise": "1 ms"}
    model = blast(tmp_path / "pipe.msh", pressure=fast)
    (told,) = doubts(model)
    assert "in 0.001 s, an S wave runs 1.26 m, 1.3 elements at the hole" in told
    assert "rise in 0.00791 s" in told


def test_a_detonation_loads_its_rings_one_after_the_other(tmp_path):
    """Ring k of a pipe of ten layers is loaded at distance / speed, from the end where it begins."""
    pipe(tmp_path / "pipe.msh", 12, layers=10)
    run = {"from": [0, 0, 0], "speed": 2000.0}
    step = {"table": [[0, 1e6], [1, 1e6]]}
    model = blast(tmp_path / "pipe.msh", detonation=run, pressure=step, delay=1e-3)
    sim = Simulation(model, threads=1)
    assert [(one["faces"], one["law"]) for one in sim.audit.modules["surface"]] == [
        (120, "pressure")
    ]
    t = sim.build.topology
    assert np.isclose(sim.audit.modules["surface"][0]["area"], 120 * 2 * np.sin(np.pi / 12))
    entries = [entry for _, entry in model.surface_entries]
    found = [ring_of(t, t.surfaces["wall"], entry.ring) for entry in entries]
    late = sorted(time for faces, time in found if len(faces))
    away = np.hypot(np.arange(10) + 0.5, np.cos(np.pi / 12))
    assert late == pytest.approx(away / 2000, rel=1e-6)
    wall = np.unique(t.face_nodes[t.surfaces["wall"]])
    seen = np.full(len(t.node_position), np.inf)
    while sim.time < 9e-3:
        sim.step(1)
        now = np.abs(rows_of(sim.core, "node.surface").force).max(axis=1) > 0
        seen[now & np.isinf(seen)] = sim.time
    ends = [seen[wall[t.node_position[wall, 2] == z]].max() for z in range(10)]
    first = 1e-3 + away[[0, *range(9)]] / 2000  # the earlier of the two rings at a node
    step = sim.core.scalars()["dt"]
    assert np.abs(np.array(ends) - first).max() < 2 * step


def test_a_stage_cannot_change_the_detonation(tmp_path):
    pipe(tmp_path / "pipe.msh", 12, layers=2)
    sim = Simulation(blast(tmp_path / "pipe.msh", detonation={"from": [0, 0, 0], "speed": 2000.0}))
    sim.set("loads.blasts.0.delay", 1e-3)
    with pytest.raises(CaseError, match="not its surface, law, stage or detonation"):
        sim.set("loads.blasts.0.detonation.speed", 1000)


def test_holes_of_blasts_and_their_charges_are_told(tmp_path):
    """The hole of 1 m is 2 m long; a charge of 850 kg/m3 and 1 m fills half of its diameter."""
    pipe(tmp_path / "pipe.msh", 16, layers=2)
    charge = {"density": 850, "speed": 400, "diameter": 1, "hole": 2}
    pulse = {key: PULSE[key] for key in ("rise", "fall")}
    model = blast(tmp_path / "pipe.msh", pressure=pulse, explosive=charge, stage="blow")
    sim = Simulation(model, threads=1)
    (told,) = sim.summary("finished")["charges"]
    assert (told["hole"], told["stage"]) == ("wall", "blow")
    ends = sorted(told["ends"], key=lambda end: end[2])
    np.testing.assert_allclose(ends, [[0, 0, 0], [0, 0, 2]], atol=1e-9)
    assert told["mass"] == pytest.approx(850 * np.pi / 4 * 2)
    assert sim.audit.as_dict()["charges"] == [told]
    assert "wall: hole 2 m long, from " in sim.audit.text()
    assert ", 1335 kg of explosive" in sim.audit.text()
    assert "of explosive" not in Simulation(blast(tmp_path / "pipe.msh"), threads=1).audit.text()


def test_each_hole_of_a_surface_has_a_charge(tmp_path):
    """Two walls of boxes, which share no vertex: a flat one each."""
    boxes = [{"group": "a", "box": {"size": [1, 1, 1]}, "translate": [3 * i, 0, 0]} for i in (0, 1)]
    top = {"surface": {"group": "a", "normal": [0, 0, 1]}, "pressure": PULSE}
    sim = Simulation(case(boxes, {"a": {}}, loads={"blasts": [top]}, stages=STAGES), threads=1)
    places = [one["ends"][0] for one in sim.audit.as_dict()["charges"]]
    np.testing.assert_allclose(sorted(places), [[0.5, 0.5, 1], [3.5, 0.5, 1]])
    assert "  loads.blasts.0: charge at " in sim.audit.text()


def test_a_wall_of_rock_that_is_not_there_is_refused(tmp_path):
    pipe(tmp_path / "pipe.msh", 16)
    later = [*STAGES, {"name": "later", "mode": "dynamic", "duration": 1e-2, "add": ["rock"]}]
    boxes = [{"group": "other", "box": {"size": [1, 1, 1]}, "translate": [20, 0, 0]}]
    model = case(boxes, {"rock": {}, "other": {}}, model={"mesh": str(tmp_path / "pipe.msh")},
                 loads={"blasts": [{"surface": "wall", "pressure": PULSE, "stage": "blow"}]},
                 stages=later,
                 waves={"allow_coarse": True})  # fmt: skip
    with pytest.raises(
        CaseError,
        match=r"loads\.blasts\.0: the wall is of rock, not present in the stage blow; give",
    ):
        Simulation(model)


def test_an_explosive_for_another_hole_is_told(tmp_path):
    """A hole of 2 m of 16 faces, and one of 0.3 m."""
    pipe(tmp_path / "pipe.msh", 16)
    pulse = {key: PULSE[key] for key in ("rise", "fall")}
    charge = {"density": 850, "speed": 40, "diameter": 0.2}
    assert not doubts(blast(tmp_path / "pipe.msh", pressure=pulse, explosive=charge | {"hole": 2}))
    (told,) = doubts(blast(tmp_path / "pipe.msh", pressure=pulse, explosive=charge | {"hole": 0.3}))
    assert (
        "explosive.hole is 0.3 m, and the hole in the mesh has a diameter of about 1.96 m" in told
    )


def test_a_detonation_that_begins_far_from_its_hole_is_told(tmp_path):
    pipe(tmp_path / "pipe.msh", 16)
    near, far = ({"from": [x, 0, 0], "speed": 4000} for x in (0, 101))
    assert not doubts(blast(tmp_path / "pipe.msh", detonation=near))
    (told,) = doubts(blast(tmp_path / "pipe.msh", detonation=far))
    assert "the detonation begins 100 m from the hole and reaches it 0.025 s after" in told
