"""What a part of torture, or `tools/mutants.py`, has done so far, in a file: it goes on from it."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any


class State:
    """Results so far, and the commits they are of.

    Args:
        path: The file, or None to keep nothing.
        asked: Options of the part; the program ends if the file is of others.
        fresh: Results before anything is done.

    Attributes:
        known: Results so far.
        now: Commit of the checkout.
    """

    def __init__(self, path: Path | None, asked: list[Any], fresh: dict[str, Any]) -> None:
        self._path, self._asked, self._commits = path, asked, []
        self.known = fresh
        self.now = commit()
        if path and path.exists():
            found = json.loads(path.read_text())
            if found["asked"] != asked:
                sys.exit(f"{path} is of {found['asked']}, not of {asked}; remove it to begin again")
            self.known, self._commits = found["known"], found["commits"]

    def keep(self) -> None:
        """Write the file: whole, or not at all."""
        if self.now not in self._commits:
            self._commits.append(self.now)
        if self._path is None:
            return
        self._path.parent.mkdir(parents=True, exist_ok=True)
        parts = {"asked": self._asked, "commits": self._commits, "known": self.known}
        new = self._path.with_suffix(".new")
        new.write_text(json.dumps(parts, indent=1))
        os.replace(new, self._path)

    def commits(self) -> str:
        """Commits that the results are of."""
        return ", ".join(self._commits)


def add_option(parser: argparse.ArgumentParser) -> None:
    """The option that names the file."""
    parser.add_argument("--state", type=Path, help="file of what is done: go on from it")


def commit() -> str:
    """Commit of the checkout, with a mark if it has changes."""
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty"]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
