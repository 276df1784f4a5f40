"""Clusters of DSE and facets of CloudCompare as joints."""

import pytest

from cdem.errors import CaseError
from cdem.joints.directions import pole
from cdem.joints.measured import read_measured

HEAD = (
    "Index; CenterX; CenterY; CenterZ; GlobalCenterX; GlobalCenterY; GlobalCenterZ; NormalX; "
    "NormalY; NormalZ; RMS; Horiz_ext; Vert_ext; Surf_ext; Surface; Dip dir.; Dip; Family ind.; "
    "Subfamily ind.; \n"
)
"""As CloudCompare's plug-in qFacets writes it."""


def facet(number, dip, direction, family):
    normal = ";".join(f"{v:.6f}" for v in pole(dip, direction))
    return (
        f"{number};1;2;3;500001;5000002;3;{normal};0.01;2;1;2;1.5;{int(direction)};{int(dip)};"
        f"{family};0;\n"
    )


def read(tmp_path, text):
    path = tmp_path / "facets.csv"
    path.write_text(text)
    return read_measured(path)


def test_facets_of_cloudcompare(tmp_path):
    found = read(tmp_path, HEAD + facet(1, 30.6, 90.7, 1) + facet(2, 80.4, 10.2, 0))
    assert found.dip == pytest.approx([30.6, 80.4], abs=1e-3)  # whole degrees beside the normals
    assert found.dip_direction == pytest.approx([90.7, 10.2], abs=1e-3)
    assert found.set_of == ["family1", ""]
    assert "planes by their normals" in found.notes[0] and "CenterX" in found.notes[1]


def test_facets_without_families_have_no_sets(tmp_path):
    found = read(tmp_path, HEAD + facet(1, 30.6, 90.7, 0) + facet(2, 80.4, 10.2, 0))
    assert found.set_of is None


def cluster(points, number, cluster, normal, mark="\t"):
    a, b, c = normal
    row = mark.join(["{}"] * 9) + "\n"
    return "".join(row.format(k, 2, 3.5, number, cluster, a, b, c, -1.5) for k in range(points))


@pytest.mark.parametrize("mark", ["\t", " ", ","])
def test_clusters_of_dse(tmp_path, mark):
    text = "".join(
        cluster(9, *row, mark)
        for row in ((1, 1, pole(30, 90)), (1, 2, pole(32, 90)), (2, 1, pole(80, 350)))
    )
    found = read(tmp_path, text + cluster(3, 0, 0, (0, 0, 1), mark))  # 0: of no set
    assert found.dip == pytest.approx([30, 32, 80]) and found.set_of == ["set1", "set1", "set2"]
    assert found.notes == ["30 points of 3 clusters, each a joint: x y z set cluster A B C D"]


def test_clusters_with_the_plane_of_their_set(tmp_path):
    text = cluster(9, 1, 1, pole(30, 90)) + cluster(9, 1, 2, pole(30, 90))
    assert "their scatter is unknown" in read(tmp_path, text).notes[1]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (cluster(2, 1, 1, (0, 0, 1)) + cluster(1, 1, 2, (0, 0, 5)), "row 3: A, B, C are no unit"),
        (cluster(2, 0, 0, (0, 0, 1)), "has no cluster with a set"),
        (cluster(2, 1, 1, (0, 0, 1)) + "a b\n", "cannot be read"),
        ("x,y,z\n1,2,3\n", "for a point cloud use --extract"),
        ("1 2 3 40\n4 5 6 70\n", "for a point cloud use --extract"),
        (HEAD + facet(1, 30, 90, 1).replace(";30;1;", ";steep;1;"), "Dip must be a number"),
    ],
)
def test_what_is_refused(tmp_path, text, words):
    with pytest.raises(CaseError) as told:
        read(tmp_path, text)
    assert words in str(told.value) and "facets.csv" in str(told.value)
