"""Reading a case file: YAML to plain data, overrides, and dotted paths into it."""

from __future__ import annotations

import math
import typing
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from cdem.case.explain import unknown_key
from cdem.case.input_file import is_file, read_text
from cdem.case.source import Key, Keys, Source, is_index
from cdem.case.yaml_text import parse
from cdem.errors import CaseError
from cdem.units import describe

LARGEST_FILE = 20_000_000
"""Largest size of a case or study [bytes]; reading so many takes minutes."""
MOST_BITS = 1000
"""Most digits of a whole number; longer ones do not fit a floating-point number."""
STARTS = {
    "case": "'cdem new incline' writes one to start from",
    "study": "see docs/sweep.md",
    "distribution": "see docs/screening.md",
    "rockfall": "'cdem new rockfall_runs' writes one to start from",
    "fit": "see docs/observations.md",
    "landslide": "'cdem new landslide_dem' writes one to start from",
    "joint": "'cdem joints' writes one from a table or a cloud",
    "profile": "see docs/records.md",
}
"""Where to look for the content of an empty file, for each kind of file."""


def load_case_data(
    path: Path, overrides: Iterable[str] = (), what: str = "case"
) -> tuple[dict[str, Any], Source]:
    """Read a case or study file as plain dicts and lists.

    Args:
        path: A YAML file.
        overrides: Texts such as ``"time.safety=0.5"``; the part after ``=`` is read as YAML.
        what: The kind of file, a key of `STARTS`.

    Returns:
        The data, and the place of each value in the file.

    Raises:
        CaseError: No such file, not YAML, a repeated key, an empty file, or a bad override.
    """
    if is_file(path) and path.stat().st_size > LARGEST_FILE:
        raise CaseError(
            f"{path}: too large for a {what} ({path.stat().st_size:,} bytes); meshes and terrain "
            "belong in files of their own"
        )
    text = read_text(path, f"{what} file")
    source = Source(file=str(path))
    tree = parse(text, str(path))
    if tree is None:
        raise CaseError(f"{path}: the file is empty; {STARTS[what]}")
    if not isinstance(tree, dict):
        raise CaseError(f"{path}:1:1: a {what} is a mapping (key: value), got {describe(tree)}")
    _note_places(tree, source, ())
    data = plain(tree, source)
    for override in overrides:
        _override(data, override, source)
    return data, source


def read_settings(texts: Iterable[str]) -> dict[str, Any]:
    """Values of texts such as ``"cohesion=1 MPa"``, as plain dicts and lists.

    Raises:
        CaseError: A text sets nothing.
    """
    data: dict[str, Any] = {}
    source = Source()
    for text in texts:
        _override(data, text, source)
    return data


def _note_places(node: Any, source: Source, keys: Keys) -> None:
    """Store line and column of every key and list entry of a tree with positions."""
    if not isinstance(node, dict | list):
        return
    places = node.lc.data or {}  # type: ignore[union-attr]  # added by ruamel.yaml
    for key in node if isinstance(node, dict) else range(len(node)):
        path = (*keys, key if isinstance(node, list) else str(key))
        if key in places:  # keys merged with << have no place of their own
            source.places[path] = (places[key][0] + 1, places[key][1] + 1)
        _note_places(node[key], source, path)


def plain(value: Any, source: Source, keys: Keys = ()) -> Any:
    """Copy a tree as plain dicts, lists and scalars.

    Raises:
        CaseError: A number is NaN, infinite, or a whole number of hundreds of digits.
    """
    if isinstance(value, BaseModel):
        return value
    if hasattr(value, "tolist"):  # NumPy arrays and scalars
        value = value.tolist()
    if isinstance(value, dict):
        return {str(k): plain(v, source, (*keys, str(k))) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v, source, (*keys, i)) for i, v in enumerate(value)]
    if isinstance(value, bool) or value is None:
        return value
    if isinstance(value, int):
        if value.bit_length() > MOST_BITS:
            raise source.error([(keys, "is a number with too many digits")])
        return int(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise source.error([(keys, f"must be a finite number, got {value}")])
        return float(value)
    return str(value) if isinstance(value, str) or hasattr(value, "isoformat") else value


def _override(data: dict[str, Any], text: str, source: Source) -> None:
    """Replace one value of raw data by ``path=value``."""
    path, equals, value = text.partition("=")
    if not equals or not all(part.strip() for part in path.split(".")):
        known = _first_number(data)
        raise CaseError(
            f"--set {text}: write key.path=value" + (f", e.g. --set {known}" if known else "")
        )
    label = f"--set {text}"
    put(data, path.strip(), parse(value, label), source, label)


def _first_number(data: dict[str, Any], path: str = "") -> str:
    """The first number below the top level, as ``path=value``; empty where there is none."""
    for key, value in data.items():
        if isinstance(value, dict) and (found := _first_number(value, f"{path}{key}.")):
            return found
        if path and isinstance(value, int | float) and not isinstance(value, bool):
            return f"{path}{key}={value}"
    return ""


def put(data: dict[str, Any], path: str, value: Any, source: Source, label: str) -> None:
    """Replace one value of raw data; missing mappings on the path are made.

    Args:
        data: Raw data of a case; is changed.
        path: The place, see `resolve`.
        value: The new value.
        source: Records who replaced the value.
        label: Name of the replacement in an error.

    Raises:
        CaseError: The path leads nowhere.
    """
    keys = resolve(data, path, label=label)
    node: Any = data
    for number, key in enumerate(keys[:-1]):
        if isinstance(node, dict) and not isinstance(node.get(str(key)), dict | list):
            node[str(key)] = {}
        node = node[key]
        if isinstance(node, list) and not isinstance(keys[number + 1], int):
            raise CaseError(f"{label}: {'.'.join(map(str, keys[: number + 1]))} is a list")
    source.overrides[keys] = label
    node[keys[-1]] = plain(value, source, keys)


def resolve(root: Any, path: str, label: str | None = None) -> Keys:
    """Turn a dotted path into keys.

    An entry of a list may be given by number or by its ``name``; ``interfaces.NAME`` is short for
    the pair of that name. Keys that mappings do not have yet are passed on unchanged.

    Args:
        root: Nested dicts and lists, or a case.
        path: e.g. ``"interfaces.bed.cohesion"``.
        label: Name of the path in an error.

    Raises:
        CaseError: The path leads nowhere.
    """
    label, node, parts = label or path, root, path.split(".")
    keys: Keys = ()
    while parts:
        known = _children(node)
        count = _longest_known(parts, known)
        key: Key = ".".join(parts[:count])
        if isinstance(node, list | tuple):
            key = _list_index(node, str(key), label, keys)
        elif keys == ("interfaces",) and key not in ("default", "pairs"):
            keys, node = (*keys, "pairs"), known.get("pairs") or []
            key = _list_index(node, str(key), label, ("interfaces",))
        elif isinstance(node, BaseModel) and key not in known:
            raise CaseError(f"{label}: {key}: {unknown_key(str(key), known)}")
        elif not isinstance(node, dict | BaseModel) and node is not None:
            raise CaseError(f"{label}: {'.'.join(map(str, keys))} has no entries")
        node = node[int(key)] if isinstance(node, list | tuple) else known.get(str(key))
        keys, parts = (*keys, key), parts[count:]
    return keys


def _children(node: Any) -> dict[str, Any]:
    if isinstance(node, BaseModel):
        return {name: getattr(node, name) for name in type(node).model_fields}
    return node if isinstance(node, dict) else {}


def _longest_known(parts: list[str], known: dict[str, Any]) -> int:
    counts = range(len(parts), 1, -1)
    return next((n for n in counts if ".".join(parts[:n]) in known), 1)


def _list_index(node: typing.Sequence[Any], key: str, label: str, keys: Keys) -> int:
    names = [_children(entry).get("name") for entry in node]
    if key in names:
        return names.index(key)
    if is_index(key) and int(key) < len(node):
        return int(key)
    allowed = [str(name) for name in names if name]
    if node:
        allowed.append("0" if len(node) == 1 else f"0 to {len(node) - 1}")
    inside = ".".join(map(str, keys)) or "the case"
    raise CaseError(
        f"{label}: no entry '{key}' in {inside}; it has: {', '.join(allowed) or 'no entries'}"
    )


def replace_at(tree: Any, keys: Keys, value: Any) -> Any:
    """Return a copy of nested dicts and lists with the value at ``keys`` replaced."""
    if not keys:
        return value
    copy: Any = dict(tree) if isinstance(tree, dict) else list(tree)
    old = copy.get(keys[0]) if isinstance(copy, dict) else copy[keys[0]]
    copy[keys[0]] = replace_at(old, keys[1:], value)
    return copy
