"""Surface laws for the core: the faces of each entry of the case."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cdem._native import core as native
from cdem.case.case import Case
from cdem.case.laws import SURFACE_LAWS
from cdem.errors import CaseError
from cdem.mesh.topology import Topology
from cdem.model.blasts import faces_of
from cdem.model.boundaries import impedances
from cdem.model.curves import add_curve
from cdem.model.faces import face_areas, face_normals
from cdem.model.flat_arrays import table
from cdem.model.module import Built, Module, Parts

KINDS = {"surface_triangles": 3, "surface_quads": 4}
"""Sets of faces in the core, with the number of vertices of a face."""


@dataclass
class SurfaceModel(Module):
    """Surface laws of a model.

    Attributes:
        entries: Parts of each entry that no stage may change: surface, law, stage.
        found: Faces of each entry and their initial area [m2].
    """

    name = "surface"
    entries: list[tuple[Any, ...]] = field(default_factory=list)
    found: list[tuple[int, float]] = field(default_factory=list)

    @classmethod
    def of(cls, case: Case, t: Topology, names: list[str]) -> SurfaceModel:
        return cls(_entries(case))

    def add_arrays(self, parts: Parts) -> None:
        case, t, out = parts.case, parts.topology, parts.assembly
        entries = case.surface_entries
        if not entries:
            return
        items: list[Any] = [item for _, item in entries]
        faces, histories = zip(
            *(faces_of(case, t, parts.names, keys, item) for keys, item in entries), strict=True
        )
        of_law = [
            native.surface_numbers(item.law, SURFACE_LAWS[item.law].numbers(item)) for item in items
        ]
        curves = [
            add_curve(history, item.stage, parts.curves)
            for history, item in zip(histories, items, strict=True)
        ]
        first = case.stages[0].name
        out.counts["surface.count"] = len(items)
        out.arrays |= {
            "surface.law": np.array([law for law, _ in of_law], np.int32),
            "surface.curve": np.array(curves, np.int32),
            "surface.parameters": np.array([row for _, row in of_law], float).ravel(),
            "surface.waits": np.array([i.stage not in (None, first) for i in items], np.int8),
        }
        face = np.concatenate(faces)
        entry = np.repeat(np.arange(len(items)), [len(f) for f in faces])
        area = face_areas(t.node_position, t.face_nodes[face])
        normal = face_normals(t.node_position, t.face_nodes[face])
        of_items = np.stack([impedances(case, parts.names, item.stage) for item in items])
        impedance = of_items[entry, t.face_group[face]]
        self.found = [(len(f), float(area[entry == i].sum())) for i, f in enumerate(faces)]
        corners = (t.face_nodes[face] >= 0).sum(axis=1)
        for kind, vertices in KINDS.items():
            some = corners == vertices
            stride = parts.stride(int(some.sum()))
            out.counts[f"{kind}.count"] = int(some.sum())
            nodes = t.face_nodes[face[some]][:, :vertices].T.astype(np.int32)
            out.arrays |= {
                f"{kind}.nodes": table(nodes, stride),
                f"{kind}.entry": table(entry[some][None].astype(np.int32), stride),
                f"{kind}.area": area[some],
                f"{kind}.normal": normal[some].ravel(),
                f"{kind}.impedance": impedance[some].ravel(),
            }

    def refuse_change(self, case: Case, was: dict[str, int], now: dict[str, int]) -> None:
        if _entries(case) != self.entries:
            raise CaseError(
                f"{case.where('loads')}: loads: a stage can change the parameters and the history of an "
                "entry of surfaces or blasts, not its surface, law, stage or detonation; write another "
                "entry with stage:"
            )

    def report(self, build: Built) -> list[dict[str, Any]]:
        rows: dict[tuple[Any, ...], dict[str, Any]] = {}
        for (keys, item), (faces, area) in zip(build.case.surface_entries, self.found, strict=True):
            name = build.case.surface_name(keys)
            empty = {"name": name, "law": item.law, "stage": item.stage, "faces": 0, "area": 0.0}
            row = rows.setdefault(keys, empty)  # all rings of a blast
            row["faces"] += faces
            row["area"] += area
        return list(rows.values())

    def lines(self, report: list[dict[str, Any]]) -> list[str]:
        return [
            f"  {one['name']}: {one['law']} acts on {one['faces']:,} faces, {one['area']:.6g} m2"
            + (f", from the begin of {one['stage']}" if one["stage"] else "")
            for one in report
        ]


def _entries(case: Case) -> list[tuple[Any, ...]]:
    """Surface, law, stage and ring of every entry."""
    return [(item.surface, item.law, item.stage, item.ring) for _, item in case.surface_entries]
