"""The compiled core: one module per instruction set, the best that this machine can run."""

from __future__ import annotations

import importlib
import importlib.util
import os
from pathlib import Path
from types import ModuleType

from cdem.errors import BackendError

# What the modules are compiled for, best first, and the CPU flags that each needs.
_NEEDS = {
    "v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl", "avx2", "fma", "bmi2"},
    "v3": {"avx2", "fma", "bmi1", "bmi2", "f16c", "movbe"},
    "x86_64": set(),
    "generic": set(),
}


def _cpu_flags() -> set[str]:
    try:
        text = Path("/proc/cpuinfo").read_text()
    except OSError:
        return set()
    for line in text.splitlines():
        if line.startswith("flags"):
            return set(line.split(":", 1)[1].split())
    return set()


def _built() -> list[str]:
    return [isa for isa in _NEEDS if importlib.util.find_spec(f"cdem._core_{isa}")]


# Threads that wait by spinning make a busy machine a hundred times slower; a short spin is enough.
os.environ.setdefault("GOMP_SPINCOUNT", "20000")


def _load() -> tuple[ModuleType, str, list[str]]:
    built = _built()
    flags = _cpu_flags()
    wanted = os.environ.get("CDEM_ISA")
    if wanted is not None:
        if wanted not in built:
            raise BackendError(
                f"CDEM_ISA={wanted}: no such compiled core; built are: {', '.join(built) or 'none'}"
            )
        # Without this the first instruction that is missing kills Python. No flags: not known.
        lacking = _NEEDS[wanted] - flags
        if flags and lacking:
            raise BackendError(
                f"CDEM_ISA={wanted}: this CPU lacks {', '.join(sorted(lacking))}; unset CDEM_ISA"
            )
        return importlib.import_module(f"cdem._core_{wanted}"), wanted, built
    for isa in built:
        if flags >= _NEEDS[isa]:
            return importlib.import_module(f"cdem._core_{isa}"), isa, built
    raise BackendError(
        "the compiled core is missing or does not run on this CPU; "
        f"built are: {', '.join(built) or 'none'}. Install cdem again with: pip install ."
    )


core, name, available = _load()
