"""A model shared out to ranks, with the interface of `Core`."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.ranks.buffers import packed, unpacked
from cdem.ranks.exchange import Exchange, Neighbour
from cdem.ranks.kinds import PAIRS, Table, flat_of
from cdem.ranks.merge import own_rows, put_together
from cdem.ranks.parts import Fences, Mesh, Parts, divide, needed, work_of
from cdem.ranks.slices import Slice

if TYPE_CHECKING:
    from cdem._core import Core

SETTINGS = {"set_gravity", "set_damping", "set_rock_damping", "set_lumped", "keep_peaks"}
"""What changes no arrays: said to the whole model and to the part."""
SCALARS = {"keep_energy_scale", "release_forces"}
"""What changes scalars of the state alone."""
DYNAMIC = {
    "exposed", "slots", "predicted", "outer_edges", "outer_edge_pairs", "outer_vertex_faces",
}  # fmt: skip
"""Kinds whose rows have other numbers after a rebuild."""
SUMS = {"energies", "unbalance_ratio", "step_limit", "stable_step"}
"""Sums and largest values over all parts; of the whole state where that is known, by any rank."""
TOGETHER = {"renew_step", "leave_adaptive", "change_mass", *SCALARS}
"""Changes that ranks make in their parts, all at the same time."""
OF_MODEL = {
    "model",
    "absent_fields",
    "describe",
    "describe_scalars",
    "lift",
    "asks_area",
    "rebuild_interval",
}
"""What reads the model alone, which every rank has."""
READS = {"rebuilt", "describe_rows", "stress", "yielded", "bond_places"}
"""What only reads: from the whole state, put together on every rank where it is not known."""


WORTH = 2.0
"""Parts are dealt anew when waiting has taken so many times the time of that."""


class Fields(Mapping[str, NDArray[Any]]):
    """The stored arrays of a shared core by name: the whole state is put together for them."""

    def __init__(self, core: SharedCore) -> None:
        self._core = core
        self._names = [i["name"] for i in core.describe() if i["origin"] == "stored"]

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._names:
            raise KeyError(name)
        return self._core.array(name)[0]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class _Waits:
    """The exchange as the core has it; counts the time that this rank waits for others.

    Attributes:
        count: Number of ranks.
        seconds: Time spent in calls so far [s].
    """

    def __init__(self, exchange: Exchange) -> None:
        self._exchange, self.count, self.seconds = exchange, exchange.count, 0.0

    def add_up(self, words: NDArray[np.int64]) -> None:
        """See `Exchange`."""
        self._wait(self._exchange.add_up, words)

    def gather(self, own: NDArray[np.uint8], all: NDArray[np.uint8]) -> None:
        """See `Exchange`."""
        self._wait(self._exchange.gather, own, all)

    def swap(
        self, send: NDArray[np.float64], receive: NDArray[np.float64], numbers: int = 1
    ) -> None:
        """See `Exchange`."""
        self._wait(self._exchange.swap, send, receive, numbers)

    def _wait(self, call: Callable[..., None], *arguments: Any) -> None:
        begin = time.perf_counter()
        call(*arguments)
        self.seconds += time.perf_counter() - begin


class SharedCore:
    """A core whose model is shared out to ranks. All ranks call the same functions alike.

    A step is done by each rank for its part. The whole state is put together on every rank when
    something asks for it; what changes it between steps changes it there, and the parts are cut
    out of it again. So parts move with the rock, and any number of ranks goes on from anywhere.

    Arrays that it gives are read-only.
    """

    def __init__(self, whole: Core, exchange: Exchange) -> None:
        """Share a model.

        Args:
            whole: The whole model at its state; ranks have the same. It is used from here on.
            exchange: The ranks.
        """
        self.exchange = exchange
        self._whole, self._mesh = whole, Mesh.of(whole)
        self._whole_is_new, self._is_prepared = True, True
        self._part: Core | None = None
        self._slice: Slice | None = None
        self._waits = _Waits(exchange)
        self._parts: Parts | None = None
        self._pace: NDArray[np.float64] | None = None
        self._busy = self._cut_seconds = 0.0
        self._known: dict[str, NDArray[Any]] = {}
        self._rows: dict[str, NDArray[np.int64]] = {}
        self._counts = {kind["name"]: kind["count"] for kind in whole.describe_rows()}
        self.shared = 0

    def __getattr__(self, name: str) -> Any:
        """A function of the core, as the tables above have it."""
        if name.startswith("_"):
            raise AttributeError(name)
        if name in SETTINGS:
            return self._in_both(name)
        if name in TOGETHER and self._part is not None:
            return self._in_part(name)
        if name in SUMS and self._part is not None and not self._whole_is_new:
            return getattr(self._part, name)
        if name in OF_MODEL:
            return _read_only(getattr(self._whole, name))
        if name in READS | SUMS:
            return _read_only(getattr(self.whole(), name))
        return self._in_whole(name)

    def broken(self) -> tuple[int, int]:
        """Bond points broken so far, in tension and in shear."""
        if self._part is None or self._whole_is_new:
            return self._whole.broken()
        assert self._slice is not None
        sums = np.zeros(2, np.int64)
        for kind in PAIRS:
            own = self._slice.own[kind]
            for number, name in enumerate(("tension", "shear")):
                points = self._part.array(f"{kind}.broken_{name}")[0]
                sums[number] += int(points[: len(own)][own].sum())
        self.exchange.add_up(sums)
        return int(sums[0]), int(sums[1])

    def fast_weakenings(self) -> list[Any]:
        """See `Core.fast_weakenings`; most models have no such interface."""
        if self._part is not None and not self._whole_is_new:
            found = np.array([len(self._part.fast_weakenings())])
            self.exchange.add_up(found)
            if not found[0]:
                return []
        return self.whole().fast_weakenings()

    def fields(self) -> Mapping[str, NDArray[Any]]:
        """Stored arrays by name."""
        return Fields(self)

    def array(self, name: str) -> tuple[NDArray[Any], dict[str, Any]]:
        """An array and its description, see `Core.array`."""
        if self._part is not None and not self._whole_is_new:
            array, info = self._part.array(name)
            if info["origin"] == "given":
                return _frozen(self._whole.array(name))
            if self._gathers(name, array, info):
                return _frozen((self._known[name], info))
        return _frozen(self.whole().array(name))

    def scalars(self) -> dict[str, Any]:
        """Numbers of the state, which all ranks have."""
        return (self._whole if self._part is None else self._part).scalars()

    def seconds(self) -> tuple[float, ...]:
        """Time that this rank has spent, by phase of a step [s]."""
        return (self._whole if self._part is None else self._part).seconds()

    def run(self, steps: int, end_time: float = 1e300, **goal: Any) -> tuple[str, int, float]:
        """Do steps, see `Core.run`; ghosts are found anew when rock has moved."""
        while True:
            is_new = self._part is None
            part = self._cut()
            before = part.scalars()["step"]
            self._forget_whole()
            begin = time.perf_counter() - self._waits.seconds
            outcome, culprit, value = part.run(steps, end_time, **goal)
            self._busy += time.perf_counter() - self._waits.seconds - begin
            steps -= part.scalars()["step"] - before
            if outcome != "ghosts_due":
                break
            if is_new and part.scalars()["step"] == before:
                raise RuntimeError(
                    f"ghosts are due at once at step {before}; please report this case"
                )
            self._put_together()
            self._part = None
        self._balance()
        if outcome == "lost_contact":  # by exposed face
            exposed = self.whole().fields()["search.exposed_face"]
            culprit = int(np.searchsorted(exposed, culprit))
        return outcome, culprit, value

    def _balance(self) -> None:
        """Deal anew what the ranks waited for each other longer than that takes.

        Work is corrected by the time that each rank has needed for its own.
        """
        busy = np.concatenate(self.exchange.gather_rows(np.array([self._busy, self._cut_seconds])))
        spent, cutting = busy[::2], busy[1::2].max()
        if spent.max() - spent.mean() > WORTH * cutting:
            self._pace = np.maximum(spent, 0.1 * spent.mean()) / spent.mean()
            self._put_together()
            self._part = None

    def whole(self) -> Core:
        """The whole model at its present state, on every rank."""
        if not self._whole_is_new:
            self._put_together()
        if not self._is_prepared:
            self._whole.prepare()
            self._is_prepared = True
        return self._whole

    def _gathers(self, name: str, array: NDArray[Any], info: dict[str, Any]) -> bool:
        """Gather one array of the whole state, if its rows have the numbers of the model."""
        assert self._slice is not None
        kind, own = info["rows"], self._slice.own.get(info["rows"])
        if own is None or kind in DYNAMIC or info["layout"] == "starts" or any(info["refers_to"]):
            return False
        if name in self._known:
            return True
        sizes = [len(array), info["numbers"]]  # a rank may have no rows, and so no numbers of them
        length, numbers = np.max(self.exchange.gather_rows(np.array(sizes)), axis=0)
        if not length:
            self._known[name] = array.copy()
            return True
        if kind not in self._rows:
            rows = self._slice.keep[kind][own]
            self._rows[kind] = np.concatenate(self.exchange.gather_rows(rows))
        info["numbers"] = int(numbers)
        part = np.empty((0, numbers), array.dtype)
        if len(array):
            part = Table(info, array, len(own)).rows()[own]
        rows = np.empty((self._counts[kind], numbers), array.dtype)
        rows[self._rows[kind]] = np.concatenate(self.exchange.gather_rows(part))
        self._known[name] = flat_of(info, rows)
        return True

    def _in_both(self, name: str) -> Callable[..., Any]:
        def say(*arguments: Any, **named: Any) -> None:
            for core in (self._whole, self._part):
                if core is not None:
                    getattr(core, name)(*arguments, **named)

        return say

    def _in_part(self, name: str) -> Callable[..., Any]:
        part = self._part
        assert part is not None
        act = getattr(part, name)

        def change(*arguments: Any, **named: Any) -> Any:
            if name in SCALARS:
                result = act(*arguments, **named)
                self._whole.restore({}, part.scalars())
                return result
            self._forget_whole()
            return act(*arguments, **named)

        return change

    def _forget_whole(self) -> None:
        self._whole_is_new = self._is_prepared = False
        self._known = {}

    def _in_whole(self, name: str) -> Callable[..., Any]:
        act = getattr(self.whole(), name)

        def change(*arguments: Any, **named: Any) -> Any:
            self._part = None
            return act(*arguments, **named)

        return change

    def _put_together(self) -> None:
        """Make the whole state from the rows that each rank owns."""
        assert self._part is not None and self._slice is not None
        before = self._part.array("edge.old_first")[0]
        own = packed(own_rows(self._slice, self._part.fields(), before))
        ranks = [unpacked(theirs) for theirs in self.exchange.gather_rows(own)]
        self._whole.restore_anew(put_together(self._whole, ranks), self._part.scalars())
        self._whole_is_new, self._is_prepared = True, False

    def _cut(self) -> Core:
        """The part of this rank, cut out of the whole where that has changed."""
        if self._part is None:
            begin = time.perf_counter()
            whole = self.whole()
            work = work_of(whole, self._mesh)
            if self._parts is not None and self._pace is not None:
                of_rank = np.bincount(self._parts.of_element, work, self.exchange.count)
                of_rank = of_rank / of_rank.mean()
                work *= (self._pace / np.maximum(of_rank, 0.01))[self._parts.of_element]
            parts = divide(whole, self._mesh, self.exchange.count, work)
            self._parts, self._pace, self._busy = parts, None, 0.0
            fences = Fences.around(whole, self._mesh)
            rank = self.exchange.rank
            found = needed(whole, self._mesh, parts, fences, rank)
            found[0] |= not found.any()  # of more ranks than blocks: no core can be empty
            own = Slice(whole, np.flatnonzero(found), parts.of_element, parts.of_node, rank)
            share = self._share_of(own, parts)
            share["fence"] = fences.of_nodes(own.keep["nodes"]).ravel()
            del fences
            self._slice, self._part = own, self._part_of(own, share)
            self._whole_is_new = False
            self._rows = {}
            self.shared += 1
            self._cut_seconds = time.perf_counter() - begin
        return self._part

    def _part_of(self, own: Slice, share: dict[str, Any]) -> Core:
        """A core with the rows of a slice. The state of the whole is not needed any more."""
        whole, core = self._whole, native.Core()
        core.take_counts(own.counts())
        core.take_settings(whole)
        core.take_model(own.model())
        core.take_share(self._waits, share)
        state, scalars = own.state(), whole.scalars()
        own.forget_whole()
        whole.drop_state()
        motion = state["node.motion"].reshape(-1, 8)
        core.start(np.ascontiguousarray(motion[:, :3]).ravel())
        core.restore(state, scalars)
        core.prepare()
        return core

    def _share_of(self, own: Slice, parts: Parts) -> dict[str, Any]:
        """What a rank knows of its part, as `Core.take_share` has it."""
        model, nodes, faces = self._whole.model(), own.keep["nodes"], own.keep["faces"]
        block = model["node.block"]
        cut = _cut_blocks(block, parts.of_node)
        number = np.full(len(cut), -1, np.int32)
        number[cut] = np.arange(cut.sum())
        return {
            "own": {kind: _padded(flags) for kind, flags in own.own.items()},
            "tiles": _tiles(self._whole, own),
            "node": nodes.astype(np.int32), "face": faces.astype(np.int32),
            "block": block[nodes], "cut_block": number[block[nodes]], "cut_blocks": int(cut.sum()),
            **self._link(nodes, parts.of_node),
        }  # fmt: skip

    def _link(self, nodes: NDArray[np.int64], owner: NDArray[np.integer]) -> dict[str, Any]:
        """Agree with the other ranks on the nodes whose motion is sent."""
        rank, count = self.exchange.rank, self.exchange.count
        local = np.full(len(owner), -1, np.int32)
        local[nodes] = np.arange(len(nodes))
        wanted = [nodes[owner[nodes] == other] if other != rank else nodes[:0]
                  for other in range(count)]  # fmt: skip
        lengths = np.array([len(those) for those in wanted])
        all_lengths = np.array(self.exchange.gather_rows(lengths)).reshape(count, count)
        asked = self.exchange.gather_rows(np.concatenate(wanted))
        send: list[NDArray[np.int32]] = []
        receive: list[NDArray[np.int32]] = []
        neighbours, sent, received = [], 0, 0
        for other in range(count):
            first = all_lengths[other, :rank].sum()
            of_other = asked[other][first : first + all_lengths[other, rank]]
            send.append(local[of_other])
            receive.append(local[wanted[other]])
            ends = sent + len(of_other), received + len(wanted[other])
            if ends != (sent, received):
                neighbours.append(Neighbour(other, slice(sent, ends[0]), slice(received, ends[1])))
            sent, received = ends
        self.exchange.link(neighbours)
        return {"send": np.concatenate(send), "receive": np.concatenate(receive)}


def _cut_blocks(block: NDArray[np.int32], owner: NDArray[np.integer]) -> NDArray[np.bool_]:
    """Blocks whose nodes several ranks own."""
    count = int(block.max(initial=-1)) + 1
    least, most = np.full(count, owner.max(initial=0)), np.zeros(count, np.int64)
    np.minimum.at(least, block, owner)
    np.maximum.at(most, block, owner)
    cut: NDArray[np.bool_] = least < most
    return cut


def _padded(flags: NDArray[np.bool_]) -> NDArray[np.int8]:
    """Flags of rows, as long as columns of the core."""
    padded = np.zeros(native.padded_stride(len(flags)), np.int8)
    padded[: len(flags)] = flags
    return padded


def _tiles(whole: Core, own: Slice) -> dict[str, NDArray[np.int32]]:
    """Tile of the whole model of each eight elements, by shape."""
    tiles, rebuilt = {}, whole.rebuilt()
    for kind, rows in own.keep.items():
        if f"{kind}.tile.blocks" in rebuilt:
            first = rebuilt[f"{kind}.tile.blocks"]
            blocks = rows[::8] // 8
            tiles[kind] = (np.searchsorted(first, blocks, side="right") - 1).astype(np.int32)
    return tiles


def _read_only(found: Any) -> Any:
    """A function of the core whose arrays nobody changes: they would be lost."""

    def read(*arguments: Any, **named: Any) -> Any:
        result = found(*arguments, **named)
        for array in _arrays_in(result):
            array.flags.writeable = False
        return result

    return read


def _frozen(found: tuple[NDArray[Any], dict[str, Any]]) -> tuple[NDArray[Any], dict[str, Any]]:
    found[0].flags.writeable = False
    return found


def _arrays_in(result: Any) -> list[NDArray[Any]]:
    if isinstance(result, np.ndarray):
        return [result]
    if isinstance(result, Mapping):
        return [array for array in result.values() if isinstance(array, np.ndarray)]
    if isinstance(result, tuple):
        return [array for array in result if isinstance(array, np.ndarray)]
    return []
