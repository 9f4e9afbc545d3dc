"""The tree of multi-bound tree search, and the queues of nodes that wait for a bound."""

import heapq
from dataclasses import dataclass, field
from itertools import count

from converter.shape import FloatArray
from planner.lgp import Bound
from planner.logic import Action, Skeleton, SymbolicState


@dataclass(eq=False)
class TreeNode:
    """An action sequence.

    Attributes:
        state: What is held and what lies where after it.
        parent: The sequence without its last action; None for the root.
        action: The last action.
        costs: Cost of each bound that has been computed.
        solutions: Optimum of each of them.
        infeasible: Whether one of them was infeasible.
        queued: Whether the pose bound has been asked for.
    """

    state: SymbolicState
    parent: "TreeNode | None" = None
    action: Action | None = None
    costs: dict[Bound, float] = field(default_factory=dict)
    solutions: dict[Bound, FloatArray] = field(default_factory=dict)
    infeasible: bool = False
    queued: bool = False

    @property
    def path(self) -> list["TreeNode"]:
        """The nodes from below the root to this one."""
        nodes, node = [], self
        while node.parent is not None:
            nodes.append(node)
            node = node.parent
        return nodes[::-1]

    @property
    def skeleton(self) -> Skeleton:
        """The actions from the root to here."""
        return tuple(node.action for node in self.path if node.action is not None)

    @property
    def pruned(self) -> bool:
        """Whether this node or an ancestor is infeasible."""
        return any(node.infeasible for node in self.path)


class Queue:
    """Nodes that wait for a bound, cheapest first; among equals the oldest."""

    def __init__(self) -> None:
        self._heap: list[tuple[float, int, TreeNode]] = []
        self._order = count()

    def push(self, node: TreeNode, cost: float) -> None:
        """Enters a node."""
        heapq.heappush(self._heap, (cost, next(self._order), node))

    def pop(self) -> TreeNode | None:
        """Takes the cheapest node out that has not been pruned."""
        while self._heap:
            node = heapq.heappop(self._heap)[-1]
            if not node.pruned:
                return node
        return None

    def __len__(self) -> int:
        return sum(not node.pruned for _, _, node in self._heap)
