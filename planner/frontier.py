"""The configurations that the search knows, and which of them to expand next ([L], section IV)."""

import heapq
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count

import numpy as np

from converter.shape import FloatArray
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

    def followed_by(self, steps: Sequence[PickPlace]) -> "Node":
        """The last of the new nodes to which `steps` lead from here; this one if there are none."""
        node = self
        for step in steps:
            node = Node(step.applied_to(node.configuration), node, step)
        return node

    @cached_property
    def length(self) -> float:
        """Distance that the agent drives on the way from the start [m]."""
        return 0.0 if self.parent is None or self.step is None else self.parent.length + self.step.length

    @property
    def pick_places(self) -> int:
        """How often an object is picked and placed on the way from the start."""
        return sum(not step.is_regrasp for step in self.steps())


class Frontier:
    """Nodes in the order of their expansion.

    A node that has been expanded comes back after all that have not. With prioritised selection (P) the best score
    goes first; among equal scores, which [L] leaves open, the node in whose surroundings the fewest nodes have been
    expanded, then the oldest. Without P it is first in, first out.
    """

    def __init__(self, settings: Settings) -> None:
        self._prioritised = "P" in settings.letters
        self._expansions = settings.expansions
        self._cell = settings.novelty_cell
        self._expanded: Counter[bytes] = Counter()
        self._heap: list[tuple[int, float, int, int, Node]] = []
        self._order = count()

    def __len__(self) -> int:
        return len(self._heap)

    def add(self, node: Node) -> None:
        """Enters a node, unless it has been expanded often enough."""
        if node.expansions < self._expansions:
            priority = -node.score if self._prioritised else 0.0
            heapq.heappush(self._heap, (node.expansions, priority, self._crowd(node), next(self._order), node))

    def select_node(self) -> Node:
        """Takes the next node out and counts its expansion."""
        expansions, priority, crowd, order, node = heapq.heappop(self._heap)
        # Crowds only grow: a node whose crowd is still what it was when it was entered has the smallest.
        while (grown := self._crowd(node)) > crowd:
            entry = (expansions, priority, grown, order, node)
            expansions, priority, crowd, order, node = heapq.heappushpop(self._heap, entry)
        node.expansions += 1
        self._expanded[self._surroundings(node)] += 1
        return node

    def _crowd(self, node: Node) -> int:
        return self._expanded[self._surroundings(node)] if self._prioritised else 0

    def _surroundings(self, node: Node) -> bytes:
        places = np.vstack([node.configuration.objects, node.configuration.agent])
        return cells_of(places, self._cell)


def cells_of(places: FloatArray, edge: float) -> bytes:
    """The square cells in which `places` (n, 2) [m] lie, as a key."""
    return np.floor(places / edge).astype(np.int64).tobytes()
