"""Formulas in a case or a study: arithmetic with named numbers; angles are in degrees."""

from __future__ import annotations

import ast
import difflib
import math
import operator
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from cdem.units import describe


def _turned(function: Callable[[float], float]) -> Callable[[float], float]:
    return lambda degrees: function(math.radians(degrees))


FUNCTIONS: dict[str, Callable[..., float]] = {
    "sin": _turned(math.sin),
    "cos": _turned(math.cos),
    "tan": _turned(math.tan),
    "asin": lambda x: math.degrees(math.asin(x)),
    "acos": lambda x: math.degrees(math.acos(x)),
    "atan": lambda x: math.degrees(math.atan(x)),
    "atan2": lambda y, x: math.degrees(math.atan2(y, x)),
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": math.log,
    "abs": abs,
    "min": min,
    "max": max,
}
ARGUMENTS = {"atan2": 2}  # others take one argument; min and max take any number
OPERATORS: dict[type, Callable[..., float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}


LONGEST = 1000
"""Most characters of a formula."""
DEEPEST = 100
"""Deepest nesting of operations; a sum of so many numbers is as deep."""


def is_formula(value: object) -> bool:
    """Whether a value of a study is a formula: a text that begins with ``=``."""
    return isinstance(value, str) and value.lstrip().startswith("=")


class Formula:
    """Arithmetic on named numbers, such as ``= atan(tan(phi) / 2)``.

    It may hold + - * / **, brackets, pi and the functions of `FUNCTIONS`; nothing else is run. A
    name may have dots, like paths in a case.

    Attributes:
        names: Names that need values.

    Raises:
        ValueError: The text is not such a formula.

    Example:
        >>> round(Formula("= atan(tan(phi) / 2)").value({"phi": 40.0}), 2)
        22.76
    """

    def __init__(self, text: str) -> None:
        self.text = text.strip()
        if len(self.text) > LONGEST:
            raise ValueError(f"a formula of {len(self.text):,} characters; {LONGEST} are allowed")
        try:
            self._tree = ast.parse(self.text.removeprefix("=").strip(), mode="eval").body
        except SyntaxError as error:
            raise ValueError(f"'{self.text}' is not a formula ({error.msg})") from None
        except (ValueError, RecursionError, MemoryError):  # a NUL, or hundreds of open brackets
            raise ValueError(f"{describe(self.text)} is not a formula") from None
        self.names: set[str] = set()
        self._check(self._tree, DEEPEST)

    def value(self, numbers: Mapping[str, Any]) -> float:
        """Compute the value; NaN where there is none (a division by zero, a root of -1).

        Raises:
            ValueError: A name is unknown, or its value is not a number.
        """
        for name in sorted(self.names):
            if name not in numbers:
                raise ValueError(f"'{self.text}': {unknown(name, numbers)}")
            if isinstance(numbers[name], bool) or not isinstance(numbers[name], int | float):
                raise ValueError(f"'{self.text}': {name} is not a number, but {numbers[name]!r}")
        try:
            result = self._compute(self._tree, numbers)
        except (ArithmeticError, ValueError):
            return math.nan
        return math.nan if isinstance(result, complex) else float(result)

    def _check(self, node: ast.AST, levels: int) -> None:
        """Collect names; raise an error for anything but arithmetic, and for too many levels."""
        if levels == 0:
            raise ValueError(f"{describe(self.text)} has more than {DEEPEST} operations in a row")
        name = _dotted(node)
        if name is not None:
            self.names |= {name} - {"pi"}
        elif isinstance(node, ast.Call) and not node.keywords:
            self._check_call(node, levels - 1)
        elif isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            self._check(node.left, levels - 1)
            self._check(node.right, levels - 1)
        elif isinstance(node, ast.UnaryOp) and type(node.op) in OPERATORS:
            self._check(node.operand, levels - 1)
        elif not (isinstance(node, ast.Constant) and type(node.value) in (int, float)):
            raise ValueError(
                f"'{self.text}': a formula is made of numbers, names, + - * / **, brackets and "
                f"{', '.join(FUNCTIONS)}"
            )

    def _check_call(self, node: ast.Call, levels: int) -> None:
        called = _dotted(node.func)
        if called not in FUNCTIONS:
            raise ValueError(f"'{self.text}': function {unknown(called or '?', FUNCTIONS)}")
        wanted = ARGUMENTS.get(called, 1)
        if len(node.args) != wanted and not (called in ("min", "max") and node.args):
            raise ValueError(
                f"'{self.text}': {called} takes {wanted} number(s), got {len(node.args)}"
            )
        for argument in node.args:
            self._check(argument, levels)

    def _compute(self, node: Any, numbers: Mapping[str, Any]) -> float:
        name = _dotted(node)
        if name is not None:
            return math.pi if name == "pi" else float(numbers[name])
        if isinstance(node, ast.Call):
            return FUNCTIONS[node.func.id](*(self._compute(a, numbers) for a in node.args))  # type: ignore[attr-defined]
        if isinstance(node, ast.BinOp):
            left, right = self._compute(node.left, numbers), self._compute(node.right, numbers)
            return OPERATORS[type(node.op)](left, right)
        if isinstance(node, ast.UnaryOp):
            return OPERATORS[type(node.op)](self._compute(node.operand, numbers))
        return float(node.value)


def unknown(name: str, known: Iterable[str]) -> str:
    """Say that a name is unknown, and suggest a similar one."""
    known = list(known)
    close = difflib.get_close_matches(name, known, n=1)
    if close:
        return f"'{name}' is unknown; did you mean {close[0]}?"
    return f"'{name}' is unknown; there are: {', '.join(known) or 'none'}"


def _dotted(node: ast.AST) -> str | None:
    """Name of ``a`` or ``a.b.c``."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        before = _dotted(node.value)
        return None if before is None else f"{before}.{node.attr}"
    return None
