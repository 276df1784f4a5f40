"""preview.py: the picture of `cdem check --picture` shows, and names, all that a model is made of."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest
from PIL import Image

from cdem.output import model_picture, render
from cdem.output.reader import SurfaceSeries
from cdem.output.render import can_draw

CASE = """\
model:
  blocks:
    - {group: base, box: {size: [6, 3, 1], divisions: [6, 3, 1]}}
    - {group: wall, box: {size: [1, 3, 3], divisions: [1, 3, 3], shape: tet4}, translate: [0, 0, 1]}
    - {group: loose, box: {size: [1, 1, 1]}, translate: [3, 1, 1]}
  split: {wall: elements}
materials: {rock: {density: 2700, young_modulus: "1 GPa", poisson_ratio: 0.25}}
groups: {base: {material: rock}, wall: {material: rock}, loose: {material: rock}}
interfaces:
  default: {friction_angle: 30}
  pairs:
    - {between: [wall, wall], cohesion: "1 MPa", tensile_strength: "0.1 MPa"}
    - {between: [wall, base], cohesion: "2 MPa", tensile_strength: "0.5 MPa", friction_angle: 20}
loads:
  supports: [{surface: {group: base, normal: [0, 0, -1]}, fix: [z]}]
  tractions: [{surface: {group: wall, normal: [1, 0, 0]}, traction: [-1000, 0, 0]}]
  velocities: [{group: loose, velocity: [0.1, 0, 0], components: [x]}]
stages: [{name: push, mode: dynamic, duration: "5 ms"}]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "model.yaml").write_text(CASE)
    return tmp_path


def has(image, color: str) -> bool:
    rgb = [int(color[i : i + 2], 16) for i in (1, 3, 5)]
    return bool((image == rgb).all(axis=2).any())


def test_the_picture_shows_and_names_everything(cdem, folder, monkeypatch):
    if not can_draw():
        pytest.skip("no OpenGL")
    legends = []
    legend = model_picture.legend
    monkeypatch.setattr(
        model_picture, "legend", lambda e, *size: legends.append(e) or legend(e, *size)
    )
    status, out, err = cdem("check", "model.yaml", "--picture", "model.png", "--threads", "1")
    assert (status, err) == (0, "")
    assert "bonded interfaces" in out
    left, right = ([label for label, _ in entries] for entries in legends)
    assert left == [
        "base", "wall", "loose", "held in z: 28 nodes", "driven in x: 8 nodes", "traction: 54 nodes"
    ]  # fmt: skip
    # 6 triangles of the wall on the base (3 whole squares of two), 78 inside it
    assert right == [
        "base - wall: 6 pair(s), 20 deg, bonded c 2e+06 T 5e+05 Pa",
        "base - loose: 1 pair(s), 30 deg",
        "wall - wall: 78 pair(s), 30 deg, bonded c 1e+06 T 1e+05 Pa",
    ]
    image = np.asarray(Image.open(folder / "model.png"))
    rows = 28 * len(left) + 10
    assert image.shape == (rows + model_picture.SIZE[1], 2 * model_picture.SIZE[0], 3)
    for half, entries in zip(np.split(image[:, :, :3], 2, axis=1), legends, strict=True):
        assert (half[rows:].min(axis=2) < 200).mean() > 0.1  # the model fills a part of the view
        assert all(has(half[:rows], color) for _, color in entries if color.startswith("#"))


def test_many_inner_pairs_are_counted_not_drawn(folder, monkeypatch):
    if not can_draw():
        pytest.skip("no OpenGL")
    import cdem

    monkeypatch.setattr(model_picture, "MOST_INNER", 10)
    entries = []
    monkeypatch.setattr(
        model_picture, "legend", lambda e, rows, _: entries.extend(e) or white(rows)
    )
    white = lambda rows: np.full((28 * rows, model_picture.SIZE[0], 3), 255, np.uint8)  # noqa: E731
    model_picture.draw_model(cdem.Simulation("model.yaml", threads=1))
    assert [label for label, _ in entries if "not drawn" in label] == [
        "wall - wall: 78 pair(s), 30 deg, bonded c 1e+06 T 1e+05 Pa (not drawn)"
    ]


def test_pictures_of_results_name_the_groups(folder, monkeypatch):
    if not can_draw():
        pytest.skip("no OpenGL")
    import cdem

    cdem.Simulation("model.yaml", output="r.results", threads=1).run()
    series = SurfaceSeries(folder / "r.results")
    legends = []
    legend = render.legend
    monkeypatch.setattr(render, "legend", lambda e, *size: legends.append(e) or legend(e, *size))
    image = render.picture([series[0]], "group", titles=["before"])
    assert [label for label, _ in legends[0]] == ["base", "wall", "loose"]
    rows = len(image) - 28 * 3 - 10
    assert all(has(image[rows:], color) for _, color in legends[0])


def test_json_stays_json_and_the_file_must_be_png(cdem, folder, monkeypatch):
    monkeypatch.setattr(model_picture, "draw_model", lambda sim: np.zeros((2, 2, 3), np.uint8))
    status, out, _ = cdem("check", "model.yaml", "--json", "--picture", "model.png")
    assert status == 0
    assert json.loads(out)["counts"]["blocks"] == 56
    assert (folder / "model.png").exists()
    status, out, err = cdem("check", "model.yaml", "--picture", "model.svg")
    assert (status, out) == (2, "")
    assert "--picture writes PNG" in err


def test_without_the_extra_one_message_says_so(cdem, folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    status, _, err = cdem("check", "model.yaml", "--picture", "model.png")
    assert (status, err) == (1, "pictures need pyvista; pip install 'cdem[viz]'\n")


@pytest.mark.parametrize("wrong", ["open", "not convex"])
def test_a_refused_body_is_drawn(cdem, tmp_path, monkeypatch, wrong):
    """Red is where an edge lacks its face, or the corner that lies outside of a face."""
    if not can_draw():
        pytest.skip("no OpenGL")
    monkeypatch.chdir(tmp_path)
    corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = ["1 2 4 3", "5 6 8 7", "1 2 6 5", "3 4 8 7", "1 3 7 5", "2 4 8 6"]
    if wrong == "open":
        faces.pop()
    else:  # a dent in a side of triangles
        corners.append([0.5, 0.5, 0.7])
        faces[5:] = ["2 4 9", "4 8 9", "8 6 9", "6 2 9"]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {face}" for face in faces]
    (tmp_path / "body.obj").write_text("\n".join(lines))
    (tmp_path / "case.yaml").write_text(
        "model: {blocks: [{group: a, file: body.obj}]}\n"
        "materials: {m: {density: 2500, young_modulus: 1e9, poisson_ratio: 0.2}}\n"
        "groups: {a: {material: m}}\n"
        "stages: [{name: fall, mode: dynamic, duration: 1}]\n"
    )
    status, said, complaint = cdem("check", "case.yaml", "--picture", "refused.png")
    assert status == 1
    assert "what is wrong in red" in said
    image = np.asarray(Image.open("refused.png")).astype(int)
    assert ((image[..., 0] > 150) & (image[..., 1:].max(axis=2) < 80)).sum() > 200
    assert ("not closed" if wrong == "open" else "not convex") in complaint
