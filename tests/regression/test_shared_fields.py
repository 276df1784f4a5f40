"""Arrays of a shared model, one by one, are those of the whole, also where a rank has no rows."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from scenes import case
from shared.ranks import on_ranks

import cdem
from cdem.ranks import shared_core
from cdem.ranks.parts import Parts

TOUGH = {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}


def falling():
    """Bonded tets, and bonded hexahedra far from them, by a law with state, and damped."""
    blocks = [
        {"group": "a", "box": {"size": [3, 1, 1], "divisions": [3, 1, 1], "shape": "tet4"}},
        {"group": "b", "box": {"size": [9, 1, 1], "divisions": [18, 1, 1]}, "translate": [90, 0, 0]},
    ]  # fmt: skip
    model = {"split": {"a": "elements", "b": "elements"}}
    damped = {"damping": {"rayleigh": {"ratio": 0.05, "frequency": 100}}}
    stages = [{"name": "fall", "mode": "dynamic", "duration": 1, **damped}]
    softening = {"law": "softening", "fracture_energy_1": 1e4, "fracture_energy_2": 1e4}
    simulation = cdem.Simulation(
        case(blocks, {"a": {"velocity": [0, 1, 0]}, "b": {"velocity": [0, 0, 1]}},
             interfaces={"default": TOUGH | softening}, model=model, stages=stages),
        threads=1,
    )  # fmt: skip
    simulation.step(10)
    return simulation


def by_shape(core, mesh, count, work):
    """A rank for the tets, and one for all other elements."""
    of_element = (np.arange(mesh.count) >= len(mesh.tables[0][2])).astype(int)
    return Parts(of_element, of_element[mesh.lowest_element(mesh.corner_node.max() + 1)])


def test_arrays_gathered_one_by_one_are_those_of_the_whole(monkeypatch):
    monkeypatch.setattr(shared_core, "divide", by_shape)
    expected = {name: np.array(array) for name, array in falling().core.fields().items()}

    def differ():
        core = falling().core
        shapes = [kind for kind in ("tet4", "hex8") if len(core._slice.own[kind])]
        found = {}
        for name in expected:
            core._forget_whole()  # else one that needs the whole state spares all others
            found[name] = np.array(core.fields()[name])
        return shapes, [n for n in expected if found[n].tobytes() != expected[n].tobytes()]

    assert on_ranks(2, lambda _: differ(), timeout=30) == [(["tet4"], []), (["hex8"], [])]
