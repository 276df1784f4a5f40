"""Points of the history of speeds, and the page that draws them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from cdem.tools.benchmark import Row

ROOT = Path(__file__).parents[3]
TIMES = {"wall [us/step]": 20.0, "CPU [us/step]": 10.0}
MEASURED = [
    Row(
        "P2 tets, all faces bonded", "9", "tets/s", 1e6, 9e5, 2e6, 1, TIMES | {"start-up [s]": 0.5}
    ),
    Row("P3 tets, broken, at 5 ms", "9", "tets/s", 3e5, 2e5, 4e5, 1, TIMES | {"CPU [us/step]": 19}),
    Row("S search of the same", "9", "springs/s", 1e6, 1e6, 1e6, 1),
]
LIMITS = {"processor": "Z", "bandwidth, 1 threads": 2.34e10}


@pytest.fixture
def tools(monkeypatch):
    """The module of the tool, and that of the page."""
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    monkeypatch.syspath_prepend(str(ROOT / "docs/_ext"))
    pytest.importorskip("docutils")
    import importlib.util

    found = []
    for path in ("tools/benchmark_history.py", "docs/_ext/benchmark_history.py"):
        spec = importlib.util.spec_from_file_location(Path(path).parent.name, ROOT / path)
        found.append(importlib.util.module_from_spec(spec))
        spec.loader.exec_module(found[-1])
    return found


def test_a_point_has_rates_by_processor_time_and_tells_a_busy_machine(tools):
    point = tools[0].point(MEASURED, LIMITS)
    assert point["rates"] == {
        "P2 tets, all faces bonded [tets/s]": 2e6,
        "P3 tets, broken, at 5 ms [tets/s]": 316_000,
        "S search, at 5 ms [springs/s]": 1_050_000,
        "P2 start-up [s]": 0.5,
    }
    assert point["busy"] and point["machine"] == "Z" and point["bandwidth [GB/s]"] == 23.4
    quiet = [replace(row, more=row.more | {"CPU [us/step]": 20}) for row in MEASURED]
    assert not tools[0].point(quiet, LIMITS)["busy"]


def test_the_page_draws_and_lists_all_points(tools):
    pytest.importorskip("matplotlib")
    point = tools[0].point(MEASURED, LIMITS)
    later = point | {"commit": "later", "busy": False, "rates": {"P5 [1/s]": 4.0}}
    svg = tools[1].plot([point, later])
    assert svg.startswith("<svg") and svg.count('id="axes_') == 6
    text = tools[1].made_table([point, later]).astext()
    for word in ("later", "316,000", "P5 [1/s]", "yes", "no"):
        assert word in text
