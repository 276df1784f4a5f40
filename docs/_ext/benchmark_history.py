"""Directive ``benchmark-history``: plot and table of the points in docs/benchmark_history.jsonl."""

import io
import json
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive
from tables import table

FILE = Path(__file__).parents[1] / "benchmark_history.jsonl"
COLUMNS = 3


class BenchmarkHistory(Directive):
    """Takes no arguments."""

    def run(self):
        """Nodes of the plot and of the table."""
        self.state.document.settings.env.note_dependency(str(FILE))
        points = [json.loads(line) for line in FILE.read_text().splitlines()]
        return [nodes.raw("", plot(points), format="html"), made_table(points)]


def names_of(points):
    """Names of the rates, in the order of their first appearance."""
    return list(dict.fromkeys(name for point in points for name in point["rates"]))


def plot(points):
    """An SVG: a panel for each rate, a line for each machine and set of kernels."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    names = names_of(points)
    lines = -(-len(names) // COLUMNS)
    figure, panels = pyplot.subplots(lines, COLUMNS, figsize=(9, 2.2 * lines), squeeze=False)
    for panel, name in zip(panels.flat, names, strict=False):
        draw(panel, points, name)
    for panel in panels.flat[len(names) :]:
        panel.axis("off")
    figure.tight_layout()
    file = io.StringIO()
    figure.savefig(file, format="svg", metadata={"Date": None})
    pyplot.close(figure)
    text = file.getvalue()
    return text[text.index("<svg") :]


def draw(panel, points, name):
    """One rate over the points in their order; hollow where the machine was busy."""
    machines = dict.fromkeys((p["machine"], p["kernels"]) for p in points)
    for number, machine in enumerate(machines):
        of = [
            (k, point["rates"][name], point["busy"])
            for k, point in enumerate(points)
            if (point["machine"], point["kernels"]) == machine and name in point["rates"]
        ]
        colour = f"C{number}"
        panel.plot([k for k, _, _ in of], [rate for _, rate, _ in of], color=colour, lw=0.8)
        for k, rate, busy in of:
            panel.plot(k, rate, "o", color=colour, mfc="none" if busy else colour)
    panel.set_title(name, fontsize=8)
    panel.set_ylim(bottom=0)
    panel.set_xticks(range(len(points)), [p["commit"] for p in points], rotation=30, fontsize=6)
    panel.tick_params(axis="y", labelsize=6)


def made_table(points):
    """A row for each rate, a column for each point."""
    heads = [
        ("date", lambda p: p["date"]), ("machine", lambda p: p["machine"]),
        ("kernels", lambda p: p["kernels"]), ("others at work", lambda p: "yes" if p["busy"] else "no"),
        ("bandwidth [GB/s]", lambda p: f"{p['bandwidth [GB/s]']:g}"),
    ]  # fmt: skip
    rows = [[name, *(of(point) for point in points)] for name, of in heads]
    for name in names_of(points):
        rates = [point["rates"].get(name) for point in points]
        rows.append([name, *("" if rate is None else f"{rate:,.6g}" for rate in rates)])
    cells = [[[nodes.Text(cell)] for cell in row] for row in rows]
    return table(["", *(point["commit"] for point in points)], cells, [2, *(1 for _ in points)])


def setup(app):
    """Called by Sphinx."""
    app.add_directive("benchmark-history", BenchmarkHistory)
    return {"parallel_read_safe": True}
