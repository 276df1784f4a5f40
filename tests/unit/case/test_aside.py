"""Readers in a process of their own: what they give, and what is said when they die or hang."""

import numpy as np
import pytest

from cdem.case import aside
from cdem.errors import CaseError, MeshError

READER = """
import os, re
import numpy as np
from cdem.case import aside
from cdem.errors import MeshError
aside.LEAST_SECONDS = 0.2

def act(path, asked):
    text = path.read_text()
    if text == "die":
        os.abort()
    if text == "hang":  # in compiled code, where Python cannot end it
        re.match("(a+)+$", "a" * 60 + "b")
    if text == "leave":
        os._exit(0)
    if text == "refuse":
        raise MeshError(f"{path}: is not good")
    if text == "raise":
        raise ValueError("bad bytes")
    if text == "tell":
        return {"told": np.array(asked)}
    return {"read": np.frombuffer(text.encode(), np.uint8)}

if __name__ == "__main__":
    aside.answer(act, "mend it")
"""


@pytest.fixture
def ask(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "reader_of_a_test.py").write_text(READER)

    def ask(text, **more):
        path = tmp_path / "a.bin"
        path.write_text(text)
        return aside.read("reader_of_a_test", path.relative_to(tmp_path), "mend it", **more)

    return ask


def test_arrays_come_back(ask):
    assert np.array_equal(ask("abc")["read"], [97, 98, 99])
    assert np.array_equal(ask("tell", asked=[1.5, 2])["told"], [1.5, 2])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("die", "a.bin: reading it ends its reader; mend it"),
        ("leave", "a.bin: reading it ends its reader; mend it"),
        ("hang", "a.bin: reading it does not come to an end; mend it"),
        ("refuse", "a.bin: is not good"),
        ("raise", "a.bin: cannot be read (bad bytes); mend it"),
    ],
)
def test_what_goes_wrong_is_one_message(ask, text, message):
    with pytest.raises(MeshError) as caught:
        ask(text)
    assert str(caught.value) == message
    with pytest.raises(CaseError):
        ask(text, kind=CaseError)
