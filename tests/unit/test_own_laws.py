"""Laws of users: no case builds or loads code by itself, and no library fits but its own."""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from shared.own_laws import flow

from cdem import own_laws
from cdem._core_choice import choose
from cdem.errors import BackendError, CaseError
from cdem.tools import law_build
from cdem.tools.law_build import Header, build, new_law

HEADER = "my_clay.hpp"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A working folder with a header and a case that names it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv(own_laws.VARIABLE, raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    new_law("my-clay", "block", tmp_path, overwrite=False)
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
    assert "has no compiled library of its present text for cdem" in done.stderr
    assert f"cdem law build {folder / HEADER}" in done.stderr
    assert sorted(p.name for p in folder.iterdir()) == [
        "cache",
        "case.yaml",
        HEADER,
        "test_my_clay.py",
    ]


def test_a_library_that_was_changed_is_refused(library):
    library.write_bytes(b"another library")
    with pytest.raises(
        BackendError, match=r"differs from the file that .* wrote; make it again: cdem law"
    ):
        own_laws.load_own_laws(HEADER)
    library.with_suffix(".json").write_text("[]")
    with pytest.raises(BackendError, match="cannot be read"):
        own_laws.load_own_laws(HEADER)


@pytest.mark.parametrize("what", ["__version__", "ABI"])
def test_another_version_has_another_library(library, folder, monkeypatch, what):
    monkeypatch.setattr(own_laws, what, "0.0.9")
    assert own_laws.library_of([folder / HEADER], choose()) != library
    with pytest.raises(BackendError, match=r"has no compiled library .*; make it: cdem law build"):
        own_laws.load_own_laws(HEADER)


def test_a_header_that_has_changed_is_refused(library, folder):
    with (folder / HEADER).open("a") as file:
        file.write("\n")
    with pytest.raises(BackendError, match="has no compiled library of its present text"):
        own_laws.load_own_laws(HEADER)


def test_a_library_beside_the_header_is_not_loaded(library, folder):
    """A stranger's folder has a library and a record with the right digests in all places beside."""
    for name in (library.name, f"my_clay.{choose()}.so"):
        (folder / name).write_bytes(library.read_bytes())
        (folder / name).with_suffix(".json").write_text(library.with_suffix(".json").read_text())
    library.unlink()
    done = cdem("check", "case.yaml", "--allow-code")
    assert done.returncode == 1 and "has no compiled library of its present text" in done.stderr


def test_a_folder_that_others_may_write_is_refused(library):
    library.parent.chmod(0o777)
    with pytest.raises(BackendError, match="another user owns it or may write there"):
        own_laws.load_own_laws(HEADER)
    library.parent.chmod(0o700)
    own = library.parent.rename(library.parent.with_name("mine"))
    library.parent.symlink_to(own)
    with pytest.raises(BackendError, match="is a link"):
        own_laws.load_own_laws(HEADER)


@pytest.mark.parametrize(
    "line",
    [
        '#include "more.hpp"', "#include </tmp/more.hpp>", '#include "core/../more.hpp"',
        "#include <../more.hpp>", "# /* */ include MORE", "%:include <a/b.h>", '#embed "x"',
        '#inc\\\nlude "more.hpp"',
    ],
)  # fmt: skip
def test_a_header_includes_no_other_file(folder, line):
    with (folder / HEADER).open("a") as file:
        file.write(line + "\n")
    with pytest.raises(CaseError, match="a law is a single header"):
        Header.read(folder / HEADER)


def test_laws_are_chosen_before_all_else(library):
    with pytest.raises(BackendError, match="before any other use"):
        own_laws.load_own_laws(HEADER)  # this process has a core already


def test_headers(folder):
    assert Header.read(folder / HEADER).law == "my-clay"
    text = (folder / HEADER).read_text()
    for old, new, told in (
        ("LawText text", "LawText other", "has 0 laws"),
        ('"my-clay"', '"my clay"', "the law's name 'my clay'"),
        ("flow(", "stream(", "needs a method flow"),
        ('#include "core/materials/law.hpp"', '#include "more.hpp"', 'includes "more.hpp"'),
        ('"my-clay"', '"mohr-coulomb"', "the name mohr-coulomb is taken by another law"),
    ):
        (folder / "wrong.hpp").write_text(text.replace(old, new))
        with pytest.raises(CaseError, match=told):
            build([folder / "wrong.hpp"])
    with pytest.raises(CaseError, match="a law's name may only have small letters"):
        new_law("MyClay", "block", folder, overwrite=False)
    with pytest.raises(CaseError, match="exists already"):
        new_law("my-clay", "block", folder, overwrite=False)


def test_a_build_without_its_tools_says_what_to_install(folder, monkeypatch):
    """Also where the system has a cmake of its own."""
    there = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda n: None if n == "nanobind" else there(n)
    )
    with pytest.raises(BackendError, match=r"finds no nanobind: pip install 'cdem\[laws\]'"):
        build([folder / HEADER])


def test_what_a_killed_build_has_left_goes_with_the_next(folder, monkeypatch):
    """A build that is still at work keeps its folder."""
    home, made = own_laws.home(), []

    def compiled(headers, isa, place):
        made.append(place)
        (place / "built.so").write_bytes(b"library")
        return place / "built.so"

    monkeypatch.setattr(law_build, "_compile", compiled)
    left = home / "build-left"
    left.mkdir()
    (left / "lock").touch()
    (left / "large.o").touch()
    wait = (
        "import time; from cdem.tools.law_build import _workplace as w\n"
        "with w() as f: print(f, flush=True); time.sleep(60)"
    )
    other = subprocess.Popen([sys.executable, "-c", wait], stdout=subprocess.PIPE, text=True)
    try:
        at_work = Path(other.stdout.readline().strip())
        assert not left.exists() and at_work.parent == home
        library = build([folder / HEADER])
        assert library.read_bytes() == b"library"
        assert made[0].parent == home and not made[0].exists()
        assert at_work.exists()
    finally:
        other.kill()
        other.wait()
    assert at_work.exists()
    build([folder / HEADER])
    assert not at_work.exists()
