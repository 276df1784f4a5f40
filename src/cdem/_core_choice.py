"""The compiled core for this process: the best that this machine can run, or the requested one."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path

from cdem._instruction_sets import NEEDS, cpu_flags
from cdem.errors import BackendError

DEVICES = ("cuda", "emulated")
"""Cores used only when CDEM_ISA names them: for a GPU, and to find faults of GPU code."""
GPU = (
    "in a clone, with nvcc: pip install . -C cmake.define.CDEM_CUDA=ON; then CDEM_ISA=cuda cdem run "
    "CASE.yaml"
)
"""How to get a core for a GPU, and to use it."""


def _is_built(isa: str) -> bool:
    spec = importlib.util.find_spec(f"cdem._core_{isa}")
    return spec is not None and spec.origin is not None and Path(spec.origin).exists()


def built() -> list[str]:
    """Instruction sets with a compiled core, best first."""
    return [isa for isa in NEEDS if _is_built(isa)]


def choose() -> str:
    """The instruction set, or device, of the core to load.

    Raises:
        BackendError: No core runs here, or CDEM_ISA names one that does not.
    """
    there, flags = built(), cpu_flags()
    wanted = os.environ.get("CDEM_ISA")
    if wanted in DEVICES:
        if not _is_built(wanted):
            raise BackendError(f"CDEM_ISA={wanted}: no such compiled core; make it: make {wanted}")
        return wanted
    if wanted is not None:
        if wanted not in there:
            raise BackendError(
                f"CDEM_ISA={wanted}: no such compiled core; built are: {', '.join(there) or 'none'}"
            )
        # Without this check a missing instruction would kill Python. No flags: unknown.
        lacking = NEEDS[wanted] - flags
        if flags and lacking:
            raise BackendError(
                f"CDEM_ISA={wanted}: this CPU lacks {', '.join(sorted(lacking))}; unset CDEM_ISA"
            )
        return wanted
    for isa in there:
        if flags >= NEEDS[isa]:
            return isa
    raise BackendError(
        "the compiled core is missing or does not run on this CPU; "
        f"built are: {', '.join(there) or 'none'}. Install cdem again with: pip install ."
    )
