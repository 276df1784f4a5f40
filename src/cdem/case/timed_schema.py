"""Curves over time: factors, and heights of water."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, ClassVar

from pydantic import Field, WithJsonSchema, model_validator

from cdem.case.types import Name, Part, Quantity

Rows = list[tuple[Annotated[float, Quantity("s")], Annotated[float, Quantity("1")]]]
_CELL = {"anyOf": [{"type": "number"}, {"type": "string"}]}
_NAMED = {
    "type": "object",
    "properties": {"file": {"type": "string", "description": "Text with two columns"}},
    "required": ["file"],
    "additionalProperties": False,
}
History = Annotated[
    Rows,
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "array", "minItems": 1, "items": {"type": "array", "items": _CELL}},
                _NAMED,
            ]
        }
    ),
]
"""Rows of time and factor; a case may name a file with them, see `history_file`."""


class Timed(Part):
    """An entry with curves over time: `history` of a factor, or `level` of heights."""

    acts_from_stage: ClassVar[bool] = False
    """Whether it starts to act in its stage, so that `stage` is useful without a curve."""
    stage: Name | None = Field(
        None,
        description="Stage where the times of history or level start; before it the "
        "first value holds. By default they start with the run",
    )

    @property
    def curves(self) -> dict[str, list[tuple[float, float]]]:
        """Rows of time [s] and value of its curves, by key."""
        values = {key: getattr(self, key, None) for key in ("history", "level")}
        return {key: rows for key, rows in values.items() if isinstance(rows, list)}

    @property
    def has_curve(self) -> bool:
        """Whether it changes over time."""
        return bool(self.curves)

    @model_validator(mode="after")
    def _times_increase(self) -> Timed:
        for key, rows in self.curves.items():
            if any(later <= earlier for (earlier, _), (later, _) in pairwise(rows)):
                raise ValueError(f"{key}: times must increase")
            if self.stage is not None and rows[0][0] < 0:
                raise ValueError(
                    f"{key}: times must be at least 0, the begin of stage {self.stage}"
                )
        if self.stage is not None and not self.has_curve and not self.acts_from_stage:
            raise ValueError(
                "stage is the start of a curve: give it with a history or level, or a record"
            )
        return self


class Factored(Timed):
    """An entry with a history of its factor."""

    history: History | None = Field(
        None,
        min_length=1,
        description="Factor over time, linear between: [[time [s], factor [1]], ...], or "
        "{file: NAME} of two columns",
    )
