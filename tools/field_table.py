"""Write the table of output fields in docs/output_fields.md from the list of the package.

`python tools/field_table.py` writes it, `--check` only says whether it is up to date.
"""

import sys
from pathlib import Path

from cdem.case.output_fields import OUTPUT_FIELDS

PAGE = Path(__file__).parent.parent / "docs" / "output_fields.md"
START, END = "<!-- table -->\n", "<!-- end of table -->\n"


def table() -> str:
    """The list as a table in Markdown."""
    rows = [
        f"| `{f.name}` | {f.unit} | {f.on} | {f.frames} | {f.surface} | {f.meaning} |\n"
        for f in OUTPUT_FIELDS
    ]
    heads = ("field", "unit", "on", "frames.vtkhdf", "surface.vtkhdf", "meaning")
    return "| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|\n" + "".join(rows)


def main() -> None:
    """Put the table between its marks."""
    page = PAGE.read_text()
    before, _, rest = page.partition(START)
    _, _, after = rest.partition(END)
    wanted = f"{before}{START}\n{table()}\n{END}{after}"
    if "--check" not in sys.argv:
        PAGE.write_text(wanted)
    elif page != wanted:
        sys.exit(f"{PAGE}: the table is old; run {Path(__file__).name}")


if __name__ == "__main__":
    main()
