"""Meshes of layers: they conform, hold their volumes, and do not depend on the format of a surface."""

import json
import math

import numpy as np
import pytest
from integration.terrain.test_solid import check_conforming
from shared.facets import KINDS, dxf_text, sheet, write

from cdem.mesh.mesh_files import read_mesh
from cdem.terrain import Landslide, make_mesh, measure, text
from cdem.terrain import write as write_mesh

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")


def plane(dip, dip_direction, x, y, z):
    return {"plane": {"dip": dip, "dip_direction": dip_direction, "through": [x, y, z]}}


def tan(angle):
    return math.tan(math.radians(angle))


def volumes(facts):
    return {name: group["volume"] for name, group in facts["groups"].items()}


@pytest.mark.parametrize("corner", [(0.0, 0.0), (500_123.4, 5_245_678.9)])
def test_layers_between_planes_have_their_volumes(corner):
    """Area times the thickness in the middle: of parallel planes, and of planes that dip apart."""
    x, y = corner
    solid = make_mesh(
        Landslide(
            terrain=plane(10, 90, x, y, 100),
            extent={"x": [x, x + 100], "y": [y, y + 80], "base": -20},
            layers=[
                {"group": "soil", "base": plane(10, 90, x, y, 92)},
                {"group": "weathered", "base": plane(12, 90, x, y, 80)},
                {"group": "shale", "base": plane(5, 180, x, y, 50)},
            ],
            bedrock="granite",
            sizes={"body": 12, "far": 30},
        )
    )
    check_conforming(solid)
    facts = measure(solid)
    middle = [120 - 50 * tan(10), 112 - 50 * tan(10), 100 - 50 * tan(12), 70 + 40 * tan(5)]
    expected = -np.diff([*middle, 0]) * 100 * 80
    found = volumes(facts)
    names = ["soil", "weathered", "shale", "granite"]
    assert [found[name] for name in names] == pytest.approx(expected, rel=1e-9)
    assert facts["layers"]["soil"] == pytest.approx(
        {"least": 8, "mean": 8, "most": 8, "share": 1}, rel=1e-6
    )
    assert facts["layers"]["weathered"]["most"] == pytest.approx(12 + 100 * (tan(12) - tan(10)))
    assert facts["slivers"] == 0 and facts["bed"] is None
    assert {n for n in solid.surfaces if not n.startswith("fix_")} == {
        "ground_soil", "base_soil", "base_weathered", "base_shale"
    }  # fmt: skip
    bottom = solid.points[solid.surfaces["base_shale"]]
    assert bottom[..., 2] == pytest.approx(50 + (bottom[..., 1] - y) * tan(5), abs=1e-6)


@pytest.mark.parametrize(("size", "error"), [(10, 0.01), (5, 0.003)])
def test_a_wedge_ends_where_two_planes_cross(size, error):
    """Thickness (x - 40) tan 20 deg east of x = 40: tan 20 (60^2 / 2) 60."""
    solid = make_mesh(
        Landslide(
            terrain=plane(0, 0, 0, 0, 100),
            extent={"x": [0, 100], "y": [0, 60], "base": 0},
            layers=[
                {"group": "soil", "base": plane(0, 0, 0, 0, 85)},
                {"group": "wedge", "base": plane(20, 90, 40, 0, 85)},
            ],
            sizes={"body": size, "far": 40},
        )
    )
    check_conforming(solid)
    facts = measure(solid)
    found = volumes(facts)
    assert found["wedge"] == pytest.approx(tan(20) * 60**2 / 2 * 60, rel=error)
    assert found["soil"] == pytest.approx(15 * 6000, rel=1e-12)
    assert sum(found.values()) == pytest.approx(100 * 6000, rel=1e-12)
    assert facts["layers"]["wedge"]["share"] == pytest.approx(0.6, abs=size / 100)
    assert facts["layers"]["wedge"]["least"] >= 0.1 * size
    assert facts["slivers"] == 0 and facts["smallest_height"] > 0.03 * size


def test_a_lens_has_its_volume_and_the_ground_shows_what_crops_out():
    """A paraboloid 20 m deep and 40 m wide: pi R2 h / 2, cut out of the ground."""
    x, y = np.meshgrid(np.linspace(0, 120, 41), np.linspace(0, 120, 41))
    bowl = 80 + 20 * (((x - 60) / 40) ** 2 + ((y - 60) / 40) ** 2)
    solid = make_mesh(
        Landslide(
            terrain=plane(0, 0, 0, 0, 100),
            extent={"x": [0, 120], "y": [0, 120], "base": 40},
            layers=[{"group": "lens", "base": {"lines": np.stack([x, y, bowl], axis=-1)}}],
            sizes={"body": 5, "far": 20},
        )
    )
    check_conforming(solid)
    facts = measure(solid)
    assert volumes(facts)["lens"] == pytest.approx(math.pi * 40**2 * 20 / 2, rel=0.015)
    assert facts["layers"]["lens"]["share"] == pytest.approx(math.pi * 40**2 / 120**2, rel=0.1)
    assert "lens" in text(facts) and "share of the plan" in text(facts)
    tops = solid.surfaces["ground_lens"], solid.surfaces["ground_bedrock"]
    assert len(tops[0]) == len(solid.surfaces["base_lens"])
    area = [
        np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])[:, 2].sum() / 2
        for c in (solid.points[faces] for faces in tops)
    ]
    assert sum(area) == pytest.approx(120**2)


def files(folder, kind):
    """A case of three surfaces in one format."""
    x, y = np.linspace(0, 90, 10), np.linspace(0, 60, 7)
    shapes = {
        "topo": lambda x, y: 100 + 5 * np.sin(x / 20) + y / 10,
        "soil": lambda x, y: 92 + 4 * np.sin(x / 20) + y / 8,
        "shale": lambda x, y: 70 + x / 4,
    }
    for name, shape in shapes.items():
        # whole 1/1024 m: STL keeps seven digits
        write(
            folder / f"{name}.{kind}",
            *sheet(lambda a, b, f=shape: np.round(f(a, b) * 1024) / 1024, x, y),
        )
    text = (
        f"terrain: {{triangles: topo.{kind}}}\nextent: {{x: [0, 90], y: [0, 60], base: 20}}\n"
        f"layers:\n  - {{group: soil, base: {{triangles: soil.{kind}}}}}\n"
        f"  - {{group: shale, base: {{triangles: shale.{kind}}}}}\n"
        "sizes: {body: 15, far: 30}\n"
    )
    (folder / "layers.yaml").write_text(text)
    return folder / "layers.yaml"


def test_every_format_gives_the_same_mesh(tmp_path):
    first = None
    for kind in KINDS:
        folder = tmp_path / f"a {kind}"
        folder.mkdir()
        solid = make_mesh(Landslide.load(files(folder, kind)))
        first = first or solid
        assert np.array_equal(solid.tets, first.tets), kind
        assert np.abs(solid.points - first.points).max() < 1e-9, kind
    check_conforming(first)
    write_mesh(first, tmp_path / "layers.msh")
    mesh = read_mesh(tmp_path / "layers.msh")
    assert set(mesh.group_names) == {"bedrock", "soil", "shale"}
    assert set(mesh.surfaces) == set(first.surfaces)


@pytest.mark.usefixtures("readers_here")
def test_the_command_prints_layers_and_notes(tmp_path, monkeypatch, run_cli):
    """A DXF with two layers, heights in feet, and thin ends of a layer."""
    folder = tmp_path / "a folder"
    folder.mkdir()
    monkeypatch.chdir(folder)
    path = files(folder, "dxf")
    x = np.linspace(0, 90, 4)
    above = dxf_text(*sheet(lambda x, y: 300 + 0 * x, x, x), layer="TOP")
    feet = dxf_text(*sheet(lambda x, y: (70 + x / 4) / 0.3048, x, x), layer="BED")
    both = above.replace("0\nENDSEC\n0\nEOF\n", feet.split("ENTITIES\n")[1])
    (folder / "shale.dxf").write_text(both)
    status, _, err = run_cli("mesh", path.name)
    assert status == 1
    assert "layers.yaml:5:27: layers.1.base.triangles: " in err and "choose one with 'layer'" in err
    settings = ["layers.1.base.layer=BED", "layers.1.base.unit=ft", "sizes.body=14"]
    words = [word for one in settings for word in ("--set", one)]
    status, out, err = run_cli("mesh", path.name, *words)
    assert status == 0, err
    assert "share of the plan:" in out
    assert "note: shale: " in out and "thinner than 1.4 m, goes to the layer below" in out
    status, out, _ = run_cli("mesh", path.name, "--json", *words)
    assert set(json.loads(out)["layers"]) == {"soil", "shale"}
    assert json.loads(out)["layers"]["shale"]["most"] == pytest.approx(29.5, abs=0.1)
