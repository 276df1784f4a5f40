"""One fault that `tools/mutants.py` plants."""

from typing import NamedTuple

FAILURE = "tests/validation/test_failure.py::"
PINNED = "tests/regression/test_golden.py::test_results_are_those_pinned"


class Mutant(NamedTuple):
    """What might go wrong in one line, and the quickest test for it.

    Attributes:
        name: For the command line.
        fault: What it stands for.
        file: Where it is planted.
        old: Text that occurs once in the file.
        new: Text that takes its place.
        test: A file of tests/core, or words for pytest.
    """

    name: str
    fault: str
    file: str
    old: str
    new: str
    test: str
