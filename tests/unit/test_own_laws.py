"""Laws of users: no case builds or loads code by itself, and no library fits but its own."""

import importlib.util
import json
import os
import subprocess
import sys

import pytest
from shared.own_laws import flow

from cdem import own_laws
from cdem._core_choice import choose
from cdem.errors import BackendError, CaseError
from cdem.tools.law_build import Header, build, new_law

HEADER = "my_clay.hpp"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A working folder with a header and a case that names it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv(own_laws.VARIABLE, raising=False)
    new_law("my-clay", "block", tmp_path, force=False)
    (tmp_path / "case.yaml").write_text(flow(own_laws=f"[{HEADER}]"))
    return tmp_path


@pytest.fixture
def library(folder):
    """A file that passes for the library of the header until it is loaded."""
    path = own_laws.library_of([folder / HEADER], choose())
    path.write_bytes(b"no library")
    record = own_laws.record_of([folder / HEADER], choose())
    record["library"] = own_laws.digest(path)
    path.with_suffix(".json").write_text(json.dumps(record))
    return path


def cdem(*words):
    """Run the program in a process of its own."""
    command = [sys.executable, "-m", "cdem", *words]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ)


@pytest.mark.parametrize(
    "words",
    [
        ["run", "case.yaml"],
        ["check", "case.yaml"],
        ["critical", "case.yaml", "--factor", "--between", "1", "2"],
        ["law", "test", HEADER, "--path", "uniaxial"],
    ],
)
def test_code_is_refused_in_one_line(library, run_cli, words):
    status, out, err = run_cli(*words)
    assert status == 1 and out == "" and err.count("\n") == 1
    assert HEADER in err and "--allow-code" in err
    if words[0] != "law":
        assert err.startswith("case.yaml:2:12: own_laws.0: ")


def test_allowed_code_is_loaded(library):
    done = cdem("check", "case.yaml", "--allow-code")
    assert done.returncode and "my_clay" in done.stderr and "too short" in done.stderr


def test_a_library_must_be_there(folder):
    done = cdem("check", "case.yaml", "--allow-code")
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert "has no library for the instruction set" in done.stderr
    assert f"cdem law build {folder / HEADER}" in done.stderr
    assert sorted(p.name for p in folder.iterdir()) == ["case.yaml", HEADER, "test_my_clay.py"]


@pytest.mark.parametrize(
    "change, told",
    [
        ({"version": "0.0.9"}, "was made for cdem 0.0.9, this is"),
        ({"abi": 0}, "was made for cdem"),
        ({"instruction_set": "v1"}, "was made for another instruction set"),
        ({"sources": ""}, "was made from other sources of cdem"),
        ({"headers": {}}, "was made from another text of its headers"),
        ({"library": ""}, "is not what cdem law build has written"),
    ],
)
def test_another_library_is_refused(library, change, told):
    record = library.with_suffix(".json")
    record.write_text(json.dumps(json.loads(record.read_text()) | change))
    with pytest.raises(BackendError, match=f"{told}.*; make it again: cdem law build"):
        own_laws.load_own_laws(HEADER)


def test_a_header_that_has_changed_is_refused(library, folder):
    with (folder / HEADER).open("a") as file:
        file.write("\n")
    with pytest.raises(BackendError, match="another text of its headers"):
        own_laws.load_own_laws(HEADER)


def test_laws_are_chosen_before_all_else(library):
    with pytest.raises(BackendError, match="before anything else"):
        own_laws.load_own_laws(HEADER)  # this process has a core already


def test_headers(folder):
    assert Header.read(folder / HEADER).law == "my-clay"
    text = (folder / HEADER).read_text()
    for old, new, told in (
        ("LawText text", "LawText other", "has 0 laws"),
        ('"my-clay"', '"my clay"', "the law's name 'my clay'"),
        ("flow(", "stream(", "needs flow"),
        ('#include "core/materials/law.hpp"', '#include "more.hpp"', 'includes "more.hpp"'),
        ('"my-clay"', '"mohr-coulomb"', "there is a law mohr-coulomb already"),
    ):
        (folder / "wrong.hpp").write_text(text.replace(old, new))
        with pytest.raises(CaseError, match=told):
            build([folder / "wrong.hpp"])
    with pytest.raises(CaseError, match="a law's name is of small letters"):
        new_law("MyClay", "block", folder, force=False)
    with pytest.raises(CaseError, match="exists already"):
        new_law("my-clay", "block", folder, force=False)


def test_a_build_without_its_tools_says_what_to_install(folder, monkeypatch):
    """Also where the system has a cmake of its own."""
    there = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda n: None if n == "nanobind" else there(n)
    )
    with pytest.raises(BackendError, match=r"finds no nanobind: pip install 'cdem\[laws\]'"):
        build([folder / HEADER])
