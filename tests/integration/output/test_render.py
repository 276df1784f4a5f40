"""Pictures of results name the groups."""

from __future__ import annotations

import pytest

import cdem
from cdem.output import render
from cdem.output.reader import SurfaceSeries
from cdem.output.render import can_draw


def has(image, color: str) -> bool:
    rgb = [int(color[i : i + 2], 16) for i in (1, 3, 5)]
    return bool((image == rgb).all(axis=2).any())


def test_pictures_of_results_name_the_groups(wall_folder, monkeypatch):
    if not can_draw():
        pytest.skip("no OpenGL")
    cdem.Simulation("model.yaml", output="r.results", threads=1).run()
    series = SurfaceSeries(wall_folder / "r.results")
    legends = []
    legend = render.labels
    monkeypatch.setattr(render, "labels", lambda e, *size: legends.append(e) or legend(e, *size))
    image = render.picture([series[0]], "group", titles=["before"])
    assert [label for label, _ in legends[0]] == ["base", "wall", "loose"]
    rows = len(image) - 28 * 3 - 10
    assert all(has(image[rows:], color) for _, color in legends[0])
