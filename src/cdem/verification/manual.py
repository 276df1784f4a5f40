"""The verification manual: results of `cdem verify` as a page with formulas, plots and pictures."""

from __future__ import annotations

import base64
import html
import io
import platform
from collections.abc import Sequence
from pathlib import Path

from cdem._native import name as native_name
from cdem._version import __version__
from cdem.errors import CaseError, CdemError
from cdem.output.figures import pyplot
from cdem.output.render import picture as draw_surfaces
from cdem.verification.runner import HEADINGS, Curve, Outcome, Picture

STYLE = """body{font:16px/1.5 sans-serif;max-width:65em;margin:2em auto;padding:0 1em}
img{max-width:100%;display:block;margin:1em 0}table{border-collapse:collapse;margin:1em 0}
td,th{padding:.2em .8em;text-align:left;border-bottom:1px solid #ddd}
pre{background:#f4f4f4;padding:1em;overflow:auto}.MISS{color:#b00;font-weight:bold}
.pass{color:#070}section{border-top:2px solid #ccc;margin-top:2em}"""


class Manual:
    """A report that grows: the manual (.html), or its table alone (.md).

    Raises:
        CaseError: It could not be written there; found before anything is computed.
    """

    def __init__(self, path: Path) -> None:
        if path.suffix not in (".html", ".md"):
            raise CaseError(f"{path}: a report ends in .html (the manual) or .md (the table alone)")
        if not path.parent.is_dir():
            raise CaseError(f"{path}: there is no folder {path.parent}")
        self.path = path
        self._outcomes: list[Outcome] = []
        self._parts: list[str] = []

    def add(self, outcome: Outcome) -> None:
        """Write the report with one outcome more."""
        self._outcomes.append(outcome)
        if self.path.suffix == ".md":
            self._parts.append(_rows(outcome))
            self.path.write_text(_table_head() + "".join(self._parts))
        else:
            self._parts.append(_section(outcome))
            self.path.write_text(_page(self._outcomes, self._parts))


def _machine() -> str:
    return f"cdem {__version__} ({native_name}), {platform.system()} {platform.machine()}"


def _table_head() -> str:
    heads = ("problem", *HEADINGS)
    return f"{_machine()}\n\n| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|\n"


def _rows(outcome: Outcome) -> str:
    name = outcome.problem.name
    rows = "".join("| " + " | ".join((name, *c.texts())) + " |\n" for c in outcome.checks)
    if outcome.failure:
        rows += f"| {name} | {outcome.failure} ||||||FAILED |\n"
    return rows.replace("|T|", "T")  # a bar ends a cell


def _section(outcome: Outcome) -> str:
    from markdown_it import MarkdownIt

    page = MarkdownIt("commonmark").enable("table").render(outcome.problem.page)
    failure = f'<p class="MISS">{html.escape(outcome.failure)}</p>' if outcome.failure else ""
    shown = "".join(_exhibit(e) for e in outcome.exhibits)
    name = outcome.problem.name
    return (
        f'<section id="{name}">{page}{_table(outcome)}{failure}{shown}<p>{outcome.wall_time:.1f} s; '
        f"repeat with <code>cdem verify {name}</code></p></section>"
    )


def _page(outcomes: Sequence[Outcome], sections: Sequence[str]) -> str:
    contents = ""
    for outcome in outcomes:
        verdict = "pass" if outcome.passed else "MISS"
        contents += (
            f'<li><a href="#{outcome.problem.name}">{html.escape(outcome.problem.title)}</a> '
            f'<span class="{verdict}">{verdict}</span>'
        )
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>cdem verification manual'
        f"</title><style>{STYLE}</style><h1>Verification manual</h1><p>{html.escape(_machine())}; "
        f"{sum(o.passed for o in outcomes)} of {len(outcomes)} problems pass.</p>"
        f"<ol>{contents}</ol>{''.join(sections)}</html>\n"
    )


def _table(outcome: Outcome) -> str:
    rows = "".join(f"<th>{name}</th>" for name in HEADINGS)
    for check in outcome.checks:
        *cells, verdict = check.texts()
        rows += "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells)
        rows += f'<td class="{verdict}">{verdict}</td></tr>'
    return f"<table>{rows}</table>"


def _exhibit(exhibit: Curve | Picture) -> str:
    title = html.escape(exhibit.title)
    try:
        data = image(exhibit)
    except CdemError as error:
        return f"<p>{title}: not drawn, {html.escape(str(error))}</p>"
    return (
        f'<figure><img alt="{title}" src="data:image/png;base64,'
        f'{base64.b64encode(data).decode()}"><figcaption>{title}</figcaption></figure>'
    )


def image(exhibit: Curve | Picture) -> bytes:
    """A plot or picture as PNG.

    Raises:
        CdemError: A library that draws is not installed.
    """
    return _plot(exhibit) if isinstance(exhibit, Curve) else _draw(exhibit)


def _plot(curve: Curve) -> bytes:
    plt = pyplot()
    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    for label, (x, y) in curve.lines.items():
        axes.plot(x, y, "o" if label.startswith(".") else "-", label=label.lstrip("."))
    if curve.log:
        axes.set(xscale="log", yscale="log")
    axes.set(xlabel=curve.x_label, ylabel=curve.y_label)
    axes.grid(alpha=0.3)
    axes.legend()
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=110)
    plt.close(figure)
    return data.getvalue()


def _draw(picture: Picture) -> bytes:
    image = draw_surfaces(picture.surfaces, picture.field)  # says so if the extra is not installed
    from PIL import Image

    data = io.BytesIO()
    Image.fromarray(image).save(data, format="png")
    return data.getvalue()
