"""YAML texts that would cost hours or gigabytes, or make what no case has, are refused at once."""

import pytest

from cdem.case.yaml_text import DEEPEST, parse
from cdem.errors import CaseError

BOMB = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{new}: &{new} [{', '.join([f'*{old}'] * 9)}]\n"
    for old, new in zip("abcdef", "bcdefg", strict=True)
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: " + "[" * 300 + "]" * 300, "t:1:44: not valid YAML: more than 40 open brackets"),
        ("a: " + "{b: " * 100_000, "more than 40 nested lists and mappings"),
        ("- " * 300 + "x", "t:1:81: more than 40 nested lists and mappings; look for"),
        ("a: 1\nb: " + "9" * 5000, "t:2:4: not valid YAML: this is not a valid int"),
        ("a: 0x_", "t:1:4: not valid YAML: this is not a valid int"),
        ("a: !!int abc", "this is not a valid int"),
        ("a: &self\n  <<: *self\n", "t:2:7: not valid YAML: *self is inside its own anchor"),
        ("a: &self [1, *self]\n", "t:1:14: not valid YAML: *self is inside its own anchor"),
        (BOMB, "t:6:8: not valid YAML: aliases repeat more than 100,000 values"),
        (
            "a: !!python/object:os.system [ls]",
            "t:1:4: not valid YAML: the tag !!python",
        ),
        ("a: !!set {b}", "the tag !!set is not allowed"),
        ("a: !mine [b]", "the tag !mine is not allowed"),
    ],
)
def test_what_is_refused(text, message):
    with pytest.raises(CaseError) as caught:
        parse(text, "t")
    assert message in str(caught.value)


def test_what_looks_like_a_date_is_a_text():
    assert parse("a: 2026-13-01\nb: 2026-11-25\n", "t") == {"a": "2026-13-01", "b": "2026-11-25"}


def test_lists_may_stand_inside_one_another():
    tree = parse("[" * DEEPEST + "]" * DEEPEST, "t")
    for _ in range(DEEPEST - 1):
        (tree,) = tree
    assert tree == []


def test_an_anchor_may_be_used_often():
    tree = parse("a: &a [1, 2]\nb: [" + "*a, " * 1000 + "*a]", "t")
    assert len(tree["b"]) == 1001 and tree["b"][-1] == [1, 2]
