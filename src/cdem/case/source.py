"""Origin of the values of a case, and errors that name file, line, column and a mend."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cdem.errors import CaseError, CdemError

Key = str | int
Keys = tuple[Key, ...]
MOST_PROBLEMS = 20  # more lines would not help


@dataclass
class Source:
    """Origin of the values of a case.

    Attributes:
        file: Name of the case file as the user typed it, or None for a case built in Python.
        places: Line and column, from 1, of each key path in the file.
        overrides: Who replaced the value at a key path: ``--set KEY=VALUE``, or a study.
    """

    file: str | None = None
    places: dict[Keys, tuple[int, int]] = field(default_factory=dict)
    overrides: dict[Keys, str] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """As data for JSON; `of` is the inverse."""
        return {
            "file": self.file,
            "places": [[list(keys), *place] for keys, place in self.places.items()],
            "overrides": [[list(keys), by] for keys, by in self.overrides.items()],
        }

    @classmethod
    def of(cls, data: dict[str, Any]) -> Source:
        """The source with this `as_dict`."""
        places = {tuple(keys): (line, column) for keys, line, column in data["places"]}
        return cls(data["file"], places, {tuple(keys): by for keys, by in data["overrides"]})

    @property
    def folder(self) -> Path:
        """Folder that relative paths in the case start at."""
        return Path(".") if self.file is None else Path(self.file).parent

    def where(self, path: str | Keys) -> str:
        """Return ``file:line:col`` of a path, or of its nearest part that is in the file."""
        keys = self.keys_of(path) if isinstance(path, str) else path
        while keys:
            if keys in self.overrides:
                return self.overrides[keys]
            if keys in self.places:
                line, column = self.places[keys]
                return f"{self.file}:{line}:{column}"
            for longer, label in self.overrides.items():  # a mapping made by an override
                if longer[: len(keys)] == keys:
                    return label
            keys = keys[:-1]
        return self.file or "case"

    def error(self, problems: Iterable[tuple[Keys, str]]) -> CaseError:
        """Make one error of pairs (path, problem), in the order of the file."""
        return CaseError("\n".join(self.lines(problems)))

    def lines(self, problems: Iterable[tuple[Keys, str]]) -> list[str]:
        """One line for each pair (path, problem), in the order of the file."""
        last = (10**9, 0)
        some = sorted(problems, key=lambda p: self.places.get(self._nearest(p[0]), last))
        lines = [
            f"{self.where(keys)}: {_dotted(keys)}: {what}".replace(": : ", ": ")
            for keys, what in some[:MOST_PROBLEMS]
        ]
        if len(some) > MOST_PROBLEMS:
            lines.append(f"... and {len(some) - MOST_PROBLEMS} more")
        return lines

    @contextmanager
    def blame(self, path: str) -> Iterator[None]:
        """Put ``file:line:col: path:`` in front of a CdemError or ValueError raised inside."""
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

    def keys_of(self, text: str) -> Keys:
        """Split a dotted path; known keys may themselves contain dots."""
        parts: list[str] = text.split(".")
        keys: Keys = ()
        known = self.places.keys() | self.overrides.keys()
        while parts:
            for count in range(len(parts), 0, -1):
                joined = ".".join(parts[:count])
                number = is_index(joined) and (*keys, int(joined)) in known
                key: Key = int(joined) if number else joined
                if count == 1 or (*keys, key) in known:
                    break
            keys, parts = (*keys, key), parts[count:]
        return keys


def is_index(text: str) -> bool:
    """Whether a part of a dotted path may be the number of an entry."""
    return text.isdecimal() and len(text) < 10


def _dotted(keys: Keys) -> str:
    """A path as text of one line."""
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode()
        for c in ".".join(map(str, keys))
    )
