"""Rows of the histories between two stages."""

import csv

import pytest
from scenes import case

import cdem


def test_energies_close_where_lumped_masses_become_exact(tmp_path):
    """A free tet spins; the first stage damps by node, with lumped masses, the second has exact ones.

    The change takes 4/5 of the energy, which the row at the begin of the second stage books as
    damping. There, too, the balance closes as in the steps, to 1e-6, and the kinetic energy is that
    of the next row but for vibration, 3e-5 of it. A row that mixed both masses was off by 80 %.
    """
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    data = case(
        [{"group": "tet", "polyhedron": {"vertices": vertices}}],
        {"tet": {"velocity": [0.1, 0, 0], "angular_velocity": [1, 2, 3]}},
        stages=[
            {"name": "lumped", "mode": "dynamic", "duration": 0.01, "damping": {"local": 0.01}},
            {"name": "exact", "mode": "dynamic", "duration": 0.01},
        ],
    )
    cdem.Simulation(data, output=tmp_path / "out", threads=1).run()
    with (tmp_path / "out" / "histories.csv").open() as file:
        rows = list(csv.DictReader(file))
    begin = next(i for i in range(1, len(rows)) if rows[i]["step"] == rows[i - 1]["step"])
    kinetic = [float(row["kinetic energy [J]"]) for row in rows]
    assert kinetic[begin] < 0.5 * kinetic[begin - 1]
    assert kinetic[begin] == pytest.approx(kinetic[begin + 1], rel=1e-4)
    assert max(abs(float(row["energy error"])) for row in rows) < 4e-6
