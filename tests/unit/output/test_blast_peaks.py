"""Peak velocities of points, and their distances from charges."""

import json

import numpy as np
import pytest

from cdem.output.blast_peaks import distance
from cdem.output.motions import measure

CHARGES = [
    {"hole": "hole1", "stage": "blow", "ends": [[0, 0, 0], [0, 0, 4]], "mass": 16.0},
    {"hole": "hole2", "stage": "blow", "ends": [[9, 0, 0], [9, 0, 4]], "mass": None},
    {"hole": "later", "stage": "other", "ends": [[3, 0, 0], [3, 0, 0]], "mass": 1.0},
]
HISTORIES = """\
cdem: 2
histories:
  - {name: near, point: [3, 0, 1], quantities: [velocity]}
  - {name: above, point: [9, 1, 4.5], quantities: [velocity]}
  - {name: still, point: [1, 0, 0], quantities: [displacement]}
  - {name: all, group: rock, quantities: [velocity]}
"""


def run(folder, charges):
    """A result folder where two points go round, the first one at 5 m/s, with 1 m/s up."""
    t = np.linspace(2, 3, 101)
    columns = {"time [s]": t}
    for name, speed in (("near", 5.0), ("above", 2.0), ("all", 50.0)):
        turn = 7 * t
        parts = {"x": speed * np.sin(turn), "y": speed * np.cos(turn), "z": 0 * t + 1}
        columns |= {f"{name}.velocity_{axis} [m/s]": values for axis, values in parts.items()}
    rows = np.column_stack(list(columns.values())).tolist()
    early = [[0.1, *[1e3] * (len(columns) - 1)]]
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in early + rows)]
    (folder / "histories.csv").write_text("\n".join(lines) + "\n")
    stages = [{"name": "blow", "mode": "dynamic", "begin": 2.0, "time": 1.0}]
    (folder / "summary.json").write_text(json.dumps({"stages": stages, "charges": charges}))
    (folder / "case.yaml").write_text(HISTORIES)
    return measure(folder, to=None, yields=[], stage=None)


def test_the_nearest_charge_of_the_stage_counts(tmp_path):
    """Length of the velocity; R / sqrt(Q) where the explosive is known."""
    found = run(tmp_path, CHARGES)
    above, near = found.peaks
    assert (above.name, above.hole, near.name, near.hole) == ("above", "hole2", "near", "hole1")
    assert above.values() == pytest.approx([np.hypot(1, 0.5), np.hypot(2, 1)], rel=1e-6)
    assert near.values() == pytest.approx([3, np.hypot(5, 1), 16, 0.75], rel=1e-6)
    (path,) = (path for path in found.write(tmp_path) if path.name == "ppv.csv")
    head, *rows = path.read_text().splitlines()
    assert head == (
        "history,nearest charge,distance [m],PPV [m/s],charge [kg],R/sqrt(Q) [m/kg^0.5]"
    )
    assert [row.split(",")[:2] for row in rows] == [["above", "hole2"], ["near", "hole1"]]
    assert rows[0].endswith(",,") and rows[1].endswith(",16,0.75")
    lines = found.lines()
    assert lines[-3].split("  ")[-1] == "nearest charge" and "R/sqrt(Q)" in lines[-3]
    assert lines[-1].split() == ["near", "3", "5.099", "16", "0.75", "hole1"]
    assert lines[-2].split() == ["above", "1.118", "2.236", "hole2"]


def test_without_explosives_there_are_distance_and_velocity_alone(tmp_path):
    found = run(tmp_path, [one | {"mass": None} for one in CHARGES])
    (path,) = (path for path in found.write(tmp_path) if path.name == "ppv.csv")
    assert path.read_text().splitlines()[0] == "history,nearest charge,distance [m],PPV [m/s]"
    assert "kg" not in found.lines()[-3]


def test_a_run_without_blasts_in_the_stage_has_no_such_table(tmp_path):
    found = run(tmp_path, CHARGES[2:])
    assert found.peaks == []
    assert "ppv.csv" not in {path.name for path in found.write(tmp_path)}


def test_the_distance_is_that_from_the_whole_length_of_a_charge():
    charge = {"ends": [[0, 0, 0], [0, 0, 4]]}
    for point, exact in (([3, 4, 2], 5), ([0, 3, 8], 5), ([0, 3, -4], 5), ([0, 0, 1], 0)):
        assert distance(point, charge) == pytest.approx(exact)
