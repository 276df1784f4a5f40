"""Arrays of the core as rows of numbers, with named parts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

if TYPE_CHECKING:
    from cdem._core import Core


class Rows:
    """An array of the core as rows of numbers: `rows_of(core, "spring.state").force_n`.

    The parts named in its description (`Core.describe`) are attributes: views of the core, until
    it changes the array. Shape (rows,), or (rows, components) for a part of several numbers.
    Padding has no name.

    Attributes:
        numbers: All numbers of the rows, shape (rows, numbers); also a view.
    """

    numbers: NDArray[Any]

    def __init__(self, core: Core, name: str) -> None:
        array, info = core.array(name)
        self._name, self._parts = name, info["parts"]
        numbers = info["numbers"]
        if not numbers:  # unused array
            self.numbers = array.reshape(0, 0)
        elif info["layout"] == "columns":
            kinds = {kind["name"]: kind["count"] for kind in core.describe_rows()}
            self.numbers = array.reshape(numbers, -1)[:, : kinds[info["rows"]]].T
        else:
            self.numbers = array.reshape(-1, numbers)

    def __getattr__(self, part: str) -> NDArray[Any]:
        first = 0
        for name, numbers in self._parts:
            if name and name == part:
                own = self.numbers[:, first : first + numbers]
                return own if numbers > 1 else own[:, 0]
            first += numbers
        names = ", ".join(name for name, _ in self._parts if name) or "none, only numbers"
        raise AttributeError(f"{self._name} has no part {part!r}; it has: {names}")


def rows_of(core: Core, name: str) -> Rows:
    """An array of model or state as rows, see `Rows`.

    Args:
        core: The compiled core.
        name: Name of the array, as in `Core.describe`.

    Raises:
        KeyError: There is no such array.
    """
    return Rows(core, name)
