"""The verbs of the program: each is imported when it is asked for, its line of help lies here."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping
from typing import Any

import typer
from typer.core import TyperGroup
from typer.main import get_command

VERBS = {
    "new": ("model", "Write a commented case to start from."),
    "check": ("model", "Read everything and report on the model; runs nothing."),
    "site": ("site", "Read a DEM and an outline; write a landslide and a case to start from."),
    "mesh": (
        "model",
        "Mesh a landslide from terrain, a sliding surface and bodies outlined in plan.",
    ),
    "joints": (
        "screening",
        "Find the sets among measured joints, and what may slide or topple on a slope.",
    ),
    "screen": (
        "screening",
        "Map the factor of safety over terrain: wedges and planes of joints, by closed forms.",
    ),
    "schema": ("model", "Print the JSON schema of a case or a study, for editors."),
    "critical": (
        "study",
        "Find the value at which a case fails, by bisection of its last, static stage.",
    ),
    "sweep": ("study", "Run a study: many variants of a case."),
    "verify": (
        "installation",
        "Compute problems whose answer is known and compare; exit status 3 if one is missed.",
    ),
    "benchmark": (
        "installation",
        "Measure the speed of the kernels against the machine's own limits.",
    ),
    "run": ("run", "Run all stages of a case."),
    "info": ("result", "Say what a run did."),
    "plot": ("result", "Draw histories and energies as PNG."),
    "render": ("result", "Draw the model as pictures or an animation."),
    "view": ("result", "Show a run in the browser; it follows a run that goes on."),
    "runout": (
        "result",
        "Measure front, reach, H/L, deposit, sections and pieces; write maps and tables.",
    ),
    "export": ("result", "Write the frames as files for ParaView and the like."),
    "doctor": ("installation", "Say what works on this machine, and how to mend what does not."),
    "law": ("law", "List laws, try one on its own, or build your own."),
}
"""Module of each verb, without ``_commands``, and its line of help, which its docstring begins with."""


class Verbs(TyperGroup):
    """The program: a group whose commands are imported when they are asked for."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings | {"commands": _Lazy()})

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the verbs into the help, from the table."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, line) for name, (_, line) in VERBS.items()])


class _Lazy(Mapping[str, Any]):
    """Commands by name, each built at its first use."""

    def __init__(self) -> None:
        self._built: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._built:
            self._built[name] = _command(name)
        return self._built[name]

    def __iter__(self) -> Iterator[str]:
        return iter(VERBS)

    def __len__(self) -> int:
        return len(VERBS)


def _command(name: str) -> Any:
    """The command of a verb, which has its name in its module: a function, or a Typer of others."""
    module = importlib.import_module(f"cdem.cli.{VERBS[name][0]}_commands")
    verb = getattr(module, name)
    if not isinstance(verb, typer.Typer):
        function, verb = verb, typer.Typer(add_completion=False, rich_markup_mode=None)
        verb.command(name, cls=getattr(module, "CLASSES", {}).get(name))(function)
    return get_command(verb)
