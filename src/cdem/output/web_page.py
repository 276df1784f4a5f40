"""The page of a run: HTML, style and script in one file, with packed frames or a server for them."""

from __future__ import annotations

import base64
import hashlib
import secrets
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment
from numpy.typing import NDArray

from cdem._version import __version__
from cdem.errors import CdemError
from cdem.output.moving_surface import MovingSurface
from cdem.output.pack import Pack, put_frames
from cdem.output.page_facts import case_facts, is_over, page_facts
from cdem.output.reader import FrameSeries, Surface, SurfaceSeries, read_histories
from cdem.run.frame_files import frame_numbers

SCRIPTS = ("numbers.js", "run.js", "picture.js", "maps.js", "plot.js", "page.js")
"""Scripts in the order of their dependence."""
MOST_ROWS = 1000
"""Most rows of the histories on a page."""
STRESSES = ("stress", "effective_stress")
"""Fields for the von Mises stress, which water does not change."""


class RunPage:
    """The page of a result folder; it grows with the run.

    Args:
        folder: Result folder.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = Path(folder)
        self._begin()

    def _begin(self) -> None:
        self._run = self.run_id()
        self._of_case = case_facts(self.folder)
        self._moving = MovingSurface()
        self._surfaces: SurfaceSeries | None = None
        self._volumes: dict[float, int] = {}
        self._series: FrameSeries | None = None
        self._stress = ""
        self._missing = ""

    def run_id(self) -> str:
        """Identifies a run in the folder: it changes when a run starts or is resumed."""
        try:
            return str((self.folder / "case.yaml").stat().st_mtime_ns)
        except OSError:
            return ""

    def state(self) -> dict[str, Any]:
        """State of the data for a live page: the present amounts."""
        rows = 0
        try:
            with (self.folder / "histories.csv").open("rb") as file:
                rows = sum(1 for _ in file) - 1
        except OSError:
            pass
        return {
            "run": self.run_id(),
            "frames": len(frame_numbers(self.folder / "surface")),
            "rows": rows,
            "over": is_over(self.folder),
        }

    def html(self, data: str = "") -> str:
        """The page: with its data, or with requests to its server for them."""
        folder = resources.files("cdem.output") / "page"
        style = (folder / "page.css").read_text(encoding="utf-8")
        script = "\n".join((folder / name).read_text(encoding="utf-8") for name in SCRIPTS)
        script = f'"use strict";\n{script}'
        rules = [
            "default-src 'none'", f"script-src '{_hash(script)}'", f"style-src '{_hash(style)}'",
            "img-src data:", "base-uri 'none'", "form-action 'none'",
        ]  # fmt: skip
        if not data:
            rules.append("connect-src 'self'")
        # case files may come from strangers: all their names are escaped
        template = Environment(autoescape=True, keep_trailing_newline=True).from_string(
            (folder / "page.html").read_text(encoding="utf-8")
        )
        title = page_facts(self.folder)["title"] if data else "cdem"
        return template.render(
            title=title, version=__version__, policy="; ".join(rules), style=style, script=script,
            data=data, live=not data,
        )  # fmt: skip

    def whole(self, budget: int) -> str:
        """The page with all data in it.

        Args:
            budget: Largest size of the page [bytes].
        """
        place = secrets.token_hex()
        before, after = self.html(place).split(place)
        room = (budget - len((before + after).encode())) * 3 // 4
        data = self.pack(0, 0, room)
        for part in (0.96, 0.9, 0.7):  # the size of frames is an estimate
            if len(data) > room:
                data = self.pack(0, 0, int(part * room))
        return f"{before}{base64.b64encode(data).decode()}{after}"

    def pack(self, frames: int, rows: int, budget: int) -> bytes:
        """Frames and rows of the histories that are new to a client, and all texts.

        Args:
            frames, rows: Numbers already known to the client.
            budget: Largest size [bytes].
        """
        if self._run != self.run_id():
            self._begin()
        facts = page_facts(self.folder) | self._of_case | {"run": self._run}
        pack = Pack({"facts": facts})
        facts["leftOut"] += self._put_histories(pack, rows)
        self._look()
        moving = self._moving
        if moving.times and self._missing:
            facts["warnings"].append(f"later frames are not shown: {self._missing}")
        facts["missing"] = self._missing
        pack.header["framesKnown"] = len(moving.times)
        if len(moving.times) > frames:
            room = budget - len(pack.compressed())
            facts["leftOut"] += put_frames(pack, moving, self._surface, frames, room)
        return pack.compressed()

    # ------------------------------------------------------------------ reading

    def _look(self) -> None:
        """Add the new frames."""
        known = len(self._moving.times)
        if known == len(frame_numbers(self.folder / "surface")) and known:
            return
        try:
            self._surfaces, self._missing = SurfaceSeries(self.folder), ""
        except CdemError as error:
            self._missing = f"No moving picture: {error}"
            return
        self._find_stress()
        try:
            for frame in range(known, len(self._surfaces)):
                self._moving.add(*self._surface(frame))
        except CdemError as error:
            self._missing = str(error)

    def _find_stress(self) -> None:
        """Find the frames of the volume with stress, and match them to frames of the surface."""
        try:
            self._series = FrameSeries(self.folder)
        except CdemError:
            return
        names = self._series.names["CellData"]
        self._stress = next((name for name in STRESSES if name in names), "")
        self._volumes = {float(time): k for k, time in enumerate(self._series.times)}

    def _surface(self, frame: int) -> tuple[Surface, NDArray | None]:
        """The surface of a frame, and the stress of all elements if there is one."""
        assert self._surfaces is not None
        surface = self._surfaces[frame]
        place = self._volumes.get(surface.time)
        if self._series is None or not self._stress or place is None:
            return surface, None
        return surface, self._series.field("CellData", self._stress, place)

    def _put_histories(self, pack: Pack, known: int) -> list[str]:
        """Add the new rows of the histories; returns the reductions."""
        try:
            columns = read_histories(self.folder)
        except CdemError:
            columns = {}
        values = np.array(list(columns.values()) or np.zeros((0, 0)), "<f4")
        total = values.shape[1]
        every = max(1, int(np.ceil((total - known) / MOST_ROWS)))
        kept = np.arange(total - 1, known - 1, -every)[::-1]
        pack.header |= {"columns": list(columns), "rowsKnown": total}
        pack.put("history", values[:, kept])
        return [f"one row of {every} of the histories is drawn"] if every > 1 else []


def _hash(text: str) -> str:
    """Hash of a script or style for the content policy."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
