"""Whatever stands at a place of a case, it is taken or refused with one error."""

import math
import random
import sys
from copy import deepcopy
from pathlib import Path

import pytest

from cdem import Case, CaseError

sys.path.insert(0, str(Path(__file__).parents[1] / "regression"))
from test_resume_stages import SCENES

ODD = ([], ["r"], {}, {"a": 1}, [[1]], None, 7, -1e300, math.nan, True, "x" * 2000, "")


def places(tree, path=()):
    """Paths of all values in nested dicts and lists."""
    for key in tree if isinstance(tree, dict) else range(len(tree)):
        yield (*path, key)
        if isinstance(tree[key], dict | list):
            yield from places(tree[key], (*path, key))


def mutated(tree, path, value):
    """A copy with another value at a place."""
    tree = deepcopy(tree)
    node = tree
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = deepcopy(value)
    return tree


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
def test_an_odd_value_anywhere_is_taken_or_refused(scene, tmp_path):
    """Lists, mappings, numbers, nothing, NaN and long texts at every place: a `CaseError` at most."""
    tree = SCENES[scene]()
    every = [(path, value) for path in places(tree) for value in ODD]
    for path, value in random.Random(1).sample(every, 430):  # 3,010 of all scenes
        try:
            Case.from_dict(mutated(tree, path, value))
        except CaseError:
            pass
        except Exception as error:
            raise AssertionError(f"{'.'.join(map(str, path))}: {value!r:.40}") from error


@pytest.mark.parametrize("value", [["elastic"], {"a": 1}, 7, None, math.nan])
@pytest.mark.parametrize(
    "path",
    [("materials", "r", "law"), ("interfaces", "default", "law"), ("groups", "ground", "material")],
)
def test_an_odd_name_is_refused_in_one_error(path, value):
    """A list for a law or a material is no traceback."""
    tree = mutated(SCENES["dam"](), path, value)
    with pytest.raises(CaseError, match=path[-1] if path[-1] == "material" else "law|material"):
        Case.from_dict(tree)


def test_an_odd_material_that_a_stage_sets_is_refused():
    """`set: {groups.g.material: [r]}` is one error that names the place."""
    tree = SCENES["dam"]()
    tree["stages"][1]["set"] = {"groups.block.material": ["r"]}
    with pytest.raises(CaseError, match=r"groups\.block\.material: must be a text"):
        Case.from_dict(tree)
