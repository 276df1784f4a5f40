"""Map projections of a case: what may be written, what is refused, and that it travels on."""

import pytest
from shared.cases import INCLINE

from cdem import Case
from cdem.case.map_system import look_up


def test_a_projection_travels_with_the_case(write):
    pyproj = pytest.importorskip("pyproj", reason="needs the extra 'terrain'")
    case = Case.load(write("crs: epsg:32632\n" + INCLINE))
    assert case.crs == "EPSG:32632"
    assert Case.load(write(case.dump())).crs == "EPSG:32632"
    lines = pyproj.CRS(31254).to_wkt(pretty=True)
    assert "\n" in lines
    case = Case.load(write("crs: |\n" + lines.replace("\n", "\n  ").join(["  ", "\n"]) + INCLINE))
    assert look_up(case.crs) == pyproj.CRS(31254)
    assert "crs" not in Case.load(write(INCLINE)).dump()


@pytest.mark.parametrize(
    ("crs", "message"),
    [
        ("UTM 32", "slope.yaml:1:1: crs: must be a code such as EPSG:32632, or WKT, got 'UTM 32'"),
        ("EPSG:99999", "crs: no projection 'EPSG:99999'"),
        ("EPSG:4326", "crs: 'WGS 84' is not a map projection: its coordinates are not metres"),
        ("EPSG:2263", "is in US survey foot, not in metres"),
        ("EPSG:3857", "(Web Mercator) stretches lengths"),
    ],
)
def test_what_is_no_projection_in_metres_is_refused(complaint, crs, message):
    pytest.importorskip("pyproj", reason="needs the extra 'terrain'")
    first = INCLINE.splitlines()[0]
    assert message in complaint(first, f"crs: {crs}\n{first}")
