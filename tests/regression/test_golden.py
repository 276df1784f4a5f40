"""Results are pinned: a refactoring that changes a bit of them fails here.

golden.json holds one hash per scene. Whoever renews it says why: its "reason" is a line of
CHANGELOG.md.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from golden_scenes import GOLDEN, SCENES, digest

from cdem import _instruction_sets, _native

PINNED = json.loads(GOLDEN.read_text())
ROOT = Path(__file__).parents[2]


def test_every_scene_is_pinned():
    """golden.json names the scenes of golden_scenes.py, no more and no fewer."""
    assert sorted(PINNED["scenes"]) == sorted(SCENES)


def test_renewed_hashes_have_their_line_in_the_changelog():
    """The reason in golden.json is a line of CHANGELOG.md."""
    assert PINNED["reason"] and PINNED["reason"] in (ROOT / "CHANGELOG.md").read_text()


DEAR = ("landslide", "leaving", "flowing", "rubble", "defaults")
"""Scenes of seconds: on one thread quick tests run them with other instruction sets only."""


@pytest.mark.parametrize(
    ("name", "threads"),
    [
        pytest.param(name, n, marks=[pytest.mark.slow] * (n == 1 and name in DEAR))
        for name in SCENES
        for n in (1, 3)
    ],
)
def test_results_are_those_pinned(name, threads):
    """Results on one and on three threads have the pinned hash."""
    assert digest(name, threads) == PINNED["scenes"][name]


def others() -> list[str]:
    """Cores that are built and that this machine can run, but for the one in use.

    The one with laws of users is compiled for any processor of its family, two items in a lane.
    """
    flags = _instruction_sets.cpu_flags()
    runnable = [isa for isa in _native.available if flags >= _instruction_sets.NEEDS[isa]]
    found = [isa for isa in runnable if isa != _native.name]
    return found + ["own_laws"] * any((ROOT / "build" / "core").glob("_core_own_laws.*.so"))


LONGEST = ("landslide", "leaving")
"""Contacts and a domain: "rubble" and "hand_over" have contacts that come and go too, and who leaves
the domain is chosen outside of kernels."""


@pytest.mark.parametrize("isa", others())
@pytest.mark.parametrize(
    "names",
    [
        pytest.param([name for name in SCENES if name not in LONGEST], id="most"),
        pytest.param(LONGEST, id="longest", marks=pytest.mark.slow),
    ],
)
def test_results_do_not_depend_on_the_instruction_set(isa, names):
    """Scenes have the pinned hashes; those of the instruction set in use are checked above.

    NumPy takes the BLAS of this CPU, whatever the environment asks for.
    """
    env = {k: v for k, v in os.environ.items() if k != "OPENBLAS_CORETYPE"}
    own_laws = [ROOT / "tests" / "validation" / "own_law_scenes.py", "pinned"]
    script = own_laws if isa == "own_laws" else [Path(__file__).parent / "golden_scenes.py"]
    done = subprocess.run(
        [sys.executable, *script, *names],
        env=env | ({} if isa == "own_laws" else {"CDEM_ISA": isa}),
        capture_output=True,
        text=True,
        check=True,
    )
    found = dict(line.split()[:2] for line in done.stdout.splitlines())
    assert found == {name: PINNED["scenes"][name] for name in names}
