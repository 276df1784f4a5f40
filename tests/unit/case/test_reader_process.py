"""Readers in a process of their own: what they give, and what is said when they die or hang."""

import sys

import numpy as np
import pytest

from cdem.case import reader_process
from cdem.errors import CaseError, MeshError

READER = """
import os, re, time
import numpy as np
from cdem.case import reader_process
from cdem.errors import MeshError
from cdem.case import input_file
input_file.LEAST_SECONDS = 0.2

def act(path, asked):
    text = path.read_text()
    if text == "die":
        os.abort()
    if text == "hang":  # in compiled code, where Python cannot end it
        re.match("(a+)+$", "a" * 60 + "b")
    if text == "loop":
        while True:
            pass
    if text == "wait":  # as on a busy machine: no processor time is taken
        time.sleep(2)
    if text == "ask":
        return {"told": np.array(reader_process.ask({"size": 3}))}
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
    reader_process.answer(act, "mend it")
"""


@pytest.fixture
def ask(tmp_path, monkeypatch):
    (tmp_path / "modules").mkdir()
    (tmp_path / "modules/reader_of_a_test.py").write_text(READER)
    monkeypatch.syspath_prepend(str(tmp_path / "modules"))
    monkeypatch.chdir(tmp_path)

    def ask(text, **more):
        path = tmp_path / "a.bin"
        path.write_text(text)
        return reader_process.read(
            "reader_of_a_test", path.relative_to(tmp_path), "mend it", **more
        )

    return ask


def test_arrays_come_back(ask):
    assert np.array_equal(ask("abc")["read"], [97, 98, 99])
    assert np.array_equal(ask("tell", asked=[1.5, 2])["told"], [1.5, 2])
    assert ask("ask", reply=lambda question: [question["size"], 4])["told"].tolist() == [3, 4]
    assert ask("wait").keys() == {"read"}


def test_what_the_answer_raises_passes(ask):
    def refuse(question):
        raise CaseError("not this part")

    with pytest.raises(CaseError, match="not this part"):
        ask("ask", reply=refuse)


def test_wall_time_is_a_last_resort_and_is_told(ask, monkeypatch):
    monkeypatch.setattr(reader_process, "START", 0.0)
    monkeypatch.setattr(reader_process, "PATIENCE", 0.1)
    with pytest.raises(MeshError, match=r"no answer in 0 s; is the machine or the disk busy\?"):
        ask("wait")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "die",
            "a.bin: its reader crashed (SIGABRT); the file may be damaged, or memory too small; mend it",
        ),
        ("leave", "a.bin: its reader ended without a message (status 0); mend it"),
        (
            "hang",
            "a.bin: reading it takes more than 3 s of processor time, longer than a sound file of its size; mend it",
        ),
        (
            "loop",
            "a.bin: reading it takes more than 0.2 s of processor time, longer than a sound file of its size; mend it",
        ),
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


def test_nothing_is_imported_from_the_current_folder(ask, tmp_path):
    """A stranger's folder has modules of names that readers import."""
    for name in ("json", "numpy", "h5py", "reader_of_a_test", "sitecustomize", "usercustomize"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    for folder in ("", ".", str(tmp_path)):
        sys.path.insert(0, folder)
        try:
            assert ask("abc").keys() == {"read"}
        finally:
            sys.path.remove(folder)
    assert not (tmp_path / "ran").exists()
