"""Reading a case file: YAML to plain data, and errors that say file, line, column and a mend."""

from __future__ import annotations

import difflib
import io
import math
import typing
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from cdem.errors import CaseError, CdemError
from cdem.units import describe

Key = str | int
Keys = tuple[Key, ...]
MOST_PROBLEMS = 20  # more lines than this help nobody


@dataclass
class Source:
    """Where the values of a case come from.

    Attributes:
        file: Name of the case file as the user typed it, or None for a case built in Python.
        places: Line and column, from 1, of each key path in the file.
        overrides: Who replaced the value at a key path: ``--set KEY=VALUE``, or a study.
    """

    file: str | None = None
    places: dict[Keys, tuple[int, int]] = field(default_factory=dict)
    overrides: dict[Keys, str] = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """Folder that relative paths in the case start at."""
        return Path(".") if self.file is None else Path(self.file).parent

    def where(self, path: str | Keys) -> str:
        """Return ``file:line:col`` of a path, or of the nearest part of it that is written down."""
        keys = self._known(path) if isinstance(path, str) else path
        while keys:
            if keys in self.overrides:
                return self.overrides[keys]
            if keys in self.places:
                line, column = self.places[keys]
                return f"{self.file}:{line}:{column}"
            for longer, label in self.overrides.items():  # a mapping that an override has made
                if longer[: len(keys)] == keys:
                    return label
            keys = keys[:-1]
        return self.file or "case"

    def error(self, problems: Iterable[tuple[Keys, str]]) -> CaseError:
        """Make one error of (path, what is wrong) pairs, in the order of the file."""
        last = (10**9, 0)
        some = sorted(problems, key=lambda p: self.places.get(self._nearest(p[0]), last))
        lines = [
            f"{self.where(keys)}: {'.'.join(map(str, keys))}: {what}".replace(": : ", ": ")
            for keys, what in some[:MOST_PROBLEMS]
        ]
        if len(some) > MOST_PROBLEMS:
            lines.append(f"... and {len(some) - MOST_PROBLEMS} more")
        return CaseError("\n".join(lines))

    @contextmanager
    def blame(self, path: str) -> Iterator[None]:
        """Put ``file:line:col: path:`` before the message of a CdemError or ValueError inside."""
        try:
            yield
        except CdemError as error:
            error.args = (f"{self.where(path)}: {path}: {error}",)
            raise
        except ValueError as error:
            raise CaseError(f"{self.where(path)}: {path}: {error}") from None

    def _nearest(self, keys: Keys) -> Keys:
        while keys and keys not in self.places:
            keys = keys[:-1]
        return keys

    def _known(self, text: str) -> Keys:
        """Split a dotted path; keys that contain dots themselves are found by what is known."""
        parts: list[str] = text.split(".")
        keys: Keys = ()
        known = self.places.keys() | self.overrides.keys()
        while parts:
            for count in range(len(parts), 0, -1):
                joined = ".".join(parts[:count])
                number = joined.isdigit() and (*keys, int(joined)) in known
                key: Key = int(joined) if number else joined
                if count == 1 or (*keys, key) in known:
                    break
            keys, parts = (*keys, key), parts[count:]
        return keys


def load_case_data(
    path: Path, overrides: Iterable[str] = (), what: str = "case"
) -> tuple[dict[str, Any], Source]:
    """Read a case or study file as plain dicts and lists.

    Args:
        path: A YAML file.
        overrides: Texts such as ``"time.safety=0.5"``; the part after ``=`` is read as YAML.
        what: "case" or "study".

    Returns:
        The data and where each of them stands.

    Raises:
        CaseError: No such file, not YAML, a key twice, an empty file, or a bad override.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise CaseError(f"{path}: cannot read the {what} file: {error.strerror}") from None
    except UnicodeDecodeError:
        raise CaseError(f"{path}: not a text file; a {what} is a YAML file in UTF-8") from None
    source = Source(file=str(path))
    tree = _parse(text, str(path))
    if tree is None:
        hint = (
            "'cdem new incline' writes one to start from" if what == "case" else "see docs/sweep.md"
        )
        raise CaseError(f"{path}: the file is empty; {hint}")
    if not isinstance(tree, dict):
        raise CaseError(f"{path}:1:1: a {what} is a mapping (key: value), got {describe(tree)}")
    _note_places(tree, source, ())
    data = plain(tree, source)
    for override in overrides:
        _override(data, override, source)
    return data, source


def _parse(text: str, file: str) -> Any:
    from ruamel.yaml import YAML
    from ruamel.yaml.constructor import DuplicateKeyError
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    try:
        return YAML(typ="rt", pure=True).load(io.StringIO(text))
    except DuplicateKeyError as error:
        key = str(error.problem).partition('"')[2].partition('"')[0]
        raise CaseError(
            f"{_mark(file, error.problem_mark)}: {key}: key is there twice; keep one"
        ) from None
    except MarkedYAMLError as error:
        what = " ".join(filter(None, (error.context, error.problem)))
        place = _mark(file, error.problem_mark or error.context_mark)
        raise CaseError(
            f"{place}: not valid YAML: {what}; look at the indentation, brackets, quotes and "
            "colons here and just above"
        ) from None
    except TypeError:  # ruamel.yaml lets a list or mapping be a key, and then cannot hash it
        raise CaseError(f"{file}: not valid YAML here: a list or mapping stands as a key") from None
    except YAMLError as error:
        raise CaseError(f"{file}: not valid YAML: {str(error).splitlines()[0]}") from None


def _mark(file: str, mark: Any) -> str:
    return f"{file}:{mark.line + 1}:{mark.column + 1}" if mark is not None else file


def _note_places(node: Any, source: Source, keys: Keys) -> None:
    """Remember line and column of every key and list entry of a tree with positions."""
    if not isinstance(node, dict | list):
        return
    places = node.lc.data or {}  # type: ignore[union-attr]  # ruamel.yaml adds it
    for key in node if isinstance(node, dict) else range(len(node)):
        path = (*keys, key if isinstance(node, list) else str(key))
        if key in places:  # keys merged with << have no place of their own
            source.places[path] = (places[key][0] + 1, places[key][1] + 1)
        _note_places(node[key], source, path)


def plain(value: Any, source: Source, keys: Keys = ()) -> Any:
    """Copy a tree as plain dicts, lists and scalars.

    Raises:
        CaseError: A number somewhere is NaN or infinite.
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
    put(data, path.strip(), _parse(value, label), source, label)


def _first_number(data: dict[str, Any], path: str = "") -> str:
    """The first number below the top level, as ``path=value``; empty where there is none."""
    for key, value in data.items():
        if isinstance(value, dict) and (found := _first_number(value, f"{path}{key}.")):
            return found
        if path and isinstance(value, int | float) and not isinstance(value, bool):
            return f"{path}{key}={value}"
    return ""


def put(data: dict[str, Any], path: str, value: Any, source: Source, label: str) -> None:
    """Replace one value of raw data; mappings on the way are made.

    Args:
        data: Raw data of a case; is changed.
        path: Where, see `resolve`.
        value: The new value.
        source: Learns who replaced the value.
        label: What to call the replacement in an error.

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
    the pair of that name. Keys of mappings that are not there yet are passed on as they are.

    Args:
        root: Nested dicts and lists, or a case.
        path: e.g. ``"interfaces.bed.cohesion"``.
        label: What to call the path in an error.

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
            raise CaseError(f"{label}: {key}: {_unknown(str(key), known)}")
        elif not isinstance(node, dict | BaseModel) and node is not None:
            raise CaseError(f"{label}: {'.'.join(map(str, keys))} has nothing inside")
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
    if key.isdigit() and int(key) < len(node):
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


# ------------------------------------------------------------------ pydantic's errors in our words


def explain(
    error: ValidationError, source: Source, root: type[BaseModel], within: Keys = ()
) -> CaseError:
    """Turn pydantic's errors into ours.

    Args:
        error: What pydantic found.
        source: Where the data came from.
        root: The model of the whole data.
        within: Path of the part that was validated, if not the whole.
    """
    return source.error(problems_of(error, root, within))


def problems_of(
    error: ValidationError, root: type[BaseModel], within: Keys = ()
) -> list[tuple[Keys, str]]:
    """Path of each error that pydantic found, and what is wrong there in our words."""
    problems = []
    for detail in error.errors(include_url=False):
        keys, model = _real_path(root, (*within, *detail["loc"]))
        problems.append((keys, _words(detail, keys, model)))
    return problems


def _real_path(root: Any, loc: tuple[Any, ...]) -> tuple[Keys, type[BaseModel] | None]:
    """Drop what pydantic adds to a location (tags of unions, "[key]"), and find the last model."""
    keys: Keys = ()
    model, kind = None, root
    for key in loc:
        kind = _unwrap(kind)
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            model = kind
            keys = (*keys, key)
            known = kind.model_fields.get(str(key))
            kind = known.annotation if known else None
        elif typing.get_origin(kind) in (dict, list, tuple):
            if key == "[key]":
                continue
            model, keys = None, (*keys, key)
            kind = next((a for a in reversed(typing.get_args(kind)) if a is not Ellipsis), None)
        elif isinstance(kind, _Choice):
            kind = kind.pick(key)
        else:
            break
    return keys, model


class _Choice:
    """A union of several kinds; pydantic's tag in the location says which one was meant."""

    def __init__(self, kinds: list[Any]) -> None:
        self.kinds = kinds

    def pick(self, tag: Any) -> Any:
        for kind in self.kinds:
            tags = [getattr(extra, "tag", None) for extra in getattr(kind, "__metadata__", ())]
            if tag in tags:
                return kind
        return None


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
        return _unknown(str(keys[-1]), model.model_fields if model else {})
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
        "list_type": "must be a list, e.g. [a, b]",
        "tuple_type": "must be a list, e.g. [a, b]",
        "bool_type": "must be true or false",
        "bool_parsing": "must be true or false",
        "string_type": "must be a text",
        "int_type": "must be a whole number",
        "int_parsing": "must be a whole number",
        "int_from_float": "must be a whole number",
        "string_too_short": "must not be empty",
        "greater_than_equal": f"must be at least {context.get('ge')}",
    }
    return f"{plain_words.get(kind, detail['msg'])}, got {describe(value)}"


def _unknown(key: str, known: Iterable[str]) -> str:
    close = difflib.get_close_matches(key, known, n=1)
    if close:
        return f"unknown key; did you mean {close[0]}?"
    return f"unknown key; possible are {', '.join(known)}"
