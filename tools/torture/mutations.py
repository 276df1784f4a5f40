"""Mutations of texts, trees and bytes: what people mistype, what programs cut short, what bites."""

from __future__ import annotations

import math
import random
import re
from copy import deepcopy
from typing import Any

VALUES: list[Any] = [
    None, True, False, 0, -1, 1, 2, 0.5, -0.0, 1e-320, 1e-200, 1e-12, 1e15, 1e200, -1e300, 2**31,
    2**63, 10**30, 10**400, "", " ", "auto", "x", "2,700", "30 GPa", "30 gpa", "5 E/h", "1e999 Pa",
    "1 m9", "1 km999", "10 %", "20 deg", "2 t/m3", "-3 cm/s", "nan", ".inf", "1 / 0", "= 1 / 0",
    "= a", "../../etc/passwd", "/dev/null", "a/b", "a\nb", "a\0b", "<b>", "ä", "\u2028", "\ud7ff",
    math.nan, math.inf, -math.inf, -7, -1e15, 10**18, [[[[]]]], ["r"], [math.nan] * 3, {1: 2},
    "2026-13-01", "x" * 5000, [], {}, [[]], [0, 0, 0], [1, 2, 3], [1, 2], ["x", "y", "z"], [None],
    [1e-200, 0, 0], [1e30, 1e30, 1e30], {"a": 1}, {"name": "a"}, {"group": "a"}, [[1, 2], [3]],
]  # fmt: skip
"""Values to put in place of others."""

TOKENS = [
    "0", "-1", "1", "99999999999", "2147483647", "-2147483648", "9" * 25, "9" * 5000, "1e308",
    "1e-320", "nan", "inf", "-0", "0x7f", "1,5", "2026-13-01", "~", "yes", "'", '"', "[", "]", "{",
    "}", ":", ": ", "- ", "#", "&a ", "*a ", "<<: *a", "|", ">", "!!int ", "!!python/object:os.x ",
    "%YAML 1.1\n---\n", "---\n", "\t", "\r", "\0", "\x1b", "é", "\ufeff", "=", "? ", "@", "`",
]  # fmt: skip
"""Pieces of text to put in."""

FACTORS = (-1, 0, 1e-9, 1e-6, 1e-3, 0.01, 0.1, 0.5, 0.99, 1.01, 2, 3, 10, 100, 1e3, 1e6, 1e9, 1e12)

NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
WORD = re.compile(r"[A-Za-z_]+")


def _pick(rng: random.Random, text: str, pattern: re.Pattern[str]) -> tuple[int, int]:
    """Start and end of a random match, or a random place."""
    found = [match.span() for match in pattern.finditer(text)]
    place = rng.randint(0, len(text))
    return rng.choice(found) if found else (place, place)


def mutate_text(rng: random.Random, text: str) -> str:
    """One change: a number, a word, a line, a piece put in or taken out."""
    kind = rng.choice(("number", "number", "word", "insert", "delete", "lines", "indent", "nest"))
    if kind in ("number", "word"):
        a, b = _pick(rng, text, NUMBER if kind == "number" else WORD)
        return text[:a] + rng.choice(TOKENS) + text[b:]
    if kind == "insert":
        a = rng.randint(0, len(text))
        return text[:a] + rng.choice(TOKENS) * rng.choice((1, 1, 1, 3, 300)) + text[a:]
    if kind == "delete":
        a = rng.randint(0, len(text))
        return text[:a] + text[a + rng.choice((1, 1, 2, 10, 200)) :]
    if kind == "nest":
        opened, closed = rng.choice((("[", "]"), ("{a: ", "}"), ("(", ")"), ("- ", "")))
        a, b = _pick(rng, text, WORD)
        depth = rng.choice((2, 10, 50, 1000))
        return text[:a] + opened * depth + text[a:b] + closed * depth + text[b:]
    lines = text.splitlines(keepends=True) or [""]
    i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    if kind == "indent":
        lines[i] = rng.choice((" ", "  ", "\t", "- ")) + lines[i]
    elif rng.random() < 0.4:
        del lines[i]
    elif rng.random() < 0.5:
        lines.insert(j, lines[i])
    else:
        lines[i], lines[j] = lines[j], lines[i]
    return "".join(lines)


def mutate_tree(rng: random.Random, tree: Any) -> Any:
    """One change in nested dicts and lists: a value, a key, an entry more or less."""
    tree = deepcopy(tree)
    places = list(_places(tree))
    if not places:
        return rng.choice(VALUES)
    node, key = rng.choice(places)
    kind = rng.choice(("value", "value", "value", "drop", "again", "key", "move", "wrap"))
    if kind == "value":
        node[key] = deepcopy(rng.choice(VALUES))
    elif kind == "drop":
        del node[key]
    elif kind == "again" and isinstance(node, list):
        node[key:key] = [deepcopy(node[key])] * rng.choice((1, 1, 50))
    elif kind == "key" and isinstance(node, dict):
        node[rng.choice((str(key)[:-1], str(key) + "x", "", "a.b", "0"))] = node.pop(key)
    elif kind == "wrap":
        node[key] = [node[key]] if rng.random() < 0.5 else {"a": node[key]}
    else:
        other, there = rng.choice(places)
        node[key] = deepcopy(other[there])
    return tree


def graft(rng: random.Random, tree: Any, other: Any) -> Any:
    """Nested dicts and lists with a part of others: under the same key of a dict, or anywhere."""
    tree = deepcopy(tree)
    node, key = rng.choice(list(_places(other)))
    places = list(_places(tree))
    same = [here for here, there in places if isinstance(here, dict) and there == key]
    if isinstance(node, dict) and rng.random() < 0.7:
        dicts = [here for here, _ in places if isinstance(here, dict)]
        rng.choice(same or dicts or [tree])[key] = deepcopy(node[key])
    elif places:
        here, there = rng.choice(places)
        here[there] = deepcopy(node[key])
    return tree


def scale_number(rng: random.Random, tree: Any) -> Any:
    """One number of nested dicts and lists times something; its unit stays."""
    tree = deepcopy(tree)
    numbers = [
        (node, key)
        for node, key in _places(tree)
        if NUMBER.match(str(node[key])) and not isinstance(node[key], dict | list)
    ]
    if not numbers:
        return tree
    node, key = rng.choice(numbers)
    old = node[key]
    match = NUMBER.match(str(old))
    assert match is not None
    factor = rng.choice(FACTORS)
    if isinstance(old, int):
        node[key] = int(old * factor)
    elif isinstance(old, float):
        node[key] = old * factor
    else:
        node[key] = f"{float(match[0]) * factor:g}{old[match.end() :]}"
    return tree


def _places(tree: Any) -> Any:
    for key in tree if isinstance(tree, dict) else range(len(tree)):
        yield tree, key
        if isinstance(tree[key], dict | list):
            yield from _places(tree[key])


def mutate_bytes(rng: random.Random, raw: bytes) -> bytes:
    """One change in a file of any kind: cut, flipped, a number in it, a part again."""
    kind = rng.choice(("cut", "flip", "number", "word", "again", "drop", "text", "text", "text"))
    place = rng.randint(0, len(raw))
    if kind == "cut":
        return raw[:place]
    if kind == "flip" and raw:
        at = min(place, len(raw) - 1)
        return raw[:at] + bytes([raw[at] ^ (1 << rng.randrange(8))]) + raw[at + 1 :]
    if kind == "number":
        width = rng.choice((4, 8))
        value = rng.choice((0, -1, 1, 2**31 - 1, -(2**31), 1000, 10**9))
        return raw[:place] + value.to_bytes(width, "little", signed=True) + raw[place + width :]
    if kind == "word":
        return raw[:place] + rng.choice(TOKENS).encode("utf-8", "replace") + raw[place:]
    length = rng.choice((1, 4, 16, 100))
    if kind == "again":
        return raw[:place] + raw[place : place + length] * rng.choice((2, 2, 100)) + raw[place:]
    if kind == "drop":
        return raw[:place] + raw[place + length :]
    return mutate_text(rng, raw.decode("latin-1")).encode("latin-1", "replace")


def encode(rng: random.Random, text: str) -> bytes:
    """A text as bytes: UTF-8 mostly."""
    if rng.random() < 0.95:
        return text.encode("utf-8", "surrogatepass")
    kind = rng.choice(("latin-1", "utf-16", "utf-8-sig", "cut", "crlf"))
    if kind == "cut":
        raw = text.encode("utf-8", "replace")
        return raw[: rng.randint(0, len(raw))]
    if kind == "crlf":
        return text.replace("\n", "\r\n").encode("utf-8", "replace")
    return text.encode(kind, "replace")
