"""Users' files: read as text, and protection around every library that reads a file."""

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
"""Processor time allowed for any file [s]."""
BYTES_PER_SECOND = 100_000
"""Size that adds a second to the allowed time; the slowest reader is ten times as fast [1/s]."""
LEAST_MEMORY = 600_000_000
"""Memory allowed for any file [bytes]."""
MEMORY_PER_BYTE = 100
"""Further memory allowed, as a multiple of the size; the greediest reader takes a tenth [1]."""
XML = (".vtu", ".xdmf", ".xmf", ".xml")
"""Endings of XML formats."""
LOOK = 0.02
"""Shortest wall time between looks at the clock [s]."""
WORDS = 200
"""Most characters shown of a library's message."""


_ONE_READER = threading.RLock()  # limits hold for the whole process


class _TooLong(BaseException):
    """Reading took longer than for a sound file; no library catches this class by chance."""


@contextmanager
def reading(
    path: Path, kind: type[CdemError], mend: str, size: int | None = None
) -> Iterator[None]:
    """Turn every failure inside into one error that names the file.

    Args:
        path: The file that is read.
        kind: Class of the error.
        mend: The expected kind of file, or advice on how to mend it.
        size: Bytes to be read; by default of the file and of files with the same name.

    Raises:
        CdemError: Of the class ``kind``: a library raised, ended the program, or took more
        processor time or memory than a file of that size needs. Errors of cdem pass unchanged.
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
        failure = (
            "is nested more deeply" if isinstance(error, RecursionError) else "needs more memory"
        )
        raise kind(f"{path}: {failure} than a sound file; {mend}") from None
    except (Exception, SystemExit) as error:
        raise kind(f"{path}: cannot be read ({_words(error)}); {mend}") from error


def size_of(path: Path) -> int:
    """Size of a file and of its neighbours of the same name [bytes]: some formats have several."""
    parts = path.parent.glob(glob.escape(path.stem) + ".*")
    return sum(part.stat().st_size for part in parts if part.is_file())


def seconds_for(size: int) -> float:
    """Processor time allowed for reading so many bytes [s]."""
    return LEAST_SECONDS + size / BYTES_PER_SECOND


def too_long(size: int) -> str:
    """Message for a file of this size [bytes] that takes longer to read."""
    return (
        f"reading it takes more than {seconds_for(size):.3g} s of processor time, longer than a "
        f"sound "
        "file of its size"
    )


def _words(error: BaseException) -> str:
    """A library's own words in one short line."""
    said = " ".join(str(error).split())
    if isinstance(error, KeyError):
        said = f"{' '.join(map(str, error.args))} is missing"
    elif isinstance(error, SystemExit):
        said = "its reader stopped"
    elif not said:
        said = type(error).__name__
    return said if len(said) <= WORDS else said[:WORDS] + " ..."


@contextmanager
def _time_limited(seconds: float) -> Iterator[None]:
    """Raise `_TooLong` inside after so much processor time: readers of meshio loop for ever on a
    truncated file.

    Python code is interrupted, in any thread; a long call of compiled code ends first.
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
            raise_in(thread, None)  # it would arrive too late


def _clock() -> Callable[[], float]:
    """Clock of this thread's processor time, readable by other threads [s]."""
    if not hasattr(time, "pthread_getcpuclockid"):
        return time.process_time
    return partial(time.clock_gettime, time.pthread_getcpuclockid(threading.get_ident()))


@contextmanager
def _memory_limited(allowed: int) -> Iterator[None]:
    """Make allocations fail above this much more memory [bytes]; on Linux only."""
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
    """Whether a user's path leads to a file; False for a path that the system refuses."""
    try:
        return path.is_file()
    except OSError:  # a name of thousands of letters, a folder without permission
        return False


def read_text(path: Path, what: str, kind: type[CdemError] = CaseError) -> str:
    """Read a text file in UTF-8, with or without a mark of byte order.

    Args:
        path: The file.
        what: The kind of file, e.g. "case file".
        kind: Class of the error.

    Raises:
        CdemError: Of the class ``kind``: no such file, or not UTF-8; names the place.
    """
    try:
        if path.is_char_device():  # some never end
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
    """Refuse an XML file that declares entities, which may grow without bound or name other files.

    Raises:
        defusedxml.DefusedXmlException: It declares some. Call this inside `reading`.
    """
    if path.suffix.lower() not in XML:
        return
    from defusedxml.ElementTree import iterparse

    with path.open("rb") as file:
        next(iterparse(file, events=("start",), forbid_dtd=True), None)
