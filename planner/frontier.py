"""The configurations that the search knows: which to expand next, and which to refuse ([L], section IV)."""

import heapq
from collections import Counter
from dataclasses import dataclass
from itertools import count

import numpy as np

from planner.pick_place import PickPlace
from planner.problem import Configuration
from planner.settings import Settings


@dataclass(eq=False)
class Node:
    """A configuration in the search tree.

    Attributes:
        configuration: Where everything is.
        parent: The node it was reached from; None for the start.
        step: The subproblem that led from the parent to here.
        score: Heuristic value.
        expansions: How often it has been expanded.
    """

    configuration: Configuration
    parent: "Node | None" = None
    step: PickPlace | None = None
    score: float = 0.0
    expansions: int = 0

    def steps(self) -> list[PickPlace]:
        """The subproblems from the start to here."""
        steps, node = [], self
        while node.parent is not None and node.step is not None:
            steps.append(node.step)
            node = node.parent
        return steps[::-1]


class Frontier:
    """Nodes in the order of their expansion.

    A node that has been expanded comes back after all that have not. Among equals the best score goes first with
    prioritised selection (P), otherwise the oldest.
    """

    def __init__(self, settings: Settings) -> None:
        self._prioritised = "P" in settings.letters
        self._expansions = settings.expansions
        self._heap: list[tuple[int, float, int, Node]] = []
        self._order = count()

    def __len__(self) -> int:
        return len(self._heap)

    def add(self, node: Node) -> None:
        """Enters a node, unless it has been expanded often enough."""
        if node.expansions < self._expansions:
            priority = -node.score if self._prioritised else 0.0
            heapq.heappush(self._heap, (node.expansions, priority, next(self._order), node))

    def select_node(self) -> Node:
        """Takes the next node out and counts its expansion."""
        node = heapq.heappop(self._heap)[-1]
        node.expansions += 1
        return node


class Rejection:
    """`rej` of [L]: refuses a configuration if enough others have the same discretised object positions (R)."""

    def __init__(self, settings: Settings) -> None:
        self._active = "R" in settings.letters
        self._cell = settings.rejection_cell
        self._limit = settings.equal_configurations
        self._seen: Counter[bytes] = Counter()

    def accepts(self, configuration: Configuration) -> bool:
        """Whether fewer than the allowed number of equal configurations have been accepted; counts this one."""
        key = np.floor(configuration.objects / self._cell).astype(np.int64).tobytes()
        if self._active and self._seen[key] >= self._limit:
            return False
        self._seen[key] += 1
        return True
