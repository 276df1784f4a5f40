"""The commands of the program with their lines of help; each is imported on demand."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping
from typing import Any

import typer
from typer.core import TyperGroup
from typer.main import get_command

VERBS = {
    "new": ("model", "Write a commented case to start from."),
    "check": ("model", "Read all input and report on the model; runs nothing."),
    "site": ("site", "Read a DEM and an outline; write a landslide and a case to start from."),
    "mesh": (
        "model",
        "Mesh a landslide or layers: terrain with bodies outlined in plan, or with layer surfaces.",
    ),
    "joints": (
        "screening",
        "Find the sets among measured joints, and joints that may slide or topple on a slope.",
    ),
    "screen": (
        "screening",
        "Map the factor of safety over terrain: wedges and planes of joints, by closed forms.",
    ),
    "schema": ("model", "Print the JSON schema of a kind of file, for editors."),
    "critical": (
        "study",
        "Find the value at which a case fails, by bisection of its last, static stage.",
    ),
    "sweep": ("study", "Run a study: many variants of a case."),
    "rockfall": (
        "rockfall",
        "Let hundreds of blocks fall over a terrain; heights, energies and counts at barriers.",
    ),
    "compare": (
        "fit",
        "Compare a run with monitored displacements: residuals, scores and a picture.",
    ),
    "fit": (
        "fit",
        "Find the parameters of a study that agree with observations, with their uncertainty.",
    ),
    "verify": (
        "installation",
        "Compute problems with known answers and compare; exit status 3 if one is missed.",
    ),
    "benchmark": (
        "installation",
        "Measure the speed of the kernels against the machine's own limits.",
    ),
    "run": ("run", "Run all stages of a case."),
    "info": ("result", "Summarize a run."),
    "plot": ("result", "Draw histories and energies as PNG."),
    "render": ("result", "Draw the model as pictures or an animation."),
    "view": ("result", "Show a run in the browser, live while it runs."),
    "runout": (
        "result",
        "Measure front, reach, H/L, deposit, sections and pieces; write maps and tables.",
    ),
    "record": (
        "record",
        "Show a record of ground motion; layered ground: amplification, motion at depth.",
    ),
    "records": (
        "record",
        "Measure the motions of a run: peaks, Arias intensity, spectra, Newmark slip, spectral ratios.",
    ),
    "export": ("result", "Write the frames as files for ParaView and the like."),
    "doctor": ("installation", "Check what works on this machine, and say how to mend the rest."),
    "law": ("law", "List laws, test one of them, or build your own."),
}
"""Module of each command, without ``_commands``, and its line of help, the start of its docstring."""


class Verbs(TyperGroup):
    """The program: a group of commands that are imported on demand."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings | {"commands": _Lazy()})

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands into the help, from the table."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, line) for name, (_, line) in VERBS.items()])


class _Lazy(Mapping[str, Any]):
    """Commands by name; each is built at its first use."""

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
    """The command of this name from its module: a function, or a Typer with commands."""
    module = importlib.import_module(f"cdem.cli.{VERBS[name][0]}_commands")
    verb = getattr(module, name)
    if not isinstance(verb, typer.Typer):
        function, verb = verb, typer.Typer(add_completion=False, rich_markup_mode=None)
        verb.command(name, cls=getattr(module, "CLASSES", {}).get(name))(function)
    return get_command(verb)
