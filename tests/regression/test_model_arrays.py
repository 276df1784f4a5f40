"""A model has the same bits on every CPU: BLAS, LAPACK and numpy have kernels for each kind."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

KERNELS = {
    "BLAS of Sandy Bridge": {"OPENBLAS_CORETYPE": "Sandybridge"},
    "the oldest": {"OPENBLAS_CORETYPE": "Prescott", "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4"},
}


def hashes(**environment):
    """Hashes of all arrays of the models in `model_arrays.py`, computed in a process of its own."""
    script = Path(__file__).parent / "model_arrays.py"
    done = subprocess.run(
        [sys.executable, str(script)],
        env=os.environ | environment, capture_output=True, check=True,
    )  # fmt: skip
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def here():
    """The hashes that this CPU gives."""
    return hashes()


@pytest.mark.parametrize("kernels", KERNELS)
def test_models_do_not_depend_on_the_kernels_of_the_libraries(here, kernels):
    found = hashes(**KERNELS[kernels])
    assert len(found) > 500
    assert [name for name in here if here[name] != found.get(name)] == []
