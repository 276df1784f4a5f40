"""Packs hold what they were given, and as little of it as the budget asks."""

from __future__ import annotations

import gzip
import json

import numpy as np
import pytest
from shared.moving import SHOWN, place, surface

from cdem.output.moving_surface import MovingSurface
from cdem.output.pack import LADDER, Pack, put_frames

ROOMY = 10**9


def moving():
    found = MovingSurface()
    for frame in range(len(SHOWN)):
        found.add(surface(frame))
    return found


def packed(first=0, budget=ROOMY):
    pack = Pack({})
    told = put_frames(pack, moving(), lambda k: (surface(k), None), first, budget)
    return *read(pack.compressed()), told


def read(content):
    """Header and arrays, as run.js reads them."""
    raw = gzip.decompress(content)
    size = int.from_bytes(raw[:4], "little")
    header, start = json.loads(raw[4 : 4 + size]), 4 + size
    return header, {
        name: np.frombuffer(raw[start + at : start + at + length], np.uint8)
        for name, (at, length) in header["arrays"].items()
    }


def places(header, arrays):
    """Positions by frame and row [m]."""
    frames, nodes = len(header["times"]), header["nodes"]
    coded = arrays["place"].reshape(frames, 2, -1).astype(np.uint16)
    folded = coded[:, 0] | coded[:, 1] << 8
    change = ((folded >> 1) ^ -(folded & 1)).astype(np.uint16).reshape(frames, nodes, 3)
    change = np.cumsum(change, axis=1, dtype=np.uint16)
    change[1:] = np.cumsum(change[1:], axis=0, dtype=np.uint16)
    place = np.cumsum(change, axis=0, dtype=np.uint16)
    return header["low"] + header["step"] * place.astype(float)


def numbers(array, width=1):
    return np.cumsum(array.view("<u4").reshape(-1, width), axis=0, dtype=np.uint32)


def test_positions_come_back_to_half_a_step():
    header, arrays, told = packed()
    found, rows = places(header, arrays), moving().nodes
    assert told == []
    for frame in range(len(SHOWN)):
        here = np.isin(rows.number, surface(frame).point_data["node"])
        there = place(frame)[rows.number]
        assert np.abs(found[frame] - there)[here].max() <= 0.501 * header["step"]
    assert header["step"] == pytest.approx((moving().highest - moving().lowest).max() / 65535)


def test_roots_of_fields_come_back_to_half_a_step_of_255():
    header, arrays, _ = packed()
    values = np.cumsum(arrays["field.damage"].reshape(4, -1), axis=0, dtype=np.uint8)
    root = np.sqrt(header["high"]["damage"])
    assert values[3] / 255 * root == pytest.approx(np.sqrt([0, 0.5, 1]), abs=0.002)


def test_amounts_over_four_powers_of_ten_stay_apart():
    few = surface(3)
    few.cell_data["damage"] = np.array([1e-4, 1e-3, 1.0])
    found, pack = MovingSurface(), Pack({})
    found.add(few)
    put_frames(pack, found, lambda _: (few, None), 0, ROOMY)
    header, arrays = read(pack.compressed())
    amounts = (arrays["field.damage"] / 255) ** 2 * header["high"]["damage"]
    low, middle, high = sorted(amounts)
    assert low == pytest.approx(1e-4, rel=0.4) and middle == pytest.approx(1e-3, rel=0.1)
    assert high == 1.0


def test_quadrilaterals_are_two_triangles_without_the_diagonal():
    header, arrays, _ = packed()
    assert numbers(arrays["triangle"], 3)[:3].tolist() == [[0, 1, 4], [0, 1, 2], [0, 2, 3]]
    assert arrays["edges"].tolist()[:3] == [7, 5, 3]
    assert numbers(arrays["element"]).ravel().tolist() == [1, 0, 0, 2, 1]
    assert header["shown"] == [3, 4, 4, 5]
    assert arrays["goes"].view("<u4").tolist() == [0, 2]


def test_later_frames_go_on_where_the_first_ended():
    header, arrays, _ = packed(first=2)
    assert header["times"] == [1.0, 1.5] and header["shown"] == [4, 5]
    assert numbers(arrays["triangle"], 3).tolist() == [[0, 1, 4]]
    assert arrays["goes"].view("<u4").tolist() == [0, 0]
    assert places(header, arrays)[1][:6] == pytest.approx(place(3), abs=header["step"])


def test_a_small_budget_leaves_out_digits_then_frames_and_says_so():
    header, _, told = packed(budget=0)
    assert header["step"] == pytest.approx((moving().highest - moving().lowest).max() / 4095)
    assert header["times"] == [0, 1.5]  # the first and the last stay
    assert told[0].startswith("positions are rounded to 0.0")
    assert told[1:] == [
        "fields have 51 steps from nothing to their largest value", "2 of 4 frames are shown"
    ]  # fmt: skip
    assert all(255 % rung.fine == 0 for rung in LADDER)
