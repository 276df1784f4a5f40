"""Triangulated surfaces, and their files in every format that is read."""

from __future__ import annotations

from pathlib import Path

import numpy as np

KINDS = ("obj", "stl", "bin.stl", "ply", "bin.ply", "ts", "dxf")


def sheet(height, x, y):
    """Points and triangles over the lines x and y of a grid, with diagonals that alternate."""
    xx, yy = np.meshgrid(x, y)
    points = np.column_stack([xx.ravel(), yy.ravel(), height(xx.ravel(), yy.ravel())])
    rows, columns = len(y), len(x)
    triangles = []
    for j in range(rows - 1):
        for i in range(columns - 1):
            a, b = j * columns + i, j * columns + i + 1
            c, d = b + columns, a + columns
            some = [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
            triangles += some
    return points, np.array(triangles)


def write(path: Path, points, triangles, **more):
    """Write a surface in the format of its ending; `.bin.stl` and `.bin.ply` are binary."""
    kind = path.suffix
    if kind == ".obj":
        path.write_text(obj_text(points, triangles))
    elif kind == ".ts":
        path.write_text(gocad_text(points, triangles, **more))
    elif kind == ".dxf":
        path.write_text(dxf_text(points, triangles, **more))
    else:
        import meshio

        mesh = meshio.Mesh(points, [("triangle", np.asarray(triangles, np.int32))])
        mesh.write(path, binary=".bin" in path.suffixes)
    return path


def obj_text(points, triangles):
    """Wavefront OBJ."""
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(points, float).tolist()]
    return "\n".join(rows + ["f {} {} {}".format(*(t + 1)) for t in np.asarray(triangles)]) + "\n"


def gocad_text(points, triangles, system="", head="name:surface"):
    """GOCAD TSurf, in one part."""
    rows = [
        f"VRTX {n} {x!r} {y!r} {z!r}"
        for n, (x, y, z) in enumerate(np.asarray(points, float).tolist(), start=1)
    ]
    rows += ["TRGL {} {} {}".format(*(t + 1)) for t in np.asarray(triangles)]
    return "\n".join(
        ["GOCAD TSurf 1", "HEADER {", head, "}", *([system] if system else []), "TFACE", *rows]
        + ["BSTONE 1", "BORDER 9 1 2", "END", ""]
    )


def dxf_text(points, triangles, layer="SURFACE", more=()):
    """DXF with a 3DFACE for each triangle, and further entities."""
    lines = ["0", "SECTION", "2", "ENTITIES", *more]
    for triangle in np.asarray(triangles):
        lines += ["0", "3DFACE", "8", layer]
        for corner, at in enumerate([*triangle, triangle[2]]):
            for axis in range(3):
                lines += [str(10 * (axis + 1) + corner), repr(float(points[at][axis]))]
    return "\n".join([*lines, "0", "ENDSEC", "0", "EOF", ""])
