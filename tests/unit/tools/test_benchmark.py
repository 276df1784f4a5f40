"""Rows of the benchmark."""

from __future__ import annotations

import pytest


def test_benchmark_rows_say_what_was_measured(monkeypatch):
    from cdem.tools import benchmark

    monkeypatch.setattr(benchmark, "SECONDS", 1e-4)
    monkeypatch.setattr(benchmark, "TRIAD_BYTES", 3_000_000)
    rubble, search = benchmark.rubble(1, 1)
    broken = benchmark.tets_broken(2, 1)
    assert broken.more["broken [%]"] > 0
    shared, bonded = benchmark.tets_shared(2, 1), benchmark.tets_bonded(2, 1)
    for row in (shared, bonded, broken, benchmark.mixed(1, 1), rubble):
        assert 0 < row.least <= row.rate <= row.most
        assert sum(v for k, v in row.more.items() if k.split()[0] in benchmark.PHASES) == (
            pytest.approx(100)
        )
        assert row.name in row.text()
    assert search.rate > rubble.rate
    assert search.more["lists [us per spring and refresh]"] > 0
    limits = benchmark.machine(2)
    assert limits["bandwidth, 2 threads"] > 1e8
    assert limits["multiply-adds, 1 threads"] > 1e8
