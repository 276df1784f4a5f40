"""Files that users name: read as text, and the boundary around every library that reads one."""

from __future__ import annotations

import codecs
import ctypes
import glob
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from cdem.errors import CaseError, CdemError

LEAST_SECONDS = 3.0
"""So much processor time the reading of any file may take [s]."""
BYTES_PER_SECOND = 100_000
"""A file so large may take a second more; the slowest reader is ten times as fast [1/s]."""
LEAST_MEMORY = 600_000_000
"""So much memory the reading of any file may take [bytes]."""
MEMORY_PER_BYTE = 100
"""A file may take so many times its size more; the most wasteful reader takes a tenth [1]."""
XML = (".vtu", ".xdmf", ".xmf", ".xml")
"""Endings of the formats that are XML."""
LOOK = 0.02
"""Shortest wall time between looks at the clock [s]."""
WORDS = 200
"""Characters of a library's message that are passed on."""


_ONE_READER = threading.RLock()  # limits are those of the whole process


class _TooLong(BaseException):
    """Reading went on for longer than a sound file takes; no library catches it by chance."""


@contextmanager
def reading(
    path: Path, kind: type[CdemError], mend: str, size: int | None = None
) -> Iterator[None]:
    """Turn whatever goes wrong inside into one error that names the file.

    Args:
        path: The file that is read.
        kind: Class of the error.
        mend: What the file should be, or how to mend it.
        size: Of all that is read [bytes]; by default of the file and those of the same name.

    Raises:
        CdemError: Of the class ``kind``: a library raised, left the program, or took more processor
            time or memory than a file of that size needs. Errors of cdem pass.
    """
    try:
        size = size_of(path) if size is None else size
        with (
            _ONE_READER,
            _memory_limited(LEAST_MEMORY + MEMORY_PER_BYTE * size),
            warnings.catch_warnings(),
            _time_limited(seconds_for(size)),
        ):
            warnings.simplefilter("ignore")
            yield
    except CdemError:
        raise
    except _TooLong:
        raise kind(f"{path}: {too_long(size or 0)}; {mend}") from None
    except OSError as error:
        raise kind(f"{path}: cannot be read ({error.strerror or _words(error)}); {mend}") from None
    except (MemoryError, RecursionError) as error:
        what = "is nested deeper" if isinstance(error, RecursionError) else "asks for more memory"
        raise kind(f"{path}: {what} than a sound file does; {mend}") from None
    except (Exception, SystemExit) as error:
        raise kind(f"{path}: cannot be read ({_words(error)}); {mend}") from error


def size_of(path: Path) -> int:
    """Size of a file and of those beside it of the same name [bytes]: some formats have several."""
    parts = path.parent.glob(glob.escape(path.stem) + ".*")
    return sum(part.stat().st_size for part in parts if part.is_file())


def seconds_for(size: int) -> float:
    """Processor time that the reading of so many bytes may take [s]."""
    return LEAST_SECONDS + size / BYTES_PER_SECOND


def too_long(size: int) -> str:
    """What is said of a file of this size [bytes] whose reading takes longer."""
    return (
        f"reading it takes more than {seconds_for(size):.3g} s of processor time, as no sound file of "
        "its size does"
    )


def _words(error: BaseException) -> str:
    """A library's own words, in one short line."""
    said = " ".join(str(error).split())
    if isinstance(error, KeyError):
        said = f"{' '.join(map(str, error.args))} is named, but not there"
    elif isinstance(error, SystemExit):
        said = "its reader gave up"
    elif not said:
        said = type(error).__name__
    return said if len(said) <= WORDS else said[:WORDS] + " ..."


@contextmanager
def _time_limited(seconds: float) -> Iterator[None]:
    """Raise `_TooLong` inside after so much processor time: readers of meshio loop for ever at an
    early end.

    Python code is interrupted, in any thread; one long call of compiled code ends first.
    """
    raise_in = ctypes.pythonapi.PyThreadState_SetAsyncExc
    thread, spent = ctypes.c_ulong(threading.get_ident()), _clock()
    end, guard, over, fired, came = (
        spent() + seconds,
        threading.Lock(),
        threading.Event(),
        [],
        False,
    )

    def watch() -> None:
        while not over.wait(max(end - spent(), LOOK)):
            with guard:
                if spent() >= end and not over.is_set():
                    raise_in(thread, ctypes.py_object(_TooLong))
                    fired.append(True)
                    return

    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    except _TooLong:
        came = True
        raise
    finally:
        with guard:
            over.set()
        if fired and not came:
            raise_in(thread, None)  # it would come too late


def _clock() -> Callable[[], float]:
    """A clock of the processor time of this thread, which other threads can read [s]."""
    if not hasattr(time, "pthread_getcpuclockid"):
        return time.process_time
    return partial(time.clock_gettime, time.pthread_getcpuclockid(threading.get_ident()))


@contextmanager
def _memory_limited(allowed: int) -> Iterator[None]:
    """Let allocations fail that would take more memory [bytes] than allowed; on Linux."""
    if sys.platform != "linux":
        yield
        return
    import resource

    pages = int(Path("/proc/self/statm").read_text().split()[0])
    before = resource.getrlimit(resource.RLIMIT_AS)
    limit = pages * resource.getpagesize() + allowed
    if before[0] != resource.RLIM_INFINITY:
        limit = min(limit, before[0])
    resource.setrlimit(resource.RLIMIT_AS, (limit, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def is_file(path: Path) -> bool:
    """Whether a path that a user wrote leads to a file; also of one that no system takes."""
    try:
        return path.is_file()
    except OSError:  # a name of thousands of letters, a folder that may not be read
        return False


def read_text(path: Path, what: str, kind: type[CdemError] = CaseError) -> str:
    """Read a text file in UTF-8, with or without a mark of byte order.

    Args:
        path: The file.
        what: What it is, e.g. "case file".
        kind: Class of the error.

    Raises:
        CdemError: Of the class ``kind``: no such file, or not UTF-8; says where.
    """
    try:
        if path.is_char_device():  # some have no end
            raise kind(f"{path}: a device, not a {what}")
        raw = path.read_bytes()
    except OSError as error:
        raise kind(f"{path}: cannot read the {what}: {error.strerror}") from None
    try:
        text = raw.removeprefix(codecs.BOM_UTF8).decode("utf-8")
        return text.replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
            raise kind(f"{path}: is text in UTF-16; save the {what} as UTF-8") from None
        word = raw[: error.end].split()[-1].decode("latin-1")
        if not word.isprintable():
            raise kind(f"{path}: not a text file; a {what} is text in UTF-8") from None
        line = raw.count(b"\n", 0, error.start) + 1
        raise kind(
            f"{path}:{line}: not in UTF-8 at '{word}'; is it in Latin-1? Save the {what} as UTF-8"
        ) from None


def refuse_entities(path: Path) -> None:
    """Stop at an XML file that declares entities, which may grow without bound or name other files.

    Raises:
        defusedxml.DefusedXmlException: It does. Call it inside of `reading`.
    """
    if path.suffix.lower() not in XML:
        return
    from defusedxml.ElementTree import iterparse

    with path.open("rb") as file:
        next(iterparse(file, events=("start",), forbid_dtd=True), None)
