"""The page of limits is in order: each entry once, with a source and a date, ascending in its theme."""

import re
from datetime import datetime
from pathlib import Path

PAGE = Path(__file__).resolve().parents[3] / "docs/limits.md"


def test_entries_are_ordered_and_dated():
    themes = PAGE.read_text().split("\n## ")[1:]
    numbers = [[int(n) for n in re.findall(r"^\| (\d+) \|", theme, re.M)] for theme in themes]
    assert all(found and found == sorted(found) for found in numbers)
    everything = [number for found in numbers for number in found]
    assert len(set(everything)) == len(everything) > 100
    dated = re.findall(r"^\| \d+ \| .+ \| .+ \| (\d+ \w+ \d+) \|$", PAGE.read_text(), re.M)
    assert len(dated) == len(everything)
    for date in dated:
        datetime.strptime(date, "%d %b %Y")
