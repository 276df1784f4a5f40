"""Files for compiled readers: each is read in a process of its own, which may crash or hang.

GDAL, HDF5, VTK and LAZ do so on some damaged files. `cdem.case.child` runs the reading module with
the arguments FILE OUT.npz SHOWN SIZE and the question as JSON in the first line of stdin. The
module calls `answer`; an error is one line on stderr and status 1. Processor time and memory of
the process are limited by the size of the input.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from cdem.case import child
from cdem.case.input_file import reading, seconds_for, size_of, too_long
from cdem.errors import CdemError, MeshError

Arrays = dict[str, NDArray]
START, PATIENCE = 60.0, 30.0
"""Wall time to start reading, and per second of processor time [s]: the machine may be busy."""
CLOSED = {"PROJ_NETWORK": "OFF", "OGR_SQLITE_LOAD_EXTENSIONS": ""}
"""Environment of the process: no library downloads or loads anything more."""
_words: IO[str] | None = None  # in the reading process: its messages to the asking process


def read(
    module: str,
    path: Path,
    mend: str,
    kind: type[CdemError] = MeshError,
    asked: Any = None,
    size: int | None = None,
    reply: Callable[[Any], Any] | None = None,
) -> Arrays:
    """Let a module read a file in a process of its own.

    Args:
        module: Calls `answer` when it is run.
        path: The file.
        mend: The expected kind of file, or advice on how to mend it.
        kind: Class of the error.
        asked: The question beside the file; anything that JSON holds.
        size: Bytes to be read; by default of the file and of files with the same name.
        reply: Answers questions that the module asks with `ask`.

    Raises:
        CdemError: Of the class ``kind``: the file cannot be read, or the process crashed or hung.
        Errors of ``reply`` pass unchanged.
    """
    size = size_of(path) if size is None else size
    patience = START + PATIENCE * seconds_for(size)
    end = time.monotonic() + patience
    with tempfile.TemporaryDirectory(prefix="cdem-read-") as folder:
        out, errors = Path(folder) / "read.npz", Path(folder) / "errors"
        command = child.module(module, str(path.absolute()), str(out), str(path), str(size))
        with errors.open("wb") as file:
            process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=file,
                text=True,
                env=os.environ | CLOSED,
            )
        timer = threading.Timer(patience, process.kill)
        timer.start()
        try:
            _talk(process, asked, reply)
            process.wait()
            late = time.monotonic() >= end
        finally:
            timer.cancel()
            process.kill()
            process.communicate()
        if late:
            raise kind(f"{path}: no answer in {patience:.0f} s; is the machine or the disk busy?")
        said = errors.read_text(errors="replace").strip()
        if process.returncode == 1 and said:
            raise kind(said.splitlines()[-1])
        if process.returncode or not out.is_file():
            raise kind(f"{path}: {_end(process.returncode, size)}; {mend}")
        with np.load(out, allow_pickle=False) as arrays:
            return dict(arrays)


def _talk(process: subprocess.Popen[str], asked: Any, reply: Callable[[Any], Any] | None) -> None:
    """Send the question, and answer the questions of the process, which may crash meanwhile."""
    assert process.stdin is not None and process.stdout is not None
    with contextlib.suppress(BrokenPipeError):
        process.stdin.write(json.dumps(asked) + "\n")
        process.stdin.flush()
        for line in process.stdout:
            assert reply is not None
            process.stdin.write(json.dumps(reply(json.loads(line))) + "\n")
            process.stdin.flush()


def _end(status: int, size: int) -> str:
    """Describe the end of a process that gave no message."""
    if status == -signal.SIGXCPU:
        return too_long(size)
    if status < 0:
        name = signal.Signals(-status).name
        return f"its reader crashed ({name}); the file may be damaged, or memory too small"
    return f"its reader ended without a message (status {status})"


def answer(function: Callable[[Path, Any], Arrays], mend: str) -> None:
    """Write the result of `function` for the file of the command line and the question."""
    global _words
    path, out, shown, size = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3], int(sys.argv[4])
    asked = json.loads(sys.stdin.readline())
    _words = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # libraries print
    _limit_time(seconds_for(size))
    try:
        with reading(path, MeshError, mend, size):
            arrays = function(path, asked)
    except CdemError as error:
        sys.exit(" ".join(str(error).replace(str(path), shown).split()))
    np.savez(out, **arrays)  # type: ignore[arg-type]


def ask(question: Any) -> Any:
    """Ask the process that wants the file; question and answer are anything that JSON holds."""
    assert _words is not None
    print(json.dumps(question), file=_words, flush=True)
    return json.loads(sys.stdin.readline())


def _limit_time(seconds: float) -> None:
    """Let the system end this process after this processor time, even in compiled code."""
    if sys.platform == "win32":
        return
    import resource

    whole = math.ceil(time.process_time() + seconds)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (whole, whole + 1))
