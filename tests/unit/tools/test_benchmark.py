"""Rows of the benchmark."""

from __future__ import annotations

import pytest


def test_benchmark_rows_say_what_was_measured(monkeypatch):
    from cdem.tools import benchmark

    monkeypatch.setattr(benchmark, "SECONDS", 1e-4)
    monkeypatch.setattr(benchmark, "TRIAD_BYTES", 3_000_000)
    monkeypatch.setattr(benchmark, "MOMENTS", (5, 20))
    rubble, search, later, _ = benchmark.rubble(1, 1)
    assert [rubble.name, later.name] == [f"P3 tets, broken, at {n} ms" for n in (5, 20)]
    assert 5 <= rubble.more["from [ms]"] < 5.1 < rubble.more["to [ms]"] < 20
    assert 20 <= later.more["from [ms]"] < 20.1 < later.more["to [ms]"]
    broken = benchmark.tets_broken(2, 1)
    assert broken.more["broken [%]"] > 0
    shared, bonded = benchmark.tets_shared(2, 1), benchmark.tets_bonded(2, 1)
    for row in (shared, bonded, broken, benchmark.mixed(1, 1), rubble, later):
        assert 0 < row.least <= row.rate <= row.most
        # one thread works as long as the clock runs, or less where others work too; 10 ms is a tick
        assert 0 < row.more["CPU [us/step]"] < 1.5 * row.more["wall [us/step]"] + 250
        assert sum(v for k, v in row.more.items() if k.split()[0] in benchmark.PHASES) == (
            pytest.approx(100)
        )
        assert row.name in row.text()
        assert row.kernels and row.processor and abs(row.more["energy error [%]"]) < 5
    assert rubble.more["damping, contact"] == 0.1 and rubble.more["damping, stiffness"] == 0
    assert search.rate > rubble.rate
    assert search.more["lists [us per spring and refresh]"] > 0
    limits = benchmark.machine(2)
    assert limits["bandwidth, 2 threads"] > 1e8
    assert limits["multiply-adds, 1 threads"] > 1e8


def test_a_simulated_second_has_its_cost_and_its_accuracy(monkeypatch):
    from cdem.tools import benchmark

    monkeypatch.setattr(benchmark, "SECONDS", 1e-4)
    monkeypatch.setattr(benchmark, "SIZES", {"1e4": 1})
    for name, value in {
        "SHAKEN": 1,
        "WALL": 2,
        "RUBBLE": 1,
        "RUBBLE_STEPS": 10,
        "REPEATS": 1,
    }.items():
        monkeypatch.setattr(benchmark, name, value)
    rows = {row.name: row for row in benchmark.seconds()}
    assert len(rows) == 12
    for row in rows.values():
        assert row.rate > 0
    steps = [rows[f"P4 wall, {kind}"].more["step [us]"] for kind in ("plain", "defaults")]
    assert steps[1] > 2 * steps[0]
    # of a cube of 6 x 6 x 6 cells; bonds of 10 E/h make it 1 + 6 / (3 * 10) times as soft
    errors = [
        rows[f"P2 regular tets, {kind}"].more["error of E [%]"] for kind in ("plain", "defaults")
    ]
    assert errors[0] == pytest.approx(100 * (1 / 1.2 - 1), abs=0.1)
    assert abs(errors[1]) < 1e-3
    assert abs(rows["P2 irregular tets, defaults, 0.1 % of mass"].more["error of E [%]"]) < 0.3
