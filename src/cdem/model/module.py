"""What the build asks of a module: of what acts on nodes and is no part of the method itself.

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
from cdem.model.curves import Curves
from cdem.model.flat_arrays import Assembly, Floats, Ints

if TYPE_CHECKING:
    from cdem._core import Core


@dataclass(frozen=True)
class Parts:
    """What arrays of a module are made from.

    Attributes:
        case: The case as it is now.
        topology: Blocks, elements, faces and pairs, as the mesh has them.
        laws: Interfaces, see `interfaces_of`.
        interface_of: Which of them is between two kinds of faces, shape (kinds, kinds).
        curves: Those of the model; a module adds its own.
        stride: The core's function from item count to table stride.
        assembly: All but modules; takes the arrays of modules.
    """

    case: Case
    topology: Topology
    laws: list[Interface]
    interface_of: NDArray[np.integer]
    curves: Curves
    stride: Callable[[int], int]
    assembly: Assembly

    @property
    def names(self) -> list[str]:
        """Names of the groups, by index."""
        return self.topology.group_names


class Built(Protocol):
    """What a report may ask of a model that is ready to run, see `Build`."""

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

    It adds no arrays where the case has no items: the core does without them. What a module does not
    answer has the answer of most.
    """

    name: ClassVar[str]
    """Of its items in the core, and of its report."""

    @classmethod
    def of(cls, case: Case, t: Topology, names: list[str]) -> Module:
        """That of a case; made once, at the start.

        Args:
            case: The case.
            t: Blocks, elements, faces and pairs.
            names: Names of the groups, by index.
        """
        raise NotImplementedError

    def corner_nodes(self) -> Ints:
        """Node of each of its rows among the corner forces, -1 where there is none, shape (rows,)."""
        return np.zeros(0, np.int32)

    def node_stiffness(self, nodes: int) -> Floats:
        """What it puts on each node at most [N/m], shape (nodes,)."""
        return np.zeros(nodes)

    def joined_blocks(self) -> Ints:
        """Pairs of blocks that it joins at the start, shape (pairs, 2)."""
        return np.zeros((0, 2), np.int32)

    def add_arrays(self, parts: Parts) -> None:
        """Add its arrays and counts to the assembly, from the case as it is now.

        Raises:
            CaseError: An entry cannot be read.
        """
        raise NotImplementedError

    def refuse_change(self, case: Case, was: dict[str, int], now: dict[str, int]) -> None:
        """Refuse what no stage can change.

        Args:
            case: The case as it is now.
            was: Counts of the assembly at the start.
            now: The same of the case as it is now.

        Raises:
            CaseError: A stage has changed it.
        """

    def report(self, build: Built) -> Any:
        """What the audit says of it, ready for JSON; empty or None where the case has no items."""
        raise NotImplementedError

    def lines(self, report: Any) -> list[str]:
        """The same as lines of text."""
        raise NotImplementedError
