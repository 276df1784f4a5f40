"""Cases stored in results, and cases of `cdem: 1`, whose number implied choices that are now keys."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

from cdem.case.source import Keys

MARKER = ".cdem-results"
"""The file that marks a folder made by `cdem run`."""
BONDS = "10.0 E/h"
"""Choices of `cdem: 1`: no compensation for bonds, and contacts with the stiffness of bonds."""


def is_stored(path: Path) -> bool:
    """Whether a file is the case that a run wrote beside its results."""
    return path.name == "case.yaml" and (path.parent / MARKER).is_file()


def renewed(data: dict[str, Any]) -> dict[str, Any]:
    """A case with the keys of today: the choices of `cdem: 1` are written out."""
    if not _is_old(data):
        return data
    out = deepcopy(data) | {"cdem": 2}
    for keys, value in chosen(data):
        node: Any = out
        for key in keys[:-1]:
            if isinstance(node, dict) and node.get(str(key)) is None:
                node[str(key)] = {}
            node = node[key]
        node[keys[-1]] = value
    return out


def outdated(data: dict[str, Any]) -> list[tuple[Keys, str]]:
    """The problem with a case of `cdem: 1`: keys that it has to write; none for other cases."""
    if not _is_old(data):
        return []
    keys = "; ".join(f"{'.'.join(map(str, path))}: {value}" for path, value in chosen(data))
    mend = (
        f", and for the same results write {keys}"
        if keys
        else "; the case gives all its choices already"
    )
    return [(("cdem",), f"1 is no longer supported; remove it{mend}")]


def chosen(data: dict[str, Any]) -> Iterator[tuple[Keys, Any]]:
    """Keys and values of the choices of `cdem: 1` that a case, sound or not, leaves open."""
    for keys, stage in _parts(data, "stages", "*"):
        mode = stage.get("mode")
        if mode == "static" and stage.get("relax") is None:
            yield (*keys, "relax"), "local"
        if mode == "dynamic" and _leaves_out(stage, "damping", "contact"):
            yield (*keys, "damping", "contact"), 0
    if _leaves_out(data, "elements", "mass"):
        yield ("elements", "mass"), "exact"
    yield from _stiffness(data)
    for keys, box in _parts(data, "model", "blocks", "*", "box"):
        if box.get("shape") == "tet4" and box.get("cells") is None:
            yield (*keys, "cells"), "alike"


def _stiffness(data: dict[str, Any]) -> Iterator[tuple[Keys, Any]]:
    """Choices for the default (which pairs take over), and for pairs that leave them to the program."""
    pair_of, default = ("stiffness_n", "stiffness_s"), dict[str, Any]()
    for keys, default in _parts(data, "interfaces", "default"):
        if all(default.get(key, "auto") == "auto" for key in pair_of):
            yield from (((*keys, key), BONDS) for key in pair_of)
    for keys, pair in _parts(data, "interfaces", "pairs", "*"):
        own = any(key in pair for key in pair_of) or not default
        if own and all(pair.get(key, default.get(key, "auto")) == "auto" for key in pair_of):
            yield from (((*keys, key), BONDS) for key in pair_of)


def _leaves_out(node: dict[str, Any], part: str, key: str) -> bool:
    """Whether a part of a mapping, which may be missing itself, lacks a key."""
    inside = node.get(part)
    return inside is None or (isinstance(inside, dict) and inside.get(key) in (None, "auto"))


def _is_old(data: dict[str, Any]) -> bool:
    return type(data.get("cdem")) is int and data["cdem"] == 1


def _parts(node: Any, *path: str, keys: Keys = ()) -> Iterator[tuple[Keys, dict[str, Any]]]:
    """Mappings at a path, in which * stands for all entries of a list, and their places."""
    if not path:
        if isinstance(node, dict):
            yield keys, node
    elif path[0] == "*":
        for number, entry in enumerate(node if isinstance(node, list) else []):
            yield from _parts(entry, *path[1:], keys=(*keys, number))
    elif isinstance(node, dict):
        yield from _parts(node.get(path[0]), *path[1:], keys=(*keys, path[0]))
