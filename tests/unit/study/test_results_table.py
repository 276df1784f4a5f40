"""The table of a study."""

from __future__ import annotations

import csv

from cdem.study.results_table import collect


def test_the_table_reads_back_to_the_same_bits(study, table_of, tmp_path):
    whole = study(
        "parameters: {loads.gravity.2: {values: [-10, -0.1], unit: m/s2}}\n"
        "results: {f: f, toe: histories.toe.x, none: list.1, root: = sqrt(f)}"
    )
    table = table_of(whole, lambda g: g / 3)
    paths = table.write(tmp_path)
    first, second = csv.DictReader(paths[0].open())
    assert first["loads.gravity.2 [m/s2]"] == "-10"
    assert (float(second["f"]), second["toe"], second["none"]) == (-0.1 / 3, "2.0", "")
    assert first["root"] == ""  # of a number below zero
    if len(paths) > 1:  # with pyarrow
        from pyarrow import parquet

        columns = parquet.read_table(paths[1]).to_pydict()
        assert columns["f"] == [-10 / 3, -0.1 / 3] and columns["none"] == [None, None]
    assert set(collect(study("parameters: {loads.gravity.2: [1]}"), table.runs[0])) == {
        "f", "list.0", "list.1", "histories.toe.x",
    }  # fmt: skip
