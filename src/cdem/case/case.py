"""The case: a user's input, from a file or built in Python, checked before anything runs."""

from __future__ import annotations

import json
from collections.abc import Iterable
from contextlib import AbstractContextManager
from hashlib import sha256
from pathlib import Path
from typing import Any

from pydantic import PrivateAttr, ValidationError

from cdem import _native
from cdem.case import checks, plausible
from cdem.case.explain import explain, problems_of
from cdem.case.history_file import with_histories
from cdem.case.named_files import files_of
from cdem.case.reader import load_case_data, plain, replace_at, resolve
from cdem.case.record_file import with_records
from cdem.case.schema import CaseParts, Stage
from cdem.case.source import Source
from cdem.case.stored import is_stored, outdated, renewed
from cdem.case.types import Part
from cdem.errors import CaseError


class Case(CaseParts):
    """A whole case. Load one from a file, or build it here with the same names.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: problem.

    Example:
        >>> case = Case(
        ...     model={"blocks": [{"group": "rock", "box": {"size": [1, 1, "10 cm"]}}]},
        ...     materials={
        ...         "granite": {"density": 2700, "young_modulus": "50 GPa", "poisson_ratio": 0.25}
        ...     },
        ...     groups={"rock": {"material": "granite"}},
        ...     stages=[{"name": "fall", "mode": "dynamic", "duration": "10 ms"}],
        ... )
        >>> case.materials["granite"].young_modulus, case.stages[0].duration
        (50000000000.0, 0.01)
    """

    _source: Source = PrivateAttr(default_factory=Source)
    _unusual: list[checks.Problem] = PrivateAttr(default_factory=list)

    def __init__(self, _source: Source | None = None, **data: Any) -> None:
        source, data = _source or Source(), plain(data, _source or Source())
        data = with_records(with_histories(data, source), source)
        problems: list[checks.Problem] = outdated(data)
        data = renewed(data)
        _refuse_code(data, source)
        try:
            super().__init__(**data)
        except ValidationError as error:
            problems += problems_of(error, Case)
            try:  # check the names too if all the rest is sound
                super().__init__(**checks.without(data, problems))
            except ValidationError:
                raise source.error(problems) from None
        self._source = source
        known = checks.contradictions(self, source.folder)
        impossible, self._unusual = plausible.doubts(self)
        known += impossible
        if not problems:  # else settings might fail because of omitted values
            trial = self.model_copy(deep=True)
            trial._source = Source()  # errors name the line of the setting instead
            problems, later = checks.stage_settings(trial, trial.set, [*known, *self._unusual])
            self._unusual += later
        problems += known
        if problems:
            raise source.error(problems)

    @property
    def warnings(self) -> list[str]:
        """Values that are possible but unusual: ``file:line:col: path: usual range``."""
        return self._source.lines(self._unusual)

    @classmethod
    def load(cls, path: str | Path, overrides: Iterable[str] = ()) -> Case:
        """Read a case file.

        Args:
            path: A YAML file.
            overrides: Texts ``"interfaces.default.cohesion=10 kPa"`` that replace values.

        Returns:
            The case, with all checks that need no mesh.

        Raises:
            CaseError: The file cannot be read or is wrong; one line for each problem.
        """
        data, source = load_case_data(Path(path), overrides)
        return cls(_source=source, **(renewed(data) if is_stored(Path(path)) else data))

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Case:
        """Build a case from nested dicts and lists with the names of a case file."""
        return cls(**data)

    def __setattr__(self, name: str, value: Any) -> None:
        try:
            super().__setattr__(name, value)
        except ValidationError as error:
            raise explain(error, self._source, Case) from None

    def where(self, path: str) -> str:
        """Return ``file:line:col`` of a value, e.g. of ``interfaces.pairs.0.cohesion``."""
        return self._source.where(path)

    def path_of(self, file: str | Path) -> Path:
        """Return a path named in the case; a relative one starts at the case file's folder."""
        return self._source.folder / file

    def digests(self) -> dict[str, str]:
        """SHA-256 of the values, as JSON with sorted keys ("case"), and of the files that they name."""
        data = self.model_dump(mode="json")
        names = {holder[key] for holder, key in files_of(data)}
        found = {"case": sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()}
        for name in sorted(names):
            if self.path_of(name).is_file():
                found[name] = sha256(self.path_of(name).read_bytes()).hexdigest()
        return found

    def __repr__(self) -> str:
        return (
            f"<Case {self.title!r}: groups {', '.join(self.groups)}; "
            f"stages {', '.join(stage.name for stage in self.stages)}>"
        )

    def __str__(self) -> str:
        return repr(self)

    def blame(self, path: str) -> AbstractContextManager[None]:
        """Put ``file:line:col: path:`` in front of a CdemError or ValueError raised inside."""
        return self._source.blame(path)

    def set(self, path: str, value: Any) -> None:
        """Change one value, checked like one from a file.

        Args:
            path: e.g. ``"interfaces.pairs.0.cohesion"`` or ``"loads.gravity.2"``. An entry of a
                list may be named by its ``name``, and a named pair directly:
                ``"interfaces.bed.friction_angle"``.
            value: The new value, in SI or with a unit.

        Raises:
            CaseError: The path leads nowhere, or the value is not allowed there.
        """
        keys = resolve(self, path)
        # the deepest Part on the way, and the number of keys that lead to it
        part: Part = self
        keep, node = 0, part
        for depth, key in enumerate(keys[:-1], start=1):
            if isinstance(node, dict):
                node = node.get(str(key))
            else:
                node = getattr(node, str(key)) if isinstance(node, Part) else node[key]
            if node is None:
                there = ".".join(map(str, keys[:depth]))
                raise CaseError(f"{path}: {there} is not given, so its entries cannot change")
            if isinstance(node, Part):
                part, keep = node, depth
        field, inner = str(keys[keep]), keys[keep + 1 :]
        given = with_histories({str(keys[-1]): plain(value, self._source)}, self._source)
        new = replace_at(getattr(part, field), inner, given[str(keys[-1])])
        try:
            setattr(part, field, new)
        except ValidationError as error:
            raise explain(error, self._source, Case, within=keys[:keep]) from None
        self.interfaces.inherit()

    def try_setting(self, path: str, value: Any) -> None:
        """Check a value that is to change during the run, like the `set` of a stage.

        Raises:
            CaseError: The value does not exist, is not allowed, or is fixed at the start.
        """
        trial = self.model_copy(deep=True)
        trial._source = Source()
        others = [stage.model_copy(update={"set": {}}) for stage in trial.stages]
        now = Stage(name="now", mode="static").model_copy(update={"set": {path: value}})
        trial.__dict__["stages"] = [*others, now]
        known = [*self._unusual, *checks.contradictions(trial, self._source.folder)]
        problems, _ = checks.stage_settings(trial, trial.set, known)
        if problems:
            raise CaseError(f"{path}: {problems[0][1]}")

    def dump(self) -> str:
        """Write the resolved case as YAML: defaults filled in, paths of files absolute."""
        from io import StringIO

        from ruamel.yaml import YAML

        data = self.model_dump(mode="json", exclude_none=True)
        for holder, key in files_of(data):
            holder[key] = str(self.path_of(holder[key]).resolve())
        if self.interfaces.default is not None:
            # A pair's inherited values follow the default when a stage sets it, so they are left
            # out.
            for pair, written in zip(
                self.interfaces.pairs, data["interfaces"]["pairs"], strict=True
            ):
                for field in pair.inherited():
                    written.pop(field, None)
        yaml, text = YAML(typ="safe", pure=True), StringIO()
        yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]
        yaml.default_flow_style = None  # short ones in one line
        yaml.width = 100
        yaml.dump(data, text)
        return text.getvalue()

    @classmethod
    def schema(cls) -> dict[str, Any]:  # type: ignore[override]
        """Return the JSON schema of a case file, for editors."""
        head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
        return head | cls.model_json_schema() | {"title": "cdem case"}


def _refuse_code(data: dict[str, Any], source: Source) -> None:
    """Raise an error for own laws that the user has not allowed.

    Raises:
        CaseError: The case names such laws.
    """
    files = data.get("own_laws")
    for number, file in enumerate(files if isinstance(files, list) else []):
        if isinstance(file, str) and (source.folder / file).resolve() not in _native.headers:
            raise source.error(
                [
                    (
                        ("own_laws", number),
                        f"{file} is code that would run inside cdem; read it, then allow it with "
                        "--allow-code (in Python: first call cdem.load_own_laws)",
                    )
                ]
            )
