"""Records in files: what they hold, and what is said of files that are none."""

import numpy as np
import pytest
from shared.signals import at2, synthetic

from cdem.errors import CaseError
from cdem.seismic.files import of_array, read_at2, read_columns

HEAD = "NAME\nPLACE\nACCELERATION TIME SERIES IN UNITS OF G\n"
TEN = "1 2 3 4 5\n6 7 8 9 -.1E+02\n"


def test_a_peer_file_gives_its_samples_step_and_unit():
    """The formula's samples come back to the digits that the file has."""
    _, a = synthetic()
    series = read_at2(at2(a, 0.005), "f.at2")
    assert series.step == 0.005 and series.unit == "g"
    np.testing.assert_allclose(series.samples * 9.81, a, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize(
    ("size", "step"),
    [("NPTS=  10, DT=   .0050 SEC", 0.005), ("   10   0.0100    NPTS, DT", 0.01),
     ("NPTS= 10, DT= 2.5E-3 SEC,", 0.0025)],
)  # fmt: skip
def test_both_kinds_of_the_line_of_sizes_are_read(size, step):
    """Newer and older files of PEER write it differently."""
    series = read_at2(f"{HEAD}{size}\n{TEN}", "f")
    assert series.step == step and series.samples.tolist() == [*range(1, 10), -10]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (TEN, "f: no line with NPTS and DT"),
        (f"{HEAD}NPTS= 11, DT= .01 SEC\n{TEN}", "f:4: NPTS is 11, but 10 numbers follow"),
        (f"{HEAD}NPTS= 10, DT= .01 SEC\n1 2 x\n", "f:5: '1 2 x' is not a row of numbers"),
        (f"{HEAD}NPTS= ten, DT= .01 SEC\n{TEN}", "f:4: 'NPTS= ten, DT= .01 SEC' has no NPTS= and"),
        (f"{HEAD}NPTS= 10, DT= 0 SEC\n{TEN}", "the time between samples is 0 s"),
        (f"{HEAD}NPTS= 10, DT= .01 SEC\n{TEN.replace('3', 'nan')}", "sample 3 is nan"),
        (f"{HEAD}NPTS= 10, DT= .01 SEC\n{TEN.replace('3', '3e90')}", "sample 3 is 3e+90"),
        (f"{HEAD}NPTS= 10, DT= .01 SEC\n" + "0 " * 10, "all 10 samples are 0"),
        (f"{HEAD}NPTS= 3, DT= .01 SEC\n1 2 3\n", "has 3 samples; a record has 10 to"),
        (f"{HEAD}NPTS= 1e12, DT= .01 SEC\n{TEN}", "NPTS is 1e12"),
    ],
)
def test_a_wrong_peer_file_is_refused_with_its_line(text, said):
    """One line says where and what."""
    with pytest.raises(CaseError) as caught:
        read_at2(text, "f")
    assert said in str(caught.value) and "\n" not in str(caught.value)


def columns(head, step=0.5, count=12):
    """Text of two columns."""
    return head + "".join(f"{i * step}, {i % 3 - 1}\n" for i in range(count))


@pytest.mark.parametrize(
    ("head", "step", "unit"),
    [("time [s], a [g]\n", 0.5, "g"), ("# from a site\ntime [ms]; v [cm/s]\n", 0.0005, "cm/s"),
     ("", 0.5, None), ("t, a [m/s2]\n", 0.5, "m/s2")],
)  # fmt: skip
def test_two_columns_have_times_and_units_in_their_header(head, step, unit):
    """Without a header the times are in s."""
    series = read_columns(columns(head), "f")
    assert series.step == pytest.approx(step) and series.unit == unit
    assert series.samples[:3].tolist() == [-1, 0, 1] and len(series.samples) == 12


def test_one_column_has_no_times():
    """Its step must come from the case."""
    series = read_columns("a [g]\n" + "1\n" * 10, "f")
    assert series.step is None and series.unit == "g" and len(series.samples) == 10


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "f: has no rows"),
        ("a [g]\n", "f: has 0 samples"),
        (columns("time [s], a [mg]\n"), "unknown unit [mg]; use one of: g, m/s2"),
        (columns("time [d], a [g]\n"), "its times are in [d]; use one of: s"),
        ("1, 2, 3\n" * 12, "f:1: has 3 columns, none with a name; a record has one"),
        (columns("") + "9\n", "f:13: has 1 numbers, not 2"),
        (columns("") + "7, 1\n", "its times are not evenly spaced (row"),
        ("1, 1\n" * 12, "its times are not evenly spaced"),
        ("0.1, nan\n" * 12, "its times are not evenly spaced"),
        (columns("").replace("3.0", "inf"), "not evenly spaced (row"),
    ],
)
def test_wrong_columns_are_refused_with_their_line(text, said):
    """One line says where and what."""
    with pytest.raises(CaseError) as caught:
        read_columns(text, "f")
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_an_array_is_a_row_of_numbers_or_two_columns():
    """Other shapes and types are refused."""
    row = np.arange(1, 13, dtype=np.float32)
    assert of_array(row, "f").step is None
    series = of_array(np.column_stack([row / 4, row]), "f")
    assert series.step == 0.25 and series.samples[-1] == 12
    for wrong in (np.zeros((12, 3)), np.zeros((2, 2, 3)), np.array(["a"] * 12), np.array(1.0)):
        with pytest.raises(CaseError, match=r"^f: "):
            of_array(wrong, "f")
