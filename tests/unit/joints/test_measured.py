"""Tables of joints: names of columns, strike, scanlines, and what is refused."""

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.joints.measured import read_measured


def read(tmp_path, text, **more):
    path = tmp_path / "joints.csv"
    path.write_text(text)
    return read_measured(path, **more)


@pytest.mark.parametrize(
    "text",
    [
        "dip,dip_direction\n30,90\n80,350\n",
        "Dip direction [deg];Dip [deg]\n90,0;30,0\n350,0;80,0\n",
        "# azimut\tAngle\n90\t30\n350\t80\n",
        "  id dip  dipdir\n\n 1 30 90\n 2 80 350\n",
    ],
)
def test_columns_by_their_common_names(tmp_path, text):
    found = read(tmp_path, text)
    assert found.dip.tolist() == [30, 80] and found.dip_direction.tolist() == [90, 350]
    assert found.normals[0] == pytest.approx([0.5, 0, np.sqrt(0.75)])
    assert (found.set_of, found.lines, found.notes) == (None, None, [])


def test_strike_is_by_the_right_hand_rule_and_says_so(tmp_path):
    found = read(tmp_path, "strike,dip\n0,30\n300,20\n")
    assert found.dip_direction.tolist() == [90, 30]
    assert found.notes == ["strike is taken by the right-hand rule: dip direction = strike + 90"]


def test_sets_and_scanlines(tmp_path):
    text = "dip,dd,set,hole,trend,plunge,depth\n30,90,a,B1,0,90,1\n31,91,,B2,90,0,2\n"
    found = read(tmp_path, text)
    assert found.set_of == ["a", ""] and found.scanline == ["B1", "B2"]
    assert np.allclose(found.lines, [[0, 0, -1], [1, 0, 0]]) and found.position.tolist() == [1, 2]
    found = read(tmp_path, "dip,dd,position\n30,90,1\n31,91,2\n", scanline=(180, 30))
    assert np.allclose(found.lines, [[0, -np.sqrt(0.75), -0.5]] * 2)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("dip,azi\n30,90\n95,10\n", "joints.csv:3: dip must be a number from 0 to 90, got '95'"),
        ("dip,azi\n30,90\n\n4,x\n", "joints.csv:4: azi must be a number from 0 to 360, got 'x'"),
        ("dip,azi\n30\n", "joints.csv:2: has 1 values, but the first line names 2 columns"),
        ("a,b\n30,90\n", "must name the columns dip and dip_direction"),
        ("dip,azi\n", "a line of names and rows of numbers"),
        ("dip,slopeangle\n90,30\n", "dip is an azimuth"),
        ("dip,angle,azi\n30,30,90\n", "more than one column may be the dip: dip, angle"),
        ("dip,azi,trend\n30,90,1\n", "both columns, trend and plunge"),
    ],
)
def test_what_is_refused(tmp_path, text, what):
    with pytest.raises(CaseError) as error:
        read(tmp_path, text)
    assert what in str(error.value)


def test_two_sources_of_scanlines_are_refused(tmp_path):
    with pytest.raises(CaseError, match="leave out the scanline"):
        read(tmp_path, "dip,azi,trend,plunge\n30,90,0,90\n", scanline=(0, 90))


@pytest.mark.parametrize("word", ["9" * 400, "N" + "9" * 400 + "E", "9 " * 200 + "/"])
def test_a_word_without_end_is_refused_at_once(tmp_path, word):
    with pytest.raises(CaseError, match=r"must be|contains|many things"):
        read(tmp_path, f"dip,dip_direction\n30,90\n{word},80\n")
    with pytest.raises(CaseError):
        read(tmp_path, f"attitude\n120/40\n{word}\n")
    with pytest.raises(CaseError, match="is no table of joints"):
        read(tmp_path, f"dip,dip_direction\n{400 * word},80\n")
