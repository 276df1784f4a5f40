"""A whole file of a user beside the case: checked values, the place of each, and its schema."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from pydantic import PrivateAttr, ValidationError

from cdem.case.explain import explain
from cdem.case.reader import plain
from cdem.case.source import Keys, Source
from cdem.case.types import Part

if TYPE_CHECKING:
    from typing_extensions import Self

SOURCE = "_source"


class Document(Part):
    """Base of a whole file; a class of it has the parts of that file as another base.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: problem.
    """

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

    def _contradictions(self) -> Iterator[tuple[Keys, str]]:
        """Problems between keys: the path of each, and words."""
        yield from ()

    @classmethod
    def schema(cls) -> dict[str, Any]:  # type: ignore[override]
        """Return the JSON schema of such a file, for editors."""
        whole = cls.model_json_schema() | {"title": f"cdem {cls.__name__.lower()}"}
        return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | whole
