"""Frames of a run that goes on: only what is whole is read."""

from __future__ import annotations

import numpy as np
from shared.moving import surface

from cdem.output.reader import SurfaceSeries
from cdem.run.frame_files import SurfaceFiles


def test_a_frame_counts_when_its_bolts_are_there_too(tmp_path):
    names = ["bed", "body"]
    surfaces = SurfaceFiles(tmp_path / "surface.vtkhdf", names)
    bolts = SurfaceFiles(tmp_path / "bolts.vtkhdf", names)
    for frame in range(3):
        s = surface(frame)
        surfaces.append(frame, s.time, s.points, s.polygons, s.point_data, s.cell_data)
        if frame < 2:  # the third is being written
            bar = np.array([[0, 1]], np.int32)
            bolts.append(
                frame,
                s.time,
                np.array([[0, 0, 0], [0, 0, 1.0 + frame]]),
                bar,
                {},
                {"axial_force": np.array([5.0])},
            )
    series = SurfaceSeries(tmp_path)
    assert series.times.tolist() == [0, 0.5]
    assert series[-1].bolts.tolist() == [[[0, 0, 0], [0, 0, 2]]]
    assert series[-1].bolt_forces.tolist() == [5]
    read, written = series[1], surface(1)
    assert (read.polygons == written.polygons).all() and (read.points == written.points).all()
    assert read.faces.tolist()[:5] == [4, *written.polygons[0]]
