"""A whole file of a user beside the case: checked values, the place of each, and its schema."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import PrivateAttr, ValidationError

from cdem.case.explain import explain
from cdem.case.reader import load_case_data, plain
from cdem.case.source import Keys, Source
from cdem.case.types import Part
from cdem.errors import CaseError

if TYPE_CHECKING:
    from typing_extensions import Self

SOURCE = "_source"


class Document(Part):
    """Base of a whole file; a class of it has the parts of that file as another base.

    Attributes:
        kind: The kind of file in errors, a key of `cdem.case.reader.STARTS`.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: problem.
    """

    kind: ClassVar[str]
    _source: Source = PrivateAttr(default_factory=Source)

    def __init__(self, **data: Any) -> None:
        source = data.pop(SOURCE, None) or Source()
        try:
            super().__init__(**plain(data, source))
        except ValidationError as error:
            raise explain(error, source, type(self)) from None
        self._source = source
        problems = list(self._contradictions())
        if problems:
            raise source.error(problems)

    @classmethod
    def of(cls, data: dict[str, Any], source: Source) -> Self:
        """Check data.

        Args:
            data: Values by the keys of the file.
            source: The file, and the place of each key in it.

        Raises:
            CaseError: One line for each problem.
        """
        return cls(**{SOURCE: source}, **data)

    @classmethod
    def load(cls, path: str | Path, overrides: Iterable[str] = ()) -> Self:
        """Read a file.

        Args:
            path: A YAML file.
            overrides: Texts ``"sizes.body=30"`` that replace values.

        Raises:
            CaseError: The file cannot be read or is wrong; one line for each problem.
        """
        return cls.of(*load_case_data(Path(path), overrides, cls.kind))

    def error(self, place: str | Keys, what: str) -> CaseError:
        """An error about a value, with its place in the file."""
        keys = self._source.keys_of(place) if isinstance(place, str) else place
        return self._source.error([(keys, what)])

    def _contradictions(self) -> Iterator[tuple[Keys, str]]:
        """Problems between keys: the path of each, and words."""
        yield from ()

    @classmethod
    def schema(cls) -> dict[str, Any]:  # type: ignore[override]
        """Return the JSON schema of such a file, for editors."""
        whole = cls.model_json_schema() | {"title": f"cdem {cls.__name__.lower()}"}
        return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | whole
