"""Contradictions within a case: checks between its parts that need no mesh."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Any

from cdem.case.blast_checks import blast_problems
from cdem.case.boundary_checks import boundary_problems
from cdem.case.curve_times import last_dynamic, least_time, over_early, record_users, timed
from cdem.case.input_file import is_file
from cdem.case.laws import BLOCK_LAWS, SURFACE_LAWS, block_contradiction
from cdem.case.map_system import why_not
from cdem.case.plausible import doubts
from cdem.case.record_checks import record_contradictions
from cdem.case.schema import CaseParts, Stage
from cdem.case.softening import softening_problems
from cdem.case.surface_schema import surface_groups
from cdem.case.water_schema import Water
from cdem.errors import CaseError

Problem = tuple[tuple[str | int, ...], str]  # path, problem
SETTABLE = (
    "interfaces.",
    "loads.",
    "groups.",
    "materials.",
    "water.",
)  # another mesh or material is another model
AT_START = ("velocity", "angular_velocity")  # of a group
WHOLE = (("groups",), ("materials",), ("records",))
"""Mappings whose entries are named elsewhere: a wrong one stays when the rest is checked."""
STRENGTHS = {p.name for law in BLOCK_LAWS.values() for p in law.parameters if p.is_strength}
"""Parts of a material that a stage may change."""


def contradictions(case: CaseParts, folder: Path) -> list[Problem]:
    """Return every mismatch between names of the case, and a missing mesh file.

    Args:
        case: The case.
        folder: Start of relative paths in the case.
    """
    return [*_mesh_file(case, folder), *_projection(case), *_maps(case), *_names(case)]


def _projection(case: CaseParts) -> Iterator[Problem]:
    if case.crs is not None and (why := why_not(case.crs)):
        yield ("crs",), why


def _maps(case: CaseParts) -> Iterator[Problem]:
    if case.output.maps and not case.output.maps.groups and not case.movable:
        yield ("output", "maps"), "no group moves: all are fixed in x, y and z; remove maps"


def _names(case: CaseParts) -> Iterator[Problem]:
    yield from _materials(case)
    yield from _initial_stress(case)
    yield from _water(case)
    yield from _groups(case)
    yield from _excavation(case)
    yield from _bolts(case)
    yield from _surfaces(case)
    yield from boundary_problems(case)
    yield from _rock_damping(case)
    yield from blast_problems(case)
    yield from _curves(case)
    yield from record_contradictions(case)
    yield from _joints(case)
    yield from _unique_names(case)


def _surfaces(case: CaseParts) -> Iterator[Problem]:
    names = [stage.name for stage in case.stages]
    for keys, entry in case.surface_entries:
        if (
            keys[0] == "boundaries"
            or not SURFACE_LAWS[entry.law].absorbs
            or entry.stage not in (None, *names)
        ):
            continue
        rest = case.stages[0 if entry.stage is None else names.index(entry.stage) :]
        if static := next((s.name for s in rest if s.mode == "static"), None):
            yield (
                (*keys, "law"),
                f"{entry.law} has dashpots, which carry no static load: the rock would creep away "
                f"in the "
                f"static stage {static}; start it in a later stage (stage: NAME), after all static "
                "ones, and until then hold the faces with supports that this stage removes",
            )
    for i, history in enumerate(case.histories):
        if "surface_force" in history.quantities and not case.surface_entries:
            yield (
                ("histories", i, "quantities"),
                "surface_force needs loads.surfaces or loads.blasts in the case",
            )


def _rock_damping(case: CaseParts) -> Iterator[Problem]:
    """Check that the elements have the dashpots and branches that a stage asks for."""
    way = case.elements.formulation
    if way == "corotational":
        return
    for i, stage in enumerate(case.stages):
        keys = ("stages", i, "damping")
        if stage.damping.maxwell is not None:
            yield (
                (*keys, "maxwell"),
                f"needs elements.formulation: corotational, got {way}",
            )
        elif stage.damping.rayleigh is not None and stage.damping.rayleigh.part == "both":
            yield (
                (*keys, "rayleigh"),
                f"damps stiffness only with elements.formulation: corotational, got {way}; or write "
                "part: mass",
            )


def _water(case: CaseParts) -> Iterator[Problem]:
    for name, material in case.materials.items():
        if (material.saturated_density or material.density) < material.density:
            yield ("materials", name, "saturated_density"), "must be at least density"
    if case.water is None:
        for i, history in enumerate(case.histories):
            if "water_force" in history.quantities:
                yield ("histories", i, "quantities"), "water_force needs water in the case"
        return
    named = [pair.name for pair in case.interfaces.pairs if pair.name is not None]
    for i, field in enumerate(case.water.fields):
        if field.interface is not None and field.interface not in named:
            yield ("water", "fields", i, "interface"), _no("interface", field.interface, named)
    if not _gravity_fits(case.loads.gravity, case.water):
        yield (
            ("loads", "gravity"),
            f"must point along -z in a case with water, got {list(case.loads.gravity)}; only water by "
            "formula or table may go with a horizontal part",
        )


def _gravity_fits(gravity: Sequence[float], water: Water) -> bool:
    """Whether water goes with a direction of gravity: heights of water need that along -z."""
    x, y, z = gravity
    given = all(f.formula is not None or f.table is not None for f in water.fields)
    return z < 0 and ((x == 0 and y == 0) or (given and water.reservoir is None))


def _mesh_file(case: CaseParts, folder: Path) -> Iterator[Problem]:
    if case.model.mesh is not None and not is_file(folder / case.model.mesh):
        path = folder / case.model.mesh
        try:
            names = [p.name for p in path.parent.glob("*") if p.is_file()]
            whole = path.resolve()
        except (OSError, RuntimeError):  # the system refuses such a path
            names, whole = [], path
        near = difflib.get_close_matches(path.name, names, n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        yield (
            ("model", "mesh"),
            f"no file {whole} (a relative path starts at the case file's folder){hint}",
        )


def _materials(case: CaseParts) -> Iterator[Problem]:
    for name, group in case.groups.items():
        if group.material not in case.materials:
            yield ("groups", name, "material"), _no("material", group.material, case.materials)

    for name, material in case.materials.items():
        if why := block_contradiction(material):
            yield ("materials", name), why
        for keys, why in softening_problems(material):
            yield ("materials", name, *keys), why
        rotates = case.elements.formulation == "corotational"
        if BLOCK_LAWS[material.law].flows and not rotates:
            yield (
                ("elements", "formulation"),
                f"must be corotational: material {name} has the law {material.law}, which is "
                f"plastic",
            )


def _initial_stress(case: CaseParts) -> Iterator[Problem]:
    if case.initial_stress and case.elements.formulation != "corotational":
        yield ("elements", "formulation"), "must be corotational with initial_stress"


def _groups(case: CaseParts) -> Iterator[Problem]:
    for keys, name in _group_names(case):
        if name not in case.groups:
            yield keys, _no("group", name, case.groups)


def _excavation(case: CaseParts) -> Iterator[Problem]:
    dug = False
    released = 1.0
    for i, stage in enumerate(case.stages):
        if stage.remove:
            dug, released = True, 0.0
        yield from _presence(case, i)
        if stage.remove and i == 0:
            yield (
                ("stages", 0, "remove"),
                "there are no forces before the first stage to release: begin with a stage that "
                "comes to "
                "rest, or leave the group out of the model",
            )
        if stage.release is not None and not dug:
            yield (
                ("stages", i, "release"),
                "no group has been removed yet; give remove, or leave out release",
            )
        elif stage.release is not None and stage.release.to < released:
            yield (
                ("stages", i, "release", "to"),
                f"must be at least {released:g}, the part that an earlier stage has released",
            )
        if stage.remove or stage.release:
            released = stage.release.to if stage.release else 1.0


def _presence(case: CaseParts, number: int) -> Iterator[Problem]:
    """Check that groups to remove are present, and groups to add are absent."""
    stage = case.stages[number]
    absent = case.absent(number)
    last: dict[str, str] = {}  # last stage that removed or added the group
    for before in case.stages[:number]:
        last |= dict.fromkeys(before.remove + before.add, before.name)
    named = [("remove", *entry) for entry in enumerate(stage.remove)]
    named += [("add", *entry) for entry in enumerate(stage.add)]
    seen: set[str] = set()
    for key, k, name in named:
        why = ""
        if name in seen:
            why = f"the stage names {name} twice"
        elif key == "add" and name not in absent:
            why = f"{name} is present since the stage {last.get(name)!r}"
        elif key == "remove" and name in absent:
            why = f"{name} was removed in the stage {last[name]!r}" if name in last else (
                f"{name} is not present yet: a later stage adds it")  # fmt: skip
        seen.add(name)
        if why:
            yield ("stages", number, key, k), why
    if stage.add and number == 0:
        yield (
            ("stages", 0, "add"),
            "leave it out: groups that no later stage adds are present from the start",
        )


def _bolts(case: CaseParts) -> Iterator[Problem]:
    for i, bolts in enumerate(case.bolts):
        if bolts.type not in case.bolt_types:
            yield ("bolts", i, "type"), _no("bolt type", bolts.type, case.bolt_types)
        elif case.bolt_types[bolts.type].grout is None and not (bolts.plate and bolts.anchor):
            yield (
                ("bolts", i),
                f"no grout, plate or anchor holds both ends: give {bolts.type} grout, or the bolts "
                f"a plate and "
                "an anchor",
            )
        kind = bolts.pattern or bolts.rings
        if kind is not None and bolts.free_length >= kind.length and not bolts.anchor:
            yield (
                ("bolts", i, "free_length"),
                f"must be below the length {kind.length:g}, or the toe needs an anchor",
            )
    yield from _stages_of_bolts(case)
    yield from _histories_of_bolts(case)


def _stages_of_bolts(case: CaseParts) -> Iterator[Problem]:
    stages = [stage.name for stage in case.stages]
    for i, bolts in enumerate(case.bolts):
        wrong = [k for k in ("install", "remove") if getattr(bolts, k) not in (None, *stages)]
        for key in wrong:
            yield ("bolts", i, key), _no("stage", getattr(bolts, key), stages)
        first = bolts.install or stages[0]
        if not wrong and bolts.remove and stages.index(bolts.remove) <= stages.index(first):
            yield (
                ("bolts", i, "remove"),
                f"must be a later stage than {first!r}, which installs the bolts",
            )


def _histories_of_bolts(case: CaseParts) -> Iterator[Problem]:
    names = [bolts.name for bolts in case.bolts]
    for i, history in enumerate(case.histories):
        if history.bolt is None or history.bolt in names:
            continue
        name, _, number = history.bolt.rpartition(".")
        if name not in names or not number.isdigit():
            yield ("histories", i, "bolt"), _no("bolt", history.bolt, names)


def _curves(case: CaseParts) -> Iterator[Problem]:
    """Check that stages named for curves exist, and contain the groups that the curves act on."""
    names = [stage.name for stage in case.stages]
    for keys, entry in timed(case):
        if entry.stage is None:
            continue
        if entry.stage not in names:
            there = ", ".join(names)
            yield (*keys, "stage"), f"no stage '{entry.stage}'; the case has: {there}"
            continue
        surface = getattr(entry, "surface", None)
        groups = surface_groups(surface) or [getattr(entry, "group", None) or ""]
        for group in set(groups) & set(case.absent(names.index(entry.stage) + 1)):
            yield (*keys, "stage"), f"{group} is not present in the stage {entry.stage}"


def _joints(case: CaseParts) -> Iterator[Problem]:
    names = case.model.joint_surfaces
    for i, pair in enumerate(case.interfaces.pairs):
        if pair.joint is not None and pair.joint not in names:
            yield ("interfaces", "pairs", i, "joint"), _no("joint set", pair.joint, names)
    for i, joint in enumerate(case.model.joints):
        if joint.bridges and names.count(joint.bridges) > 1:
            yield ("model", "joints", i, "bridge"), f"'{joint.bridges}' is the name of two surfaces"
    everywhere = any(joint.group is None for joint in case.model.joints)
    cut = {joint.group for joint in case.model.joints}
    for name, kind in case.model.split.items():
        if kind == "one" and names and (everywhere or name in cut):
            yield ("model", "split", name), "joints cut this group, so it cannot be one block"


def _group_names(case: CaseParts) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Every place of a case that names a group."""
    for i, block in enumerate(case.model.blocks):
        yield ("model", "blocks", i, "group"), block.group
    for name in case.model.split:
        yield ("model", "split", name), name
    for i, joint in enumerate(case.model.joints):
        if joint.group is not None:
            yield ("model", "joints", i, "group"), joint.group
    yield from _listed_names(case)
    for kind in ("tractions", "surfaces", "blasts", "velocities", "supports"):
        for i, load in enumerate(getattr(case.loads, kind)):
            if getattr(load, "group", None) is not None:
                yield ("loads", kind, i, "group"), load.group
            surface = getattr(load, "surface", None)
            for name in surface_groups(surface):
                yield ("loads", kind, i, "surface", "group"), name
    for i, boundary in enumerate(case.boundaries):
        for name in surface_groups(boundary.surface):
            yield ("boundaries", i, "surface", "group"), name
    for i, history in enumerate(case.histories):
        if history.group is not None:
            yield ("histories", i, "group"), history.group
    yield from _groups_of_bolts(case)


def _groups_of_bolts(case: CaseParts) -> Iterator[tuple[tuple[str | int, ...], str]]:
    for i, bolts in enumerate(case.bolts):
        if bolts.rings is not None and bolts.rings.inside is not None:
            yield ("bolts", i, "rings", "inside"), bolts.rings.inside
        for name in surface_groups(bolts.pattern and bolts.pattern.surface):
            yield ("bolts", i, "pattern", "surface", "group"), name


def _listed_names(case: CaseParts) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Every place of a list of names of groups."""
    for i, pair in enumerate(case.interfaces.pairs):
        for k, name in enumerate(pair.between or []):
            yield ("interfaces", "pairs", i, "between", k), name
    maps = case.output.maps
    groups = [
        *((("initial_stress", i), s.groups) for i, s in enumerate(case.initial_stress)),
        *(
            (("water", "fields", i), f.groups)
            for i, f in enumerate(case.water.fields if case.water else [])
        ),
        (("output", "maps"), maps and maps.groups),
    ]
    for place, names in groups:
        for k, name in enumerate(names or []):
            yield (*place, "groups", k), name
    for i, stage in enumerate(case.stages):
        for key in ("remove", "add"):
            for k, name in enumerate(getattr(stage, key)):
                yield ("stages", i, key, k), name


def _unique_names(case: CaseParts) -> Iterator[Problem]:
    named: dict[tuple[str, ...], Sequence[Any]] = {
        ("stages",): case.stages,
        ("histories",): case.histories,
        ("bolts",): case.bolts,
        ("interfaces", "pairs"): case.interfaces.pairs,
        ("model", "joints"): case.model.joints,
        ("water", "fields"): case.water.fields if case.water else [],
        ("boundaries",): case.boundaries,
    }
    for keys, entries in named.items():
        seen: set[str] = set()
        for i, entry in enumerate(entries):
            if entry.name in seen:
                yield (*keys, i, "name"), f"'{entry.name}' is the name of two entries"
            if entry.name is not None:
                seen.add(entry.name)


def without(data: dict[str, Any], problems: Iterable[Problem]) -> dict[str, Any]:
    """Remove wrong values, so that the rest of a case can be checked.

    Groups, materials, records and entries of lists stay: without them other parts would look wrong.
    """
    rest = deepcopy(data)
    for keys, _ in problems:
        node: Any = rest
        for key in keys[:-1]:
            inside = node.get(key) if isinstance(node, dict) else None
            if isinstance(node, list) and isinstance(key, int) and key < len(node):
                inside = node[key]
            node = inside
        if isinstance(node, dict) and keys[:-1] not in WHOLE:
            node.pop(keys[-1], None)
    return rest


def _fixed_at_the_start(trial: CaseParts, stage: Stage, path: str, value: Any) -> str:
    """Why a setting would change a value that is fixed at the start of a run, or ""."""
    part, *keys = path.split(".")
    whole = len(keys) == 1 and isinstance(value, dict)
    changed = [str(key) for key in value] if whole else keys[1:2]
    fixed = {"interfaces": ["law"], "groups": AT_START}.get(part, [])
    if part == "interfaces":
        changed = keys[-1:]
    elif part == "materials":
        fixed = [key for key in changed if key not in STRENGTHS]
    found = [key for key in changed if key in fixed]
    if found:
        kind = {"interfaces": "an interface", "groups": "a group", "materials": "a material"}[part]
        return f"{found[0]!r} of {kind} is fixed at the start and cannot change"
    if part == "groups" and "material" in changed:
        return _fixed_material(trial, stage, keys[0], value["material"] if whole else value)
    return ""


def _fixed_material(trial: CaseParts, stage: Stage, group: str, material: Any) -> str:
    """Why a stage cannot give a group this material, or "": it must add it and keep the law."""
    if not isinstance(material, str):
        return ""  # the schema refuses it
    was = trial.groups[group].material if group in trial.groups else material
    laws = {trial.materials[name].law for name in (was, material) if name in trial.materials}
    if group in stage.add and len(laws) == 1:
        return ""
    return (
        "'material' of a group is fixed at the start and cannot change, unless the stage adds the "
        "group "
        "and both have the same law"
    )


def stage_settings(
    trial: CaseParts, put: Callable[[str, Any], None], known: Sequence[Problem]
) -> tuple[list[Problem], list[Problem]]:
    """Try the ``set`` of all stages, one after the other.

    Args:
        trial: A copy of the case; is changed.
        put: Sets the value at a path of the copy.
        known: Problems and warnings that it has already; they are not repeated.

    Returns:
        Problems of the settings, and warnings.
    """
    problems: list[Problem] = []
    doubtful: list[Problem] = []
    known = list(known)
    fixed_values = trial.interfaces.fixed()
    records = list(record_users(trial))
    for i, stage in enumerate(trial.stages):
        problems += _settings_of_one(trial, i, put)
        now = trial.interfaces.fixed()
        for key in now:
            if now[key] != fixed_values[key]:
                fixed = f"{key!r} of an interface is fixed at the start and cannot change"
                problems.append((("stages", i, "set"), fixed))
        fixed_values = now
        if (used := list(record_users(trial))) != records:
            problems.append((("stages", i, "set"), "records and their stages cannot change"))
        records = used
        problems += [
            (("stages", i, "set"), f"gives {'.'.join(map(str, keys))}: {what}")
            for keys, what in _names(trial)
            if (keys, what) not in known
        ]
        if i == last_dynamic(trial.stages):
            over = over_early(trial, least_time(trial.stages[:i]))
            problems += [problem for problem in over if problem not in known]
        if stage.set:
            for found, told in zip(doubts(trial), (problems, doubtful), strict=True):
                told += [
                    (("stages", i, "set"), f"gives {'.'.join(map(str, keys))}: {what}")
                    for keys, what in found
                    if (keys, what) not in known
                ]
                known += found
    return problems, doubtful


def _settings_of_one(
    trial: CaseParts, number: int, put: Callable[[str, Any], None]
) -> Iterator[Problem]:
    """Put the settings of a stage into a copy of the case; yields settings that fail."""
    stage = trial.stages[number]
    for path, value in stage.set.items():
        keys = ("stages", number, "set", path)
        if not path.startswith(SETTABLE):
            allowed = ", ".join(f"{start}*" for start in SETTABLE)
            yield keys, f"a stage can change {allowed} only"
        elif fixed := _fixed_at_the_start(trial, stage, path, value):
            yield keys, fixed
        else:
            try:
                put(path, value)
            except CaseError as error:
                what = str(error).removeprefix("case: ").splitlines()[0]  # case: path: what
                yield keys, what.partition(": ")[2]


def _no(kind: str, name: str, known: Iterable[str]) -> str:
    close = difflib.get_close_matches(name, known, n=1)
    hint = f"did you mean {close[0]}?" if close else f"the case has: {', '.join(known) or 'none'}"
    return f"no {kind} '{name}'; {hint}"
