"""Records the largest values of `FlowMaps` during a run, also between two frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.element_volumes import Solids
from cdem.mesh.hdf5_links import refuse_links
from cdem.rows import rows_of
from cdem.run.fields import block_of, group_of, pieces_of
from cdem.run.flow_maps import LAYERS, FlowMaps, Moment
from cdem.run.stage_state import StageState
from cdem.run.state import RunState
from cdem.whole_files import replaced

Floats = NDArray[np.float64]

FILE = "maxima.h5"
PREFIX = "maps."
"""Prefix of the names of its arrays in a checkpoint."""
STEP = 0.5
"""Fraction of a cell that the fastest node may move in plan between two looks."""
FALL = 9.81
"""Least acceleration assumed for a node between two looks [m/s2]."""


class FlowRecorder:
    """Takes in the moving groups whenever the fastest node may have moved half a cell in plan.

    Args:
        sim: A run whose case has `output.maps`.

    Attributes:
        maps: The recorded values.
        due: Time of the next look [s]; inf if none is scheduled.
        ended: Why recording stopped, or "".
    """

    def __init__(self, sim: RunState) -> None:
        wanted = sim.case.output.maps
        assert wanted is not None
        self.groups = wanted.groups or sim.case.movable
        topology, names = sim.build.topology, sim.build.group_names
        self._chosen = np.isin(group_of(sim), [names.index(name) for name in self.groups])
        self._block = block_of(sim)[self._chosen]
        self._cells: dict[str, NDArray[np.int32]] = {}
        for shape, nodes in topology.element_nodes.items():
            some = nodes[np.isin(topology.element_group[shape], self._numbers(sim))]
            if len(some):
                self._cells[shape] = some
        self._nodes = np.unique(np.concatenate([c.ravel() for c in self._cells.values()]))
        densities = [sim.case.materials[sim.case.groups[name].material].density for name in names]
        volume = Solids.of(sim.build.start_position, self._cells).volumes()
        self._mass = np.array(densities)[group_of(sim)[self._chosen]] * volume
        self.maps = FlowMaps(float(wanted.cell), 0.0)
        self.due, self.ended = np.inf, ""

    def _numbers(self, sim: RunState) -> list[int]:
        return [sim.build.group_names.index(name) for name in self.groups]

    def begin(self, sim: RunState, stage: StageState) -> None:
        """Start a stage: one that resets displacements restarts the run-out.

        Raises:
            CdemError: The cell is so small that the maps would be too large.
        """
        if sim.case.stages[sim.stage_index].reset_displacement:
            self.maps = FlowMaps(self.maps.cell, sim.time)
        self.due = np.inf
        if stage.mode == "dynamic":
            self.take_in(sim)

    def look(self, sim: RunState) -> None:
        """Record the present values if the maps have room; else recording stops, not the run."""
        if self.ended or not np.isfinite(sim.motion).all():  # the core reports the place
            self.due = np.inf
            return
        try:
            self.take_in(sim)
        except CdemError as error:
            self.due, self.ended = np.inf, f"output.maps: recording stopped: {error}"

    def take_in(self, sim: RunState) -> None:
        """Record the present values and schedule the next look.

        Raises:
            CdemError: The maps would be too large.
        """
        stays = ~sim.out[self._block]
        motion = rows_of(sim.core, "node.motion")
        solids = Solids.of(motion.position, self._cells).only(stays)
        mean = np.concatenate(
            [motion.velocity[nodes].mean(axis=1) for nodes in self._cells.values()]
        )
        piece = pieces_of(sim)[self._chosen][stays]
        self.maps.take_in(Moment(sim.time, solids, mean[stays], self._mass[stays], piece))
        speed = float(np.linalg.norm(motion.velocity[self._nodes, :2], axis=1).max(initial=0.0))
        fall = max(FALL, float(np.linalg.norm([float(g) for g in sim.case.loads.gravity])))
        way = STEP * self.maps.cell
        self.due = sim.time + (np.sqrt(speed**2 + 2 * fall * way) - speed) / fall

    # ------------------------------------------------------------------ keeping

    @property
    def arrays(self) -> dict[str, Floats]:
        """All data to continue bit for bit."""
        m = self.maps
        numbers = [m.start, *m.low, *m.layers.shape[1:], m.last, m.jump, self.due, bool(self.ended)]
        return {
            f"{PREFIX}numbers": np.array(numbers, float),
            f"{PREFIX}layers": m.layers.ravel(),
            f"{PREFIX}middles": m.middles.ravel(),
        }

    def restore(self, arrays: dict[str, Floats]) -> str:
        """Continue from the arrays of a checkpoint; returns the fault in them, or ""."""
        try:
            numbers, layers, middles = (arrays[name] for name in self.arrays)
            self.maps = _maps_of(self.maps.cell, numbers, layers, middles)
            self.due = float(numbers[-2])
            self.ended = "output.maps: recording stopped" if numbers[-1] else ""
        except (KeyError, ValueError, IndexError, OverflowError):
            return "its maps are incomplete"
        return ""

    def write(self, folder: Path, time: float) -> None:
        """Write maxima.h5 into a result folder, for `cdem runout`.

        Args:
            folder: The result folder.
            time: End of the recording [s].
        """
        import h5py

        with replaced(folder / FILE) as file, h5py.File(file, "w") as hdf5:
            for name, values in self.arrays.items():
                hdf5[name.removeprefix(PREFIX)] = values
            hdf5.attrs["cell"] = self.maps.cell
            hdf5.attrs["time"] = self.maps.last if self.ended else time
            hdf5.attrs["groups"] = self.groups


def read_maxima(folder: Path) -> tuple[FlowMaps, list[str], float] | None:
    """The maps recorded by a run, their groups, and the end of the recording; None without maps.

    Raises:
        CdemError: The file is damaged.
    """
    import h5py

    path = folder / FILE
    if not path.is_file():
        return None
    try:
        with h5py.File(path, "r") as hdf5:
            refuse_links(hdf5, path, kind=CdemError)
            numbers, layers, middles = (hdf5[n][()] for n in ("numbers", "layers", "middles"))
            maps = _maps_of(float(hdf5.attrs["cell"]), numbers, layers, middles)
            time = float(hdf5.attrs["time"])
            groups = [str(name) for name in hdf5.attrs["groups"]]
    except (OSError, KeyError, ValueError, OverflowError, RuntimeError) as error:
        raise CdemError(
            f"{path}: is damaged ({error}); move it away to make maps from frames"
        ) from None
    return maps, groups, time


def _maps_of(cell: float, numbers: Floats, layers: Floats, middles: Floats) -> FlowMaps:
    """Maps from the stored arrays."""
    start, column, row, rows, columns, last, jump = (float(n) for n in numbers[:7])
    return FlowMaps(
        cell, start, (int(column), int(row)),
        layers.reshape(len(LAYERS), int(rows), int(columns)), last, middles.reshape(-1, 2), jump,
    )  # fmt: skip
