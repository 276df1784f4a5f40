"""Sections and tables as nodes of docutils, for the pages that are made from the code."""

import re

from docutils import nodes


def section(title, name, *content):
    """A section that others reach by its name.

    Args:
        title: Text, or nodes, of its heading.
        name: Its id on the page.
        content: Nodes of the section.
    """
    heading = [nodes.Text(title)] if isinstance(title, str) else title
    return nodes.section("", nodes.title("", "", *heading), *content, ids=[name], names=[name])


def words(text):
    """Nodes of a text in which `code` stands between backticks."""
    parts = re.split(r"`+([^`]*)`+", " ".join(text.split()))
    return [
        nodes.literal(part, part) if i % 2 else nodes.Text(part)
        for i, part in enumerate(parts)
        if part
    ]


def paragraph(text):
    """A paragraph of such a text."""
    return nodes.paragraph("", "", *words(text))


def table(headings, rows, widths):
    """A table.

    Args:
        headings: Texts of the first row.
        rows: Lists of cells; each is a list of nodes that stand in a line.
        widths: Shares of the columns.
    """
    group = nodes.tgroup("", *(nodes.colspec(colwidth=w) for w in widths), cols=len(widths))
    group += nodes.thead("", _row([[nodes.Text(heading)] for heading in headings]))
    group += nodes.tbody("", *map(_row, rows))
    return nodes.table("", group, classes=["made"])


def _row(cells):
    return nodes.row("", *(nodes.entry("", nodes.paragraph("", "", *cell)) for cell in cells))
