"""One run of a study."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass
class Run:
    """One run of a study.

    Attributes:
        name: Name of its folder, the first digits of `identity`.
        identity: Hash of the resolved case, of its use, and of cdem's version.
        parameters: Value of each parameter.
        task: Data for the worker.
        result: Its result, or None.
        error: Why there is no result, or nothing.
    """

    name: str
    identity: str
    parameters: dict[str, Any]
    task: dict[str, Any] = field(repr=False)
    result: dict[str, Any] | None = field(default=None, repr=False)
    error: str = ""

    @property
    def status(self) -> str:
        """Its status: of the run, "found" (critical), "failed", or "waiting"."""
        if self.error or (self.result and "error" in self.result):
            return "failed"
        return self.result["status"] if self.result else "waiting"

    @property
    def why(self) -> str:
        """Why it failed, or nothing."""
        return self.error or str((self.result or {}).get("error", ""))

    def text(self) -> str:
        """Name, parameters and cause of failure, in one line."""
        values = ", ".join(f"{name} = {value}" for name, value in self.parameters.items())
        return f"{self.name or 'no case'} ({values}): {self.why}"
