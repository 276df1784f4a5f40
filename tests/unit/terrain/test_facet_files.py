"""Triangulated surfaces from files: the same triangles from every format, and refusals in one line."""

import numpy as np
import pytest
from shared.facets import KINDS, dxf_text, gocad_text, obj_text, sheet, write

from cdem.errors import CaseError
from cdem.terrain.facet_files import read_facets

POINTS, TRIANGLES = sheet(
    lambda x, y: 100 + x / 8 - y / 4, np.arange(0, 40, 8), np.arange(0, 32, 8)
)
CORNERS = POINTS[TRIANGLES]


@pytest.mark.parametrize("kind", KINDS)
def test_every_format_gives_the_same_triangles(tmp_path, kind):
    found = read_facets(write(tmp_path / f"a surface.{kind}", POINTS, TRIANGLES))
    assert np.array_equal(found.points[found.triangles], CORNERS)
    assert found.notes == [] and found.unit == ""


def test_what_is_not_used_is_told(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(
        "mtllib ../secret.mtl\nusemtl a\nvt 0 0\ncurv 1\n" + obj_text(POINTS, TRIANGLES)
    )
    found = read_facets(path)
    assert found.notes == [
        "a.obj: the file of its materials (mtllib) is not opened",
        "a.obj: only its faces are used; 1 of 'curv' ignored",
    ]


def test_obj_counts_from_the_end_and_polygons_are_fanned(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nf -4/1/1 -3 -2 -1\n")
    found = read_facets(path)
    assert found.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_stl_on_a_map_is_told_to_be_rounded(tmp_path):
    path = write(tmp_path / "a.bin.stl", POINTS + [5e5, 5e6, 0], TRIANGLES)
    found = read_facets(path)
    assert 0.25 <= found.rounding < 0.5
    assert "STL keeps seven digits" in found.notes[0]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.tin", "x", r"a surface of triangles is read from \.obj, \.stl, \.ply, \.ts or \.dxf"),
        ("a.ts", "", r"is empty"),
        ("a.obj", "v 0 0 0\nv 1 0 0\n", r"contains no faces"),
        ("a.obj", "v 0 0 zero\n", r"a\.obj:1: cannot be read: v 0 0 zero"),
        ("a.obj", "v 0 0 0\nf 1 2 3\n", r"a\.obj:2: a face needs three or more vertices"),
        ("a.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", r"1 of its corners .* not finite"),
        ("a.obj", "v 0 0 1e300\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", r"not finite, or beyond 1e\+09"),
        ("a.stl", "solid a\nfacet normal 0 0 1\n", r"contains no triangles"),
        ("a.ply", "ply\nformat ascii 1.0\nend_header\n", r"a\.ply: "),
        ("a.stl", "\0\1\2", r"is no complete STL"),
    ],
)
def test_files_that_are_refused(tmp_path, name, text, message):
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(CaseError, match=message) as caught:
        read_facets(path)
    assert "\n" not in str(caught.value)


def test_a_missing_file_a_folder_and_a_layer_of_no_dxf(tmp_path):
    (tmp_path / "b.ts").mkdir()
    for name in ("a.obj", "b.ts"):
        with pytest.raises(CaseError, match="no such file"):
            read_facets(tmp_path / name)
    with pytest.raises(CaseError, match=r"layer goes with \.dxf"):
        read_facets(write(tmp_path / "a.obj", POINTS, TRIANGLES), "TOP")


# ------------------------------------------------------------------ GOCAD


SYSTEM = (
    'GOCAD_ORIGINAL_COORDINATE_SYSTEM\nNAME Default\n{}AXIS_NAME "X" "Y" "Z"\n'
    "AXIS_UNIT {}\nZPOSITIVE {}\nEND_ORIGINAL_COORDINATE_SYSTEM"
)


def test_gocad_with_properties_atoms_and_two_parts(tmp_path):
    path = tmp_path / "a.ts"
    path.write_text(
        "GOCAD TSurf 1\nHEADER {\nname:top\n*visible:true\n}\nPROPERTIES age\nESIZES 1\n"
        "PROPERTY_CLASS_HEADER Z {\nis_z:on\n}\n"
        "TFACE\nPVRTX 1 0 0 5 77 CNXYZ\nVRTX 2 10 0 5\nVRTX 3 0 10 6\nTRGL 1 2 3\n"
        "TFACE\nATOM 4 2\nPATOM 5 3 77\nVRTX 6 10 10 6\nTRGL 4 6 5\nBSTONE 1\nBORDER 7 1 2\nODD 1\nEND\n"
    )
    found = read_facets(path)
    assert found.points[found.triangles].tolist() == [
        [[0, 0, 5], [10, 0, 5], [0, 10, 6]],
        [[10, 0, 5], [10, 10, 6], [0, 10, 6]],
    ]
    assert found.notes == [
        "a.ts: properties of its vertices are not used",
        "a.ts: only its faces are used; 1 of 'ODD' ignored",
    ]


def test_gocad_depths_and_feet_are_told_and_turned(tmp_path):
    path = tmp_path / "a.ts"
    system = SYSTEM.format("PROJECTION UTM32\n", '"ft" "ft" "m"', "Depth")
    found = read_facets(write(path, POINTS, TRIANGLES, system=system))
    assert np.abs(found.points[found.triangles] - CORNERS * [0.3048, 0.3048, -1]).max() < 1e-12
    assert [note.partition(": ")[2] for note in found.notes] == [
        "its x and y are in ft and ft, and are multiplied by 0.3048 and 0.3048",
        "its z is a depth (ZPOSITIVE Depth); heights are -z",
        "'PROJECTION UTM32' is not used; give crs beside the file",
    ]
    found = read_facets(
        write(path, POINTS, TRIANGLES, system=SYSTEM.format("", '"m" "m" "ft"', "Elevation"))
    )
    assert found.unit == "ft" and np.array_equal(found.points[found.triangles], CORNERS)


def test_several_surfaces_of_one_gocad_file_are_one(tmp_path):
    path = tmp_path / "a.ts"
    second = POINTS + [32, 0, 4]
    path.write_text(gocad_text(POINTS, TRIANGLES) + gocad_text(second, TRIANGLES))
    found = read_facets(path)
    assert np.array_equal(
        found.points[found.triangles], np.concatenate([CORNERS, second[TRIANGLES]])
    )
    assert found.notes == ["a.ts: its 2 surfaces are taken as one"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("solid a\n", r"is no GOCAD file"),
        ("GOCAD PLine 1\nEND\n", r"is a GOCAD PLine; a surface of triangles is a TSurf"),
        ("GOCAD TSurf 1\nTFACE\nVRTX 1 0 0\n", r"a\.ts:3: cannot be read: VRTX 1 0 0"),
        ("GOCAD TSurf 1\nTFACE\nVRTX 1 0 0 0\nTRGL 1 2 3\n", r"a\.ts:4: names vertex 2"),
        ("GOCAD TSurf 1\nTFACE\nEND\n", r"contains no triangles"),
        ("GOCAD TSurf 1\nZPOSITIVE Sideways\n", r"a\.ts:2: cannot be read: ZPOSITIVE Sideways"),
        (
            gocad_text(POINTS, TRIANGLES, system=SYSTEM.format("", '"m" "m" "ms"', "Depth")),
            r"an axis is in 'ms', which is no length known here: m, ft, us-ft, cm, dm, km",
        ),
    ],
)
def test_gocad_files_that_are_refused(tmp_path, text, message):
    (tmp_path / "a.ts").write_text(text)
    with pytest.raises(CaseError, match=message):
        read_facets(tmp_path / "a.ts")


# ------------------------------------------------------------------ DXF


def groups(*pairs):
    return [str(part) for pair in pairs for part in pair]


def test_dxf_layers_are_chosen(tmp_path):
    path = tmp_path / "a.dxf"
    other = (
        dxf_text(POINTS + [0, 0, 50], TRIANGLES, "UP").split("ENTITIES\n")[1].split("0\nENDSEC")[0]
    )
    line = groups((0, "LINE"), (8, "UP"), (10, 0), (20, 0), (11, 1), (21, 1))
    path.write_text(dxf_text(POINTS, TRIANGLES, "DOWN", [*other.split("\n")[:-1], *line]))
    with pytest.raises(CaseError, match=r"choose one with 'layer': DOWN \(24\), UP \(24\)"):
        read_facets(path)
    with pytest.raises(CaseError, match=r"has no faces on layer 'TOP'; there are faces on: DOWN"):
        read_facets(path, "TOP")
    found = read_facets(path, "UP")
    assert np.array_equal(found.points[found.triangles], CORNERS + [0, 0, 50])
    assert found.notes == ["a.dxf: only its faces are used; 1 of 'LINE' ignored"]


def test_dxf_quadrilaterals_and_meshes_of_polylines(tmp_path):
    """A face of four corners, a polyface mesh, and a mesh of 2 by 3 points: 2 + 2 + 4 triangles."""
    square = [(0, 0), (9, 0), (9, 9), (0, 9)]
    face = groups((0, "3DFACE"), (8, "A"))
    for corner, (x, y) in enumerate(square):
        face += groups((10 + corner, x), (20 + corner, y), (30 + corner, 1))

    def vertices(points, flag):
        return [
            word
            for x, y in points
            for word in groups((0, "VERTEX"), (8, "A"), (10, x), (20, y), (30, 1), (70, flag))
        ]

    polyface = groups((0, "POLYLINE"), (8, "A"), (66, 1), (70, 64), (71, 4), (72, 1))
    polyface += vertices([(x + 9, y) for x, y in square], 192)
    polyface += groups((0, "VERTEX"), (8, "A"), (70, 128), (71, 1), (72, -2), (73, 3), (74, 4))
    polyface += groups((0, "SEQEND"))
    mesh = groups((0, "POLYLINE"), (8, "A"), (66, 1), (70, 16), (71, 2), (72, 3))
    mesh += vertices([(x, y) for x in (18, 27) for y in (0, 4, 9)], 64)
    path = tmp_path / "a.dxf"
    path.write_text(
        dxf_text(POINTS[:0], [], more=[*face, *polyface, *mesh, *groups((0, "SEQEND"))])
    )
    found = read_facets(path)
    assert len(found.triangles) == 8 and found.notes == []
    corners = found.points[found.triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2
    assert abs(area).sum() == pytest.approx(9 * 27)


def test_dxf_units_of_insertion_are_told(tmp_path):
    path = tmp_path / "a.dxf"
    head = groups((0, "SECTION"), (2, "HEADER"), (9, "$INSUNITS"), (70, 2), (0, "ENDSEC"))
    path.write_text("\n".join(head) + "\n" + dxf_text(POINTS, TRIANGLES))
    assert read_facets(path).notes == [
        "a.dxf: its $INSUNITS 2 (not metres) is not used: x and y are taken as metres"
    ]


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (b"AutoCAD Binary DXF\r\n\x1a\0", r"is a binary DXF; save it as ASCII DXF"),
        (b"v 0 0 0\nv 1 0 0\n", r"a\.dxf:1: is no DXF: a group code is a whole number"),
        (dxf_text(POINTS[:0], [], more=["0", "3DSOLID", "8", "A"]).encode(), r"has no faces .* 1 of 3DSOLID"),
        (dxf_text(POINTS, TRIANGLES).encode()[:400], r"a\.dxf: "),
        (
            dxf_text(POINTS[:0], [], more=groups(
                (0, "POLYLINE"), (70, 64), (0, "VERTEX"), (70, 128), (71, 1), (72, 2), (73, 3)
            )).encode(),
            r"names vertices that it does not have",
        ),
    ],
)  # fmt: skip
def test_dxf_files_that_are_refused(tmp_path, raw, message):
    (tmp_path / "a.dxf").write_bytes(raw)
    with pytest.raises(CaseError, match=message) as caught:
        read_facets(tmp_path / "a.dxf")
    assert "\n" not in str(caught.value)
