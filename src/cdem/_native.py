"""The compiled core: one module per instruction set, the best that this machine can run."""

from __future__ import annotations

import importlib
import importlib.util
import os
from pathlib import Path
from types import ModuleType

from cdem._instruction_sets import NEEDS, cpu_flags
from cdem.errors import BackendError


def _is_built(isa: str) -> bool:
    spec = importlib.util.find_spec(f"cdem._core_{isa}")
    return spec is not None and spec.origin is not None and Path(spec.origin).exists()


def _built() -> list[str]:
    return [isa for isa in NEEDS if _is_built(isa)]


# Threads that wait by spinning make a busy machine a hundred times slower; a short spin is enough.
os.environ.setdefault("GOMP_SPINCOUNT", "20000")


def _load() -> tuple[ModuleType, str, list[str]]:
    built = _built()
    flags = cpu_flags()
    wanted = os.environ.get("CDEM_ISA")
    if wanted is not None:
        if wanted not in built:
            raise BackendError(
                f"CDEM_ISA={wanted}: no such compiled core; built are: {', '.join(built) or 'none'}"
            )
        # Without this the first instruction that is missing kills Python. No flags: not known.
        lacking = NEEDS[wanted] - flags
        if flags and lacking:
            raise BackendError(
                f"CDEM_ISA={wanted}: this CPU lacks {', '.join(sorted(lacking))}; unset CDEM_ISA"
            )
        return importlib.import_module(f"cdem._core_{wanted}"), wanted, built
    for isa in built:
        if flags >= NEEDS[isa]:
            return importlib.import_module(f"cdem._core_{isa}"), isa, built
    raise BackendError(
        "the compiled core is missing or does not run on this CPU; "
        f"built are: {', '.join(built) or 'none'}. Install cdem again with: pip install ."
    )


core, name, available = _load()
