"""Draw the architecture from the code: folders in their order, their sizes, imports among them.

`python tools/drawing.py` writes docs/pictures/architecture.svg; `--check` fails if it is out of date.
"""

import re
import sys
from collections import Counter
from collections.abc import Iterable
from html import escape
from pathlib import Path

import layers
import package_layers

ROOT = Path(__file__).resolve().parent.parent
PICTURE = ROOT / "docs/pictures/architecture.svg"
WIDTH, ROW, BOX, ARCS = 1160, 36, 30, 90
LEFT, RIGHT = ARCS + 10, 660  # where the boxes of both columns begin
BOX_WIDTH = {LEFT: 440, RIGHT: 500}
COLOURS = {"case": "#e8f0fa", "core": "#fbeee0"}
STYLE = (
    "text { font: 12px sans-serif; fill: #222 } .name { font-weight: bold } .head { font-size: 15px;"
    " font-weight: bold } .lines { fill: #777; text-anchor: end } rect { stroke: #9aa5ad }"
    " path { fill: none; stroke: #5f7f9f } .core { stroke: #b07f45 } .flow { stroke: #333;"
    " stroke-width: 2 }"
)
Row = tuple[str, str, int]  # a folder, its contents, its lines


def lines(paths: Iterable[Path]) -> int:
    """Lines of some files, to the ten."""
    return round(sum(len(path.read_text().splitlines()) for path in paths), -1)


def packages() -> tuple[list[Row], Counter[tuple[int, int]]]:
    """Python packages, highest first, and numbers of imports between them."""
    order = [name for name, about in reversed(package_layers.FOLDERS.items()) if about]
    place = package_layers.ROOT / "cdem"
    about = package_layers.FOLDERS
    rows = [(name, about[name], lines((place / name).rglob("*.py"))) for name in order]
    arcs: Counter[tuple[int, int]] = Counter()
    for module, others in package_layers.graph_of_imports().items():
        upper = module.split(".")[1]
        for lower in (other.split(".")[1] for other in others):
            if upper != lower and {upper, lower} <= set(order):
                arcs[order.index(upper), order.index(lower)] += 1
    return rows, arcs


def folders() -> tuple[list[Row], Counter[tuple[int, int]]]:
    """Folders of the core, highest first, and numbers of includes between them."""
    order = list(reversed(layers.FOLDERS))
    files: dict[str, list[Path]] = {name: [] for name in order}
    arcs: Counter[tuple[int, int]] = Counter()
    for path in layers.sources():
        upper = str(Path(path).relative_to("core").parent)
        files[upper].append(ROOT / path)
        for other in layers.includes(path):
            lower = str(Path(other).relative_to("core").parent)
            if upper != lower:
                arcs[order.index(upper), order.index(lower)] += 1
    names = {".": "step"}
    rows = [(names.get(o, o), layers.FOLDERS[o], lines(files[o])) for o in order]
    return rows, arcs


def text(x: float, y: float, words: str, kind: str = "") -> str:
    """Words at a place."""
    return f'<text x="{x}" y="{y}" class="{kind}">{escape(words)}</text>'


def column(rows: list[Row], x: int, top: int, colour: str) -> list[str]:
    """Boxes, one below the other."""
    out = []
    for number, (name, about, size) in enumerate(rows):
        y, wide = top + number * ROW, BOX_WIDTH[x]
        out.append(
            f'<rect x="{x}" y="{y}" width="{wide}" height="{BOX}" rx="4" fill="{colour}"/>'
            + text(x + 8, y + 20, name, "name")
            + text(x + (100 if x == LEFT else 170), y + 20, about)
            + text(x + wide - 8, y + 20, f"{size:,}", "lines")
        )
    return out


def curves(arcs: Counter[tuple[int, int]], x: int, top: int, kind: str) -> list[str]:
    """Imports between boxes as arcs beside them: the wider the arc, the more imports."""
    out = []
    for (upper, lower), count in sorted(arcs.items()):
        y, z = top + upper * ROW + BOX * 0.7, top + lower * ROW + BOX * 0.3
        reach = ARCS * min(1.0, 0.16 + abs(lower - upper) / 16)
        wide = 0.5 + min(count, 60) / 15
        side = x - reach if x == LEFT else x + BOX_WIDTH[x] + reach
        edge = x if x == LEFT else x + BOX_WIDTH[x]
        out.append(
            f'<path class="{kind}" d="M{edge} {y:.0f} C{side:.0f} {y:.0f} {side:.0f} {z:.0f} '
            f'{edge} {z:.0f}" stroke-width="{wide:.1f}" opacity="0.45"/>'
        )
    return out


def flow(top: int, places: dict[str, int]) -> list[str]:
    """The way of a case between both columns: arrays to the core, steps, state back."""
    x, y = LEFT + BOX_WIDTH[LEFT], top + BOX / 2
    out = [
        '<marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
        'orient="auto"><path d="M0 0L8 4L0 8z" style="fill:#333;stroke:none"/></marker>'
    ]
    for name, to, words in (
        ("model", "core model", "arrays"),
        ("run", "core run", "advance"),
    ):
        a, b = y + places[name] * ROW, y + places[to] * ROW
        out.append(
            f'<path class="flow" d="M{x} {a} C{x + 70} {a} {RIGHT - 70} {b} {RIGHT} {b}" '
            'marker-end="url(#tip)"/>' + text((x + RIGHT) / 2 - 30, (a + b) / 2 - 8, words)
        )
    return out


def drawing() -> str:
    """The picture."""
    left, imports = packages()
    right, included = folders()
    top, below = 70, 70 + ROW * len(right)
    first = top + ROW * (len(right) - len(left)) // 2
    places = {name: number for number, (name, _, _) in enumerate(left)}
    shift = (first - top) / ROW
    places = {name: number + shift for name, number in places.items()}
    places |= {f"core {name}": number for number, (name, _, _) in enumerate(right)}
    bound = lines((ROOT / "bindings").glob("*.[hc]pp"))
    parts = [
        text(LEFT, first - 18, "src/cdem: Python, cases, models, results", "head"),
        text(RIGHT, top - 18, "core: C++20, the method", "head"),
        *curves(imports, LEFT, first, ""),
        *curves(included, RIGHT, top, "core"),
        *column(left, LEFT, first, COLOURS["case"]),
        *column(right, RIGHT, top, COLOURS["core"]),
        text(LEFT, first + ROW * len(left) + 24, "A folder imports only from folders below it."),
        text(
            LEFT, first + ROW * len(left) + 42, "The wider an arc, the more imports. Right: lines."
        ),
        text(LEFT, first + ROW * len(left) + 60, f"bindings/ ({bound:,} lines) joins both."),
        *flow(top, places),
    ]
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH + ARCS} {below + 12}">'
    paper = '<rect width="100%" height="100%" fill="white" style="stroke:none"/>'
    return "\n".join([head, f"<style>{STYLE}</style>", paper, *parts, "</svg>", ""])


def main() -> None:
    """Write the picture; with --check, only fail where it is out of date."""
    new = drawing()
    # Sizes change with every edit, so only what is drawn must agree.
    plain = re.compile(r'class="lines">[^<]*<|[\d,]+ lines|stroke-width="[\d.]+"')
    if "--check" in sys.argv:
        old = PICTURE.read_text()
        if plain.sub("", old) != plain.sub("", new):
            sys.exit(f"{PICTURE.relative_to(ROOT)} is out of date; run tools/drawing.py")
        return
    PICTURE.write_text(new)


if __name__ == "__main__":
    main()
