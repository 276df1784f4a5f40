"""A law is one header: laws that only the tests have run on all kinds of joints and elements.

Their headers lie in tests/core/own_laws; `tools/build.py --own-laws` builds a core with them.
"""

import subprocess
import sys
from pathlib import Path

import pytest

SCENES = Path(__file__).parent / "own_law_scenes.py"
CORE = Path(__file__).parents[2] / "build" / "core"


@pytest.mark.parametrize(
    "scene", ["springs", "edges", "bonds", "two_laws", "plasticity", "results"]
)
def test_a_law_in_one_header(scene):
    """See the docstring of each scene for theory and tolerance."""
    if not list(CORE.glob("_core_own_laws.*.so")):
        pytest.skip("the core with the tests' own laws is not built; use make test")
    done = subprocess.run(
        [sys.executable, str(SCENES), scene], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
