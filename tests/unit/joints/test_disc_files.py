"""Files of discs: one disc in all that is read gives that disc; the rest is refused in one line."""

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.joints.directions import pole
from cdem.joints.discs import read_discs

CORNERS = 64


def polygon():
    """A regular polygon of the disc's plane, centre and area."""
    normal = pole(40, 121)
    across = np.linalg.svd(normal[None])[2][1:]
    turn = 2 * np.pi * np.arange(CORNERS) / CORNERS
    r = 1.34 * np.sqrt(2 * np.pi / CORNERS / np.sin(2 * np.pi / CORNERS))
    x = np.array([3.5, -2, 7]) + r * np.stack([np.cos(turn), np.sin(turn)], -1) @ across
    return f"{CORNERS} " + " ".join("{%.9f, %.9f, %.9f}" % tuple(row) for row in x)  # noqa: UP031


@pytest.mark.parametrize(
    "name, text",
    [
        ("a.csv", "X,Y,Z,Dip,DipDir,R\n3.5,-2,7,40,121,1.34\n"),
        ("a.csv", "x;y;z;dip;dip_direction;radius\n3,5;-2,0;7;40,0;121,0;1,34\n"),
        ("a.csv", "x,y,z,nx,ny,nz,radius\n3.5,-2,7,0.550975,-0.331060,0.766044,1.34\n"),
        ("a.csv", "x,y,z,trend,plunge,diameter\n3.5,-2,7,301,50,2.68\n"),
        ("a.csv", "x,y,z,strike,dip,quadrant,r\n3.5,-2,7,31,40,SE,1.34\n"),
        ("a.txt", "x [cm] y [m] z dip dd r [mm]\n350 -2 7 40 121 1340\n".replace(" [", "[")),
        ("a.dat", f"nPolygons: 1\n{polygon()}\n"),
    ],
)
def test_one_disc_in_all_that_is_read(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    disc = read_discs(tmp_path / name)[0]
    assert disc.center == pytest.approx([3.5, -2, 7], abs=1e-6)
    assert disc.radius == pytest.approx(1.34, rel=1e-6)
    assert disc.normal == pytest.approx(pole(40, 121), abs=1e-5)


@pytest.mark.parametrize(
    "name, text, told",
    [
        ("a.csv", "a;b\n1;2\n", "columns x, y, z, dip, dip_direction, radius .*it says: a, b"),
        ("a.csv", "x,y,z,nx,ny,nz\n1,1,1,0,0,1\n", "the radius a diameter; it says: x, y, z"),
        (
            "a.dat",
            "nPolygons: 2\n3 {0,0,0} {1,0,0} {0,1,0}\n",
            "1 polygons, but its first line says 2",
        ),
        ("a.dat", "nPolygons: 1\n4 {0,0,0} {1,0,0} {0,1,0}\n", ":2: a polygon is a row"),
    ],
)
def test_the_rest_is_refused_in_one_line(tmp_path, name, text, told):
    (tmp_path / name).write_text(text)
    with pytest.raises(CaseError, match=told) as error:
        read_discs(tmp_path / name)
    assert "\n" not in str(error.value)


def test_columns_not_used_are_said(tmp_path):
    (tmp_path / "a.csv").write_text("x,y,z,dip,dd,r,aperture\n1,1,1,40,121,1,2e-4\n")
    notes = []
    read_discs(tmp_path / "a.csv", notes)
    assert notes == ["a.csv: columns not used: aperture"]
