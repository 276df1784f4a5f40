"""Frames of a moving surface in few bytes: the data of report.html and `cdem view`.

A pack is the length of a header in JSON (four bytes), the header, and arrays one after the other,
compressed by gzip. `unpack` of the page's run.js reads it.

- Positions are whole numbers in the box of the frames. A frame holds the second difference in time
  and its difference from node to node, folded so that small values are small numbers (zigzag),
  low bytes before high bytes.
- Amounts are bytes of the root of their share of the largest value, so that small amounts keep
  their order on a logarithmic scale; labels are numbers; a frame holds differences.
- Rows that a frame lacks keep their last value, or have their first value in advance: no
difference.
"""

from __future__ import annotations

import json
import zlib
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.output.moving_surface import NEVER, MovingSurface, SurfaceOf, values_of

LEVEL = 6
"""Level of gzip: level 9 takes three times as long and saves 2 %."""
SAMPLES = 6
"""Number of frames for an estimate of the total size."""
GZIP = 31
"""Setting of zlib for gzip, without a time stamp."""
WIDEST = 8.0
"""Largest distinct value of a field, over the value of the last colour."""
HELD = 100_000_000
"""Most memory for positions of all frames [bytes]; else some frames are skipped at once."""


@dataclass(frozen=True)
class Rung:
    """A level of reduction.

    Attributes:
        bits: Bits of a coordinate.
        fine: Steps, of 255, from one amount to the next.
        every: Distance of kept frames.
    """

    bits: int
    fine: int
    every: int


LADDER = [Rung(16, 1, 1), Rung(14, 1, 1), Rung(14, 5, 1), Rung(12, 5, 1)] + [
    Rung(12, 5, every) for every in (2, 3, 4, 5, 7, 10, 15, 22, 33, 50)
]
"""Levels from no reduction to the strongest."""


@dataclass
class _Held:
    """Values of the kept frames, by row.

    Attributes:
        frames: Their numbers.
        place: Positions in the finest steps, shape (frames, nodes, 3).
        values: Values by field, shape (frames, rows).
        high: Value of byte 255, by field.
        bars: Ends of the bars of bolts relative to the low corner of the box [m], by frame.
    """

    frames: NDArray[np.int64]
    place: NDArray[np.uint16]
    values: dict[str, NDArray[np.uint8]]
    high: dict[str, float]
    bars: list[NDArray[np.float32]]


class Pack:
    """Arrays and a header, written as one piece.

    Attributes:
        header: Data for JSON.
    """

    def __init__(self, header: dict[str, Any]) -> None:
        self.header = header | {"arrays": {}}
        self._parts: list[bytes] = []
        self._size = 0

    def put(self, name: str, values: NDArray) -> None:
        """Add an array as bytes of its own type, little-endian."""
        content = np.ascontiguousarray(values).tobytes()
        self.header["arrays"][name] = [self._size, len(content)]
        self._parts.append(content)
        self._size += len(content)

    def compressed(self) -> bytes:
        """All bytes; equal contents give equal bytes."""
        header = json.dumps(self.header).encode()
        squeeze = zlib.compressobj(LEVEL, wbits=GZIP)
        parts = [len(header).to_bytes(4, "little"), header, *self._parts]
        return b"".join([*map(squeeze.compress, parts), squeeze.flush()])


def put_frames(
    pack: Pack, moving: MovingSurface, surface_of: SurfaceOf, first: int, budget: int
) -> list[str]:
    """Add the frames from `first` on to a pack, with their new rows.

    To meet the budget, digits are dropped first, then frames.

    Args:
        pack: The pack.
        moving: The surface with all frames added.
        surface_of: Gives the surface of a frame.
        first: Number of the first frame.
        budget: Largest size of the frames [bytes].

    Returns:
        The reductions, in words.
    """
    total = len(moving.times)
    bytes_a_frame = max(6 * len(moving.nodes), 1)
    sparse = max(1, int(np.ceil((total - first) * bytes_a_frame / HELD)))
    held = _hold(moving, surface_of, _every(first, total, sparse))
    _put_rows(pack, moving, first)
    room = budget - len(pack.compressed())
    rung = next((r for r in LADDER if _estimate(held, r) <= room), LADDER[-1])
    kept = _every(0, len(held.frames), rung.every)
    frames = held.frames[kept]
    size = _size(moving)
    _put_coming_and_going(pack, moving, first, frames)
    pack.put("place", _coded_places(_coarse(held.place[kept], rung.bits)))
    for name, values in held.values.items():
        fine = rung.fine if name in held.high else 1
        pack.put(f"field.{name}", _coded_bytes(_rounded(values[kept], fine)))
    bars = [held.bars[k] for k in kept]
    pack.put("bars", np.concatenate(bars))
    pack.header |= {
        "bars": [len(some) for some in bars],
        "times": [moving.times[k] for k in frames],
        "low": moving.lowest.tolist(),
        "box": moving.highest.tolist(),
        "step": size / (2**rung.bits - 1),
        "high": held.high,
    }
    told = []
    if rung.bits < 16:
        told.append(f"positions are rounded to {size / (2**rung.bits - 1):.2g} m")
    if rung.fine > 1:
        told.append(f"fields have {255 // rung.fine} steps from nothing to their largest value")
    if len(frames) < total - first:
        told.append(f"{len(frames)} of {total - first} frames are shown")
    return told


def _every(first: int, total: int, step: int) -> NDArray[np.int64]:
    """Numbers below a total at a fixed distance, counted from the last, and the first."""
    return (
        np.unique([first, *range(total - 1, first - 1, -step)])
        if total > first
        else np.zeros(0, np.int64)
    )


def _size(moving: MovingSurface) -> float:
    """Longest side of the box of all frames [m]."""
    return float((moving.highest - moving.lowest).max()) or 1.0


def _hold(moving: MovingSurface, surface_of: SurfaceOf, frames: NDArray[np.int64]) -> _Held:
    """Read frames into arrays by row."""
    rows = {
        "node": len(moving.nodes),
        "element": len(moving.elements),
        "face": len(moving.faces.born),
    }
    changing = {n: f for n, f in moving.fields.items() if n not in ("group", "block", "joint")}
    high = {
        name: min(moving.most[name], WIDEST * moving.top[name]) or moving.most[name] or 1.0
        for name, f in changing.items() if f.kind == "amount" and name in moving.most
    }  # fmt: skip
    place = np.zeros((len(frames), rows["node"], 3), np.uint16)
    values = {n: np.zeros((len(frames), rows[f.on]), np.uint8) for n, f in changing.items()}
    scale = 65535 / _size(moving)
    latest = np.round((moving.last - moving.lowest) * scale).clip(0, 65535).astype(np.uint16)
    bars, known = [], -1
    for k, frame in enumerate(frames):
        surface, stress = surface_of(int(frame))
        where = moving.rows(surface)
        place[k] = place[k - 1] if k else latest
        whole = np.isfinite(surface.points).all(axis=1)
        inside = (surface.points[whole] - moving.lowest) * scale
        place[k, where["node"][whole]] = np.round(inside).clip(0, 65535)
        for name, of in values_of(surface, stress).items():
            if name in changing:
                values[name][k] = values[name][k - 1] if k else 0
                values[name][k, where[changing[name].on]] = _bytes(of, high.get(name))
        born = moving.nodes.born
        comes = np.flatnonzero((born > known) & (born <= frame))
        known = int(frame)
        place[:k, comes] = place[k, comes]
        bars.append((surface.bolts - moving.lowest).astype("<f4"))
    return _Held(frames, place, values, high, bars)


def _bytes(values: NDArray, high: float | None) -> NDArray[np.uint8]:
    """Roots of amounts relative to the largest; labels unchanged."""
    if high is None:
        return np.clip(values, 0, 255).astype(np.uint8)
    part = np.nan_to_num(values / high, nan=0.0, posinf=1.0, neginf=0.0)
    return np.round(255 * np.sqrt(part.clip(0, 1))).astype(np.uint8)


def _coarse(place: NDArray[np.uint16], bits: int) -> NDArray[np.uint16]:
    """Round 16-bit positions to fewer bits."""
    if bits == 16:
        return place
    return np.round(place * np.float32((2**bits - 1) / 65535)).astype(np.uint16)


def _rounded(values: NDArray[np.uint8], fine: int) -> NDArray[np.uint8]:
    """Round bytes to multiples of a divisor of 255."""
    if fine == 1:
        return values
    return ((values.astype(np.uint16) + fine // 2) // fine * fine).astype(np.uint8)


def _coded_places(place: NDArray[np.uint16]) -> NDArray[np.uint8]:
    """Differences in time and from node to node, modulo 65536, folded; low bytes, then high bytes."""
    coded = np.zeros((len(place), 2, place[:1].size), np.uint8)
    zero = np.zeros_like(place[0]) if len(place) else place
    before, change = zero, zero
    for k, now in enumerate(place):
        difference = now - before
        second = difference - change if k > 1 else difference.copy()
        second[1:] -= second[:-1].copy()  # nodes of an element move similarly
        signed = second.view(np.int16)
        folded = ((signed << 1) ^ (signed >> 15)).view(np.uint16).ravel()
        coded[k] = folded & 255, folded >> 8
        before, change = now, difference
    return coded


def _coded_numbers(numbers: NDArray[np.int64]) -> NDArray[np.uint32]:
    """Difference from row to row, modulo 2^32."""
    coded = numbers.astype("<u4")
    coded[1:] -= numbers[:-1].astype("<u4")
    return coded


def _coded_bytes(values: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """First difference in time, modulo 256."""
    coded = values.copy()
    coded[1:] -= values[:-1]
    return coded


def _estimate(held: _Held, rung: Rung) -> float:
    """Estimated size of the frames, from a few of them [bytes]."""
    kept = _every(0, len(held.frames), rung.every)
    if not len(kept):
        return 0.0
    some = np.unique(np.linspace(0, len(kept) - 1, min(SAMPLES, len(kept))).astype(int))
    sizes = []
    for k in some:
        window = kept[max(0, k - 2) : k + 1]
        parts = [_coded_places(_coarse(held.place[window], rung.bits))[-1]]
        for name, values in held.values.items():
            fine = rung.fine if name in held.high else 1
            parts.append(_coded_bytes(_rounded(values[window[-2:]], fine))[-1])
        sizes.append(sum(len(zlib.compress(part.tobytes(), LEVEL)) for part in parts))
    return sizes[0] + float(np.mean(sizes[1:] or [0])) * (len(kept) - 1)


def _put_rows(pack: Pack, moving: MovingSurface, first: int) -> None:
    """Add the triangles and elements that appear from a frame on."""
    triangles, face, edges = _triangles(moving)
    faces = moving.faces
    new = faces.born[face] >= first
    elements = moving.elements.born >= first
    pack.put("triangle", _coded_numbers(triangles[new]))
    pack.put("element", _coded_numbers(faces.element[face[new]]))
    pack.put("face", _coded_numbers(face[new]))
    pack.put("edges", edges[new].astype(np.uint8))
    pack.put("joint", faces.joint[face[new]].clip(0, 255).astype(np.uint8))
    pack.put("group", moving.group[elements].clip(0, 255).astype(np.uint8))
    pack.put("block", _coded_numbers(moving.block[elements]))
    pack.header |= {
        "nodes": len(moving.nodes),
        "groups": moving.group_names,
        "fields": [asdict(f) | {"top": _top(moving, f.name)} for f in moving.fields.values()],
    }


def _put_coming_and_going(
    pack: Pack, moving: MovingSurface, first: int, frames: NDArray[np.int64]
) -> None:
    """Add the number of triangles that have appeared by each frame, and the disappearing ones."""
    _, face, _ = _triangles(moving)
    born, goes = moving.faces.born[face], moving.faces.goes[face]
    went = np.flatnonzero((goes != NEVER) & (goes >= first))
    pack.put("goes", np.stack([went, np.searchsorted(frames, goes[went])], axis=1).astype("<u4"))
    pack.header["shown"] = np.searchsorted(born, frames, side="right").tolist()


def _top(moving: MovingSurface, name: str) -> float:
    """Value with the last colour."""
    if name == "damage":
        return 1.0
    return moving.top.get(name, 0.0) or moving.most.get(name, 0.0) or 1.0


def _triangles(
    moving: MovingSurface,
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Triangles of all faces in their order: rows of nodes, of faces, and a mask of true edges.

    The sides are bits: 1, 2, 4 for the side opposite the first, second, third corner. The diagonal
    of a quadrilateral is not an edge.
    """
    nodes = moving.faces.nodes
    halves = np.where(nodes[:, 3] >= 0, 2, 1)
    face = np.repeat(np.arange(len(nodes)), halves)
    second = np.concatenate([[False], face[1:] == face[:-1]]) if len(face) else np.zeros(0, bool)
    whole = halves[face] == 1
    corners = np.where(second[:, None], nodes[face][:, [0, 2, 3]], nodes[face][:, :3])
    # the diagonal is opposite to the second corner of half 0 1 2 and to the third of half 0 2 3
    edges = np.where(whole, 7, np.where(second, 7 - 4, 7 - 2))
    return corners, face, edges
