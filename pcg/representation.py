"""How an agent edits a map: narrow, turtle or wide (Khalifa et al., PCGRL, AIIDE 2020), or flip.

- *narrow*: the environment goes from cell to cell, in an order drawn for each episode; the agent keeps the tile there or
  replaces it. Actions: 0 keep, 1 + t write tile t.
- *turtle*: the agent stands on a cell and walks left, up, right, down (actions 0 to 3) or writes tile t (action 4 + t).
- *wide*: the agent writes any tile anywhere: action 5 * cell + t.
- *flip*: the agent builds a wall on a floor or removes one, anywhere: action cell. Players, crates and targets stay where
  the start map has them, so it needs start maps that have them.

Cells are numbered `row * columns + column`, tiles as in `Tile`, the first five of it. All methods work on n episodes at
once.
"""

from typing import Final, Protocol

import numpy as np

from pcg.arrays import IntArray
from pcg.grid import DIRECTIONS, Cell
from pcg.level import Tile, TileArray

N_TILES = 5
"""Tiles that an agent can write: floor, wall, player, crate, target."""

KEEP = -1
"""Written in place of a tile where nothing is written."""


class Representation(Protocol):
    """A way to edit maps of one shape."""

    @property
    def has_position(self) -> bool:
        """Whether the agent edits the map around one cell."""

    @property
    def sees_solution(self) -> bool:
        """Whether the agent sees where the optimal solution passes."""

    @property
    def n_actions(self) -> int:
        """Actions are 0 to n_actions - 1."""

    def begin(self, rng: np.random.Generator, episodes: IntArray) -> None:
        """Draws what the given episodes (their numbers) need at their start."""

    def positions(self) -> IntArray:
        """(n,) cell of each episode's agent; 0 if it has none."""

    def step(self, actions: IntArray, maps: TileArray) -> tuple[IntArray, IntArray]:
        """Carries out one action in each episode.

        Args:
            actions: (n,).
            maps: (n, rows, columns) tiles before the action.

        Returns:
            (n,) cells to write to and (n,) tiles to write, `KEEP` for none.
        """


class Narrow:
    """Visits all cells in random order, again and again."""

    has_position = True
    sees_solution = False
    n_actions = 1 + N_TILES

    def __init__(self, shape: Cell, n: int) -> None:
        cells = shape[0] * shape[1]
        self._order = np.tile(np.arange(cells), (n, 1))
        self._visited = np.zeros(n, dtype=np.int64)
        self._episodes = np.arange(n)

    def begin(self, rng: np.random.Generator, episodes: IntArray) -> None:
        """Draws the order of the cells."""
        in_order = np.tile(np.arange(self._order.shape[1]), (len(episodes), 1))
        self._order[episodes] = rng.permuted(in_order, axis=1)
        self._visited[episodes] = 0

    def positions(self) -> IntArray:
        """(n,) cells that are visited."""
        return self._order[self._episodes, self._visited]

    def step(self, actions: IntArray, maps: TileArray) -> tuple[IntArray, IntArray]:
        """Keeps or writes the tile, and goes on to the next cell."""
        del maps
        cells = self.positions()
        self._visited = (self._visited + 1) % self._order.shape[1]
        return cells, actions - 1


class Turtle:
    """Walks over the map from a random cell; a step over the edge does nothing."""

    has_position = True
    sees_solution = False
    n_actions = len(DIRECTIONS) + N_TILES

    def __init__(self, shape: Cell, n: int) -> None:
        self._shape = shape
        self._cells = np.zeros(n, dtype=np.int64)
        rows, columns = np.indices(shape)
        steps = [*DIRECTIONS.values(), *N_TILES * [(0, 0)]]
        walks = [
            np.clip(rows + down, 0, shape[0] - 1) * shape[1] + np.clip(columns + right, 0, shape[1] - 1)
            for down, right in steps
        ]
        self._next = np.array(walks).reshape(len(steps), -1)
        """(n_actions, cells) the cell that an action leads to."""
        self._written = np.array([*len(DIRECTIONS) * [KEEP], *range(N_TILES)])
        """(n_actions,) the tile that an action writes."""

    def begin(self, rng: np.random.Generator, episodes: IntArray) -> None:
        """Draws the cell where the turtle stands."""
        rows = rng.integers(self._shape[0], size=len(episodes))
        self._cells[episodes] = rows * self._shape[1] + rng.integers(self._shape[1], size=len(episodes))

    def positions(self) -> IntArray:
        """(n,) cells where the turtles stand."""
        return self._cells

    def step(self, actions: IntArray, maps: TileArray) -> tuple[IntArray, IntArray]:
        """Walks, or writes the tile where the turtle stands."""
        del maps
        cells = self._cells
        self._cells = self._next[actions, cells]
        return cells, self._written[actions]


class _Anywhere:
    """What is alike without a position: nothing is drawn, and the agent is nowhere."""

    has_position = False

    def __init__(self, n: int) -> None:
        self._nowhere = np.zeros(n, dtype=np.int64)

    def begin(self, rng: np.random.Generator, episodes: IntArray) -> None:
        """Nothing is drawn."""
        del rng, episodes

    def positions(self) -> IntArray:
        """(n,) zeros."""
        return self._nowhere


class Wide(_Anywhere):
    """Writes anywhere."""

    sees_solution = False

    def __init__(self, shape: Cell, n: int) -> None:
        super().__init__(n)
        self.n_actions = shape[0] * shape[1] * N_TILES

    def step(self, actions: IntArray, maps: TileArray) -> tuple[IntArray, IntArray]:
        """Writes the tile."""
        del maps
        return actions // N_TILES, actions % N_TILES


_FLIPPED: Final = np.array([Tile.WALL, Tile.FLOOR, *[KEEP] * (len(Tile) - 2)])
"""What `Flip` writes, by the tile that is there."""


class Flip(_Anywhere):
    """Builds or removes a wall anywhere."""

    sees_solution = True

    def __init__(self, shape: Cell, n: int) -> None:
        super().__init__(n)
        self.n_actions = shape[0] * shape[1]
        self._episodes = np.arange(n)

    def step(self, actions: IntArray, maps: TileArray) -> tuple[IntArray, IntArray]:
        """Writes floor in place of a wall, and a wall in place of floor."""
        return actions, _FLIPPED[maps.reshape(len(maps), -1)[self._episodes, actions]]


REPRESENTATIONS: dict[str, type[Narrow | Turtle | Wide | Flip]] = {
    "narrow": Narrow,
    "turtle": Turtle,
    "wide": Wide,
    "flip": Flip,
}
"""By name; made of a shape and the number of episodes."""
