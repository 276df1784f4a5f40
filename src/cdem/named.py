"""Values by name, for users of Python."""

from __future__ import annotations

from typing import Any, NoReturn, TypeVar

T = TypeVar("T")


class Named(dict[str, T]):
    """A dictionary that answers a name it does not have with those it has.

    Args:
        kind: Kind of the values, for the message.
        values: Values by name.
    """

    def __init__(self, kind: str, values: dict[str, T]) -> None:
        super().__init__(values)
        self.kind = kind

    def __missing__(self, name: Any) -> NoReturn:
        raise KeyError(f"no {self.kind} {name!r}; there are: {', '.join(self)}")

    def __reduce__(self) -> tuple[Any, ...]:
        return Named, (self.kind, dict(self))
