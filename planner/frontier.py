"""The configurations that the search knows, and which of them to expand next ([L], section IV)."""

import heapq
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from typing import TypeVar

import numpy as np

from converter.shape import FloatArray
from planner.pick_place import PickPlace
from planner.problem import Configuration
from planner.settings import Settings

_T = TypeVar("_T")


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

    Scores mislead: where the goal-object sees the goal from the start, there is no end of nodes as good in which only
    another object has moved. So a share of the selections, `explore_share`, disregards the score: it takes a node at
    random, every place of the goal-object being as likely (type-based exploration: Xie, Mueller, Holte and Imai 2014).

    Args:
        settings: Which order, how often a node may be expanded, and the share of exploration.
        rng: Draws the explored nodes.
        goal_index: The goal-object.
    """

    def __init__(self, settings: Settings, rng: np.random.Generator, goal_index: int) -> None:
        self._prioritised = "P" in settings.letters
        self._explore_share = settings.explore_share if self._prioritised else 0.0
        self._rng = rng
        self._goal_index = goal_index
        self._expansions = settings.expansions
        self._cell = settings.novelty_cell
        self._expanded: Counter[bytes] = Counter()
        self._heap: list[tuple[int, float, int, int, Node]] = []
        self._unexpanded = Types()
        self._order = count()
        self._n_nodes = 0

    def __len__(self) -> int:
        return self._n_nodes

    def add(self, node: Node) -> None:
        """Enters a node, unless it has been expanded often enough."""
        if node.expansions < self._expansions:
            priority = -node.score if self._prioritised else 0.0
            heapq.heappush(self._heap, (node.expansions, priority, self._crowd(node), next(self._order), node))
            if node.expansions == 0 and self._explore_share:
                self._unexpanded.add(cells_of(node.configuration.objects[self._goal_index], self._cell), node)
            self._n_nodes += 1

    def select_node(self) -> Node:
        """Takes the next node out and counts its expansion."""
        explores = self._explore_share and self._rng.random() < self._explore_share
        node = (self._unexpanded.draw(self._rng) if explores else None) or self._first()
        node.expansions += 1
        self._expanded[self._surroundings(node)] += 1
        self._n_nodes -= 1
        return node

    def _first(self) -> Node:
        while True:
            expansions, priority, crowd, order, node = heapq.heappop(self._heap)
            # Crowds only grow: a node whose crowd is still what it was when it was entered has the smallest.
            while (grown := self._crowd(node)) > crowd:
                entry = (expansions, priority, grown, order, node)
                expansions, priority, crowd, order, node = heapq.heappushpop(self._heap, entry)
            if node.expansions == expansions:
                return node
            # Exploration has taken it out before.

    def _crowd(self, node: Node) -> int:
        return self._expanded[self._surroundings(node)] if self._prioritised else 0

    def _surroundings(self, node: Node) -> bytes:
        places = np.vstack([node.configuration.objects, node.configuration.agent])
        return cells_of(places, self._cell)


class Types:
    """Nodes that have not been expanded, by type."""

    def __init__(self) -> None:
        self._nodes: dict[bytes, list[Node]] = {}
        self._keys: list[bytes] = []

    def add(self, key: bytes, node: Node) -> None:
        """Enters a node of the type `key`."""
        if key not in self._nodes:
            self._nodes[key] = []
            self._keys.append(key)
        self._nodes[key].append(node)

    def draw(self, rng: np.random.Generator) -> Node | None:
        """Takes out a random node of a random type; None if all have been expanded."""
        while self._keys:
            nodes = self._nodes[key := _take(self._keys, rng)]
            while nodes:
                node = _take(nodes, rng)
                if node.expansions == 0:
                    self._keys.append(key)
                    return node
            del self._nodes[key]
        return None


def _take(items: list[_T], rng: np.random.Generator) -> _T:
    """Takes out a random item; the last takes its place."""
    index = int(rng.integers(len(items)))
    items[index], items[-1] = items[-1], items[index]
    return items.pop()


def cells_of(places: FloatArray, edge: float) -> bytes:
    """The square cells in which `places` (n, 2) [m] lie, as a key."""
    return np.floor(places / edge).astype(np.int64).tobytes()
