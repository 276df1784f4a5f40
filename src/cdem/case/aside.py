"""Files that only compiled libraries read: in a process of its own, for they may die or hang.

HDF5, VTK and LAZ do on some damaged files. The module that reads is run as ``python -m MODULE FILE
OUT.npz`` with what is asked as JSON on stdin, and calls `answer`; an error is one line on stderr and
status 1.
"""

from __future__ import annotations

import faulthandler
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import BYTES_PER_SECOND, LEAST_SECONDS, reading
from cdem.errors import CdemError, MeshError

Arrays = dict[str, NDArray]
START = 60.0
"""Seconds in which the process begins to read; on a slow disk libraries take long to load."""


def read(
    module: str, path: Path, mend: str, kind: type[CdemError] = MeshError, asked: Any = None
) -> Arrays:
    """Let a module read a file in a process of its own.

    Args:
        module: Calls `answer` when it is run.
        path: The file.
        mend: What the file should be, or how to mend it.
        kind: Class of the error.
        asked: What the module wants to know beside the file; anything that JSON holds.

    Raises:
        CdemError: Of the class ``kind``: the file cannot be read, or the process died or hung.
    """
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "read.npz"
        try:
            ended = subprocess.run(
                [sys.executable, "-m", module, str(path.absolute()), str(out), str(path)],
                input=json.dumps(asked),
                capture_output=True,
                text=True,
                errors="replace",
                timeout=START + _seconds(path),
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise kind(f"{path}: reading it does not come to an end; {mend}") from None
        said = ended.stderr.strip()
        if ended.returncode == 1 and said:
            raise kind(said.splitlines()[-1])
        if ended.returncode or not out.is_file():
            what = "does not come to an end" if ended.returncode == 1 else "ends its reader"
            raise kind(f"{path}: reading it {what}; {mend}")
        with np.load(out, allow_pickle=False) as arrays:
            return dict(arrays)


def answer(function: Callable[[Path, Any], Arrays], mend: str) -> None:
    """Write what `function` makes of the file that the command line names and of what is asked."""
    path, out, shown = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
    asked = json.load(sys.stdin)
    with open(os.devnull, "w") as silent:
        faulthandler.dump_traceback_later(0.5 + _seconds(path), exit=True, file=silent)
        try:
            with reading(path, MeshError, mend):
                arrays = function(path, asked)
        except CdemError as error:
            sys.exit(" ".join(str(error).replace(str(path), shown).split()))
        np.savez(out, **arrays)  # type: ignore[arg-type]
        faulthandler.cancel_dump_traceback_later()


def _seconds(path: Path) -> float:
    return LEAST_SECONDS + path.stat().st_size / BYTES_PER_SECOND
