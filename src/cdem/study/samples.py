"""Random values of a study, stored in the folder of its sweep: they stay the same for every user."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cdem.errors import CdemError
from cdem.study.sampling import Row, draw
from cdem.study.study import Study

SAMPLES = "samples.json"


def samples(study: Study, folder: Path) -> list[Row]:
    """Random values of a study: stored in the folder of its sweep, or new.

    Raises:
        CdemError: The stored file is damaged, or an older cdem drew values without storing them.
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
    """The stored values of a study; one by one, its first rows equal new draws."""
    assert study.sampling is not None
    drawn = _drawn(study)
    draws = [{name: row[name] for name in drawn} for row in rows[: study.sampling.count]]
    return {"drawn for": _asked(study), "draws": draws}


def _drawn(study: Study) -> dict[str, Any]:
    return {name: p for name, p in study.parameters.items() if p.is_drawn}


def _asked(study: Study) -> dict[str, Any]:
    """All data that the random values depend on, for JSON."""
    assert study.sampling is not None
    parameters = {name: p.model_dump(mode="json") for name, p in _drawn(study).items()}
    return {"sampling": study.sampling.model_dump(mode="json"), "parameters": parameters}


def _refuse_unknown(folder: Path) -> None:
    """Refuse a sweep of Latin hypercubes whose values were not stored: new draws would differ."""
    try:
        before = json.loads((folder / "study.json").read_text(encoding="utf-8")).get("sampling")
    except (OSError, ValueError, AttributeError):
        return  # no sweep yet; opening the folder refuses other files
    if before and before.get("method", "latin-hypercube") == "latin-hypercube":
        raise CdemError(
            f"{folder}: an earlier cdem drew the values of its runs without storing them, and this "
            "version draws others; continue with that cdem, or name another folder with -o"
        )
