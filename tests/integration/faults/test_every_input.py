"""Each input of `tests/faults` is named by a test of this folder, or by an input that one names."""

import re
from pathlib import Path

from shared.faults import FAULTS


def test_each_input_is_named_by_a_test():
    inputs = [path for path in sorted(FAULTS.rglob("*")) if path.is_file()]
    assert len(inputs) == 48
    tests = [path for path in Path(__file__).parent.glob("test_*.py") if path != Path(__file__)]
    for path in inputs:
        others = [*tests, *(other for other in path.parent.glob("*.yaml") if other != path)]
        assert any(re.search(rf"\b{path.stem}\b", other.read_text()) for other in others), path
