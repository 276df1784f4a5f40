"""Free fields of a case: ground beside the sides of a model that is shaken."""

from __future__ import annotations

from pydantic import Field

from cdem.case.types import Name, Part


class FreeField(Part):
    """Ground beside a side, which moves as columns of the rock at that side."""

    base: Name = Field(description="Boundary with the motion below the side, quiet or rigid")
