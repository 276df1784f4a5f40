"""The picture of `cdem check --picture` shows, and names, all that a model is made of."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

import cdem
from cdem.output import model_picture
from cdem.output.render import can_draw


def has(image, color: str) -> bool:
    rgb = [int(color[i : i + 2], 16) for i in (1, 3, 5)]
    return bool((image == rgb).all(axis=2).any())


def test_the_picture_shows_and_names_everything(run_cli, wall_folder, monkeypatch):
    if not can_draw():
        pytest.skip("no OpenGL")
    legends = []
    legend = model_picture.labels
    monkeypatch.setattr(
        model_picture, "labels", lambda e, *size: legends.append(e) or legend(e, *size)
    )
    status, out, err = run_cli("check", "model.yaml", "--picture", "model.png", "--threads", "1")
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
    image = np.asarray(Image.open(wall_folder / "model.png"))
    rows = 28 * len(left) + 10
    assert image.shape == (rows + model_picture.SIZE[1], 2 * model_picture.SIZE[0], 3)
    for half, entries in zip(np.split(image[:, :, :3], 2, axis=1), legends, strict=True):
        assert (half[rows:].min(axis=2) < 200).mean() > 0.1  # the model fills a part of the view
        assert all(has(half[:rows], color) for _, color in entries if color.startswith("#"))


def _inside(run_cli, monkeypatch, name):
    """The legend and the right view of a template, in a folder of its own."""
    if not can_draw():
        pytest.skip("no OpenGL")
    legends, legend = [], model_picture.labels
    monkeypatch.setattr(
        model_picture, "labels", lambda e, *size: legends.append(e) or legend(e, *size)
    )
    assert run_cli("new", name)[0] == 0
    status, _, err = run_cli("check", f"{name}.yaml", "--picture", "m.png", "--threads", "1")
    assert (status, err) == (0, "")
    image = np.asarray(Image.open("m.png")).astype(int)
    view = image[-model_picture.SIZE[1] :, model_picture.SIZE[0] :]
    view[700:, :200] = 255  # the axes
    return legends[1], view


def _bluish(image):
    red, green, blue = image[..., 0], image[..., 1], image[..., 2]
    return (blue > red + 30) & (blue > green + 20)


def test_joints_are_whole_and_bolts_and_water_are_drawn(run_cli, tmp_path, monkeypatch):
    """The planes of the road cut have the area of its sections; its table cuts the rock."""
    monkeypatch.chdir(tmp_path)
    legend, image = _inside(run_cli, monkeypatch, "road_cut")
    assert [label for label, _ in legend] == [
        "rock - rock, joint bedding: 1,088 m2, 30 deg, c_r 40000 Pa, bonded c 4e+04 T 0 Pa",
        "rock - rock, joint steep: 1,000 m2, 35 deg",
        "bolts anchors: 8 of strand5, 22 m",
        "water table: plane",
    ]
    assert (image.max(axis=2) < 40).sum() > 1000  # bolts and their heads
    assert _bluish(image).mean() > 0.005
    reddish = image[..., 0] > image[..., 1:].max(axis=2) + 20
    greenish = image[..., 1] > image[..., [0, 2]].max(axis=2) + 10
    assert reddish.mean() > 0.05
    assert greenish.mean() > 0.02


def test_a_table_is_drawn_where_a_stage_lifts_it(run_cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    legend, image = _inside(run_cli, monkeypatch, "bedded_slope")
    assert [label for label, _ in legend][-2:] == [
        "water table: plane, lifted by -20 m (no table in the rock)",
        "water table, stage rain: plane, lifted by 6 m",
    ]
    assert _bluish(image).mean() > 0.005


def test_open_water_is_drawn_outside_the_rock_at_its_highest(run_cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    legend, image = _inside(run_cli, monkeypatch, "dam")
    assert [label for label, _ in legend][-2:] == [
        "water uplift: formula, in base (no table in the rock)", "reservoir: level 50 m"
    ]  # fmt: skip
    rows, columns = np.nonzero(_bluish(image))
    assert columns.max() < model_picture.SIZE[0] / 2  # upstream of the dam only
    assert rows.max() < model_picture.SIZE[1] / 2
    assert rows.min() > 5  # the whole of it


def test_many_inner_pairs_are_counted_not_drawn(wall_folder, monkeypatch):
    if not can_draw():
        pytest.skip("no OpenGL")
    monkeypatch.setattr(model_picture, "MOST_INNER", 10)
    entries = []
    monkeypatch.setattr(
        model_picture, "labels", lambda e, rows, _: entries.extend(e) or white(rows)
    )
    white = lambda rows: np.full((28 * rows, model_picture.SIZE[0], 3), 255, np.uint8)  # noqa: E731
    model_picture.draw_model(cdem.Simulation("model.yaml", threads=1))
    assert [label for label, _ in entries if "not drawn" in label] == [
        "wall - wall: 78 pair(s), 30 deg, bonded c 1e+06 T 1e+05 Pa (not drawn)"
    ]


@pytest.mark.parametrize("wrong", ["open", "not convex"])
def test_a_refused_body_is_drawn(run_cli, tmp_path, monkeypatch, wrong):
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
    status, said, complaint = run_cli("check", "case.yaml", "--picture", "refused.png")
    assert status == 1
    assert "its faults in red" in said
    image = np.asarray(Image.open("refused.png")).astype(int)
    assert ((image[..., 0] > 150) & (image[..., 1:].max(axis=2) < 80)).sum() > 200
    assert ("not closed" if wrong == "open" else "not convex") in complaint
