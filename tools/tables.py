"""Renew the tables of the documents that follow from lists in the code; --check: compare them."""

import sys
from pathlib import Path

from cdem._native import core as native
from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS, SURFACE_LAWS, Law
from cdem.case.output_fields import OUTPUT_FIELDS
from cdem.case.plausible import RANGES, written
from cdem.verification.runner import problems

DOCS = Path(__file__).parent.parent / "docs"
BEGIN, END = "<!-- table -->\n\n", "\n<!-- end of table -->"


def fields_table() -> str:
    """The output fields that do not depend on a law."""
    rows = [
        f"| `{f.name}` | {f.unit} | {f.on} | {f.frames} | {f.surface} | {f.meaning} |"
        for f in OUTPUT_FIELDS
    ]
    head = "| field | unit | on | frames.vtkhdf | surface.vtkhdf | meaning |\n|---|---|---|---|---|---|"
    return "\n".join([head, *rows, ""])


def law_rows(key: str, law: Law) -> list[str]:
    """A law and its parameters as rows of a table."""
    rows = [f"| **{key}: {law.name}** | | | | {law.meaning} |"]
    for p in law.parameters:
        upper = "" if p.below is None else f", below {p.below:g}"
        upper += "" if p.at_most is None else f", at most {p.at_most:g}"
        default = "required" if p.default is None else f"{p.default:g}".replace("inf", "no limit")
        default = default if p.like is None else f"`{p.like}`"
        limits = "any" if p.at_least is None else f"at least {p.at_least:g}{upper}"
        if p.choices:
            limits, default = (
                ", ".join(f"`{word}`" for word in p.choices.split()),
                p.choices.split()[0],
            )
        rows.append(f"| `{p.name}` | {p.unit} | {limits} | {default} | {p.meaning} |")
    rows += [f"| state `{v.name}` | {v.unit} | | | {v.meaning} |" for v in law.state]
    return rows


def laws_table() -> str:
    """All laws that the core declares."""
    rows = ["| | unit | range | default | meaning |", "|---|---|---|---|---|"]
    for law in INTERFACE_LAWS.values():
        rows += law_rows("interface", law)
    for law in BLOCK_LAWS.values():
        rows += law_rows("material", law)
    for law in SURFACE_LAWS.values():
        rows += law_rows("surface", law)
    return "\n".join([*rows, ""])


def checks_table() -> str:
    """What values are usual and possible, with sources."""
    rows = ["| quantity | usual | possible | source |", "|---|---|---|---|"]
    for entry in RANGES:
        usual, possible = (
            "any" if limits is None else " to ".join(written(v, entry.unit) for v in limits)
            for limits in (entry.usual, entry.possible)
        )
        zero = ", or 0" if entry.zero else ""
        rows.append(f"| {entry.quantity} | {usual}{zero} | {possible} | {entry.source} |")
    return "\n".join([*rows, ""])


def problems_table() -> str:
    """The problems of `cdem verify`, with links to their pages."""
    rows = ["| problem | what | in the quick set |", "|---|---|---|"]
    for problem in problems():
        page = f"../src/cdem/verification/{problem.name}/README.md"
        quick = "yes" if problem.quick else ""
        rows.append(f"| [{problem.name}]({page}) | {problem.title} | {quick} |")
    return "\n".join([*rows, ""])


def arrays_table() -> str:
    """The arrays of the core with several numbers a row, and the parts of a row."""
    rows = ["| array | a row for each of | parts of a row | meaning |", "|---|---|---|---|"]
    for info in native.Core().describe():
        units = [unit.strip() for unit in info["unit"].split(",")]
        if not info["parts"]:
            continue
        units = units * len(info["parts"]) if len(units) == 1 else units
        named = [
            (f"`{name}`" if name else "pad")
            + (f" ({numbers})" if numbers > 1 else "")
            + (f" {unit}" if name and unit != "1" else "")
            for (name, numbers), unit in zip(info["parts"], units, strict=True)
        ]
        rows.append(
            f"| `{info['name']}` | {info['rows']} | {', '.join(named)} | {info['meaning']} |"
        )
    return "\n".join([*rows, ""])


TABLES = {
    "manual.md": problems_table,
    "output_fields.md": fields_table,
    "laws.md": laws_table,
    "checks.md": checks_table,
    "contributing/arrays.md": arrays_table,
}


def main() -> None:
    """Put every table into its page; with --check, only fail where one is out of date."""
    for name, table in TABLES.items():
        page = DOCS / name
        text = page.read_text()
        before, rest = text.split(BEGIN)
        new = before + BEGIN + table() + END + rest.split(END)[1]
        if "--check" in sys.argv and new != text:
            sys.exit(f"docs/{name}: the table is out of date; run tools/tables.py")
        page.write_text(new)


if __name__ == "__main__":
    main()
