"""Cases that fuzzing starts from name every field of the schema, and every law."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel

from cdem import Case
from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS
from cdem.run.simulation import Simulation

TOOLS = Path(__file__).parents[3] / "tools/torture"
ELSEWHERE = {"own_laws", "mesh"}
"""Need code, or a file of a mesh: other tests and other cases have them."""


def models_in(kind: Any) -> set[type[BaseModel]]:
    """Models that an annotation names, and those that they name."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        found = {kind}
        for field in kind.model_fields.values():
            found |= models_in(field.annotation)
        return found
    return {model for one in getattr(kind, "__args__", ()) for model in models_in(one)}


def declared(model: type[BaseModel], name: str) -> tuple[str, str]:
    """A field with the class that declares it; pairs have the laws of interfaces."""
    first = next(c for c in reversed(model.__mro__) if name in getattr(c, "model_fields", {}))
    return first.__name__.replace("InterfacePair", "Interface"), name


def given_in(part: Any) -> set[tuple[str, str]]:
    """Model and name of each field that a case gives."""
    if isinstance(part, BaseModel):
        found = set()
        for name in part.model_fields_set:
            found |= {declared(type(part), name)} | given_in(getattr(part, name))
        return found
    parts = part.values() if isinstance(part, dict) else part if isinstance(part, list) else ()
    return {one for child in parts for one in given_in(child)}


@pytest.fixture(scope="module")
def seeds(tmp_path_factory):
    """Folder of cases to start from."""
    folder = tmp_path_factory.mktemp("seeds")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(TOOLS))
        import corpus

        corpus.write_cases(folder)
    return folder


def test_every_field_is_in_a_case(seeds):
    given = set()
    for path in [*seeds.glob("parts-*.yaml"), *seeds.glob("law-*.yaml")]:
        case = Case.load(path)
        Simulation(case, threads=1)  # sound to the end: a model is made
        given |= given_in(case)
    wanted = {declared(m, name) for m in models_in(Case) for name in m.model_fields}
    missing = sorted(one for one in wanted - given if one[1] not in ELSEWHERE)
    assert not missing


@pytest.mark.parametrize(
    "name", ["beside-fit", "rockfall_runs-rockfall_runs", "screening-uncertain"]
)
def test_files_beside_the_case_are_sound(seeds, monkeypatch, name):
    monkeypatch.syspath_prepend(str(TOOLS))
    import fuzz

    fuzz.read_case(seeds / f"{name}.yaml")


@pytest.mark.parametrize("name", [*BLOCK_LAWS, *INTERFACE_LAWS])
def test_every_law_has_a_case(seeds, name):
    case = Case.load(seeds / f"law-{name}.yaml")
    laws = {case.materials["rock"].law, case.interfaces.default.law}
    assert name in laws


@pytest.mark.parametrize(("far", "small"), [(14.0, True), (14_000.0, False)])
def test_hundreds_of_planes_through_a_polyhedron_are_not_small(seeds, monkeypatch, far, small):
    """To cut thousands of blocks takes seconds, as it should: no model is made of such a case."""
    monkeypatch.syspath_prepend(str(TOOLS))
    import fuzz

    path = seeds / "templates-bedded_slope.yaml"
    case = Case.load(path, [f"model.blocks.0.polyhedron.vertices.2.0={far}"])
    assert fuzz._is_small(case) == small
