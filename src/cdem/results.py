"""The result folder of a run: what is written when, and how a resumed run goes on with it."""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem import __version__
from cdem.build import bonded_pairs, interfaces_of
from cdem.errors import CdemError
from cdem.record import (
    FrameWriter,
    HistoryWriter,
    SurfaceWriter,
    read_checkpoint,
    write_checkpoint,
    write_json_atomic,
)
from cdem.topology import components

if TYPE_CHECKING:
    from cdem.simulation import Simulation

ENERGIES = ("kinetic", "strain", "contact")
WORKS = ("friction", "damping", "fracture", "external")


RESULT_FILES = {"case.yaml", "run.log", "summary.json", "checkpoint.h5"}
"""A folder that holds one of these is a result folder."""


def _guard(folder: Path, *, overwrite: bool, resume: bool) -> None:
    """Stop before anything is computed if the folder must not be written to."""
    if folder.exists() and not folder.is_dir():
        raise CdemError(f"{folder}: is a file; name another folder with -o")
    inside = {path.name for path in folder.iterdir()} if folder.exists() else set()
    if resume:
        if "checkpoint.h5" not in inside:
            raise CdemError(f"{folder}: no checkpoint to resume from; run without --resume")
    elif inside and not overwrite:
        raise CdemError(
            f"{folder}: exists already; use --overwrite to replace it, --resume to go on, or -o "
            "for another folder"
        )
    elif inside and not inside & RESULT_FILES:
        raise CdemError(f"{folder}: is not a result folder, so it is not overwritten")


class Results:
    """Writes the result folder of one simulation.

    Args:
        folder: The result folder.
        overwrite: Empty an existing folder.
        resume: Go on in an existing one.

    Raises:
        CdemError: The folder exists and neither was asked for, it holds other things than results, or
            there is nothing to resume.
    """

    def __init__(self, folder: Path, *, overwrite: bool, resume: bool) -> None:
        self.folder = folder
        _guard(folder, overwrite=overwrite, resume=resume)
        self.overwrite = overwrite
        self.rows = 0
        self.frames = 0
        self.tracks: list[tuple[str, Any]] = []
        self._history: HistoryWriter
        self._volume: FrameWriter | None = None
        self._surface: SurfaceWriter | None = None

    # ------------------------------------------------------------------ opening

    def open(self, sim: Simulation) -> None:
        """Create the folder; nothing is written before the model has been built."""
        if self.overwrite and self.folder.exists():
            shutil.rmtree(self.folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / "case.yaml").write_text(sim.case.dump())
        (self.folder / "run.log").write_text("")
        self.log(sim.audit.text())
        self._open_series(sim, None, None)

    def reopen(self, sim: Simulation, attributes: dict[str, Any]) -> None:
        """Go on with the files of an interrupted run, cut back to its checkpoint."""
        self.rows, self.frames = int(attributes["rows"]), int(attributes["frames"])
        self._open_series(sim, self.frames, self.rows)
        self.log(f"resumed at step {sim.step_count}, t = {sim.time:.6g} s")

    def _open_series(self, sim: Simulation, frames: int | None, rows: int | None) -> None:
        t = sim.build.topology
        self.tracks = tracks(sim)
        columns = [
            "time [s]", "step",
            *(f"{e} energy [J]" for e in ENERGIES), *(f"{w} work [J]" for w in WORKS),
            "energy error", "unbalance ratio", "broken tension", "broken shear",
        ]  # fmt: skip
        columns += [name for name, _ in self.tracks]
        self._history = HistoryWriter(self.folder / "histories.csv", columns, keep_rows=rows)
        if not sim.case.output.frames:
            return
        static = {
            "group": np.concatenate(list(t.element_group.values())),
            "block": np.concatenate(list(t.element_block.values())),
        }
        self._volume = FrameWriter(
            self.folder / "frames.vtkhdf", t.element_nodes, static, resume_steps=frames
        )
        self._volume.name_groups(sim.build.group_names)
        self._surface = SurfaceWriter(self.folder / "surface.vtkhdf", resume_steps=frames)

    # ------------------------------------------------------------------ writing

    def log(self, text: str) -> None:
        """Add a line to run.log."""
        with (self.folder / "run.log").open("a") as file:
            file.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')} {text}\n")

    def record(self, sim: Simulation, frame: bool) -> None:
        """Write a history row, and a frame of the fields with it if asked."""
        e = sim.energies
        broken = sim.broken
        row = [sim.time, sim.step_count]
        row += [e[name] for name in (*ENERGIES, *WORKS)]
        row += [e["error"], sim.core.unbalance_ratio(), broken["tension"], broken["shear"]]
        row += [value() for _, value in self.tracks]
        self._history.append(row)
        self.rows += 1
        if frame and self._volume is not None and self._surface is not None:
            fields = sim.fields
            wanted = sim.case.output.fields
            points: dict[str, NDArray] = {
                n: fields[n] for n in ("displacement", "velocity") if n in wanted
            }
            whole: dict[str, NDArray] = {"damage": damage_of(sim), "piece": pieces_of(sim)}
            cells: dict[str, NDArray] = {n: v for n, v in whole.items() if n in wanted}
            if "stress" in wanted:
                cells["stress"] = stress_of(sim)
            self._volume.append(sim.time, fields["position"], points, cells)
            self._surface.append(sim.time, *surface_of(sim, points, whole))
            if self._surface.frames == 1:
                self._surface.name_groups(sim.build.group_names)
            self.frames += 1

    def checkpoint(self, sim: Simulation) -> None:
        """Write the checkpoint."""
        arrays = dict(sim.core.fields())
        arrays["simulation.reference"] = sim.reference
        attributes = sim.attributes() | {"rows": self.rows, "frames": self.frames}
        write_checkpoint(self.folder / "checkpoint.h5", arrays, attributes)

    def read_checkpoint(self, sim: Simulation) -> tuple[dict[str, NDArray], dict[str, Any]]:
        """Read the checkpoint and make sure that it belongs to the same model."""
        arrays, attributes = read_checkpoint(self.folder / "checkpoint.h5")
        nodes = len(sim.build.topology.node_position)
        if arrays["simulation.reference"].shape != (nodes, 3):
            raise CdemError(
                f"{self.folder / 'checkpoint.h5'}: belongs to another model "
                f"({len(arrays['simulation.reference'])} nodes, this one has {nodes}); "
                "resume with the case that was run"
            )
        if attributes.get("nodes") != sim.build.fingerprint:
            raise CdemError(
                f"{self.folder / 'checkpoint.h5'}: belongs to another model, with other elements or "
                "groups, or whose nodes begin at other places or are numbered otherwise; resume with "
                f"the case, the mesh and the cdem that were run ({attributes['version']}; this is {__version__})"
            )
        return arrays, attributes

    def finish(self, sim: Simulation, status: str) -> None:
        """Write the summary; the report is made from the folder alone."""
        write_json_atomic(self.folder / "summary.json", sim.summary(status))
        self.log(f"{status} at step {sim.step_count}, t = {sim.time:.6g} s")

    def fail(self, sim: Simulation) -> None:
        """Record where a run failed."""
        write_json_atomic(self.folder / "summary.json", sim.summary("failed"))
        self.log(f"failed at step {sim.step_count}, t = {sim.time:.6g} s")


def surface_of(
    sim: Simulation, points: dict[str, NDArray], elements: dict[str, NDArray]
) -> tuple[NDArray, NDArray, dict[str, NDArray], dict[str, NDArray]]:
    """Outer and broken faces now: positions, vertices of the faces (-1 after a triangle's), fields.

    Args:
        sim: The simulation.
        points: Fields on its nodes, to be carried over to the points of the surface.
        elements: Fields on its elements, to be carried over to their faces.
    """
    t = sim.build.topology
    faces, broken = visible_faces(sim)
    nodes = t.face_nodes[faces]
    used = np.unique(nodes[nodes >= 0])
    number = np.full(len(t.node_position) + 1, -1, np.int32)
    number[used] = np.arange(len(used))
    return (
        sim.fields["position"][used],
        number[nodes],
        {name: values[used] for name, values in points.items()},
        {
            "group": t.face_group[faces],
            "block": t.face_block[faces],
            **{name: values[t.face_element[faces]] for name, values in elements.items()},
            "broken": broken.astype(np.int8),
            "joint": (t.face_kind // len(t.group_names))[faces],  # 0: not made by a set of joints
        },
    )


def bonds_of(sim: Simulation) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Bonded pairs of faces, shape (pairs, 2), and the part of each one's bond points that holds."""
    b = sim.build
    state = sim.core.fields()
    faces, intact = [], []
    for kind, points in (("triangles", 3), ("quads", 4)):
        pairs = b.assembly.counts[f"{kind}.count"]
        faces.append(b.assembly.pair_faces[kind])
        intact.append(state[f"{kind}.bond"].reshape(points, -1)[:, :pairs].mean(axis=0))
    if b.assembly.counts["overlaps.count"]:
        first = b.topology.overlap_first
        faces.append(b.topology.overlap_faces)
        intact.append(np.add.reduceat(state["overlaps.bond"], first[:-1]) / np.diff(first))
    return np.concatenate(faces), np.concatenate(intact)


def damage_of(sim: Simulation) -> NDArray[np.float64]:
    """Broken part of the bonded faces of each element, 0 to 1, shapes one after the other."""
    t = sim.build.topology
    count = sum(len(e) for e in t.element_nodes.values())
    broken, total = np.zeros(count), np.zeros(count)
    faces, intact = bonds_of(sim)
    for side in range(2):
        element = t.face_element[faces[:, side]]
        np.add.at(broken, element, 1 - intact)
        np.add.at(total, element, 1.0)
    return broken / np.maximum(total, 1)


def pieces_of(sim: Simulation) -> NDArray[np.int32]:
    """Piece of each element, shapes one after the other: the least block that it hangs together with.

    Blocks hang together through every pair of faces of which a bond point still holds, and whose
    interface has a strength: one whose cohesion and tension a stage has set to zero joins nothing.
    """
    t = sim.build.topology
    laws, interface = interfaces_of(sim.case, sim.build.group_names)
    faces, intact = bonds_of(sim)
    kinds = t.face_kind[faces]
    holds = (intact > 0) & bonded_pairs(laws, interface)[kinds[:, 0], kinds[:, 1]]
    a, b = t.face_block[faces[holds]].T
    piece = components(len(t.block_group), a, b)
    return piece[np.concatenate(list(t.element_block.values()))].astype(np.int32)


def stress_of(sim: Simulation) -> NDArray[np.float64]:
    """Mean stress of each element [Pa], xx yy zz xy yz zx, shapes one after the other."""
    tables = sim.core.stress()
    counts = sim.build.assembly.counts
    rows = [tables[shape].reshape(6, -1)[:, : counts[f"{shape}.count"]].T for shape in tables]
    return np.concatenate(rows)


def visible_faces(sim: Simulation) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Outer faces and those whose bonds are all broken; the second says which are the latter."""
    b = sim.build
    state = sim.core.fields()
    glued = np.zeros(len(b.topology.face_nodes), bool)
    bonded = glued.copy()
    for kind, points in (("triangles", 3), ("quads", 4)):
        pairs = b.assembly.counts[f"{kind}.count"]
        faces = b.assembly.pair_faces[kind]
        intact = state[f"{kind}.bond"].reshape(points, -1)[:, :pairs].any(axis=0)
        glued[faces[intact].ravel()] = True
        bonded[faces.ravel()] = True
    shown = np.flatnonzero(~glued)
    return shown, bonded[shown]


def tracks(sim: Simulation) -> list[tuple[str, Any]]:
    """Column name and value of everything that the case's histories follow."""
    units = {"centroid": "m", "displacement": "m", "velocity": "m/s", "force": "N"}
    out: list[tuple[str, Any]] = []
    position = sim.build.start_position
    for entry in sim.case.histories:
        if entry.group is not None:
            nodes = sim.build.nodes_of(entry.group)
        else:
            place = np.asarray(entry.point, float)
            nodes = np.array([np.linalg.norm(position - place, axis=1).argmin()])
        for quantity in entry.quantities:
            if quantity == "energy":
                name = f"{entry.name}.kinetic_energy [J]"
                out.append((name, lambda n=nodes: _kinetic(sim, n)))
                continue
            for axis in range(3):
                name = f"{entry.name}.{quantity}_{'xyz'[axis]} [{units[quantity]}]"
                out.append((name, lambda q=quantity, n=nodes, a=axis: _value(sim, q, n)[a]))
    return out


def _value(sim: Simulation, quantity: str, nodes) -> NDArray[np.float64]:
    fields = sim.fields
    if quantity == "force":  # of supports, which is what a user measures at a loading plate
        return fields["reaction"][nodes].sum(axis=0)
    name = "position" if quantity == "centroid" else quantity
    mass = fields["mass"][nodes]
    return mass @ fields[name][nodes] / mass.sum()


def _kinetic(sim: Simulation, nodes) -> float:
    fields = sim.fields
    return float(0.5 * (fields["mass"][nodes, None] * fields["velocity"][nodes] ** 2).sum())
