"""Shells complete commands, templates and fields."""

import os
import subprocess
import sys

import pytest


@pytest.mark.parametrize(
    "words, found",
    [
        ("cdem ren", ["render"]),
        ("cdem new landslide", ["landslide", "landslide_dem"]),
        ("cdem render DIR --field sigma", ["sigma_1", "sigma_2", "sigma_3"]),
    ],
)
def test_bash_completes(words, found):
    asked = {"_CDEM_COMPLETE": "complete_bash", "COMP_WORDS": words}
    asked["COMP_CWORD"] = str(len(words.split()) - 1)
    code = "import sys; sys.argv = ['cdem']; from cdem.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=os.environ | asked,
        check=False,
    )  # fmt: skip
    assert done.stdout.split() == found
