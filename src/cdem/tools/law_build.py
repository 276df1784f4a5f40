"""Laws of users: a header to start from, and the library made of headers."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

from filelock import FileLock, Timeout

from cdem._core_choice import choose
from cdem.errors import BackendError, CaseError
from cdem.own_laws import digest, home, library_of, record_of, sources
from cdem.whole_files import replaced, write_json

NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
LAW = re.compile(
    r'template\s*<class T>\s*struct\s+(\w+)[^;]*?LawText\s+text\s*\{\s*\.name\s*=\s*"([^"]*)"'
)
INCLUDE = re.compile(r"^\s*(?:#|%:)\s*(?:include\w*|import|embed)(.*)$", re.MULTILINE)
KNOWN = re.compile(r'\s*(?:<\w+(?:\.h)?>|"core/(?:\w+/)*\w+\.hpp")\s*')
ANSWERS = {
    "BLOCK": re.compile(r"\bflow\s*\("),
    "INTERFACE": re.compile(r"\brespond\s*\(\s*const\s+JointInput\b"),
    "SURFACE": re.compile(r"\brespond\s*\(\s*const\s+SurfacePoint\b"),
}
"""The method that a law of each kind must have."""
BUILD, LOCK = "build", "lock"
"""Prefix of build folders among the libraries; each has a lock."""
SHOWN = 8
"""Most lines of compiler output in an error."""


@dataclass(frozen=True)
class Header:
    """A header with one law.

    Attributes:
        path: The file.
        structure: Name of its structure.
        law: Name of the law in a case.
        kind: Kind, of `ANSWERS`.
    """

    path: Path
    structure: str
    law: str
    kind: str

    @classmethod
    def read(cls, path: Path) -> Header:
        """Check a header.

        Raises:
            CaseError: It has no law or several, or includes files outside cdem.
        """
        if not path.is_file():
            raise CaseError(f"{path}: no such file")
        text = path.read_text(errors="replace").replace("\\\n", "")
        text = re.sub(r"/\*.*?\*/|//[^\n]*", " ", text, flags=re.DOTALL)
        for other in INCLUDE.findall(text):
            if KNOWN.fullmatch(other):
                continue
            raise CaseError(
                f"{path}: includes {other.strip()}; a law is a single header that includes only "
                f"files of "
                "core/ and of the language"
            )
        laws = LAW.findall(text)
        if len(laws) != 1:
            raise CaseError(
                f"{path}: has {len(laws)} laws (structures with a LawText text) instead of one; "
                "cdem law new writes a header to start from"
            )
        ((structure, law),) = laws
        if not NAME.fullmatch(law):
            raise CaseError(
                f"{path}: the law's name {law!r} may only have small letters, digits and -"
            )
        kinds = [kind for kind, answer in ANSWERS.items() if answer.search(text)]
        if len(kinds) != 1:
            raise CaseError(
                f"{path}: {structure} needs a method flow (block law), or respond to a const "
                f"JointInput "
                "(interface law) or a const SurfacePoint (surface law)"
            )
        return cls(path.resolve(), structure, law, kinds[0])


def new_law(name: str, kind: str, folder: Path, *, overwrite: bool) -> list[Path]:
    """Write a header to start from, and a test for it.

    Args:
        name: Name of the law, e.g. ``"my-clay"``.
        kind: "block", "interface" or "surface".
        folder: Folder to write to.
        overwrite: Whether to replace existing files.

    Raises:
        CaseError: The name is invalid, or a file exists.
    """
    if not NAME.fullmatch(name):
        raise CaseError(
            f"{name!r}: a law's name may only have small letters, digits and -, e.g. my-clay"
        )
    home = resources.files("cdem") / "templates" / "laws"
    stem = name.replace("-", "_")
    own, structure = _named((home / f"{kind}.hpp").read_text())
    texts = {}
    files = {f"{stem}.hpp": f"{kind}.hpp", f"test_{stem}.py": f"{kind}_test.txt"}
    for file, template in files.items():
        text = (home / template).read_text().replace(f"{kind}.hpp", f"{stem}.hpp")
        text = re.sub(rf"\b{structure}\b", name.title().replace("-", ""), text)
        texts[folder / file] = re.sub(rf"(?<![\w-]){own}(?![\w-])", name, text)
    for path in texts:
        if path.exists() and not overwrite:
            raise CaseError(f"{path}: exists already; use --overwrite or name another folder")
    folder.mkdir(parents=True, exist_ok=True)
    for path, text in texts.items():
        path.write_text(text)
    return list(texts)


def _named(text: str) -> tuple[str, str]:
    """Name and structure of the law of a template."""
    ((structure, law),) = LAW.findall(text)
    return law, structure


def build(files: list[Path]) -> Path:
    """Compile a core with the laws of some headers, for the instruction set that cdem uses here.

    Args:
        files: The headers; a case names them in the same order.

    Returns:
        The library, in the folder of libraries of this user.

    Raises:
        CaseError: A header is wrong, or does not compile.
        BackendError: There is no compiler, or another tool is missing.
    """
    from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS, SURFACE_LAWS

    headers = [Header.read(path) for path in files]
    for number, header in enumerate(headers):
        others = {*BLOCK_LAWS, *INTERFACE_LAWS, *SURFACE_LAWS, *(h.law for h in headers[:number])}
        if header.law in others:
            raise CaseError(
                f"{header.path}: the name {header.law} is taken by another law; choose another"
            )
    isa = choose()
    paths = [header.path for header in headers]
    if len({path.name for path in paths}) < len(paths):
        raise CaseError("own laws of one library need different file names")
    with _workplace() as folder:
        # compile the text of the digest, even if the files change meanwhile
        copies = [Path(shutil.copy(path, folder)) for path in paths]
        library, made = library_of(copies, isa), record_of(copies, isa)
        built = _compile(headers, isa, folder)
        with replaced(library) as file:
            file.write(built.read_bytes())
    write_json(library.with_suffix(".json"), made | {"library": digest(library)})
    return library


@contextmanager
def _workplace() -> Iterator[Path]:
    """A temporary folder to build in. It also removes the folders of killed builds.

    A build holds the lock of its folder, which the system releases when its process ends.
    """
    place = home()
    with ExitStack() as kept:
        with FileLock(place / f"{BUILD}.lock"):
            for left in place.glob(f"{BUILD}-*"):
                with suppress(Timeout), FileLock(left / LOCK, timeout=0):
                    shutil.rmtree(left, ignore_errors=True)
            made = tempfile.TemporaryDirectory(prefix=f"{BUILD}-", dir=place)
            folder = Path(kept.enter_context(made))
            kept.enter_context(FileLock(folder / LOCK))
        yield folder


def _compile(headers: list[Header], isa: str, folder: Path) -> Path:
    """Compile in a folder; the library in it."""
    if importlib.util.find_spec("nanobind") is None:
        raise BackendError(_needs("nanobind"))
    settings = {"CDEM_ISAS": isa, "Python_EXECUTABLE": sys.executable}
    for kind in ANSWERS:
        own = [header for header in headers if header.kind == kind]
        if own:
            whole = folder / f"{kind.lower()}_laws.hpp"
            whole.write_text("".join(f'#include "{folder / header.path.name}"\n' for header in own))
            settings[f"CDEM_OWN_{kind}_LAW"] = ",".join(header.structure for header in own)
            settings[f"CDEM_OWN_{kind}_HEADER"] = str(whole)
    given = [f"-D{name}={value}" for name, value in settings.items()]
    build = folder / "build"
    _run(["cmake", "-S", str(sources()), "-B", str(build), "-G", "Ninja", *given], headers, folder)
    _run(["ninja", "-C", str(build), f"_core_{isa}"], headers, folder)
    (built,) = build.glob(f"_core_{isa}.*")
    return built


def _needs(missing: str) -> str:
    """Advice for a missing tool."""
    return f"cdem law build finds no {missing}: pip install 'cdem[laws]', and g++ or clang of the system"


def _run(command: list[str], headers: list[Header], folder: Path) -> None:
    """Run a tool of the build, in its folder: nothing is imported from the current one.

    Raises:
        CaseError: The compiler refuses a header.
        BackendError: The tool is missing or fails.
    """
    beside = Path(sys.executable).parent
    tools = os.pathsep.join([str(beside), os.environ.get("PATH", "")])
    found = shutil.which(command[0], path=tools)
    if found is None:
        raise BackendError(_needs(command[0]))
    environment = os.environ | {"PATH": tools, "LC_ALL": "C"}
    done = subprocess.run(
        [found, *command[1:]],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
        cwd=folder,
    )
    if done.returncode == 0:
        return
    said = (done.stdout + done.stderr).splitlines()
    faults = [line for line in said if "error" in line.lower()] or said
    text = "\n".join(faults[:SHOWN])
    for header in headers:
        text = text.replace(str(folder / header.path.name), str(header.path))
    if any(str(header.path) in text for header in headers):
        raise CaseError(f"a law does not compile:\n{text}")
    raise BackendError(f"{command[0]} fails:\n{text}")
