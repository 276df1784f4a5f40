"""A law is one header: laws that only the tests have run on all kinds of joints and elements.

They are the templates of `cdem law new`, and copies of built-in laws under other names;
`tools/build.py --own-laws` builds a core with them.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from shared.own_laws import differences, flow

from cdem._core_choice import choose
from cdem.own_laws import library_of, sources
from cdem.run.checkpoint import read_checkpoint

SCENES = Path(__file__).parent / "own_law_scenes.py"
CORE = Path(__file__).parents[2] / "build" / "core"


@pytest.mark.parametrize(
    "scene",
    ["springs", "edges", "bonds", "two_laws", "plasticity", "foundation", "results", "copies"],
)
def test_a_law_in_one_header(scene):
    """See the docstring of each scene for theory and tolerance."""
    if not list(CORE.glob("_core_own_laws.*.so")):
        pytest.skip("the core with the tests' own laws is not built; use make test")
    done = subprocess.run(
        [sys.executable, str(SCENES), scene], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def copies(tmp_path_factory):
    """Copies of three built-in laws in the package's folders, in a library by cdem law build."""
    folder, core = tmp_path_factory.mktemp("laws"), sources() / "core"
    for path, structure, name in (
        ("materials/mohr_coulomb.hpp", "MohrCoulomb", "mohr-coulomb"),
        ("interfaces/voellmy.hpp", "Voellmy", "voellmy"),
        ("surface/pressure.hpp", "Pressure", "pressure"),
    ):
        text = re.sub(rf"\b{structure}\b", f"Copied{structure}", (core / path).read_text())
        text = text.replace(f'"{name}"', f'"copied-{name}"')
        (folder / f"copied_{Path(path).name}").write_text(text)
    done = cdem(folder, "law", "build", *HEADERS)
    assert done.returncode == 0, done.stderr
    return folder


HEADERS = ["copied_mohr_coulomb.hpp", "copied_voellmy.hpp", "copied_pressure.hpp"]


def cdem(folder, *words):
    """Run the program in a folder, on one thread."""
    return subprocess.run(
        [sys.executable, "-m", "cdem", *words],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )


@pytest.mark.slow
def test_a_library_gives_the_bits_of_built_in_laws(copies):
    """Exact: the same text of a law is the same machine code. So is a run that is resumed."""
    (copies / "built_in.yaml").write_text(flow())
    (copies / "own.yaml").write_text(flow("copied-", f"[{', '.join(HEADERS)}]"))
    steps = ["--set", "stages.0.max_steps=200"]
    for words in (
        ["built_in.yaml"],
        ["own.yaml", "--allow-code"],
        ["own.yaml", "--allow-code", "-o", "parts", *steps],
        ["own.yaml", "--allow-code", "-o", "parts", "--resume"],
    ):
        done = cdem(copies, "run", *words, "--quiet")
        assert done.returncode == 0, done.stderr
    built_in, own, parts = (
        read_checkpoint(copies / folder / "checkpoint.h5")[0]
        for folder in ("built_in.results", "own.results", "parts")
    )
    assert differences(built_in, own) == []
    assert differences(own, parts) == []


@pytest.mark.slow
def test_keys_of_an_own_law_are_checked(copies):
    """The header declares them: unknown keys and values out of range are refused in one line."""
    (copies / "own.yaml").write_text(flow("copied-", f"[{', '.join(HEADERS)}]"))
    for setting, told in (
        ("materials.soft.cohesio=1", "unknown key; did you mean cohesion?"),
        ("materials.soft.cohesion=-1", "must be at least 0 [Pa], got -1"),
        ("interfaces.default.turbulence=0", "turbulence must be above 0"),
    ):
        done = cdem(copies, "check", "own.yaml", "--allow-code", "--set", setting)
        assert done.returncode == 1 and told in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.slow
def test_a_run_is_not_resumed_with_another_text(copies):
    """The checkpoint keeps what the headers were."""
    (copies / "other.yaml").write_text(flow("copied-", f"[{', '.join(HEADERS)}]"))
    run = ["run", "other.yaml", "--allow-code", "--quiet"]
    assert cdem(copies, *run).returncode == 0
    paths = [copies / header for header in HEADERS]
    library = library_of(paths, choose())
    text = (copies / HEADERS[0]).read_text()
    try:
        (copies / HEADERS[0]).write_text(text + "// another\n")
        other = library_of(paths, choose())  # as if built of it
        for suffix in (".so", ".json"):
            other.with_suffix(suffix).write_bytes(library.with_suffix(suffix).read_bytes())
        done = cdem(copies, *run, "--resume")
        assert done.returncode == 1 and "was written with other headers of own laws" in done.stderr
    finally:
        (copies / HEADERS[0]).write_text(text)
