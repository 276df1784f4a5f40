"""Where the values of a case come from."""

import json

from cdem.case.source import Source


def test_it_goes_as_json_to_another_process_and_back():
    places = {("a",): (1, 2), ("b", 0, "c"): (3, 4)}
    source = Source("case.yaml", places, {("b", 1): "study.yaml:2:1: b.1"})
    assert Source.of(json.loads(json.dumps(source.as_dict()))) == source
    assert Source.of(Source().as_dict()) == Source()


def test_many_problems_are_cut_short():
    error = Source().error([(("a", i), "is wrong") for i in range(50)])
    assert str(error).count("\n") == 20
    assert str(error).endswith("... and 30 more")
