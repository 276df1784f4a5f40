"""Values that a study has drawn, kept in the folder of its sweep: the same whoever draws them again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cdem.errors import CdemError
from cdem.study.sampling import Row, draw
from cdem.study.study import Study

SAMPLES = "samples.json"


def samples(study: Study, folder: Path) -> list[Row]:
    """Draws of a study: those that the folder of its sweep keeps, or new ones.

    Raises:
        CdemError: What it keeps are no samples, or were drawn by a cdem that did not keep them.
        BackendError: Latin hypercubes need the extra `sweep`.
    """
    if study.sampling is None:
        return [{}]
    path = folder / SAMPLES
    if not path.is_file():
        _refuse_unknown(folder)
        return draw(_drawn(study), study.sampling)
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))
        asked, draws = kept["drawn for"], list(kept["draws"])
        sound = len(draws) == asked["sampling"]["count"]
        sound = sound and all(row.keys() == asked["parameters"].keys() for row in draws)
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        sound = False
    if not sound:
        raise CdemError(f"{path}: is damaged; name another folder with -o, or remove {folder}")
    return draws if asked == _asked(study) else draw(_drawn(study), study.sampling)


def to_keep(study: Study, rows: list[Row]) -> dict[str, Any]:
    """What a folder keeps of the draws of a study, which the first of its rows have one by one."""
    assert study.sampling is not None
    drawn = _drawn(study)
    draws = [{name: row[name] for name in drawn} for row in rows[: study.sampling.count]]
    return {"drawn for": _asked(study), "draws": draws}


def _drawn(study: Study) -> dict[str, Any]:
    return {name: p for name, p in study.parameters.items() if p.is_drawn}


def _asked(study: Study) -> dict[str, Any]:
    """All that the draws depend on, as JSON has it."""
    assert study.sampling is not None
    parameters = {name: p.model_dump(mode="json") for name, p in _drawn(study).items()}
    return {"sampling": study.sampling.model_dump(mode="json"), "parameters": parameters}


def _refuse_unknown(folder: Path) -> None:
    """Stop at a sweep of Latin hypercubes that were not kept: others would take their place."""
    try:
        before = json.loads((folder / "study.json").read_text(encoding="utf-8")).get("sampling")
    except (OSError, ValueError, AttributeError):
        return  # no sweep yet; another file is refused by who opens the folder
    if before and before.get("method", "latin-hypercube") == "latin-hypercube":
        raise CdemError(
            f"{folder}: an earlier cdem drew the values of its runs and did not keep them, and this "
            "one draws others; go on with that cdem, or name another folder with -o"
        )
