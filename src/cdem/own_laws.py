"""Laws of users: `cdem law build` compiles a core of its own, a library, from their headers.

Libraries lie in a folder of the user's own, `home`, each under a digest of its sources: the text of
its headers, the sources and the version of cdem. So the text that was read is the code that runs;
no other file beside a header is loaded. A process has one core, so its laws are chosen before any
other use of cdem; processes that it starts have them too.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import stat
import sys
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType
from typing import Any

from cdem._core_choice import choose
from cdem._version import __version__
from cdem.errors import BackendError, CaseError

ABI = 1
"""Version of the format of a library and its record."""
VARIABLE = "CDEM_OWN_LAWS"
"""Environment variable with the paths of the headers."""


def sources() -> Path:
    """Folder with the sources of the core: of the installed package, or of a clone."""
    package = Path(__file__).resolve().parent
    installed = package / "sources"
    return installed if installed.is_dir() else package.parents[1]


def digest(path: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def digest_of_sources() -> str:
    """SHA-256 of the sources of the core."""
    home, whole = sources(), hashlib.sha256()
    for folder in ("core", "bindings"):
        for path in sorted((home / folder).rglob("*.[hc]pp")):
            whole.update(path.relative_to(home).as_posix().encode() + path.read_bytes())
    return whole.hexdigest()


def home() -> Path:
    """Folder of the libraries, which only this user may write.

    Raises:
        BackendError: Another user owns it or may write there.
    """
    caches = os.environ.get("XDG_CACHE_HOME") or ""
    folder = (Path(caches) if Path(caches).is_absolute() else Path.home() / ".cache") / "cdem/laws"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    _refuse_others(folder)
    return folder


def _refuse_others(path: Path) -> None:
    there = path.lstat()
    if stat.S_ISLNK(there.st_mode) or there.st_uid != os.getuid() or there.st_mode & 0o022:
        raise BackendError(
            f"{path}: is a link, or another user owns it or may write there; own laws are loaded "
            f"only "
            "from a private folder: remove it, or chmod go-w"
        )


def library_of(headers: Iterable[Path], isa: str) -> Path:
    """The library for the present text of these headers."""
    headers = list(headers)
    made = json.dumps(record_of(headers, isa), sort_keys=True)
    return home() / f"{headers[0].stem}-{hashlib.sha256(made.encode()).hexdigest()}.so"


def record_of(headers: Iterable[Path], isa: str) -> dict[str, Any]:
    """Present sources of a library of these headers."""
    return {
        "abi": ABI,
        "version": __version__,
        "instruction_set": isa,
        "sources": digest_of_sources(),
        "headers": [[header.name, digest(header)] for header in headers],
    }


def digests(headers: Iterable[Path]) -> dict[str, str]:
    """SHA-256 of each header, by its name."""
    return {header.name: digest(header) for header in headers}


def load_own_laws(*headers: str | Path) -> None:
    """Let cdem use the laws of headers, after `cdem law build` has compiled them.

    Their code runs inside cdem: read it first. Call this before any other use of cdem.

    Args:
        headers: In the order in which they were built.

    Raises:
        CaseError: There is no such header.
        BackendError: There is no library of this text for this version and core, or other users may
            write it; or this process already uses other laws.
    """
    paths = [Path(header).resolve() for header in headers]
    _checked(paths, choose())
    if (native := sys.modules.get("cdem._native")) and native.headers != paths:
        raise BackendError("load_own_laws: call it before any other use of cdem")
    os.environ[VARIABLE] = os.pathsep.join(map(str, paths))


def allowed() -> list[Path]:
    """Headers whose laws this process may use."""
    return [Path(one) for one in os.environ.get(VARIABLE, "").split(os.pathsep) if one]


def import_core(headers: list[Path], isa: str) -> ModuleType:
    """Import the core with the laws of these headers.

    Raises:
        CaseError, BackendError: As `load_own_laws`.
    """
    name = f"cdem._core_{isa}"
    spec = importlib.util.spec_from_file_location(name, _checked(headers, isa))
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.modules[name] = module
    return module


def _checked(headers: list[Path], isa: str) -> Path:
    """The library of these headers, if it matches the present sources and core."""
    for header in headers:
        if not header.is_file():
            raise CaseError(f"{header}: no such file")
    library = library_of(headers, isa)
    again = f"cdem law build {' '.join(map(str, headers))}"
    record = library.with_suffix(".json")
    try:
        _refuse_others(library)
        made = json.loads(record.read_text())["library"]
        whole = digest(library)
    except FileNotFoundError:
        raise BackendError(
            f"{headers[0]}: has no compiled library of its present text for cdem {__version__}, "
            f"instruction set {isa}; "
            f"make it: {again}"
        ) from None
    except (ValueError, KeyError, TypeError) as error:
        raise BackendError(f"{record}: cannot be read ({error}); make it again: {again}") from None
    if made != whole:
        raise BackendError(
            f"{library}: differs from the file that cdem law build wrote; make it again: {again}"
        )
    return library
