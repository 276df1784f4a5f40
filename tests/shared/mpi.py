"""Ranks that are processes, started by mpiexec."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

MPIEXEC = shutil.which("mpiexec", path=f"{Path(sys.executable).parent}:{os.environ['PATH']}")
needs_mpi = pytest.mark.skipif(
    MPIEXEC is None or importlib.util.find_spec("mpi4py") is None,
    reason="needs mpi4py and mpiexec: pip install mpi4py mpich",
)
ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
}


def command(count: int, *words: str | Path) -> list[str]:
    """Words that start Python on several ranks."""
    return [str(MPIEXEC), "-n", str(count), sys.executable, *map(str, words)]


def ranks(count: int, *words: str | Path, cwd: Path | None = None, **more: str):
    """Start Python on several ranks; returns exit status, stdout, stderr and the time it took [s]."""
    began = time.monotonic()
    done = subprocess.run(
        command(count, *words),
        capture_output=True,
        text=True,
        timeout=120,
        cwd=cwd,
        env=os.environ | ENVIRONMENT | more,
    )
    return done.returncode, done.stdout, done.stderr, time.monotonic() - began
