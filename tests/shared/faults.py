"""Inputs that once were answered wrongly, each kept in `tests/faults` under its own name."""

from __future__ import annotations

from pathlib import Path

from ruamel.yaml import YAML

FAULTS = Path(__file__).parents[1] / "faults"


def fault(name: str) -> dict:
    """A case of `tests/faults`, as nested dicts and lists."""
    return YAML(typ="safe", pure=True).load(FAULTS / name)
