"""A result folder opened from Python: numbers, tables, and meshes for pyvista."""

from __future__ import annotations

import html
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.named import Named
from cdem.output.meshes import surface_mesh, volume_mesh
from cdem.output.reader import FrameSeries, SurfaceSeries, read_histories, read_summary
from cdem.output.report import info
from cdem.output.web_page import RunPage

NOTEBOOK = 3_000_000
"""Largest size of the page inside a notebook [bytes]."""


def open_results(folder: str | Path) -> Results:
    """Open the result folder of a run, which may be in progress.

    Args:
        folder: The folder written by `cdem run -o` or `Simulation(output=...)`.

    Raises:
        CdemError: It is not a result folder.
    """
    return Results(Path(folder))


class Results:
    """Results of a run in its folder; files are read on demand.

    Frames are numbered from 0; negative numbers count from the end. A notebook shows it as the
    page of the run.

    Attributes:
        folder: The result folder.

    Example:
        >>> import cdem
        >>> results = cdem.open("incline.results")  # doctest: +SKIP
        >>> results.histories["block.displacement_x [m]"].max()  # doctest: +SKIP
        >>> results.volume(-1).plot(scalars="stress")  # doctest: +SKIP
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        if not (folder / "histories.csv").is_file():
            raise CdemError(f"{folder}: no histories.csv; is this a result folder?")

    def __repr__(self) -> str:
        return f"Results({str(self.folder)!r})"

    def __len__(self) -> int:
        """Number of frames."""
        return len(self.times)

    @property
    def summary(self) -> dict[str, Any]:
        """Content of summary.json.

        Raises:
            CdemError: The run has not ended.
        """
        return read_summary(self.folder)

    @property
    def histories(self) -> dict[str, NDArray[np.float64]]:
        """Columns of histories.csv by name, e.g. "time [s]"."""
        return Named("column", read_histories(self.folder))

    def table(self) -> Any:
        """The histories as a table of pandas.

        Raises:
            CdemError: pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            raise CdemError("tables need pandas; pip install pandas, or use histories") from None
        return pandas.DataFrame(self.histories)

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the frames [s]."""
        return self._surfaces.times

    @cached_property
    def _surfaces(self) -> SurfaceSeries:
        return SurfaceSeries(self.folder)

    @cached_property
    def _volumes(self) -> FrameSeries:
        return FrameSeries(self.folder)

    def surface(self, frame: int = -1) -> Any:
        """The outer and broken faces of a frame, a PolyData of pyvista with fields.

        Raises:
            CdemError: pyvista is not installed, or there is no such frame.
        """
        self._check(frame)
        return surface_mesh(self._surfaces[frame])

    def volume(self, frame: int = -1) -> Any:
        """All elements of a frame, an UnstructuredGrid of pyvista with the fields of `output.fields`.

        Raises:
            CdemError: pyvista is not installed, or there is no such frame.
        """
        self._check(frame)
        return volume_mesh(self._volumes, range(len(self._volumes))[frame])

    def _check(self, frame: int) -> None:
        if not -len(self) <= frame < len(self):
            raise CdemError(f"{self.folder}: no frame {frame}; there are {len(self)}")

    def _repr_html_(self) -> str:
        """Display in a notebook: the page of the run, or its summary if pages are not shown."""
        try:
            text = info(self.folder)
        except CdemError as error:
            text = str(error)
        page = html.escape(RunPage(self.folder).whole(NOTEBOOK))
        return (
            f"<details><summary>{html.escape(str(self))}</summary>"
            f"<pre>{html.escape(text)}</pre></details>"
            f'<iframe srcdoc="{page}" sandbox="allow-scripts allow-downloads" '
            'style="width:100%;height:720px;border:0"></iframe>'
        )
