"""Tables and rasters of monitored displacements."""

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.fit.monitored import read_monitored


@pytest.fixture
def table(tmp_path):
    def table(text: str, name: str = "prisms.csv"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return table


def test_components_units_and_deviations(table):
    path = table(
        "Point;Easting;Northing;Height;dE [mm];dN [mm];dU [cm];sU [mm]\nA;1,5;2;3;4;-5;0,6;2\n"
    )
    found = read_monitored(path)
    assert found.names == ["A"] and found.at.tolist() == [[1.5, 2, 3]]
    assert found.moved[0, :3] == pytest.approx([0.004, -0.005, 0.006])
    assert np.isnan(found.moved[0, 3]) and np.isnan(found.time[0])


def test_a_gap_is_not_a_zero(table):
    found = read_monitored(table("x,y,dx,dz\n1,2,,0.5\n3,4,0.25,nan\n"))
    assert np.isnan(found.moved[0, 0]) and found.moved[0, 2] == 0.5
    assert found.moved[1, 0] == 0.25 and np.isnan(found.moved[1, 2])
    assert np.isnan(found.at[:, 2]).all()


@pytest.mark.parametrize(("unit", "seconds"), [("[h]", 7200), ("(d)", 172800), ("[s]", 2), ("", 2)])
def test_times_have_the_unit_of_their_heading(table, unit, seconds):
    found = read_monitored(table(f"Punkt;x;y;dz [mm];Zeit {unit}\nA;1;2;-3,5;2\n"))
    assert found.time.tolist() == [seconds] and found.names == ["A"]


def test_dates_give_times_from_the_start(table):
    path = table("point,x,y,date,dz\nA,0,0,2024-03-02,0.1\nA,0,0,2024-03-03,0.2\n")
    found = read_monitored(path, start="2024-03-01T12:00")
    assert found.time.tolist() == [43200, 129600]


def test_dates_without_a_start_give_the_change_of_each_point(table):
    text = "point,x,y,date,dz,sz\nA,0,0,2024-03-03,0.5,3\nB,1,0,2024-03-01,0.7,1\nA,0,0,2024-03-01,0.1,4\n"
    found = read_monitored(table(text))
    assert found.names == ["A", "B"] and np.isnan(found.time).all()
    assert found.moved[:, 2] == pytest.approx([0.4, 0.7])
    assert found.deviation[:, 2] == pytest.approx([5, 1])
    assert "first to the last date" in found.notes[-1]


def test_a_raster_in_millimetres(table):
    text = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n"
    text += "-9999 -9999\n12 -9999\n"
    found = read_monitored(table(text, "los.asc"), unit="mm")
    assert found.at[:, :2].tolist() == [[5, 5]] and found.moved[0, 3] == pytest.approx(0.012)


@pytest.mark.parametrize(
    "text, options, message",
    [
        ("y,dx\n1,2\n", {}, "has no column x"),
        ("x,y,speed\n1,2,3\n", {}, "has no displacements; name their columns dx, dy, dz, or los"),
        ("x,y,dx\n1,2,far\n", {}, "prisms.csv:2: dx must be a number, got 'far'"),
        ("x,y,dx\nhere,2,3\n", {}, "x must be a number, got 'here'"),
        ("x,y,dx,sx\n1,2,3,0\n", {}, "sx must be above 0"),
        ("x,y,dx,date\n1,2,3,03.04.2024\n", {}, "'03.04.2024' is no date; write 2024-03-31"),
        ("x,y,dx,date\n1,2,3,2024-04-03\n", {"start": "soon"}, "--start: 'soon' is no date"),
        ("x,y,dx,time\n1,2,3,4\n", {"start": "2024-04-03"}, "has times, not dates"),
        ("x,y,dx\n1,2,3\n", {"start": "2024-04-03"}, "has no column date"),
        ("x,y,dx\n1,2,3\n", {"unit": "mm"}, "leave --unit out"),
        ("x,y,dx,de\n1,2,3,4\n", {}, "more than one column may be the dx"),
        ("x,y,dx\n", {}, "needs a line of names and rows of numbers"),
        ("x,y,dx\n1,2\n", {}, "has 2 values, but the first line names 3"),
        ("x,y,dx,time\n1,2,3,x\n", {}, "time must be a number"),
    ],
)
def test_a_wrong_table_is_one_clear_error(table, text, options, message):
    with pytest.raises(CaseError, match=message):
        read_monitored(table(text), **options)
