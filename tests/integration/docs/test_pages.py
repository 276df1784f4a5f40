"""Tutorials and how-to pages work as they are typed: their blocks are run, page by page.

Blocks of `sh` and `python` are run in order in an empty folder. A comment before a block says what
else holds for it: `<!-- save: NAME -->` writes it to a file, `<!-- slow -->` leaves it to the slow
tests, `<!-- not run -->` to the reader, and `<!-- fails -->` expects exit status 1.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[3] / "docs"
BLOCK = re.compile(r"(?:^<!-- (.*?) -->\n\n)?^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGES = sorted([*DOCS.glob("tutorials/*.md"), *DOCS.glob("howto/*.md")])
RUN = {"sh": ["bash", "-euc"], "python": [sys.executable, "-c"]}


def blocks(page: Path) -> list[tuple[str, str, str]]:
    """Comment, language and text of each block."""
    return BLOCK.findall(page.read_text())


def runs(page: Path, folder: Path, *, slow: bool) -> int:
    """Run the blocks of a page; how many there were."""
    programs = Path(sys.executable).parent
    environment = os.environ | {"PATH": f"{programs}:{os.environ['PATH']}", "OMP_NUM_THREADS": "1"}
    count = 0
    for comment, language, text in blocks(page):
        if comment.startswith("save: "):
            (folder / comment.removeprefix("save: ")).write_text(text)
        elif language in RUN and comment != "not run" and (slow or comment != "slow"):
            command = [*RUN[language], text]
            done = subprocess.run(
                command, cwd=folder, env=environment, capture_output=True, text=True, timeout=3000
            )
            expected = 1 if comment == "fails" else 0
            assert done.returncode == expected, f"{text}\n{done.stdout}\n{done.stderr}"
            count += 1
    return count


def named(pages: list[Path]) -> list:
    """Parameters of a test for pages."""
    return [pytest.param(page, id=page.stem) for page in pages]


def has(page: Path, *comments: str) -> bool:
    """Whether a page has blocks to run with one of these comments."""
    return any(c in comments and language in RUN for c, language, _ in blocks(page))


@pytest.mark.parametrize("page", named([page for page in PAGES if has(page, "", "fails")]))
def test_quick_blocks(page, tmp_path):
    assert runs(page, tmp_path, slow=False)


@pytest.mark.slow
@pytest.mark.parametrize("page", named([page for page in PAGES if has(page, "slow")]))
def test_all_blocks(page, tmp_path):
    assert runs(page, tmp_path, slow=True)


def test_comments_are_known():
    """A comment that is misspelt would run what should not be run, or nothing."""
    known = re.compile(r"|slow|not run|fails|save: [\w.]+|table|end of table")
    for page in [*PAGES, DOCS / "install.md"]:
        for comment in re.findall(r"^<!-- (.*?) -->$", page.read_text(), re.MULTILINE):
            assert known.fullmatch(comment), f"{page.name}: {comment}"
            assert f"<!-- {comment} -->\n\n```" in page.read_text(), f"{page.name}: {comment}"
