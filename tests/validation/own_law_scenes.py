"""Scenes with laws that only the tests have; runs in a process that loads their core.

`python own_law_scenes.py NAME` runs one scene and fails where it is not as theory says.
"""

from __future__ import annotations

import importlib.util
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
GRAVITY = {"gravity": [0, 0, -10.0]}
PEAK, RESIDUAL, SLIP = 40.0, 20.0, 0.0125
WEAK = {
    "law": "weakening",
    "friction_angle": PEAK,
    "residual_angle": RESIDUAL,
    "weakening_slip": SLIP,
}


def load_core() -> None:
    """Let cdem use the core of build/ that has the own laws of the tests."""
    from cdem import _instruction_sets

    (path,) = (ROOT / "build" / "core").glob("_core_own_laws.*.so")
    spec = importlib.util.spec_from_file_location("cdem._core_own_laws", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    for isa in _instruction_sets.NEEDS:
        sys.modules[f"cdem._core_{isa}"] = module


def tangent(slip):
    """tan(phi) of WEAK after so much slip."""
    peak, residual = np.tan(np.radians([PEAK, RESIDUAL]))
    return residual + (peak - residual) * np.maximum(1 - np.asarray(slip) / SLIP, 0)


SPEED = 0.05  # of the slider  [m/s]


def slider(**interface):
    """A block that comes to rest on a bed, then is drawn along it."""
    from scenes import simulate

    damping = {"contact": 0.3, "stiffness": 0.3}
    return simulate(
        [
            {"group": "block", "box": {"size": [1, 1, 0.4]}, "translate": [-2, -0.5, 0]},
            {"group": "bed", "box": {"size": [5, 2, 0.5]}, "translate": [-3, -1, -0.5]},
        ],
        {"block": {}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={"default": WEAK | interface},
        rock={"young_modulus": "0.2 GPa"},
        loads={
            **GRAVITY,
            "velocities": [{"group": "block", "velocity": [0, 0, 0], "components": ["x"]}],
        },
        stages=[
            {"name": "settle", "mode": "dynamic", "duration": 0.2, "damping": damping},
            {
                "name": "slide",
                "mode": "dynamic",
                "duration": 0.35,
                "damping": damping,
                "set": {"loads.velocities.0.velocity": [SPEED, 0, 0]},
            },
        ],
    )


def remembered(state, kind):
    """What the walls remember of their slip [m], and which have the law."""
    from cdem.case.laws import INTERFACE_LAWS

    has = state[f"{kind}.history_law"] == list(INTERFACE_LAWS).index("weakening")
    return state[f"{kind}.history"].reshape(len(has), -1)[:, 0], has


def springs():
    """Semi-springs: the force that draws the block falls with its slip as the law says."""
    sim = slider()
    sim.run_stage("settle")
    bed = sim.build.nodes_of("bed")
    seen = []
    for end in np.arange(0.2125, 0.55, 0.0125):
        sim.run_until(end)
        force = sim.core.fields()["node.reaction"].reshape(-1, 4)[bed].sum(axis=0)
        weight = 0.4 * 2500 * 10  # of the block; the bed carries its own as well
        seen.append((SPEED * (sim.time - 0.2), abs(force[0]) / weight))
    moved, ratio = np.array(seen).T
    # the shear springs stretch by about 3e-5 m; the block still rocks a little
    assert np.allclose(ratio, tangent(moved), rtol=0.02), np.c_[moved, ratio, tangent(moved)]
    state = sim.core.fields()
    slip, has = remembered(state, "spring")
    slip = slip[has]
    assert np.allclose(slip, moved[-1], rtol=0.01), (slip, moved[-1])
    assert abs(sim.energies["error"]) < 0.01, sim.energies


def edges():
    """Semi-edges: the force of every crossing obeys the friction that its side remembers."""
    from scenes import simulate

    along = {"rotate": {"axis": [1, 0, 0], "angle": "45 deg"}, "translate": [-2, 0, 0]}
    across = {"rotate": {"axis": [0, 1, 0], "angle": "45 deg"}, "translate": [-0.4, -2, 1.0605]}
    sim = simulate(
        [
            {"group": "low", "box": {"size": [4, 0.5, 0.5], "divisions": [4, 1, 1]}} | along,
            {"group": "high", "box": {"size": [0.5, 4, 0.5], "divisions": [1, 4, 1]}} | across,
        ],
        {"low": {"fix": ["x", "y", "z"]}, "high": {"velocity": [0.5, 0.1, -0.2]}},
        interfaces={"default": WEAK},
        rock={"young_modulus": "0.1 GPa"},
        loads=GRAVITY,
    )
    seen = []
    for _ in range(200):
        sim.step(1)
        state = sim.core.fields()
        rows = state["edge.state"].reshape(-1, 8)
        side = state["edge.contact"].reshape(-1, 4)[:, 0]
        slip, _ = remembered(state, "edge")
        for (normal, _, s1, s2, *_), history in zip(rows, slip[side], strict=True):
            if normal > 0 and history > 0:
                seen.append((np.hypot(s1, s2) / normal, history))
    ratio, history = np.array(seen).T
    assert len(ratio) > 20 and np.ptp(ratio) > 0.01, (history.max(), ratio)
    # the limit of a step is that of the slip before it
    assert (ratio < tangent(history) + 0.01).all() and (ratio > tangent(history) - 0.01).any()


def bonds():
    """Bond points: a bond that breaks slides on, and its slip goes to the contacts at release."""
    sim = slider(cohesion="20 kPa")
    sim.run_stage("settle")
    slipped = 0.0
    for _ in range(2000):
        sim.run_until(sim.time + 2e-4)
        state = sim.core.fields()
        if state["overlaps.status"][0] == 0:
            break
        slipped = state["overlaps.history"].max()
    assert state["overlaps.status"][0] == 0 and sum(sim.broken.values()) > 0
    assert slipped > 1e-4
    walls, has = remembered(state, "spring")
    walls = walls[has]
    assert len(walls) >= 8 and walls.max() >= 0.99 * slipped, (walls, slipped)
    assert abs(sim.energies["error"]) < 0.01, sim.energies


def two_laws():
    """Brittle contacts give the same bits whether or not another law acts in the model."""
    from scenes import simulate

    def scene(far):
        pairs = [{"between": ["far", "bed"], **far}]
        sim = simulate(
            [
                {"group": "near", "box": {"size": [1, 1, 0.4]}, "translate": [-2, -0.5, 0]},
                {"group": "far", "box": {"size": [1, 1, 0.4]}, "translate": [2, -0.5, 0]},
                {"group": "bed", "box": {"size": [8, 2, 0.5]}, "translate": [-4, -1, -0.5]},
            ],
            {
                "near": {"velocity": [1, 0, 0]},
                "far": {"velocity": [0.1, 0, 0]},
                "bed": {"fix": ["x", "y", "z"]},
            },
            interfaces={"default": {"friction_angle": 30}, "pairs": pairs},
            rock={"young_modulus": "0.1 GPa"},
            loads=GRAVITY,
            time={"step": "0.1 ms"},
        )
        sim.step(300)
        return sim.fields["position"][sim.build.nodes_of("near")].tobytes()

    assert scene(WEAK) == scene({"friction_angle": 40})


def plasticity():
    """A bar that is pulled yields: axial stress, plastic strain and work as theory says."""
    from scenes import simulate

    young, yield_stress, speed, steps = 1e9, 1e6, 0.05, 3000
    for shape in ("hex8", "tet4", "wedge6", "pyramid5"):
        sim = simulate(
            [{"group": "bar", "box": {"size": [1, 1, 1], "divisions": [1, 1, 2], "shape": shape}}],
            {"bar": {}},
            rock={
                "law": "perfectly-plastic",
                "yield_stress": yield_stress,
                "young_modulus": young,
                "density": 2500,
            },
            loads={
                "supports": [
                    {"surface": {"group": "bar", "normal": [-1, 0, 0]}, "fix": ["x"]},
                    {"surface": {"group": "bar", "normal": [0, -1, 0]}, "fix": ["y"]},
                    {"surface": {"group": "bar", "normal": [0, 0, -1]}, "fix": ["z"]},
                ],
                "velocities": [
                    {
                        "surface": {"group": "bar", "normal": [0, 0, 1]},
                        "velocity": [0, 0, speed],
                        "components": ["z"],
                        "history": [[0, 0], [0.02, 1]],
                    }
                ],
            },
            stages=[
                {
                    "name": "pull",
                    "mode": "dynamic",
                    "duration": 1.0,
                    "damping": {"stiffness": 0.5},
                }
            ],
            time={"step": "20 us"},
        )
        sim.step(steps)
        strain = speed * (sim.time - 0.01)
        stress = sim.core.stress()[shape].reshape(6, -1)[2]
        count = sim.build.assembly.counts[f"{shape}.count"]
        energies = sim.energies
        assert np.allclose(stress[:count], yield_stress, rtol=0.01), (shape, stress[:count])
        work = yield_stress * (strain - yield_stress / young)
        assert abs(energies["plastic"] / work - 1) < 0.01, (shape, energies, work)
        assert abs(energies["error"]) < 1e-3, (shape, energies)


def results():
    """States are output fields, survive a restart, and are in the schema; mistakes are told."""
    import cdem
    from cdem.errors import CaseError

    schema = str(cdem.Case.schema())
    assert "residual_angle" in schema and "yield_stress" in schema
    for wrong, told in (
        ({"residual_angle": 50}, "residual_angle must not be larger than friction_angle, 40"),
        ({"weakening_slip": -1}, "weakening_slip"),
        ({"law": "weakning"}, "law"),
        ({"dilation_angle": 3}, "dilation_angle"),
    ):
        try:
            slider(**wrong)
        except CaseError as error:
            assert told in str(error), str(error)
        else:
            raise AssertionError(f"{wrong} was accepted")
    with tempfile.TemporaryDirectory() as folder:
        from cdem.output.reader import FrameSeries

        def case():
            short = slider().case
            short.stages[0].duration, short.stages[1].duration = 0.02, 0.2
            short.output.every = 0.05
            return short

        whole = cdem.Simulation(case(), output=f"{folder}/a", threads=1)
        whole.run()
        half = cdem.Simulation(case(), output=f"{folder}/b", threads=1)
        half.run_until(0.1)
        half.checkpoint()
        half.close()
        rest = cdem.Simulation(case(), output=f"{folder}/b", threads=1, resume=True)
        rest.run()
        own, other = whole.core.fields(), rest.core.fields()
        assert own.keys() == other.keys()
        differ = [name for name in own if not np.array_equal(own[name], other[name])]
        assert differ == [], differ
        frames = FrameSeries(Path(folder) / "a")
        slip = frames.field("CellData", "joint_slip", len(frames) - 1)
        assert 0.8 * SPEED * 0.2 < slip.max() < 1.01 * SPEED * 0.2, slip


def copies():
    """Copies of mohr-coulomb and voellmy give the same bits as the built-in laws."""
    from shared.own_laws import differences, flow

    import cdem

    ended = []
    with tempfile.TemporaryDirectory() as folder:
        for prefix in ("", "copied-"):
            path = Path(folder) / "case.yaml"
            path.write_text(flow(prefix))
            sim = cdem.Simulation(path, threads=1)
            sim.run()
            ended.append((sim.core.fields(), sim.energies))
    (one, energies), (other, same) = ended
    assert energies == same and energies["plastic"] > 100 and energies["friction"] > 100, energies
    assert differences(one, other) == []


def foundation():
    """A cube on springs to the ground: it settles by m g / (k A), swings with (k A / m)^1/2, tears off.

    Thrown up by v it rises on the springs to the pull T that they bear, at T / k, and leaves with
    (v^2 - (w T / k)^2)^1/2. A wedge on triangles beside it does the same.
    """
    from scenes import simulate

    mass, modulus, strength, thrown = 2500.0, 1e6, 1e4, 0.3
    spin = np.sqrt(modulus / mass)
    entry = {"law": "foundation", "modulus": modulus}
    blocks = [
        {"group": name, "box": {"size": [1, 1, 1], "shape": shape}, "translate": [3 * i, 0, 0]}
        for i, (name, shape) in enumerate((("cube", "hex8"), ("wedge", "tet4")))
    ]

    def stand(**more):
        down = [{"surface": {"group": b["group"], "normal": [0, 0, -1]}} | entry for b in blocks]
        groups = {b["group"]: {"velocity": [0, 0, more.pop("up", 0)]} for b in blocks[:1]}
        groups |= {"wedge": dict(groups["cube"])}
        extra = {"tensile_strength": strength} if more.pop("tears", False) else {}
        surfaces = {"surfaces": [one | extra for one in down]}
        return simulate(
            blocks, groups, rock={"young_modulus": 1e10, "density": mass},
            loads=surfaces | more.pop("loads", {}), **more,
        )  # fmt: skip

    rest = {"name": "rest", "mode": "static", "tolerance": 1e-7, "relax": "adaptive"}
    sim = stand(loads=GRAVITY, stages=[rest])
    sim.run()
    down = sim.fields["displacement"][:, 2]
    assert np.allclose(down, -mass * 10 / modulus, rtol=2e-3), down
    sim = stand(up=thrown)
    for end in np.linspace(0.01, 0.3, 12):
        sim.run_until(end)
        for group in ("cube", "wedge"):
            up = sim.fields["displacement"][sim.build.nodes_of(group), 2].mean()
            # reached 3e-4: the cube is an elastic one
            assert abs(up - thrown / spin * np.sin(spin * sim.time)) < 2e-3 * thrown / spin, end
    # what the springs have taken from the motion
    total = -sum(sim.energies[name] for name in ("kinetic", "strain")) + sim.energies["surface"]
    assert abs(total + mass * thrown**2) < 1e-3 * mass * thrown**2, sim.energies
    sim = stand(up=thrown, tears=True)
    sim.run_until(0.2)
    left = np.sqrt(thrown**2 - (spin * strength / modulus) ** 2)
    for group in ("cube", "wedge"):
        speed = sim.fields["velocity"][sim.build.nodes_of(group), 2].mean()
        assert abs(speed - left) < 0.02 * left, (group, speed, left)
    lost = [sim.core.fields()[f"surface_{kind}.history"] for kind in ("quads", "triangles")]
    assert [int((one > 0).sum()) for one in lost] == [4, 6], lost


def pinned():
    """Print the hashes of the pinned scenes, which have none of these laws: test_golden.py."""
    sys.path.insert(0, str(ROOT / "tests" / "regression"))
    import golden_scenes

    golden_scenes.main()


if __name__ == "__main__":
    sys.path[:0] = [str(ROOT / "tests")]
    load_core()
    globals()[sys.argv[1]]()
