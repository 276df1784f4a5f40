"""Tables of planes: every convention of one plane, 40/121, gives that plane; what is in doubt is refused."""

import pytest

from cdem.errors import CaseError
from cdem.joints.measured import read_measured

SAME = [
    "strike,dip,dip_quadrant\n31,40,SE\n",
    "strike,dip,dip_quadrant\n211,40,SE\n",
    "strike,dip\nN31E,40SE\n",
    "strike,dip\nS31W,40 SE\n",
    "strike,dip\n211,40 SE\n",
    "strike (LHR),dip\n211,40\n",
    "strike (right-hand rule),dip\n31,40\n",
    "Azimuth;Dip;Dip_Direction\n31;40;SE\n",
    "dip,dip_direction\n40°,121°\n",
    "dip,dip_direction,\n40,481,\n",
    "dip;dip_direction\n40,0;-239,0\n",
    "# survey of bench 3\n# declination: 0\ndip,dip_direction\n40,121\n# end\n",
    "# dip dip_direction\n40 121\n",
    "40,121\n",
    "121/40\n",
    "N31E 40SE\n",
    "attitude\nN31E/40SE\n",
    "dip_direction/dip\n121/40\n",
    "pole_trend,pole_plunge\n301,50\n",
    "trend,plunge\n301,50\n",
    "nx,ny,nz\n0.550975,-0.331060,0.766044\n",
    "Dip [gon],Dip direction [gon]\n44.444444,134.444444\n",
    "Streichen;Einfallen;Fallrichtung\n31;40;SO\n",
    "Einfallen [°];Einfallrichtung [°]\n40;121\n",
    "Pendage;Azimut du pendage\n40;121\n",
    "Pendage;Direction;Sens de pendage\n40;31;SE\n",
    "Immersione,Inclinazione\n121,40\n",
    "Buzamiento,Dirección de buzamiento\n40,121\n",
    "Rumbo;Buzamiento\nN31E;40 SE\n",
    "倾向，倾角\n121，40\n",
    "走向,倾角,倾向\n31,40,SE\n",
    "产状\n121°∠40°\n",
]


def read(tmp_path, text):
    path = tmp_path / "joints.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_measured(path)


@pytest.mark.parametrize("text", SAME)
def test_one_plane_in_all_conventions(tmp_path, text):
    found = read(tmp_path, text)
    assert found.dip == pytest.approx([40], abs=1e-4)
    assert found.dip_direction == pytest.approx([121], abs=1e-4)


@pytest.mark.parametrize(
    "text, encoding, said",
    [
        ("Fallwinkel;Fallrichtung;Kluftfläche\n40°;121°;ü\n", "cp1252", "read as Latin-1"),
        ("倾向,倾角\n121,40\n", "gb18030", "read as GB18030"),
        ("dip,dipdir\n40°,121°\n", "utf-16", ""),
    ],
)
def test_encodings(tmp_path, text, encoding, said):
    found = read(tmp_path, text.encode(encoding))
    assert (found.dip, found.dip_direction) == ([40], [121])
    assert found.notes[0].startswith(said) if said else not found.notes


@pytest.mark.parametrize(
    "text, note",
    [
        ("dip,dd,roughness,remark\n40,121,JRC 8,wet\n", "columns not used: roughness, remark"),
        ("dip,dd,strike\n40,121,31\n", "columns not used: strike"),
        ("dip (true),dd\n40,121\n", "not used: '(true)' in the heading of 'dip (true)'"),
        ("strike LHR,dip\n211,40\n", "left-hand rule: dip direction = strike - 90"),
        ("40,121\n", "no line of names: column 1 is dip, column 2 is dip direction"),
        ("trend,plunge\n301,50\n", "describe poles"),
        ("dip,dd\n40,481\n", "dd: 1 outside 0 to 360, corrected by full turns"),
    ],
)
def test_what_is_assumed_or_not_used_is_said(tmp_path, text, note):
    assert any(note in line for line in read(tmp_path, text).notes)


@pytest.mark.parametrize(
    "text, what",
    [
        ("strike,dip,dip_quadrant\n31,40,NE\n", ":2: strike '31' and the side 'NE' contradict"),
        ("strike,dip,dip_quadrant\n31,40,SE\n31,40,\n", ":3: gives no side of the dip"),
        ("strike,dip\nN31E,40\n", "beside a dip with its side, as 40SE, got 'N31E'"),
        ("dip,dip_direction\n40SE,301\n", "'301' and the side 'SE' contradict"),
        ("40,45\n50,60\n", "has no line of names"),
        ("dip [grad],dd\n40,121\n", "has the unit 'grad'; use one of deg"),
        ("pendage;direction\n40;121\n", "may be strike or dip direction"),
        ("dip,dip_direction\n40,SO\n", "O is east or west"),
        ("dip,dip_direction\n40,1000\n", "from 0 to 360, got '1000'"),
        ("nx,ny,nz\n0,0,0\n", ":2: the normal is 0, 0, 0"),
    ],
)
def test_what_is_in_doubt_is_refused(tmp_path, text, what):
    with pytest.raises(CaseError) as error:
        read(tmp_path, text)
    assert what in str(error.value)
