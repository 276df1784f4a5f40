"""Check of node ids in gmsh files: meshio would take another node for a missing one."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import islice
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from cdem.errors import MeshError

LINEAR = {1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 15: 1}
"""Nodes of linear elements, by their type number in gmsh; other types are refused later."""


def check_node_ids(path: Path) -> None:
    """Refuse a gmsh file, of version 2 or 4.1, whose elements name missing nodes.

    Raises:
        MeshError: Names the element and the node, or an incomplete element.
    """
    with path.open("rb") as file:
        words = file.readline().split() and file.readline().split()
        version = words[0].decode("latin-1") if words else ""
        check = _CHECKS.get(("2" if version == "2.2" else version, words[1:2] == [b"1"]))
        if check and _go_to(file, b"$Nodes"):
            check(path, file)


def _go_to(file: BinaryIO, section: bytes) -> bool:
    return any(line.strip() == section for line in file)


def _check_text_2(path: Path, file: BinaryIO) -> None:
    count = int(file.readline())
    ids = {line.split(None, 1)[0] for line in islice(file, count)}
    if len(ids) < count:
        raise MeshError(f"{path}: declares {count} nodes, but has {len(ids)} different ids")
    if not _go_to(file, b"$Elements"):
        return
    needed = {str(kind).encode(): nodes for kind, nodes in LINEAR.items()}
    for line in islice(file, int(file.readline())):
        row = line.split()
        nodes = row[3 + int(row[2]) :]
        # a million elements a second; ids may be written in more than one way
        if len(nodes) != needed.get(row[1]) or not ids.issuperset(nodes):
            _check_row(path, set(map(int, ids)), [int(word) for word in row])


def _check_row(path: Path, ids: set[int], row: list[int]) -> None:
    nodes, needed = row[3 + row[2] :], LINEAR.get(row[1])
    if needed and len(nodes) != needed:
        raise MeshError(f"{path}: element {row[0]} has {len(nodes)} nodes and needs {needed}")
    if needed:
        _refuse_absent(path, row[0], nodes, ids)


def _check_text_4(path: Path, file: BinaryIO) -> None:
    ids: set[bytes] = set()
    for _ in range(int(file.readline().split()[0])):
        count = int(file.readline().split()[3])
        ids.update(line.strip() for line in islice(file, count))
        for _ in islice(file, count):  # their coordinates
            pass
    if _go_to(file, b"$Elements"):
        for _ in range(int(file.readline().split()[0])):
            for line in islice(file, int(file.readline().split()[3])):
                element, *nodes = line.split()
                if not ids.issuperset(nodes):  # or they are written differently
                    _refuse_absent(path, int(element), map(int, nodes), set(map(int, ids)))


def _refuse_absent(path: Path, element: int, nodes: Iterable[int], ids: set[int]) -> None:
    for node in nodes:
        if node not in ids:
            raise MeshError(
                f"{path}: element {element} names node {node}, which the file does not have; write "
                "the mesh again, completely"
            )


def _check_binary_2(path: Path, file: BinaryIO) -> None:
    nodes = np.fromfile(file, [("id", "<i4"), ("x", "<f8", 3)], int(file.readline()))
    if _go_to(file, b"$Elements"):
        left = int(file.readline())
        while left > 0:
            kind, count, tags = np.fromfile(file, "<i4", 3).tolist()
            if count <= 0 or kind not in LINEAR:
                return
            wide = 1 + tags + LINEAR[kind]
            rows = np.fromfile(file, "<i4", count * wide).reshape(count, wide)
            _check_rows(path, nodes["id"], rows[:, 0], rows[:, 1 + tags :])
            left -= count


def _check_binary_4(path: Path, file: BinaryIO) -> None:
    ids = [np.zeros(0, np.int64)]
    for _ in range(int(np.fromfile(file, "<i8", 4)[0])):
        np.fromfile(file, "<i4", 3)
        count = int(np.fromfile(file, "<i8", 1)[0])
        ids.append(np.fromfile(file, "<i8", count))
        np.fromfile(file, "<f8", 3 * count)
    if _go_to(file, b"$Elements"):
        for _ in range(int(np.fromfile(file, "<i8", 4)[0])):
            kind = int(np.fromfile(file, "<i4", 3)[2])
            count = int(np.fromfile(file, "<i8", 1)[0])
            if kind not in LINEAR:
                return
            rows = np.fromfile(file, "<i8", count * (1 + LINEAR[kind])).reshape(count, -1)
            _check_rows(path, np.concatenate(ids), rows[:, 0], rows[:, 1:])


def _check_rows(path: Path, ids: NDArray, elements: NDArray, nodes: NDArray) -> None:
    wrong = np.flatnonzero(~np.isin(nodes, ids).all(axis=1))
    if len(wrong):
        row = wrong[0]
        _refuse_absent(path, int(elements[row]), nodes[row].tolist(), set(ids.tolist()))


_CHECKS: dict[tuple[str, bool], Callable[[Path, BinaryIO], None]] = {
    ("2", False): _check_text_2,
    ("2", True): _check_binary_2,
    ("4.1", False): _check_text_4,
    ("4", False): _check_text_4,
    ("4.1", True): _check_binary_4,
    ("4", True): _check_binary_4,
}
"""Version, and whether the file is binary."""
