"""Report on a model before the first step: counts, groups, interfaces, step, memory, warnings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem._native import digests
from cdem.case.laws import BLOCK_LAWS
from cdem.errors import CaseError
from cdem.mesh.arrays import in_pieces, lengths
from cdem.mesh.element_shapes import NODES, SLIVER
from cdem.model.blast_doubts import blast_doubts
from cdem.model.boundary_doubts import boundary_doubts
from cdem.model.build import Build
from cdem.model.charges import charge_lines, charges
from cdem.model.compliance import bonded_interfaces, coarse_beams
from cdem.model.contact_overlaps import contact_interfaces
from cdem.model.damping_doubts import damping_doubts
from cdem.model.damping_report import rock_dampings
from cdem.model.disc_areas import disc_areas, disc_lines, weak_bridges
from cdem.model.held import unheld_blocks
from cdem.model.meshed_strength import meshed_strengths, strength_text
from cdem.model.model_warnings import crowded_edges, idle_bonds, uneven_tiles, unlike_sides
from cdem.model.options import pairs_loose_joints
from cdem.model.rigid_bases import base_lines, rigid_bases
from cdem.model.ruling_step import remedy, ruling_step
from cdem.model.slips import slips
from cdem.model.wave_mesh import highest_frequency, wave_doubts, wave_lines, wave_mesh
from cdem.model.wetted import idle_water, wet_bonds
from cdem.seismic.measures import measures
from cdem.seismic.tables import record_lines

SOFT = 30.0
"""Compliance of the interfaces, in the softest direction, above which the audit warns [%]."""


class Audit:
    """Report on a model that is ready to run.

    Args:
        build: The model, prepared.
        overlap: Overlap of the blocks at the start: depth [m], number of vertices, a face.
        threads: Number of threads for the run.

    Attributes:
        counts: Nodes, elements, blocks, faces, semi-springs, semi-edges, bonded pairs.
        warnings: Warnings for the user.
    """

    def __init__(self, build: Build, overlap: tuple[float, int, int], threads: int) -> None:
        self._build = build
        self._overlap = overlap
        self._threads = threads
        t = build.topology
        corners = (t.face_nodes >= 0).sum(axis=1)
        counts = build.assembly.counts
        self.counts = {
            "nodes": len(t.node_position),
            "elements": sum(len(e) for e in t.element_nodes.values()),
            "blocks": len(t.block_group),
            "faces": len(t.face_nodes),
            "semi_springs": int(corners.sum()),
            "semi_edges": int(corners.sum()),
            "bonded_pairs": sum(counts[f"{k}.count"] for k in ("triangles", "quads", "overlaps")),
        }
        self.groups = self._groups()
        self.interfaces = bonded_interfaces(build)
        self.contacts = contact_interfaces(build)
        self.compensation = self._compensation()
        self.discs = disc_areas(build)
        self.modules = {name: module.report(build) for name, module in build.modules.items()}
        self.step = self._step()
        self.damping = rock_dampings(build, self.interfaces)
        self.frequency = highest_frequency(build.case)
        self.charges = charges(build)
        self.wave_mesh = wave_mesh(build, self.interfaces, self.frequency)
        self.rigid_bases = rigid_bases(build, self.wave_mesh)
        self.warnings = self._warnings()

    # ------------------------------------------------------------------ parts

    def _groups(self) -> dict[str, dict[str, Any]]:
        b = self._build
        t = b.topology
        out = {}
        for index, name in enumerate(b.group_names):
            nodes = b.nodes_of(name)
            volume = mass = elements = 0.0
            for shape in NODES:
                some = t.element_group[shape] == index
                volume += b.assembly.element_volume[shape][some].sum()
                mass += b.assembly.element_mass[shape][some].sum()
                elements += int(some.sum())
            out[name] = {
                "law": b.case.materials[b.case.groups[name].material].law,
                "blocks": int((t.block_group == index).sum()),
                "elements": int(elements),
                "nodal_means": self._nodal_means(index),
                "volume": float(volume),
                "mass": float(mass),
                "low": b.start_position[nodes].min(axis=0).tolist(),
                "high": b.start_position[nodes].max(axis=0).tolist(),
            }
        return out

    @property
    def absent(self) -> dict[str, str]:
        """Groups absent at the start, and the stages that first add them."""
        case = self._build.case
        return {
            name: next(stage.name for stage in case.stages if name in stage.add)
            for name in case.absent(0)
        }

    def _nodal_means(self, group: int) -> int:
        """Tets of a group whose dilatation is averaged at their nodes."""
        of = self._build.topology.element_group["tet4"]
        averaged = self._build.arrays["tet4.nodal_mean"][: len(of)]
        return int(averaged[of[: len(averaged)] == group].sum())

    def _compensation(self) -> dict[str, dict[str, Any]]:
        b, out = self._build, {}
        for name, made_up in b.compensation.items():
            rock = b.case.materials[b.case.groups[name].material]
            numbers = vars(made_up).copy()
            del numbers["state"], numbers["of_faces"]
            out[name] = numbers | {
                "young_modulus": made_up.stiffening * rock.young_modulus,
                "poisson_ratio": made_up.stiffening * rock.poisson_ratio,
            }
        return out

    def _step(self) -> dict[str, Any]:
        b = self._build
        ruling = ruling_step(b)
        dt = float(b.core.scalars()["dt"])
        if not dt > 0:
            raise CaseError(
                f"the stable time step is {ruling.limit:.3g} s, for group {ruling.group}: the "
                f"model "
                "could not move; check its density, Young's modulus and damping, and the stiffness "
                "of "
                "its interfaces"
            )
        return asdict(ruling) | {
            "dt": dt,
            "rules": ruling.rules,
            "words": ruling.words(),
            "remedy": remedy(b, ruling, dt),
            "added_mass": float(b.assembly.added_mass.sum()),
        }

    @cached_property
    def meshed_strength(self) -> dict[str, dict[str, Any]]:
        """Result of `meshed_strengths`: takes about a second per group, so it is computed on demand."""
        return meshed_strengths(self._build)

    def _slivers(self) -> int:
        t = self._build.topology

        def thin(nodes: NDArray, volume: NDArray) -> NDArray[np.bool_]:
            tets = t.node_position[nodes]
            sides = tets[:, [1, 2, 3, 2, 3, 3]] - tets[:, [0, 0, 0, 1, 1, 2]]
            longest = lengths(sides).max(axis=1)
            # two sides of each face, split at the corner opposite the first triangle
            area = lengths(np.cross(sides[:, [0, 0, 1, 3]], sides[:, [1, 2, 2, 4]])).max(axis=1)
            return 6 * volume / area < SLIVER * longest

        volume = self._build.assembly.element_volume["tet4"]
        return int(in_pieces(thin, t.element_nodes["tet4"], volume).sum())

    def _unheld_blocks(self) -> dict[str, int]:
        """Blocks of each group that no support, bond or contact holds at the start."""
        b, t = self._build, self._build.topology
        out = np.isin(t.block_group, [b.group_names.index(name) for name in b.case.absent(0)])
        names = [b.group_names[g] for g in t.block_group[unheld_blocks(b, out)]]
        return {name: names.count(name) for name in dict.fromkeys(names)}

    def _soft_interfaces(self) -> Iterator[str]:
        for row in self.interfaces:  # joints are soft on purpose; the table has their compliance
            made_up = set(row["between"]) <= self.compensation.keys()
            if row["compliance_percent"] > SOFT and not made_up and not row["joint"]:
                yield (
                    f"the interface {_place(row)} adds {row['compliance_percent']:.0f} % compliance in "
                    "tension and bending; raise its stiffness_n"
                )

    def _pulled(self) -> Iterator[str]:
        for i in self._build.initial.pulled if self._build.initial else []:
            yield (
                f"{self._build.case.where(f'initial_stress.{i}')}: initial_stress.{i} gives "
                f"tension in "
                "all directions everywhere; tension is positive, write pressure with a minus sign"
            )

    def _warnings(self) -> list[str]:
        b = self._build
        out = [*b.case.warnings, *b.mesh.notes, *crowded_edges(b.topology)]
        out += weak_bridges(b, {row["joint"] for row in self.interfaces})
        out += idle_bonds(b)
        out += uneven_tiles(b)
        out += unlike_sides(b)
        out += idle_water(b, self.modules["water"])
        out += wet_bonds(b, {row["joint"] for row in self.interfaces if row["joint"]})
        unheld = self._unheld_blocks()
        out += slips(b, self._threads, unheld)
        if any(s.mode == "static" for s in b.case.stages):
            for name, count in unheld.items():
                blocks = "1 block has" if count == 1 else f"{count:,} blocks have"
                out.append(
                    f"group {name}: {blocks} no support, direct or through others, at the start; in "
                    "a static stage they move until something stops them"
                )
        depth, count, face = self._overlap
        if count:
            block = int(b.topology.face_block[face])
            group = b.group_names[b.topology.block_group[block]]
            out.append(
                f"blocks overlap at the start: {count} vertices, up to {depth:.3g} m (block {block} "
                f"of group {group}); the overlap counts as free of stress. Correct the mesh unless "
                f"the "
                "overlap is intended"
            )
        out += blast_doubts(b)
        out += boundary_doubts(b)
        out += damping_doubts(b.case)
        out += wave_doubts(b.case, self.wave_mesh, self.frequency)
        out += self._pulled()
        if b.case.time.step != "auto" and self.step["dt"] > self.step["limit"]:
            out.append(
                f"time.step {self.step['dt']:.4g} s is above the stable {self.step['limit']:.4g} s; "
                "the run will blow up: give a smaller one, or auto"
            )
        slivers = self._slivers()
        if slivers:
            out.append(
                f"{slivers} sliver elements (height below {SLIVER:.0%} of the longest edge) shorten "
                "the time step; remesh, or use time.mass_scaling"
            )
        out += self._soft_interfaces()
        out += coarse_beams(b)
        if b.assembly.lumped_blocks:
            out.append(
                f"{b.assembly.lumped_blocks} large blocks one element thick keep lumped masses: "
                "their rotational inertia is too large"
            )
        if self.step["added_mass"]:
            share = self.step["added_mass"] / b.assembly.free_mass
            out.append(
                f"mass scaling adds {self.step['added_mass']:.3g} kg "
                f"({100 * share:.2g} % of the mass of free nodes)"
            )
        return out

    def refuse_warnings(self) -> None:
        """Raise a CaseError of all warnings, if there are any."""
        if self.warnings:
            count = "1 warning" if len(self.warnings) == 1 else f"{len(self.warnings)} warnings"
            raise CaseError("\n".join([*self.warnings, f"{count}, which --strict does not allow"]))

    # ------------------------------------------------------------------ output

    @property
    def memory(self) -> int:
        """Bytes of the arrays of model and state in the core; without temporary arrays of a step,
        and without the mesh in Python."""
        arrays = [*self._build.core.fields().values(), *self._build.arrays.values()]
        return sum(a.nbytes for a in arrays)

    def as_dict(self) -> dict[str, Any]:
        """All results of the report, ready for JSON."""
        return {
            "own_laws": digests,
            "counts": self.counts,
            "groups": self.groups,
            "absent": self.absent,
            "interfaces": self.interfaces,
            "compensation": self.compensation,
            "meshed_strength": self.meshed_strength,
            "contacts": self.contacts,
            "discs": self.discs,
            **self.modules,
            "charges": [one.as_dict() for one in self.charges],
            "wave_mesh": self.wave_mesh,
            "rigid_bases": self.rigid_bases,
            "initial_stress": self._build.initial.as_dict() if self._build.initial else None,
            "time_step": self.step,
            "records": {name: self._record(name) for name in self._build.case.records},
            "damping": [one.as_dict() for one in self.damping],
            "memory_bytes": self.memory,
            "warnings": self.warnings,
        }

    def text(self, estimate: str = "") -> str:
        """The report as a page of text, with lines on the cost of the run."""
        lines = [self._build.case.title or "untitled case", ""]
        lines += [
            f"  {key.replace('_', ' '):<14}{value:>12,}" for key, value in self.counts.items()
        ]
        lines += [
            "",
            f"  {'group':<18}{'blocks':>9}{'elements':>10}{'volume [m3]':>14}{'mass [kg]':>14}",
        ]
        for name, g in self.groups.items():
            lines.append(
                f"  {name:<18}{g['blocks']:>9,}{g['elements']:>10,}{g['volume']:>14.6g}"
                f"{g['mass']:>14.6g}"
            )
        lines += [f"  absent before the stage {at!r}: {n}" for n, at in self.absent.items()]
        flow = {name: g for name, g in self.groups.items() if BLOCK_LAWS[g["law"]].flows}
        lines += [""] * bool(flow)
        lines += [f"  {name}: {_flow_text(g)}" for name, g in flow.items()]
        low = np.min([g["low"] for g in self.groups.values()], axis=0)
        high = np.max([g["high"] for g in self.groups.values()], axis=0)
        spans = ", ".join(f"{a:.10g} .. {b:.10g}" for a, b in zip(low, high, strict=True))
        lines += [""] * bool(digests)
        lines += [f"  own law: {name}, sha256 {d[:16]}..." for name, d in digests.items()]
        lines += ["", f"  extent x, y, z [m]: {spans}"]
        lines += self._interfaces_text()
        lines += strength_text(self.meshed_strength)
        lines += [""] * bool(self.discs) + disc_lines(self.discs)
        lines += self._stiffness_text()
        lines += self._initial_text()
        lines += self._modules_text()
        lines += base_lines(self.rigid_bases)
        lines += self._records_text()
        lines += charge_lines(self.charges)
        lines += wave_lines(self.wave_mesh, self.frequency)
        s = self.step
        lines += [
            "",
            f"  time step {s['dt']:.4g} s, stable below {s['limit']:.4g} s; {s['words']} rule it",
            *([f"    {s['remedy']}"] if s["remedy"] else []),
            *self._damping_text(),
            f"  memory of model and state {self.memory / 1e6:,.0f} MB",
        ]
        if estimate:
            lines.append(estimate.rstrip())
        lines += [""] + [f"  warning: {w}" for w in self.warnings]
        return "\n".join(lines).rstrip() + "\n"

    def _damping_text(self) -> list[str]:
        """Lines on the damping of rock in each stage."""
        return [line for one in self.damping for line in one.lines()]

    def _interfaces_text(self) -> list[str]:
        """Lines on pairs of faces that are bonded, or that begin broken."""
        lines: list[str] = []
        if self.interfaces:
            loose = pairs_loose_joints(self._build.case)
            lines += [
                "",
                "  bonded interfaces" + (", and joints without strength" if loose else ""),
            ]
        for row in self.interfaces:
            adds = "compensated by the elements"
            if not set(row["between"]) <= self.compensation.keys():
                adds = (
                    f"adds {row['compliance_percent']:.3g} % compliance in tension and bending, "
                    f"{row['shear_compliance_percent']:.3g} % in shear"
                )
            weakest, strongest = row["strength_factors"]
            varies = f", strength times {weakest:.3g} .. {strongest:.3g}" if weakest < 1 else ""
            lines.append(
                f"    {_place(row)}: {row['bonded_pairs']:,} pairs, "
                f"{row['area']:.6g} m2, k_n {row['stiffness_n'][0]:.3g} .. "
                f"{row['stiffness_n'][1]:.3g} Pa/m, {adds}{varies}"
            )
        return lines

    def _initial_text(self) -> list[str]:
        """Lines on the initial stress."""
        initial = self._build.initial
        if initial is None:
            return []
        spans = (
            f"{a:.3g} .. {b:.3g}" for a, b in zip(initial.lowest, initial.highest, strict=True)
        )
        lines = ["", f"  initial stress xx, yy, zz [Pa], tension positive: {', '.join(spans)}"]
        if initial.cut:
            place = ", ".join(f"{x:.4g}" for x in initial.cut_at or [])
            lines.append(
                f"    {initial.cut:,} points of joints and bonds cannot carry it and begin at "
                f"their "
                f"strength: up to {initial.most_cut:.3g} Pa less (near {place})"
            )
        return lines

    def _modules_text(self) -> list[str]:
        """Lines of the modules."""
        modules = self._build.modules.items()
        return [line for name, module in modules for line in module.lines(self.modules[name])]

    def _record(self, name: str) -> dict[str, float]:
        """Measures of a processed record."""
        return measures(self._build.case.processed(name))._asdict()

    def _records_text(self) -> list[str]:
        """Lines on the records, as read and as used."""
        case, lines = self._build.case, [""] * bool(self._build.case.records)
        for name, record in case.records.items():
            (first, before), *_ = record.steps()
            told = record_lines(name, [(first, before), ("processed", case.processed(name))])
            lines += [f"  {line}" for line in told]
        return lines

    def _stiffness_text(self) -> list[str]:
        """Lines on the compensation for bonds, and on overlaps of contacts."""
        lines = ["", "  elements stiffened to compensate bonds"] if self.compensation else []
        for name, c in self.compensation.items():
            young, shear, bulk = (100 * error for error in c["errors"])
            along = ", ".join(f"{round(100 * e, 1) + 0.0:+.1f}" for e in c["along_xyz"])
            lines.append(
                f"    {name}: E {c['young_modulus']:.4g} Pa, nu {c['poisson_ratio']:.3g}, bonds of "
                f"{c['stiffness']:.3g} Pa/m (q {c['q']:.3g}, faces "
                f"{c['area_per_volume']:.3g} m2/m3, h {c['height']:.3g} m); remaining error in E "
                f"up to "
                f"{young:+.2g} %, in G {shear:+.2g} %, in K {bulk:+.2g} %; in E of the whole, "
                f"including its "
                f"surfaces, along x, y, z {along} %"
            )
        lines += ["", "  contacts"]
        for row in self.contacts:
            low, high = row["stiffness_n"]
            lines.append(
                f"    {row['interface']}: k_n {low:.3g} .. {high:.3g} Pa/m; blocks overlap by up to "
                f"{100 * row['overlap_under_weight']:.2g} % of an element under "
                f"{row['height']:.3g} m of rock, {100 * row['overlap_at_speed']:.2g} % at "
                f"{row['speed']:.3g} m/s"
            )
            if row["curve_end"] == 0:
                lines[-1] += (
                    "; joints do not follow a closure curve: k_n is below their initial stiffness"
                )
            elif row["curve_end"] is not None:
                lines[-1] += (
                    f"; joints follow a closure curve up to {row['curve_end']:.3g} Pa, and from "
                    f"there on they "
                    "are as stiff as k_n, which determines the step"
                )
            if row["restitution"] < 1 and self.step["rules"] == "contact":
                lines[-1] += (
                    f"; restitution {row['restitution']:g} makes them "
                    f"{row['restitution'] ** -2:.3g} times as stiff in unloading, which shortens the step"
                )
        return lines


def _flow_text(group: dict[str, Any]) -> str:
    """Lines on elements of a group with a plastic material."""
    means = f", {group['nodal_means']:,} with nodal mean" if group["nodal_means"] else ""
    return f"{group['elements']:,} elements of law {group['law']}{means}"


def _place(row: dict[str, Any]) -> str:
    """Groups, and joint set if any, of a row of interfaces."""
    joint = f", joint {row['joint']}" if row["joint"] else ""
    return " - ".join(row["between"]) + joint
