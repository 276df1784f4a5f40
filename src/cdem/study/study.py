"""A study: varied parameters of a case, the task of each run, and the collected results."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import model_validator

from cdem.case.document import Document
from cdem.case.source import Keys
from cdem.study.checks import contradictions
from cdem.study.schema import StudyParts


class Study(Document, StudyParts):
    """A whole study. Load one from a file, or build it here with the same names.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: problem.
    """

    kind = "study"

    def _contradictions(self) -> Iterator[tuple[Keys, str]]:
        yield from contradictions(self)

    @model_validator(mode="before")
    @classmethod
    def _list_of_results(cls, data: Any) -> Any:
        if isinstance(data, dict) and isinstance(data.get("results"), list):
            return data | {"results": {str(path): path for path in data["results"]}}
        return data

    @property
    def case_file(self) -> Path:
        """The case file."""
        return self._source.folder / self.case

    @classmethod
    def schema(cls) -> dict[str, Any]:  # type: ignore[override]
        """Return the JSON schema of a study file, for editors."""
        whole = super().schema()
        fields = whole["properties"]  # two of them may be plain lists
        parameter = fields["parameters"]["additionalProperties"]
        fields["parameters"]["additionalProperties"] = {"anyOf": [parameter, {"type": "array"}]}
        names = {"type": "array", "items": {"type": "string"}}
        fields["results"] = {"anyOf": [fields["results"], names]}
        return whole
