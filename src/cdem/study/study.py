"""A study: varied parameters of a case, the task of each run, and the collected results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import PrivateAttr, ValidationError, model_validator

from cdem.case.explain import explain
from cdem.case.reader import load_case_data, plain
from cdem.case.source import Keys, Source
from cdem.errors import CaseError
from cdem.study.checks import contradictions
from cdem.study.schema import StudyParts


class Study(StudyParts):
    """A whole study. Load one from a file, or build it here with the same names.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: problem.
    """

    _source: Source = PrivateAttr(default_factory=Source)

    def __init__(self, _source: Source | None = None, **data: Any) -> None:
        source = _source or Source()
        try:
            super().__init__(**plain(data, source))
        except ValidationError as error:
            raise explain(error, source, Study) from None
        self._source = source
        problems = list(contradictions(self))
        if problems:
            raise source.error(problems)

    @model_validator(mode="before")
    @classmethod
    def _list_of_results(cls, data: Any) -> Any:
        if isinstance(data, dict) and isinstance(data.get("results"), list):
            return data | {"results": {str(path): path for path in data["results"]}}
        return data

    @classmethod
    def load(cls, path: str | Path) -> Study:
        """Read a study file.

        Raises:
            CaseError: The file cannot be read or is wrong; one line for each problem.
        """
        data, source = load_case_data(Path(path), what="study")
        return cls(_source=source, **data)

    @property
    def case_file(self) -> Path:
        """The case file."""
        return self._source.folder / self.case

    @classmethod
    def schema(cls) -> dict[str, Any]:  # type: ignore[override]
        """Return the JSON schema of a study file, for editors."""
        whole = cls.model_json_schema() | {"title": "cdem study"}
        fields = whole["properties"]  # two of them may be plain lists
        parameter = fields["parameters"]["additionalProperties"]
        fields["parameters"]["additionalProperties"] = {"anyOf": [parameter, {"type": "array"}]}
        names = {"type": "array", "items": {"type": "string"}}
        fields["results"] = {"anyOf": [fields["results"], names]}
        return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | whole

    def error(self, keys: Keys, what: str) -> CaseError:
        """An error about one place of the study."""
        return self._source.error([(keys, what)])
