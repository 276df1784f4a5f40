"""The picture of `cdem check --picture`: its file, and what is missing."""

from __future__ import annotations

import json
import sys

import numpy as np

from cdem.output import model_picture


def test_json_stays_json_and_the_file_must_be_png(run_cli, wall_folder, monkeypatch):
    monkeypatch.setattr(model_picture, "draw_model", lambda sim: np.zeros((2, 2, 3), np.uint8))
    status, out, _ = run_cli("check", "model.yaml", "--json", "--picture", "model.png")
    assert status == 0
    assert json.loads(out)["counts"]["blocks"] == 56
    assert (wall_folder / "model.png").exists()
    status, out, err = run_cli("check", "model.yaml", "--picture", "model.svg")
    assert (status, out) == (2, "")
    assert "--picture writes PNG" in err


def test_without_the_extra_one_message_says_so(run_cli, wall_folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    status, _, err = run_cli("check", "model.yaml", "--picture", "model.png")
    assert (status, err) == (1, "pictures need pyvista; pip install 'cdem[viz]'\n")
