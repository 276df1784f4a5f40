"""Sound files to start from: all cases of the repository, and a small file of every format read.

Cases that no example has the like of are in `parts_of_cases.py`.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import shutil
import sys
from pathlib import Path
from typing import Any

import parts_of_cases
from ruamel.yaml import YAML

ROOT = Path(__file__).parent.parent.parent
FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
"""Of a cube."""
JOINTED = """\
model:
  blocks:
    - {group: a, box: {size: [2, 2, 2]}, translate: [0, 0, 1]}
    - {group: b, polyhedron: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}}
    - {group: b, box: {size: [1, 1, 1], shape: tet4}, translate: [5, 0, 0],
       rotate: {axis: [0, 0, 1], angle: 30}}
  joints:
    - {name: x, group: a, dip: 40, dip_direction: 90, spacing: 0.7, scatter: {fisher: 50}, seed: 2}
    - {name: y, normal: [0.1, 1, 0.3], origin: [0.2, 0.3, 1.4], persistence: 0.5}
  thinnest: 0.01
materials: {rock: {density: 2700, young_modulus: "1 GPa", poisson_ratio: 0.25}}
groups: {a: {material: rock, velocity: [0, 0, 1]}, b: {material: rock, fix: [x, y, z]}}
interfaces:
  default: {friction_angle: 30, cohesion: 1e5, tensile_strength: 1e4}
  pairs: [{joint: x, friction_angle: 20, stiffness_n: "5 GPa/m"}]
loads: {gravity: [0, 0, -9.81], supports: [{box: {min: [0, 0, 0], max: [9, 9, 0.1]}, fix: [z]}]}
stages:
  - {name: s, mode: static}
  - {name: d, mode: dynamic, duration: 0.1, set: {interfaces.default.friction_angle: 10}}
histories: [{name: h, group: a, quantities: [velocity, energy]}]
"""
"""A case with two sets of joints, supports, histories and a stage that sets a value."""


def write_cases(folder: Path) -> None:
    """Write cases, studies and landslide files, and the small files that they name."""
    places = [ROOT / "src/cdem/templates", ROOT / "src/cdem/verification", ROOT / "examples"]
    sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "tests/regression")]
    from shared import cases
    from test_resume_stages import SCENES

    found = [path for place in places for path in sorted(place.rglob("*.yaml"))]
    for path in found:
        name = "-".join(path.relative_to(ROOT).parts[-2:])
        (folder / name).write_bytes(path.read_bytes())
    for name, text in vars(cases).items():
        if isinstance(text, str) and not name.startswith("_"):
            (folder / f"tests-{name.lower()}.yaml").write_text(text)
    (folder / "tests-jointed.yaml").write_text(JOINTED)
    (folder / "parts-solid.yaml").write_text(parts_of_cases.SOLID)
    (folder / "parts-waves.yaml").write_text(parts_of_cases.WAVES)
    (folder / "parts-joints.yaml").write_text(parts_of_cases.JOINTS)
    (folder / "beside-fit.yaml").write_text(parts_of_cases.FIT)
    trees = {f"scene-{name}": scene() for name, scene in SCENES.items()}
    trees |= {f"law-{name}": case for name, case in parts_of_cases.of_laws().items()}
    for name, tree in trees.items():
        YAML().dump(tree, folder / f"{name}.yaml")
    for name, text in parts_of_cases.BESIDE.items():
        (folder / name).write_text(text)
    (folder / "cube.yaml").write_text(cases.CUBE)
    (folder / "case.yaml").write_text(cases.CUBE)
    shutil.copy(ROOT / "src/cdem/templates/slope.msh", folder)
    for path in (ROOT / "src/cdem/templates/rockfall_runs").glob("*.asc"):
        shutil.copy(path, folder)
    skin = _cube()
    (folder / "cube.obj").write_text(skin[0])
    skin[1].write(folder / "cube.stl", binary=False)


def write_files(folder: Path) -> None:
    """Write small meshes, bodies and terrain in every format that is read."""
    _write_meshes(folder)
    _write_bodies(folder)
    _write_terrain(folder)
    _write_facets(folder)
    (folder / "monitored-a.csv").write_text(
        "point;x;y;z;date;dx [mm];sx [mm]\nA;1;2;3;2024-03-01;4,5;1\nB;2;2;3;2024-03-02;;1\n"
    )
    (folder / "history-a.csv").write_text("# blast\ntime [ms]; factor [%]\n0; 0\n0.5; 100\n2; 30\n")
    (folder / "history-b.txt").write_text("0 0\n0.5\t1e0\n2 -.3\n")
    _write_records(folder)
    _write_outcrops(folder)


def _write_outcrops(folder: Path) -> None:
    """Clouds of an outcrop, facets of CloudCompare, clusters of DSE."""
    import laspy
    import numpy as np

    x = np.random.default_rng(1).uniform(0, 5, (60, 3)).round(3)
    rows = "\n".join(" ".join(map(str, row)) for row in x)
    (folder / "outcrop-a.xyz").write_text(f"# scan\n{rows}\n")
    (folder / "outcrop-b.pts").write_text(
        f"60\n{rows.replace(chr(10), ' 7 255 0 0' + chr(10))} 7 1 1 1"
    )
    (folder / "outcrop-c.csv").write_text(f"x;y;z\n{rows.replace(' ', ';').replace('.', ',')}\n")
    for name, kind in (("d", "ascii"), ("e", "binary_little_endian")):
        head = f"ply\nformat {kind} 1.0\ncomment TextureFile a.png\nelement vertex 60\n"
        head += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
        raw = rows.encode() if kind == "ascii" else x.astype("<f4").tobytes()
        (folder / f"outcrop-{name}.ply").write_bytes(head.encode() + raw)
    cloud = laspy.LasData(laspy.LasHeader(point_format=0, version="1.2"))
    cloud.x, cloud.y, cloud.z = x.T
    cloud.write(folder / "outcrop-f.las")
    cloud.write(folder / "outcrop-g.laz")
    head = "Index; CenterX; NormalX; NormalY; NormalZ; Horiz_ext; Vert_ext; Dip dir.; Dip; Family ind.; \n"
    facets = "".join(f"{k};{k}.5;0.5;0;0.866;1;1;90;30;{k % 2};\n" for k in range(6))
    (folder / "joints-a.csv").write_text(head + facets)
    clusters = "".join(f"{k}\t1\t2\t{1 + k % 2}\t{1 + k // 2}\t0\t0\t1\t-2\n" for k in range(8))
    (folder / "joints-b.txt").write_text(clusters)


def _write_records(folder: Path) -> None:
    import numpy as np

    samples = [round(math.sin(0.7 * i) * i * 1e-3, 7) for i in range(40)]
    rows = "\n".join(" ".join(f"{a: .7E}" for a in samples[i : i + 5]) for i in range(0, 40, 5))
    head = "PEER NGA STRONG MOTION\nSite, 90\nACCELERATION TIME SERIES IN UNITS OF G\n"
    (folder / "record-a.at2").write_text(f"{head}NPTS=   40, DT=   .0050 SEC,\n{rows}\n")
    (folder / "record-b.at2").write_text(f"{head}   40   0.0050   NPTS, DT\n{rows}\n")
    timed = "".join(f"{0.01 * i:.2f}; {a}\n" for i, a in enumerate(samples))
    (folder / "record-c.csv").write_text(f"# site\ntime [s]; velocity [cm/s]\n{timed}")
    (folder / "record-d.txt").write_text("\n".join(map(str, samples)))
    np.save(folder / "record-e.npy", np.array(samples))


def _write_meshes(folder: Path) -> None:
    import meshio
    import numpy as np

    from cdem.mesh.primitives import box

    tets = box("a", (1, 2, 3), (1, 1, 2), shape="tet4")
    hexes = box("b", (1, 1, 1), (2, 1, 1))
    wedges = box("c", (1, 1, 1), (1, 1, 1), shape="wedge6")
    points = np.concatenate([tets.points, hexes.points + 5, wedges.points + 9])
    first, second = len(tets.points), len(tets.points) + len(hexes.points)
    cells = [
        ("tetra", tets.cells["tet4"]),
        ("hexahedron", hexes.cells["hex8"] + first),
        ("wedge", wedges.cells["wedge6"] + second),
    ]
    tags = [np.full(len(c), 1 + i) for i, (_, c) in enumerate(cells)]
    names = {n: np.array([1 + i, 3]) for i, n in enumerate(("rock", "bed", "wall"))}
    mixed = meshio.Mesh(
        points,
        cells,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data=names,
    )
    plain = meshio.Mesh(points[:first], cells[:1])
    formats = [
        (mixed, "gmsh22", "a22.msh", {"binary": False}), (mixed, "gmsh22", "b22.msh", {}),
        (plain, "gmsh", "a41.msh", {"binary": False}), (plain, "gmsh", "b41.msh", {}),
        (plain, "ansys", "a.msh", {"binary": False}), (plain, "ansys", "b.msh", {}),
        (plain, "abaqus", "a.inp", {}), (plain, "nastran", "a.bdf", {}),
        (plain, "netgen", "a.vol", {}), (plain, "medit", "a.mesh", {}),
        (plain, "medit", "b.meshb", {}), (mixed, "vtk42", "a.vtk", {"binary": False}),
        (mixed, "vtk51", "c.vtk", {"binary": False}), (mixed, "vtk", "b.vtk", {}),
        (mixed, "vtu", "a.vtu", {"binary": False}), (mixed, "vtu", "b.vtu", {}),
        (plain, "su2", "a.su2", {}), (plain, "flac3d", "a.f3grid", {"binary": False}),
        (plain, "flac3d", "b.f3grid", {"binary": True}), (plain, "tetgen", "a.node", {}),
        (plain, "avsucd", "a.avs", {}), (plain, "mdpa", "a.mdpa", {}),
        (plain, "permas", "a.post", {}), (plain, "tecplot", "a.dat", {}),
        (plain, "dolfin-xml", "a.xml", {}), (plain, "xdmf", "a.xdmf", {"data_format": "XML"}),
        (plain, "med", "a.med", {}), (plain, "h5m", "a.h5m", {}), (plain, "cgns", "a.cgns", {}),
        (plain, "hmf", "a.hmf", {}),
    ]  # fmt: skip
    silent = io.StringIO()
    with contextlib.redirect_stdout(silent), contextlib.redirect_stderr(silent):
        for mesh, form, name, options in formats:
            meshio.write(folder / f"mesh-{name}", mesh, file_format=form, **options)


def _corners() -> Any:
    from cdem.mesh.primitives import box

    return box("a", (1, 1, 1)).points


def _cube() -> tuple[str, Any]:
    """Text of a cube as .obj, and its skin of triangles."""
    import meshio
    import numpy as np

    corners = _corners()
    lines = [f"v {x:g} {y:g} {z:g}" for x, y, z in corners]
    lines += ["f " + " ".join(str(v + 1) for v in face) for face in FACES]
    triangles = [(f[0], f[m], f[m + 1]) for f in FACES for m in (1, 2)]
    return "\n".join(lines) + "\n", meshio.Mesh(corners, [("triangle", np.array(triangles))])


def _write_bodies(folder: Path) -> None:
    import pyvista

    corner = _corners()
    text, skin = _cube()
    (folder / "body-a.obj").write_text(text)
    skin.write(folder / "body-a.stl", binary=False)
    skin.write(folder / "body-b.stl", binary=True)
    skin.cells[0].data = skin.cells[0].data.astype("int32")  # PLY has no longer ones
    skin.write(folder / "body-a.ply", binary=False)
    skin.write(folder / "body-b.ply", binary=True)
    row = [len(FACES), *(v for face in FACES for v in (len(face), *face))]
    grid = pyvista.UnstructuredGrid([len(row), *row], [pyvista.CellType.POLYHEDRON], corner)
    for name, binary in (("a.vtu", False), ("b.vtu", True), ("a.vtk", False), ("b.vtk", True)):
        grid.save(folder / f"body-{name}", binary=binary)


def _write_facets(folder: Path) -> None:
    """Surfaces of triangles; cubes have two heights, so each is a sheet."""
    sys.path[:0] = [str(ROOT / "tests")]
    import numpy as np
    from shared import facets

    points, triangles = facets.sheet(
        lambda x, y: x / 4 + y, np.arange(0, 16, 5), np.arange(0, 11, 5)
    )
    system = 'GOCAD_ORIGINAL_COORDINATE_SYSTEM\nAXIS_UNIT "m" "m" "ft"\nZPOSITIVE Depth\n'
    facets.write(folder / "facets-a.obj", points, triangles)
    facets.write(
        folder / "facets-a.ts", points, triangles, system=system + "END_ORIGINAL_COORDINATE_SYSTEM"
    )
    facets.write(folder / "facets-a.dxf", points, triangles, layer="A")
    for kind in ("stl", "bin.stl", "ply", "bin.ply"):
        facets.write(folder / f"facets-{kind[0]}.{kind}", points, triangles)


def _write_terrain(folder: Path) -> None:
    import numpy as np
    import rasterio

    lines = [[[x, 10 * k + x / 9] for x in range(0, 50, 10)] for k in range(5)]
    features = [
        {
            "type": "Feature",
            "properties": {"id": k, "elev": 5.0 * k},
            "geometry": {"type": "LineString", "coordinates": line},
        }
        for k, line in enumerate(lines)
    ]
    (folder / "lines-a.geojson").write_text(json.dumps({"features": features}, indent=0))
    rows = [f"{k},{x},{y},{5 * k}" for k, line in enumerate(lines) for x, y in line]
    (folder / "lines-a.csv").write_text("\n".join(["line,x,y,z", *rows]))
    ring = [[0, 0], [9, 0], [9, 9], [0, 9], [0, 0]]
    (folder / "outline-a.geojson").write_text(
        json.dumps({"type": "Polygon", "coordinates": [ring]})
    )
    heights = np.add.outer(np.arange(6.0), np.arange(5.0))
    body = "\n".join(" ".join(map(str, row)) for row in heights)
    head = "ncols 5\nnrows 6\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n"
    (folder / "grid-a.asc").write_text(head + body)
    place = rasterio.transform.from_origin(0, 60, 10, 10)
    shape = {"width": 5, "height": 6, "count": 1, "dtype": "float64", "transform": place}
    for name, more in (("a.tif", {}), ("b.tif", {"compress": "lzw"}), ("c.tif", {"tiled": True})):
        with rasterio.open(folder / f"grid-{name}", "w", driver="GTiff", **shape, **more) as file:
            file.write(heights, 1)
    _write_by_gdal(folder, ring, lines)


def _write_by_gdal(folder: Path, ring: list, lines: list) -> None:
    """Outlines, contours and grids in the formats that GDAL reads, and a cloud of points."""
    import zipfile

    import laspy
    import numpy as np
    import pyogrio
    import shapely
    from rasterio.shutil import copy

    kinds = {
        "gpkg": "GPKG",
        "shp": "ESRI Shapefile",
        "kml": "KML",
        "fgb": "FlatGeobuf",
        "dxf": "DXF",
    }
    shapes = np.array([shapely.to_wkb(shapely.LineString(line)) for line in lines], object)
    closed = np.array([shapely.to_wkb(shapely.LineString(ring))], object)
    heights = [np.array([5.0 * k for k in range(len(lines))])]
    for ending, driver in kinds.items():
        options = {"geometry_type": "LineString", "driver": driver, "crs": "EPSG:32632"}
        pyogrio.raw.write(folder / f"outline-b.{ending}", closed, [], [], **options)
        if driver not in ("DXF", "KML"):
            pyogrio.raw.write(folder / f"lines-b.{ending}", shapes, heights, ["elev"], **options)
    with zipfile.ZipFile(folder / "outline-c.kmz", "w", zipfile.ZIP_DEFLATED) as packed:
        packed.write(folder / "outline-b.kml", "doc.kml")
    for name, driver in (("d.vrt", "VRT"), ("e.grd", "GSBG"), ("f.grd", "GSAG")):
        copy(folder / "grid-a.tif", folder / f"grid-{name}", driver=driver)
    for path in folder.glob("*.aux.xml"):
        path.unlink()
    cloud = laspy.LasData(laspy.LasHeader(point_format=3, version="1.2"))
    cloud.x, cloud.y = np.tile(np.arange(9.0), 9), np.repeat(np.arange(9.0), 9)
    cloud.z, cloud.classification = cloud.x, np.full(81, 2)
    for name in ("a.las", "b.laz"):
        cloud.write(str(folder / f"cloud-{name}"))
