"""Where the values of a case come from."""

from cdem.case.source import Source


def test_many_problems_are_cut_short():
    error = Source().error([(("a", i), "is wrong") for i in range(50)])
    assert str(error).count("\n") == 20
    assert str(error).endswith("... and 30 more")
