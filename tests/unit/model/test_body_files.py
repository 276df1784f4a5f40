"""Convex bodies from files, and refusals of those that cannot be used."""

import re

import numpy as np
import pytest

import cdem
from cdem.joints import convex_cells, cutting
from cdem.mesh import primitives
from cdem.mesh.blocks import block_labels, build_topology
from cdem.model.body_files import fill_bodies, read_bodies

CUBE = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def cubes(count=1, at=0.0):
    """Corners and faces of unit cubes in a row, each with corners of its own."""
    corner = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    points = np.concatenate([corner + [at + k, 0, 0] for k in range(count)])
    return points, [[8 * k + v for v in face] for k in range(count) for face in CUBE]


def write_obj(path, points, faces):
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]
    lines += ["f " + " ".join(f"{v + 1}//1" for v in face) for face in faces]
    path.write_text("# blocks\n" + "\n".join(lines) + "\n")


PLY_HEAD = (
    "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
    "element face {}\nproperty list uchar int vertex_indices\nend_header\n"
)


def triangles(faces):
    return [(f[0], f[m], f[m + 1]) for f in faces for m in range(1, len(f) - 1)]


def volume(made):
    x = made.points[made.cells["tet4"]]
    return np.linalg.det(x[:, 1:] - x[:, :1]).sum() / 6


def test_obj(tmp_path):
    points, faces = cubes(3, at=0.25)
    faces[0] = faces[0][::-1]  # the turn of a face does not matter
    points[8:16] += [10, 0, 0]  # the middle one stands apart
    write_obj(tmp_path / "a.obj", points, faces)
    made = read_bodies(tmp_path / "a.obj", "rock")
    t = build_topology(made, {})
    assert len(t.block_group) == 3 and volume(made) == pytest.approx(3, rel=1e-12)
    assert len(t.pair_faces) == 0


def test_solids_that_share_a_face_are_bodies_of_their_own(tmp_path):
    points, faces = cubes(3)
    write_obj(tmp_path / "a.obj", points, faces)
    made = read_bodies(tmp_path / "a.obj", "rock")
    t = build_topology(made, {})
    assert len(t.block_group) == 3 and volume(made) == pytest.approx(3, rel=1e-12)
    assert len(t.pair_faces) == 4  # two walls of two triangles
    write_obj(tmp_path / "a.obj", points, faces[:-1])  # one is open: no part is taken for sound
    with pytest.raises(cdem.MeshError, match=r"body 0: the surface is not closed.* has 4;"):
        read_bodies(tmp_path / "a.obj", "rock")


@pytest.mark.parametrize("binary", [True, False])
def test_solids_of_an_stl_that_share_a_face(tmp_path, binary):
    import meshio

    points, faces = cubes(2)
    mesh = meshio.Mesh(points, [("triangle", np.array(triangles(faces)))])
    mesh.write(tmp_path / "a.stl", binary=binary)
    made = read_bodies(tmp_path / "a.stl", "rock", scale=0.001)
    assert len(build_topology(made, {}).block_group) == 2
    assert volume(made) == pytest.approx(2e-9, rel=1e-6)


def test_a_damaged_stl_is_refused(tmp_path):
    import meshio

    points, faces = cubes()
    path = tmp_path / "a.stl"
    meshio.Mesh(points, [("triangle", np.array(triangles(faces)))]).write(path)
    sound = path.read_text()
    path.write_text(sound.replace("vertex 1.0 1.0 1.0", "vertex 1.0 1.0 1.0 1.0", 1))
    with pytest.raises(
        cdem.MeshError, match=r"a\.stl:\d+: cannot be read: vertex 1\.0 1\.0 1\.0 1"
    ):
        read_bodies(path, "rock")


@pytest.mark.parametrize("binary", [True, False])
def test_ply(tmp_path, binary):
    """Solids of quadrilaterals and of triangles that share a face."""
    import meshio

    points, faces = cubes(2)
    cells = [("quad", np.array(faces[:6])), ("triangle", np.array(triangles(faces[6:])))]
    meshio.Mesh(points, cells).write(tmp_path / "a.ply", binary=binary)
    made = read_bodies(tmp_path / "a.ply", "rock", scale=2)
    assert len(build_topology(made, {}).block_group) == 2
    assert volume(made) == pytest.approx(16, rel=1e-12)


def test_what_of_an_obj_is_not_used_is_told_and_no_other_file_is_opened(tmp_path):
    write_obj(tmp_path / "a.obj", *cubes())
    whole = (tmp_path / "a.obj").read_text()
    (tmp_path / "a.obj").write_text(
        f"mtllib a.mtl\no stone\n{whole}usemtl grey\ns off\nl 1 2\nl 2 3\ncurv 0 1 1 2\n"
    )
    (tmp_path / "a.mtl").mkdir()  # opening it would fail
    made = read_bodies(tmp_path / "a.obj", "rock")
    assert made.notes == ["a.obj: only faces are used; 2 of 'l', 1 of 'curv' ignored"]


def test_corners_that_are_not_finite_are_refused(tmp_path):
    points, faces = cubes()
    points[7, 2] = np.nan
    write_obj(tmp_path / "a.obj", points, faces)
    with pytest.raises(cdem.MeshError, match=r"a.obj: body 0: a corner has .* not finite"):
        read_bodies(tmp_path / "a.obj", "rock")


def test_almost_convex_is_convex_and_told(tmp_path):
    points, faces = cubes()
    points[7, 2] += 3e-5  # a warped lid
    write_obj(tmp_path / "a.obj", points, faces)
    made = read_bodies(tmp_path / "a.obj", "rock")
    assert volume(made) == pytest.approx(1 + 1e-5, rel=1e-5)
    assert "body 0 is taken as convex: corners lie up to" in made.notes[0]
    made = primitives.polyhedron("rock", points, faces)
    assert "is taken as convex" in made.notes[0] and volume(made) == pytest.approx(1, rel=3e-5)
    points[7] -= 1e-3
    write_obj(tmp_path / "a.obj", points, [list(t) for t in triangles(faces)])
    with pytest.raises(cdem.MeshError, match="not convex"):
        read_bodies(tmp_path / "a.obj", "rock")


@pytest.mark.parametrize("name", ["material", "region", "gmsh:physical"])
def test_cell_data_of_vtk_are_groups(tmp_path, name):
    pyvista = pytest.importorskip("pyvista")
    from cdem.mesh.mesh_files import read_mesh

    grid = pyvista.ImageData(dimensions=(4, 2, 2)).cast_to_unstructured_grid()
    grid.cell_data[name] = np.array([1, 2, 2])
    grid.save(tmp_path / "a.vtu")
    stem = "group" if name == "gmsh:physical" else name
    made = read_bodies(tmp_path / "a.vtu", "rock")
    assert made.group_names == [f"rock_{stem}1", f"rock_{stem}2"]
    assert np.bincount(made.cell_group["tet4"]).tolist() == [12, 24]
    cells = [("hexahedron", grid.cells.reshape(-1, 9)[:, [1, 2, 4, 3, 5, 6, 8, 7]])]  # of voxels
    import meshio

    data = {name: [grid.cell_data[name]]}
    meshio.Mesh(np.asarray(grid.points, float), cells, cell_data=data).write(tmp_path / "b.vtu")
    mesh = read_mesh(tmp_path / "b.vtu")
    assert mesh.group_names == [f"{stem}1", f"{stem}2"]
    assert mesh.cell_group["hex8"].tolist() == [0, 1, 1]


@pytest.mark.parametrize("far", [0.0, 5000.0])
def test_stl(tmp_path, far):
    import meshio

    points, faces = cubes(1)
    points = points @ np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0] + far
    meshio.Mesh(points, [("triangle", np.array(triangles(faces)))]).write(tmp_path / "a.stl")
    assert volume(read_bodies(tmp_path / "a.stl", "rock")) == pytest.approx(
        1, rel=1e-6 + far * 1e-6
    )


def test_vtk_polyhedra(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    piece = primitives.box("rock", (2, 2, 2))
    c = convex_cells.from_mesh(piece, ["rock"], block_labels(piece, {}))
    for number, normal in enumerate(([1, 1, 1], [1, -0.5, 0.3])):
        n = np.array(normal) / np.linalg.norm(normal)
        c, _ = cutting.cut(c, n, n @ [1, 1.1, 0.9], number, among=np.array([True]))
    rows = []
    for k in range(len(c.block)):
        loops = [
            c.corner[c.first[f] : c.first[f + 1]].tolist() for f in np.flatnonzero(c.cell == k)
        ]
        row = [len(loops), *(v for loop in loops for v in (len(loop), *loop))]
        rows += [len(row), *row]
    kinds = np.full(len(c.block), pyvista.CellType.POLYHEDRON)
    pyvista.UnstructuredGrid(rows, kinds, c.points).save(tmp_path / "a.vtu")
    made = read_bodies(tmp_path / "a.vtu", "rock")
    t = build_topology(made, {})
    assert len(t.block_group) == 4 and volume(made) == pytest.approx(8, rel=1e-12)
    x = t.node_position[t.face_nodes[:, :3]]
    outer = (np.isclose(x, 0).all(axis=1) | np.isclose(x, 2).all(axis=1)).any(axis=1)
    assert t.pair_faces.size == (~outer).sum() > 8  # both sides of a cut are divided alike


@pytest.mark.parametrize(
    "change, message",
    [
        (lambda p, f: f.pop(), r"not closed: .*\(0, 0, 1\) - \(0, 1, 1\) has 1"),
        (lambda p, f: p.__setitem__(7, [0.4, 0.4, 0.4]), "not convex: vertex"),
        (lambda p, f: p.__setitem__((slice(None), 2), 0), "has no area|not closed|no volume"),
        (lambda p, f: f.append([0, 1, 99]), r"a.obj:\d+: a face needs three or more vertices"),
    ],
)
def test_refusals_say_where(tmp_path, change, message):
    points, faces = cubes()
    if "convex" in message:
        faces = [list(t) for t in triangles(faces)]
    change(points, faces)
    write_obj(tmp_path / "a.obj", points, faces)
    with pytest.raises(cdem.MeshError, match=message):
        read_bodies(tmp_path / "a.obj", "rock")


def test_vtk_may_die_of_a_file(tmp_path):
    """A corner that is not there, far outside of the points, makes VTK read foreign memory."""
    pyvista = pytest.importorskip("pyvista")
    points, faces = cubes()
    row = [len(faces), *(v for face in faces for v in (len(face), *face))]
    grid = pyvista.UnstructuredGrid([len(row), *row], [pyvista.CellType.POLYHEDRON], points)
    path = tmp_path / "a.vtu"
    grid.save(path, binary=False)
    assert volume(read_bodies(path, "rock")) == pytest.approx(1, rel=1e-12)
    path.write_text(re.sub(r"(?<=\s)7(?=\s)", "99999999", path.read_text()))
    with pytest.raises(cdem.MeshError, match=r"a\.vtu: its reader crashed"):
        read_bodies(path, "rock")
    grid = pyvista.UnstructuredGrid([5, 1, 3, 0, 1, 2], [pyvista.CellType.POLYHEDRON], points)
    grid.save(tmp_path / "b.vtu", binary=False)
    with pytest.raises(cdem.MeshError, match=r"b\.vtu: a cell has less than four faces"):
        read_bodies(tmp_path / "b.vtu", "rock")
    path.write_text(path.read_text()[:700])
    with pytest.raises(cdem.MeshError, match=r"a\.vtu: contains no bodies"):
        read_bodies(path, "rock")


@pytest.mark.parametrize("name, text, message", [
    ("a.txt", "", "bodies are read from .obj, .stl, .ply, .vtu, .vtk files"),
    ("a.obj", "v 1 2 3\nv x 0 0\n", "a.obj:2: cannot be read"),
    ("a.obj", "v 1 2 3\nv 1 2\n", "a.obj:2: cannot be read"),
    ("a.obj", "", "contains no faces"),
    ("a.stl", "not one", "a.stl: is no complete STL"),
    ("a.ply", "not one", "a.ply: has no header of a PLY file"),
    ("a.ply", PLY_HEAD.format(3, 0) + "0 0 0\n1 0 0\n0 1 0\n", "contains no readable faces"),
    ("a.ply", PLY_HEAD.format(1, 1) + "0 0 0\n3 0 0 -1\n", "cannot be read|refers to a missing vertex"),
    ("a.ply", PLY_HEAD.format(2, 1) + "0 0 0\n1 0 0\n3 0 1 7\n", "a face refers to a missing vertex"),
])  # fmt: skip
def test_files_that_are_no_bodies(tmp_path, name, text, message):
    (tmp_path / name).write_text(text)
    with pytest.raises(cdem.MeshError, match=message):
        read_bodies(tmp_path / name, "rock")


def test_a_case_with_bodies_from_a_file(run_cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_obj(tmp_path / "cube.obj", *cubes())
    (tmp_path / "case.yaml").write_text(
        "model: {blocks: [{group: a, file: cube.obj, translate: [0, 0, 1]}]}\n"
        "materials: {m: {density: 2500, young_modulus: 1e9, poisson_ratio: 0.2}}\n"
        "groups: {a: {material: m}}\n"
        "stages: [{name: fall, mode: dynamic, duration: 1}]\n"
    )
    assert run_cli("check", "case.yaml")[0] == 0
    status, _, err = run_cli("check", "case.yaml", "--set", "model.blocks.0.file=cub.obj")
    assert status == 1 and "model.blocks.0: " in err and "no such file" in err


def ell(turned=False):
    """An L of three unit cubes: corners and faces, and one face the wrong way round."""
    outline = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    points = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in outline])
    low = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    faces = [f[::-1] for f in low] + [tuple(v + 6 for v in f) for f in low]
    for a in range(6):
        b = (a + 1) % 6
        faces += [(a, b, b + 6), (a, b + 6, a + 6)]
    if turned:
        faces[5] = faces[5][::-1]
    return points, [list(f) for f in faces]


@pytest.mark.parametrize("turned", [False, True])
def test_a_body_that_is_not_convex_is_filled_with_tets(tmp_path, turned):
    pytest.importorskip("netgen", reason="needs the extra 'terrain'")
    points, faces = ell(turned)
    path = tmp_path / "a.obj"
    write_obj(
        path,
        np.concatenate([points, points + [5, 0, 0]]),
        [*faces, *[[v + 12 for v in f] for f in faces]],
    )
    made = fill_bodies(path, "rock", 0.7)
    assert volume(made) == pytest.approx(6, rel=1e-12)
    assert np.linalg.det(np.diff(made.points[made.cells["tet4"]], axis=1)).min() > 0
    assert len(build_topology(made, {}).block_group) == 2
    with pytest.raises(
        cdem.MeshError, match=r"not convex.*; with 'size' beside the file it is filled"
    ):
        read_bodies(path, "rock")


def test_what_cannot_be_filled_is_refused(tmp_path):
    pytest.importorskip("netgen", reason="needs the extra 'terrain'")
    points, faces = ell()
    write_obj(tmp_path / "open.obj", points, faces[:-1])
    with pytest.raises(cdem.MeshError, match=r"body 0: the surface is not closed"):
        fill_bodies(tmp_path / "open.obj", "rock", 0.7)
    points[0] = [3, 0.5, 0.5]  # a corner pushed through the walls
    write_obj(tmp_path / "crossed.obj", points, faces)
    with pytest.raises(cdem.MeshError, match=r"body 0: its surface cannot be filled with tets"):
        fill_bodies(tmp_path / "crossed.obj", "rock", 0.7)
    with pytest.raises(cdem.MeshError, match=r"size goes with surfaces, \.obj, \.stl, \.ply"):
        fill_bodies(tmp_path / "a.vtu", "rock", 0.7)
