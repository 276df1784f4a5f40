"""A fit: the file that names a study and the observations."""

from __future__ import annotations

from pathlib import Path

from cdem.case.document import Document
from cdem.fit.schema import FitParts
from cdem.study.study import Study


class Fit(Document, FitParts):
    """A whole fit. Load one from a file, or build it here with the same names.

    Raises:
        CaseError: Every problem found, one line each: file:line:column: path: problem.
    """

    kind = "fit"

    def load_study(self) -> Study:
        """The study that is named.

        Raises:
            CaseError: It cannot be read or is wrong.
        """
        return Study.load(self.path_of(self.study))

    @property
    def folder(self) -> Path:
        """Folder of the results of the study."""
        if self.sweep is not None:
            return self.path_of(self.sweep)
        study = self.path_of(self.study)
        return study.with_name(f"{study.stem}.sweep")

    def path_of(self, name: str) -> Path:
        """Path of a file that is named relative to the fit file."""
        return self._source.folder / name
