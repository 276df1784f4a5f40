"""Prints the hash of every array of a few models, as JSON."""

import hashlib
import json
import sys
from importlib.resources import files
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent))
from scenes import case

import cdem
from cdem.model.build import build

TURN = {"axis": [1, 2, 3], "angle": 33}


def models():
    """Cases that take every way to an array: joints, triangulated polyhedra, shapes, overlaps."""
    folder = files("cdem") / "templates"
    yield "slope", cdem.Case.load(folder / "slope.yaml")
    yield "landslide", cdem.Case.load(folder / "landslide.yaml")
    for mass in ("exact", "lumped"):
        shapes = ["tet4", "hex8", "wedge6", "pyramid5"]
        blocks = [
            _box(3 * i, {"size": [2, 1, 1], "shape": shape}) for i, shape in enumerate(shapes)
        ]
        yield mass, case(blocks, {"a": {}}, elements={"mass": mass})
    blocks = [_box(x, {"size": [1, 1, 1], "divisions": [2, 2, 2]}) for x in (0, 2)]
    yield "one-point", case(blocks, {"a": {}}, elements={"hexahedra": "one-point"})
    joints = [
        {"name": "x", "group": "a", "dip": 40, "dip_direction": 90, "spacing": 0.7,
         "scatter": {"fisher": 50}, "seed": 2},
        {"name": "y", "normal": [0.1, 1, 0.3], "spacing": 0.8, "persistence": 0.8},
    ]  # fmt: skip
    cut = {"joints": joints, "thinnest": 0.01}
    whole = {"default": {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}}
    tets = _box(0, {"size": [4, 3.3, 3], "divisions": [4, 3, 3], "shape": "tet4"})
    split = {"split": {"a": "elements"}}
    yield "made up for", case([tets], {"a": {}}, defaults=True, interfaces=whole, model=split)
    yield "cut", case([_box(0, {"size": [3, 2, 2]})], {"a": {}}, model=cut)


def _box(x, box):
    """A box that lies askew."""
    return {"group": "a", "box": box, "translate": [x, 0, 0], "rotate": TURN}


def main():
    """Print the hashes."""
    found = {}
    for name, data in models():
        for key, array in build(data).arrays.items():
            found[f"{name} {key}"] = hashlib.sha256(np.ascontiguousarray(array)).hexdigest()
    print(json.dumps(found))


if __name__ == "__main__":
    main()
