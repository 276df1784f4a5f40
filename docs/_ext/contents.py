"""The order of pages on the site is that of the tables with links on index pages.

GitHub would show a table of contents of Sphinx as code, so pages have none: each index page says
which pages there are, and this extension makes Sphinx's hidden ones of them. On the front
page a row of the table is a part of the sidebar, named by its first cell.
"""

import re
from pathlib import Path

LINK = re.compile(r"\]\(([^):#\s]+?)\.(?:md|rst|ipynb)(?:#[^)]*)?\)")

INDEXES = ("index", "manual")


def tree(pages, caption=""):
    """The lines of a hidden table of contents."""
    options = [":hidden:"] + ([f":caption: {caption}"] if caption else [])
    return ["```{toctree}", *options, "", *pages, "```", ""]


def parts(text, front):
    """Parts of an index page, each with its pages: rows of tables with their first cell, or all."""
    if not front:
        yield "", LINK.findall(text)
        return
    for line in text.splitlines():
        if line.startswith("|"):
            yield line.split("|")[1].strip().capitalize(), LINK.findall(line)


def add_contents(app, name, source):
    """Add tables of contents to an index page."""
    if name.rsplit("/", 1)[-1] not in INDEXES:
        return
    folder = Path(app.srcdir, name).parent
    seen = {"index"}
    for caption, pages in parts(source[0], front=name == "index"):
        new = [p for p in dict.fromkeys(pages) if p not in seen and _is_page(folder, p)]
        seen |= set(new)
        if new:
            source[0] += "\n".join(["", *tree(new, caption)])


def _is_page(folder, page):
    """Whether there is a source of a page, in the folder or below it."""
    path = Path(folder, page)
    return not page.startswith("..") and any(
        path.with_name(path.name + ending).is_file() for ending in (".md", ".rst", ".ipynb")
    )


def setup(app):
    """Called by Sphinx."""
    app.connect("source-read", add_contents)
    return {"parallel_read_safe": True}
