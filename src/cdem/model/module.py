"""Interface of a module in the build: an action on nodes beyond the basic method.

The list of modules is `modules.MODULES`; `core/model/module.hpp` has the answers of the core.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.interface_schema import Interface
from cdem.mesh.topology import Topology
from cdem.model.boundaries import Boundaries
from cdem.model.curves import Curves
from cdem.model.flat_arrays import Assembly, Floats, Ints

if TYPE_CHECKING:
    from cdem._core import Core


@dataclass(frozen=True)
class Parts:
    """Data for the arrays of a module.

    Attributes:
        case: The present case.
        topology: Blocks, elements, faces and pairs of the mesh.
        laws: Interfaces, see `interfaces_of`.
        interface_of: Index of the interface between two kinds of faces, shape (kinds, kinds).
        curves: Curves of the model; a module adds its own.
        boundaries: Quiet and driven boundaries, and which of them act.
        stride: The core's function from item count to table stride.
        assembly: All arrays except those of modules; receives the arrays of modules.
    """

    case: Case
    topology: Topology
    laws: list[Interface]
    interface_of: NDArray[np.integer]
    curves: Curves
    boundaries: Boundaries
    stride: Callable[[int], int]
    assembly: Assembly

    @property
    def names(self) -> list[str]:
        """Names of the groups, by index."""
        return self.topology.group_names


class Built(Protocol):
    """A model ready to run, as a report sees it, see `Build`."""

    @property
    def case(self) -> Case: ...
    @property
    def core(self) -> Core: ...
    @property
    def topology(self) -> Topology: ...
    @property
    def arrays(self) -> dict[str, NDArray]: ...
    @property
    def start_position(self) -> Floats: ...
    @property
    def group_names(self) -> list[str]: ...


class Module:
    """A module in one model: its items.

    It adds no arrays if the case has no items: the core then runs without them. Methods that a
    module does not override have the usual answer.
    """

    name: ClassVar[str]
    """Name of its items in the core, and of its report."""

    @classmethod
    def of(cls, case: Case, t: Topology, names: list[str]) -> Module:
        """The module of a case; made once, at the start.

        Args:
            case: The case.
            t: Blocks, elements, faces and pairs.
            names: Names of the groups, by index.
        """
        raise NotImplementedError

    def corner_nodes(self) -> Ints:
        """Node of each of its rows among the corner forces, or -1, shape (rows,)."""
        return np.zeros(0, np.int32)

    def node_stiffness(self, nodes: int) -> Floats:
        """Its largest stiffness at each node [N/m], shape (nodes,)."""
        return np.zeros(nodes)

    def joined_blocks(self) -> Ints:
        """Pairs of blocks joined at the start, shape (pairs, 2)."""
        return np.zeros((0, 2), np.int32)

    def add_arrays(self, parts: Parts) -> None:
        """Add its arrays and counts to the assembly, from the present case.

        Raises:
            CaseError: An entry cannot be read.
        """
        raise NotImplementedError

    def refuse_change(self, case: Case, was: dict[str, int], now: dict[str, int]) -> None:
        """Refuse changes that no stage can make.

        Args:
            case: The present case.
            was: Counts of the assembly at the start.
            now: Counts of the present case.

        Raises:
            CaseError: A stage has changed it.
        """

    def report(self, build: Built) -> Any:
        """Its data for the audit, ready for JSON; empty or None if the case has no items."""
        raise NotImplementedError

    def lines(self, report: Any) -> list[str]:
        """The same as lines of text."""
        raise NotImplementedError
