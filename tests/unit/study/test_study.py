"""Studies: mistakes in the file."""

from __future__ import annotations

import pytest

from cdem.errors import CaseError


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("parameterz: {}", "study.yaml:2:1: parameterz: unknown key; did you mean parameters?"),
        ("parameters: {}", "parameters: needs at least 1 entry, got 0"),
        (
            "parameters: {a.b: {}}",
            "study.yaml:2:14: parameters.a.b: give exactly one of values, gr",
        ),
        ("parameters: {a.b: {normal: {mean: 1, sd: 2}}}", "sd: unknown key"),
        ("parameters: {a.b: {uniform: {low: 2, high: 1}}}", "low 2 must be below high 1"),
        ("parameters: {a.b: {triangular: {low: 0, mode: 3, high: 1}}}", "mode 3 must lie between"),
        ("parameters: {a.b: {uniform: {low: 0, high: 1}}}", "needs sampling: {count: 100}"),
        ("parameters: {a.b: [1]}\nsampling: {count: 2}", "no parameter has a distribution"),
        ("parameters: {phi: [1]}", "parameters.phi: is neither used by a formula nor a path"),
        ("parameters: {phi: [1]}\nset: {a.b: = ph + 1}", "'ph' is unknown; did you mean phi?"),
        ("parameters: {phi: [1]}\nset: {a.b: = open(phi)}", "function 'open' is unknown"),
        ('parameters: {phi: [1]}\nset: {a.b: "= phi.x[0]"}', "a formula is made of numbers"),
        ("parameters: {phi: [1]}\nset: {a.b: = 1 +}", "is not a formula"),
        ("parameters: {a.b: [1], c.d: [1, 2]}\ncombine: together", "got a.b 1, c.d 2"),
        ("parameters: {a.b: [1]}\ncritical: {between: [1, 2]}", "give either parameter or factor"),
        (
            "parameters: {a.b: [1]}\ncritical: {parameter: a.b, between: [1, 2]}",
            "critical.parameter: 'a.b' is also given by parameters; vary it once",
        ),
        (
            "parameters: {a.b: {grid: {first: 0, last: 1, count: 10001}}, "
            "c.d: {grid: {first: 0, last: 1, count: 10001}}}",
            "combine: 100,020,001 runs are too many; the limit is 1,000,000",
        ),
        ("parameters: {a.b: [1]}\nresults: {error: time}", "a column of every table"),
        ("parameters: {a.b: [1]}\nplots: [{lines: x}]", "lines needs x"),
        ("parameters: {a.b: [1]}\nplots: [{lines: f, x: a.c}]", "'a.c' is unknown; did you"),
        (
            "parameters: {a.b: [1]}\nresults: {f: time}\nplots: [{tornado: g}]",
            "study.yaml:4:10: plots.0.tornado: result 'g' is unknown; there are: f",
        ),
    ],
)
def test_mistakes_are_answered_with_their_place(study, text, message):
    with pytest.raises(CaseError) as error:
        study(text)
    assert message in str(error.value)
    assert str(error.value).startswith("study.yaml:")
