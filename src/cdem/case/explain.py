"""Errors of pydantic in plain words."""

from __future__ import annotations

import difflib
import typing
from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel, ValidationError

from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS, SURFACE_LAWS
from cdem.case.source import Keys, Source
from cdem.errors import CaseError
from cdem.units import describe


def explain(
    error: ValidationError, source: Source, root: type[BaseModel], within: Keys = ()
) -> CaseError:
    """Turn pydantic's errors into errors of cdem.

    Args:
        error: The errors of pydantic.
        source: Origin of the data.
        root: The model of the whole data.
        within: Path of the part that was validated, if not the whole.
    """
    return source.error(problems_of(error, root, within))


def problems_of(
    error: ValidationError, root: type[BaseModel], within: Keys = ()
) -> list[tuple[Keys, str]]:
    """Path of each error of pydantic, with the problem in plain words."""
    problems = []
    for detail in error.errors(include_url=False):
        keys, model = _real_path(root, (*within, *detail["loc"]))
        problems.append((keys, _words(detail, keys, model)))
    return problems


def _real_path(root: Any, loc: tuple[Any, ...]) -> tuple[Keys, type[BaseModel] | None]:
    """Remove pydantic's additions to a location (tags of unions, "[key]"); find the last model."""
    keys: Keys = ()
    model, kind = None, root
    for key in loc:
        if key == "[key]":
            continue
        kind = _unwrap(kind)
        if isinstance(kind, _Choice):
            picked = kind.pick(key)
            if picked is not None:
                kind = picked
                continue
            kind = kind.with_field(str(key))
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            model = kind
            keys = (*keys, key)
            known = kind.model_fields.get(str(key))
            kind = known.annotation if known else None
        elif typing.get_origin(kind) in (dict, list, tuple):
            model, keys = None, (*keys, key)
            kind = next((a for a in reversed(typing.get_args(kind)) if a is not Ellipsis), None)
        else:
            break
    return keys, model


class _Choice:
    """The member of a union that was meant: pydantic's tag in the location names it."""

    def __init__(self, kinds: list[Any]) -> None:
        self.kinds = kinds

    def pick(self, tag: Any) -> Any:
        for kind in self.kinds:
            tags = [getattr(extra, "tag", None) for extra in getattr(kind, "__metadata__", ())]
            if tag in tags:
                return kind
        return None

    def with_field(self, name: str) -> Any:
        """The first model that has a field; paths in a case contain no tags."""
        models = (_unwrap(kind) for kind in self.kinds)
        return next((m for m in models if name in getattr(m, "model_fields", {})), None)


def _unwrap(kind: Any) -> Any:
    """Strip Annotated and ``| None``."""
    while hasattr(kind, "__metadata__"):
        kind = kind.__origin__
    arguments = [a for a in typing.get_args(kind) if a is not type(None)]
    if typing.get_origin(kind) in (typing.Union, type(int | str)):
        return _unwrap(arguments[0]) if len(arguments) == 1 else _Choice(arguments)
    return kind


def _words(detail: Any, keys: Keys, model: type[BaseModel] | None) -> str:
    kind, context, value = detail["type"], detail.get("ctx", {}), detail.get("input")
    if kind == "extra_forbidden":
        return _extra(str(keys[-1]), value, model)
    if kind == "missing":
        known = model.model_fields.get(str(keys[-1])) if model else None
        meaning = f": {known.description}" if known and known.description else ""
        return f"is missing{meaning}"
    if kind == "value_error":
        return str(context["error"])
    if kind == "literal_error":
        expected = str(context["expected"]).replace("'", "")
        options = [word for part in expected.split(", ") for word in part.split(" or ")]
        close = difflib.get_close_matches(str(value), options, n=1)
        hint = f"; did you mean {close[0]}?" if close else ""
        return f"must be {expected}, got {describe(value)}{hint}"
    lengths = {"too_short": "at least", "too_long": "at most"}
    if kind in lengths:
        limit = context.get("min_length", context.get("max_length"))
        entries = "entry" if limit == 1 else "entries"
        return f"needs {lengths[kind]} {limit} {entries}, got {context['actual_length']}"
    plain_words = {
        "dict_type": "must be a mapping (key: value)",
        "model_type": "must be a mapping (key: value)",
        "model_attributes_type": "must be a mapping (key: value)",
        "list_type": _list_wanted(keys, model),
        "tuple_type": "must be a list, e.g. [a, b]",
        "bool_type": "must be true or false",
        "bool_parsing": "must be true or false",
        "string_type": "must be a text",
        "int_type": "must be a whole number",
        "int_parsing": "must be a whole number",
        "int_from_float": "must be a whole number",
        "string_too_short": "must not be empty",
        "greater_than_equal": f"must be at least {context.get('ge')}",
        "less_than_equal": f"must be at most {context.get('le')}",
    }
    return f"{plain_words.get(kind, detail['msg'])}, got {describe(value)}"


def _extra(key: str, value: Any, model: type[BaseModel] | None) -> str:
    if value is None and key.isdecimal():
        return f"is a key without a value; if it ends a number such as 2,{key}, leave out the comma"
    return unknown_key(key, model.model_fields if model else {})


def _list_wanted(keys: Keys, model: type[BaseModel] | None) -> str:
    """Describe the wanted list; three numbers along the axes have an example of their own."""
    known = model.model_fields.get(str(keys[-1])) if model else None
    lengths = [getattr(extra, "min_length", None) for extra in known.metadata] if known else []
    return "must be a list, e.g. " + ("[0, 0, -9.81] (x, y, z)" if 3 in lengths else "[a, b]")


MISPLACED = {
    "damping": "it belongs to a stage: stages: [{name: ..., mode: ..., damping: {local: 0.8}}]",
    "gravity": "it belongs to loads: loads: {gravity: [0, 0, -9.81]}",
    "supports": "it belongs to loads: loads: {supports: [...]}",
    "joints": "it belongs to model: model: {joints: [...]}",
    "blocks": "it belongs to model: model: {blocks: [...]}",
    "mesh": "it belongs to model: model: {mesh: FILE}",
    "duration": "it belongs to a stage: stages: [{name: ..., mode: dynamic, duration: 1}]",
}
"""Keys that are often written at the top of a case, and their places."""


def unknown_key(key: str, known: Iterable[str]) -> str:
    """Say that a key is unknown, and suggest: a key of another law, or a similar key."""
    known = list(known)
    kind = BLOCK_LAWS if "density" in known else INTERFACE_LAWS
    kind = SURFACE_LAWS if "surface" in known else kind
    laws = [law.name for law in kind.values() if key in {p.name for p in law.parameters}]
    if laws and "law" in known:
        return f"unknown key; it belongs to law: {' or '.join(laws)}"
    if key in MISPLACED and "stages" in known:
        return f"unknown key here; {MISPLACED[key]}"
    close = difflib.get_close_matches(key, known, n=1)
    if close:
        return f"unknown key; did you mean {close[0]}?"
    return f"unknown key; possible are {', '.join(known)}"
