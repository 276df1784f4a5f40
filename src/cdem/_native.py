"""The compiled core: one module per instruction set, the best that this machine can run."""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING

from cdem import own_laws
from cdem._core_choice import built, choose
from cdem.errors import BackendError

# Threads that spin while waiting make a busy machine a hundred times slower; a short spin is
# enough.
# A policy set by the user is kept.
if "OMP_WAIT_POLICY" not in os.environ:
    os.environ.setdefault("GOMP_SPINCOUNT", "20000")

available = built()
name = choose()
headers = own_laws.allowed()
"""Headers of own laws in this core."""
digests = own_laws.digests(headers)
"""SHA-256 of each header, by name."""
if TYPE_CHECKING:
    from cdem import _core as core  # src/cdem/_core.pyi, of all of them
else:
    core = (
        own_laws.import_core(headers, name)
        if headers
        else importlib.import_module(f"cdem._core_{name}")
    )
try:
    device = core.device_name()
    """"cpu", "emulated", or the name of the GPU."""
except RuntimeError as error:
    raise BackendError(f"CDEM_ISA={name}: no CUDA device that works: {error}") from None
