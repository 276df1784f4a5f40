"""Errors for the user: place, problem, remedy."""

from __future__ import annotations

from typing import Any


class CdemError(Exception):
    """Base of every error that is shown as one message, without a traceback.

    Attributes:
        exit_code: Exit status of the program ``cdem`` when the error reaches its top.
    """

    exit_code = 1


class CaseError(CdemError):
    """The case file is wrong: an unknown key, a bad value, or parts that contradict one another."""


class MeshError(CdemError):
    """The mesh is wrong: it cannot be read, or has an inverted or empty element."""


class BodyError(MeshError):
    """A body cannot be used: it is open or not convex.

    Attributes:
        points: Its corners, (corners, 3).
        faces: Corner numbers of each face.
        marks: Faults: two corner numbers for an edge, one for a corner.
    """

    def __init__(self, message: str, points: Any, faces: Any, marks: Any) -> None:
        super().__init__(message)
        self.points, self.faces, self.marks = points, faces, marks


class ModelError(CdemError):
    """Case and mesh are each sound but do not fit together."""


class UnstableError(CdemError):
    """The computation failed: a number is not finite, a runaway, or the time step collapsed."""

    exit_code = 3


class BackendError(CdemError):
    """The machine cannot do it: no compiled core, no such device, no such extra."""


class DiskError(BackendError):
    """A file cannot be written, e.g. because the disk is full."""
