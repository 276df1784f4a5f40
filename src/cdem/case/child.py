"""Python processes that cdem starts: none imports anything from the current folder.

The current folder may hold files of a stranger. ``python -m`` and ``python -c`` look there first, so
a file ``json.py`` beside a case would run. ``-I`` prevents that, but also drops PYTHONPATH and the
folder of the user's own packages; so this process passes on its own folders, without the current
one.
"""

from __future__ import annotations

import sys
from pathlib import Path

AWAY = Path(__file__).parents[1]
"""A folder with no files of strangers, for processes that open no file of the user."""
RUN = "import runpy; sys.argv.pop(0); runpy.run_module(sys.argv[0], run_name='__main__', alter_sys=True)"


def module(name: str, *words: str) -> list[str]:
    """Command line that runs a module with these arguments."""
    return [*code(RUN), name, *words]


def code(text: str) -> list[str]:
    """Command line that runs some lines of Python."""
    return [sys.executable, "-I", "-c", f"import sys; sys.path[:] = {folders()!r}\n{text}"]


def folders() -> list[str]:
    """Folders where this process finds modules, without the current folder.

    The folder of cdem itself stays: its code runs here already.
    """
    here, home = Path.cwd(), Path(__file__).parents[2]
    found = [one for one in sys.path if Path(one).is_absolute() and Path(one).resolve() != here]
    return found if home != here else [*found, str(home)]
