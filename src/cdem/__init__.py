"""cdem: rock as blocks of finite elements that touch, bond, break and slide."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from cdem._version import __version__

if TYPE_CHECKING:
    from cdem.case.case import Case
    from cdem.errors import (
        BackendError,
        CaseError,
        CdemError,
        MeshError,
        ModelError,
        UnstableError,
    )
    from cdem.output.results import Results
    from cdem.own_laws import load_own_laws
    from cdem.run.progress import Progress
    from cdem.run.simulation import Simulation

# Public names and the module of each; imported at first use, so that `import cdem` takes no time.
_HOMES = {
    "load_own_laws": "cdem.own_laws",
    "Case": "cdem.case.case",
    "Progress": "cdem.run.progress",
    "Results": "cdem.output.results",
    "Simulation": "cdem.run.simulation",
    "BackendError": "cdem.errors",
    "CaseError": "cdem.errors",
    "CdemError": "cdem.errors",
    "MeshError": "cdem.errors",
    "ModelError": "cdem.errors",
    "UnstableError": "cdem.errors",
}

__all__ = [
    "BackendError",
    "Case",
    "CaseError",
    "CdemError",
    "MeshError",
    "ModelError",
    "Progress",
    "Results",
    "Simulation",
    "UnstableError",
    "__version__",
    "load_own_laws",
]


def __getattr__(name: str) -> Any:
    if name == "open":  # a function of that name would hide Python's own in its module
        value = importlib.import_module("cdem.output.results").open_results
    elif name in _HOMES:
        value = getattr(importlib.import_module(_HOMES[name]), name)
    else:
        raise AttributeError(f"module 'cdem' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*__all__, "open"])
