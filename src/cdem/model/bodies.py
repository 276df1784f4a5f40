"""The bodies of a case in one mesh: its mesh file, the blocks made here, and the joints that cut them."""

from __future__ import annotations

import numpy as np

from cdem.case.bodies_schema import Block
from cdem.case.case import Case
from cdem.errors import CaseError
from cdem.joints.discs import read_discs
from cdem.joints.joints import cut_model
from cdem.mesh.mesh import Mesh, merge, place
from cdem.mesh.mesh_files import read_mesh
from cdem.mesh.primitives import box, outward_faces, polyhedron
from cdem.model.body_files import fill_bodies, read_bodies

LARGER = 20
"""Bodies of a file may exceed all others by this factor without a warning."""
FAR_LARGER = 100
"""Above this factor the scale must be given."""
LARGE = 1000.0
"""Largest size without a warning if there are no others [m]."""


def read_model(case: Case, more: Mesh | None = None) -> Mesh:
    """Read and place the mesh file and the blocks of a case, all in one mesh.

    Args:
        case: The case.
        more: Bodies that the caller has made, in their places.
    """
    pieces = []
    model = case.model
    if model.mesh is not None:
        with case.blame("model.mesh"):
            pieces.append(read_mesh(case.path_of(model.mesh)))
    for index, block in enumerate(model.blocks):
        with case.blame(f"model.blocks.{index}"):
            pieces.append(_block(case, block))
    _tell_sizes(case, pieces)
    if not model.joints:
        placed = place(merge(pieces), model.rotate, model.translate)
        return placed if more is None else merge([more, placed])
    pieces = [place(piece, model.rotate, model.translate) for piece in pieces]
    hulls: list[list[list[int]] | None] = [None] * (model.mesh is not None)
    for block in model.blocks:
        body = block.polyhedron
        hulls.append(None if body is None else outward_faces(np.array(body.vertices), body.faces))
    files, notes = {}, list[str]()
    for index, joint in enumerate(model.joints):
        if joint.discs is not None and joint.discs.file is not None:
            with case.blame(f"model.joints.{index}.discs.file"):
                files[joint.name] = read_discs(case.path_of(joint.discs.file), notes)
    with case.blame("model.joints"):
        mesh = cut_model(list(zip(pieces, hulls, strict=True)), model, files)
    mesh.notes += notes
    return mesh


def _tell_sizes(case: Case, pieces: list[Mesh]) -> None:
    """Warn of bodies of files that are unusually large, if no scale is given; refuse far larger ones."""
    sizes = [np.ptp(piece.points, axis=0) for piece in pieces]
    first = len(pieces) - len(case.model.blocks)
    for index, block in enumerate(case.model.blocks, first):
        others = [float(s.max()) for i, s in enumerate(sizes) if i != index]
        most = LARGER * max(others) if others else LARGE
        if block.file is None or block.scale is not None or sizes[index].max() <= most:
            continue
        span = " x ".join(f"{s:,.4g}" for s in sizes[index])
        beside = f"; the other bodies span up to {max(others):.4g} m" if others else ""
        said = (
            f"{block.file} spans {span} m if its numbers are metres{beside}. If they are "
            "millimetres, write scale: 0.001 beside the file, otherwise scale: 1"
        )
        if others and sizes[index].max() > FAR_LARGER * max(others):
            with case.blame(f"model.blocks.{index - first}"):
                raise CaseError(said)
        pieces[index].notes.append(f"model.blocks.{index - first}: {said}")


def _block(case: Case, block: Block) -> Mesh:
    if block.file is not None and block.size is not None:
        piece = fill_bodies(case.path_of(block.file), block.group, block.size, block.scale or 1)
    elif block.file is not None:
        piece = read_bodies(case.path_of(block.file), block.group, block.scale or 1)
    elif block.box is not None:
        b = block.box
        piece = box(block.group, b.size, b.divisions, shape=b.shape, mirrored=b.cells != "alike")
    else:
        assert block.polyhedron is not None
        piece = polyhedron(block.group, block.polyhedron.vertices, block.polyhedron.faces)
    return place(piece, block.rotate, block.translate)


def check_groups(case: Case, names: list[str]) -> None:
    """Refuse a case whose groups differ from the groups of the model.

    Args:
        case: The case.
        names: Groups of the model.
    """
    listed = ", ".join(names)
    if case.model.mesh is not None and "default" in names:
        listed += "; elements without a group in the mesh file are in 'default'"
    for name in names:
        if name not in case.groups:
            raise CaseError(
                f"{case.where('groups')}: groups: group {name!r} of the model is missing; "
                f"give it a material (the model has: {listed})"
            )
    for name in case.groups:
        if name not in names:
            raise CaseError(
                f"{case.where(f'groups.{name}')}: groups.{name}: no such group in the model; "
                f"it has: {listed}"
            )
    for name in case.model.split:
        if name not in names:
            raise CaseError(
                f"{case.where(f'model.split.{name}')}: model.split.{name}: no such group in the "
                f"model; it has: {listed}"
            )
