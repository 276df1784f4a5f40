"""Tutorials, how-to pages and the gallery work as they are typed: tools/pages.py runs them."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PAGES = sorted([*ROOT.glob("docs/tutorials/*.md"), *ROOT.glob("docs/howto/*.md"),
                ROOT / "docs/records.md"])  # fmt: skip
RUN = r"(?:sh|python)\n"


def named(pattern: str) -> list:
    """Parameters of a test for the pages that match a pattern."""
    found = [page for page in [*PAGES, ROOT / "docs/gallery.md"]
             if re.search(pattern, page.read_text(), re.MULTILINE)]  # fmt: skip
    return [pytest.param(page, id=page.stem) for page in found]


def run(*words: str | Path) -> subprocess.CompletedProcess:
    """Call the tool."""
    command = [sys.executable, ROOT / "tools/pages.py", *words]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.mark.parametrize("page", named(rf"(?<!-->)\n\n```{RUN}|^<!-- fails"))
def test_quick_blocks(page):
    done = run(page)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("page", named("^<!-- slow"))
def test_all_blocks(page):
    done = run("--slow", page)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "text, status, said",
    [
        ("```sh\ntrue\n```\n", 0, ""),
        ("```sh\necho no; exit 3\n```\n", 1, "exit status 3\nno"),
        ("<!-- fails -->\n\n```sh\nexit 1\n```\n", 0, ""),
        ("<!-- fails -->\n\n```sh\ntrue\n```\n", 1, "exit status 0"),
        ("<!-- slow -->\n\n```sh\nexit 3\n```\n", 0, ""),
        ("<!-- not run -->\n\n```python\n1 / 0\n```\n", 0, ""),
        ("<!-- save: a.txt -->\n\n```yaml\nb\n```\n\n```sh\ngrep b a.txt\n```\n", 0, ""),
        ('```python\nprint(1)\n```\n\n```python\nraise SystemExit("no")\n```\n', 1, "no"),
    ],
)
def test_tool(tmp_path, text, status, said):
    page = tmp_path / "page.md"
    page.write_text(text)
    done = run(page)
    assert done.returncode == status
    assert said in done.stderr


def test_comments_are_known():
    """A comment that is misspelt would run what should not be run."""
    known = re.compile(r"slow|not run|fails|save: [\w.]+")
    for page in [*PAGES, ROOT / "docs/install.md", ROOT / "docs/gallery.md"]:
        text = page.read_text()
        for comment in re.findall(r"<!-- (.*?) -->", text):
            assert known.fullmatch(comment), f"{page.name}: {comment}"
            assert f"\n<!-- {comment} -->\n\n```" in text, f"{page.name}: {comment}"
