"""This CPU: instruction sets of the compiled core, best first, and cores. tools/build.py reads it too."""

from __future__ import annotations

import os
from pathlib import Path

# Targets of the compiled modules, best first, and the CPU flags that each needs.
NEEDS = {
    "v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl", "avx2", "fma", "bmi2"},
    "v3": {"avx2", "fma", "bmi1", "bmi2", "f16c", "movbe"},
    "x86_64": set(),
    "generic": set(),
}


def cpu_flags() -> set[str]:
    """Flags of this CPU; empty if the system does not give them."""
    try:
        text = Path("/proc/cpuinfo").read_text()
    except OSError:
        return set()
    for line in text.splitlines():
        if line.startswith("flags"):
            return set(line.split(":", 1)[1].split())
    return set()


def native() -> str:
    """The best instruction set that this CPU can run."""
    flags = cpu_flags()
    return next(isa for isa, needs in NEEDS.items() if flags >= needs)


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):  # not on macOS
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
