"""The verification manual: a page for each problem, made of its README and its latest results.

Pages are written to docs/problems, which is no part of the repository; docs/manual.md lists them.
"""

import re
from pathlib import Path

from repository_links import redirect

HOME = "src/cdem/verification"


def make_pages(app):
    """Write the pages, each only if it changed."""
    root = Path(app.srcdir).parent
    folder = Path(app.srcdir, "problems")
    folder.mkdir(exist_ok=True)
    head, rows = _results((root / "docs/verification.md").read_text())
    for readme in sorted((root / HOME).glob("*/README.md")):
        name = readme.parent.name
        text = redirect(readme.read_text(), f"{HOME}/{name}", "docs/problems")
        results = ["## Results", "", *head, *rows[name]] if name in rows else []
        _write(folder / f"{name}.md", "\n".join([text, *results, ""]))


def _results(text):
    """Head of the table of results without its first column, and rows by problem."""
    found = [line.split("|", 2) for line in text.splitlines() if re.match(r"\| \w+ \|", line)]
    lines = [(first.strip(), f"|{rest}") for _, first, rest in found]
    start = next(i for i, (first, rest) in enumerate(lines) if "quantity" in rest)
    head = [lines[start][1], "|---|---|---|---|---|---|---|"]
    rows = {}
    for first, rest in lines[start + 1 :]:
        rows.setdefault(first, []).append(rest)
    return head, rows


def _write(path, text):
    if not path.is_file() or path.read_text() != text:
        path.write_text(text)


def setup(app):
    """Called by Sphinx."""
    app.connect("builder-inited", make_pages)
    return {"parallel_read_safe": True}
