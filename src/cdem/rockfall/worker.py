"""Executes one run of a rockfall once, and stores its result and its track.

As a program it is a worker of `cdem.study.local_workers`.
"""

from __future__ import annotations

import json
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem._version import __version__
from cdem.errors import BackendError
from cdem.rockfall.blocks import Wish, draw
from cdem.rockfall.fall import Fall, Physics, fall
from cdem.rockfall.ground import read_ground
from cdem.rockfall.schema import Drawn, Shape
from cdem.rockfall.starts import Starts
from cdem.study.worker import RESULT_FILE, serve
from cdem.whole_files import refuse_link, replaced, write_json

Floats = NDArray[np.float64]
TRACK = "track.npy"


def finished(task: dict[str, Any]) -> dict[str, Any] | None:
    """The result of a task that was executed before, or None."""
    folder = place(task)
    try:
        result = json.loads((folder / RESULT_FILE).read_text())
    except (OSError, ValueError):
        return None
    if result.get("identity") != task["identity"] or not (folder / TRACK).is_file():
        return None
    return result


def place(task: dict[str, Any]) -> Path:
    """Folder of a run."""
    return Path(task["folder"]) / "runs" / task["name"]


def execute(task: dict[str, Any]) -> dict[str, Any]:
    """Execute one run on a worker, and write its track and then its result, each as a whole.

    Raises:
        CdemError: The machine failed, not the run.
    """
    if known := finished(task):
        return known
    if task["version"] != __version__:
        raise BackendError(f"a worker has cdem {__version__}, this command {task['version']}")
    folder = place(task)
    for part in (folder.parent, folder):
        refuse_link(part)
    folder.mkdir(parents=True, exist_ok=True)
    began = time.perf_counter(), time.process_time()
    ground = read_ground(Path(task["ground"]))
    start = draw(wish_of(task["wish"]), task["number"], ground)
    found = fall(ground, start.boulder, Physics(**task["physics"]))
    with replaced(folder / TRACK) as file:
        np.save(file, found.samples)
    result = {key: task[key] for key in ("name", "identity", "version", "number")}
    result |= {"shape": start.shape, **_facts(found)}
    result |= {"wall_time": time.perf_counter() - began[0], "cpu": time.process_time() - began[1]}
    write_json(folder / RESULT_FILE, result)
    return json.loads((folder / RESULT_FILE).read_text())


def _facts(found: Fall) -> dict[str, Any]:
    """Numbers of a run without its track."""
    facts = asdict(found)
    del facts["samples"]
    return facts | {"run_time": float(found.samples[-1, 0]), "samples": len(found.samples)}


def wish_as_dict(wish: Wish) -> dict[str, Any]:
    """What is drawn, as data for JSON; `wish_of` is the inverse."""
    starts = wish.starts
    return {
        "seed": wish.seed,
        "shapes": {name: shape.model_dump(mode="json") for name, shape in wish.shapes.items()},
        **{
            key: getattr(wish, key).model_dump(mode="json", exclude_none=True)
            for key in ("volume", "height", "velocity")
        },
        "starts": {
            "lines": [line.tolist() for line in starts.lines],
            "triangles": starts.triangles.tolist(),
            "points": starts.points.tolist(),
        },
    }


def wish_of(data: dict[str, Any]) -> Wish:
    """What is drawn, from this data."""
    starts = data["starts"]
    return Wish(
        seed=data["seed"],
        shapes={name: Shape(**shape) for name, shape in data["shapes"].items()},
        volume=Drawn(**data["volume"]),
        height=Drawn(**data["height"]),
        velocity=Drawn(**data["velocity"]),
        starts=Starts(
            [np.array(line) for line in starts["lines"]],
            np.reshape(starts["triangles"], (-1, 3, 2)).astype(float),
            np.reshape(starts["points"], (-1, 2)).astype(float),
        ),
    )


if __name__ == "__main__":
    serve(execute)
