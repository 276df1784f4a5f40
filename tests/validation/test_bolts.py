"""Bolts that pull on rock: bits, energy, stages, excavation."""

import numpy as np
import pytest
from scenes import digest

import cdem
from cdem.rows import rows_of

BAR = {
    "area": 5e-4, "young_modulus": 2e11, "yield_force": 2e5, "rupture_strain": 0.05,
    "grout": {"stiffness": 1e8, "strength": 5e4}, "dowel": True,
}  # fmt: skip
PULL = {"name": "pull", "mode": "dynamic", "duration": 0.02}


def cubes(*stages, bolts=None, kind=BAR, shape="tet4", every=None, **more):
    """A held cube of 2 m and two more beside it, each with bolts across its joint; the last is
    drawn along the bolts and, half as fast, across them."""
    blocks = [
        {"group": name, "box": {"size": [2, 2, 2], "divisions": [2, 2, 2], "shape": shape},
         "translate": [2 * k, 0, 0]}
        for k, name in enumerate(("held", "middle", "drawn"))
    ]  # fmt: skip
    bolts = bolts or [
        {"points": [[5.5, 0.6, 0.7], [0.5, 0.9, 1.1]], "plate": True},
        {"points": [[5.7, 1.3, 1.4], [1.5, 1.2, 0.8]], "plate": True, "pretension": 5e4},
    ]
    velocity = {"surface": {"group": "drawn", "normal": [1, 0, 0]}, "velocity": [0.5, 0.25, 0]}
    return cdem.Simulation(
        cdem.Case.from_dict(
            {
                "model": {"blocks": blocks},
                "materials": {
                    "rock": {"density": 2500, "young_modulus": 2e10, "poisson_ratio": 0.3}
                },
                "groups": {
                    "held": {"material": "rock", "fix": ["x", "y", "z"]},
                    "middle": {"material": "rock"},
                    "drawn": {"material": "rock"},
                },
                "interfaces": {"default": {"friction_angle": 30}},
                "bolt_types": {"bar": kind},
                "bolts": [{"name": f"b{k}", "type": "bar"} | b for k, b in enumerate(bolts)],
                "loads": {"gravity": [0, 0, -9.81], "velocities": [velocity]},
                "stages": list(stages or [PULL]),
                "output": {"every": every},
            }
        ),
        **{"threads": 1, **more},
    )


def test_the_ledger_closes_and_the_parts_are_at_work():
    sim = cubes()
    sim.run()
    e = sim.energies
    assert e["bolts"] > 0 and e["bolt_loss"] > 0.1 * e["external"]
    assert abs(e["error"]) < 1e-3
    state = sim.core.fields()
    assert state["bolts.grout_state"].any()
    assert np.abs(state["bolts.dowel_force"]).max() > 1e3


def test_bolts_shorten_the_step():
    """And the assembly, whose limit mass scaling starts from, knows it as well as the core."""
    stiff = {"stiffness": 1e12}
    line = {"points": [[4.7, 0.6, 0.7], [0.5, 0.9, 1.1]], "plate": stiff}
    kind = BAR | {"area": 1.0, "yield_force": 1e6}
    soft, hard = (
        cubes(kind=k, bolts=[b]) for k, b in ((BAR, line | {"plate": True}), (kind, line))
    )
    soft, hard = ((s.core.step_limit()[0], s.build.assembly.limits[0]) for s in (soft, hard))
    assert hard[0] < 0.9 * soft[0]
    assert hard[0] / soft[0] == pytest.approx(hard[1] / soft[1], rel=0.2)


def test_bolts_put_no_net_force_on_the_rock():
    sim = cubes()
    sim.run()
    first = sim.build.assembly.counts["bolts.corner_first"]
    of_bolts = rows_of(sim.core, "corner.force").force[first:-1]
    assert np.abs(of_bolts).max() > 1e3
    np.testing.assert_allclose(of_bolts.sum(axis=0), 0, atol=1e-8 * np.abs(of_bolts).sum())


def test_the_same_bits_on_any_number_of_threads():
    digests = set()
    for threads in (1, 2, 3):
        sim = cubes(threads=threads)
        sim.run()
        digests.add(digest(sim))
    assert len(digests) == 1


@pytest.mark.parametrize("at", [0.004, 0.0131])
def test_a_resumed_run_goes_on_with_the_same_bits(tmp_path, at):
    stages = [PULL, PULL | {"name": "again", "duration": 0.005}]
    bolts = [
        {"points": [[5.5, 0.6, 0.7], [0.5, 0.9, 1.1]], "plate": True, "remove": "again"},
        {"points": [[5.7, 1.3, 1.4], [1.5, 1.2, 0.8]], "plate": True, "pretension": 5e4,
         "install": "again"},
    ]  # fmt: skip
    whole = cubes(*stages, bolts=bolts, every=0.005)
    whole.run()
    broken = cubes(*stages, bolts=bolts, every=0.005, output=tmp_path / "r")
    broken.run_until(at)
    broken.checkpoint()
    broken.results.release()
    again = cubes(*stages, bolts=bolts, every=0.005, output=tmp_path / "r", resume=True)
    again.run()
    assert digest(again) == digest(whole)


def test_a_bolt_comes_and_goes_with_its_stages():
    stages = [PULL | {"name": name, "duration": 0.002} for name in ("one", "two", "three")]
    line = {"points": [[5.5, 0.6, 0.7], [0.5, 0.9, 1.1]], "install": "two", "remove": "three"}
    sim = cubes(*stages, bolts=[line])
    state = sim.core.fields()
    sim.run_stage("one")
    assert not state["bolts.axial_force"].any()
    sim.run_stage("two")
    assert np.abs(state["bolts.axial_force"]).max() > 1e3
    stored = sim.energies["bolts"]
    lost = sim.energies["bolt_loss"]
    sim.run_stage("three")
    assert not state["bolts.axial_force"].any() and sim.energies["bolts"] == 0
    assert sim.energies["bolt_loss"] == pytest.approx(lost + stored, rel=1e-3)
    assert abs(sim.energies["error"]) < 1e-3


def test_what_is_dug_out_takes_its_part_of_a_bolt_along():
    dig = PULL | {"name": "dig", "remove": ["drawn"], "duration": 0.002}
    sim = cubes(PULL | {"duration": 0.004}, dig)
    sim.run_stage("pull")
    sim.run()
    state, bolts = sim.core.fields(), sim.build.bolts
    first = bolts.first
    for i, bolt in enumerate(bolts.bolts):
        out = np.array(bolt.places)[:, 0] > 4
        rows = slice(first[i], first[i + 1])
        assert state["bolts.grout_lost"][rows].tolist() == out.tolist()
        assert not np.round(state["bolts.axial_force"][rows][out], 2).any()
        assert np.abs(state["bolts.axial_force"][rows][~out]).max() > 100


def test_pretension_is_that_of_the_head():
    """A rod without grout between a plate and an anchor in rock that gives way very little."""
    bare = {"area": 5e-4, "young_modulus": 2e11, "yield_force": 2e5}
    line = {"points": [[3.99, 1, 1], [0.5, 1, 1]], "plate": True, "anchor": True, "pretension": 5e4}
    rest = {"name": "rest", "mode": "static"}
    sim = cubes(rest, bolts=[line], kind=bare)
    sim.core.run(1)
    np.testing.assert_allclose(sim.core.fields()["bolts.axial_force"][:-1], 5e4, rtol=1e-4)
    assert sim.energies["external"] > 0.5 * 5e4**2 * 3.49 / 1e8


def test_a_bolt_that_is_torn_lets_go():
    kind = BAR | {"rupture_strain": 0.003, "grout": {"stiffness": 1e9, "strength": 1e6}}
    sim = cubes(kind=kind)
    sim.run()
    state = sim.core.fields()
    assert (state["bolts.bar_broken"] == 1).any()
    assert abs(sim.energies["error"]) < 2e-3


def test_histories_and_frames_of_bolts(tmp_path):
    import h5py

    sim = cubes(PULL | {"duration": 0.002}, output=tmp_path / "r")
    sim.run()
    with h5py.File(tmp_path / "r" / "bolts.vtkhdf") as file:
        root = file["VTKHDF"]
        frames = root["Steps"].attrs["NSteps"]
        assert len(root["CellData/axial_force"]) == frames * (
            len(sim.build.bolts.arrays["bolts.grout"]) // 2 - 2
        )
        force = sim.core.fields()["bolts.axial_force"]
        assert np.abs(root["CellData/axial_force"][()]).max() == np.abs(force).max()
