"""Many editing episodes at once: the state and the rules that all environments share.

Every episode starts from a random map and ends with success (every term of the reward's distance is 0) or when a budget
is spent: a share of the tiles for changes, a share of the tiles for steps. Budgets are properties of the settings, so
they always belong to the size at hand.
"""

from dataclasses import dataclass, field

import numpy as np

from pcg.arrays import BoolArray, FloatArray, Int32Array, IntArray
from pcg.episode_kernel import advance
from pcg.grid import Cell
from pcg.level import TileArray
from pcg.representation import REPRESENTATIONS, Representation
from pcg.reward import Control, RewardSettings, distances, reward
from pcg.solver import MAX_CELLS
from pcg.statistics_kernel import Column, make_judge, measure


@dataclass(frozen=True)
class EpisodeSettings:
    """Size, budgets and start of an episode.

    Attributes:
        representation: narrow, turtle, wide or flip.
        rows: Rows.
        columns: Columns.
        change_share: Tiles that may be changed, by the number of tiles.
        step_share: Steps of an episode, by the number of tiles.
        takes_back: An edit that leads away from what is wanted is taken back at once; it costs a step, but no change.
        thing_share: Chance of a cell to hold a player at the start; likewise a crate, a target.
        wall_spread: The chance of a wall is that of the middle of the wanted band, plus or minus up to this.
        reward: What is wanted.
        spare_crates: Maps with so many crates too many are solved too; else moving a crate, first writing the new one and
            then removing the old one, would lose the solution in between.
        max_states: Limit of the solver; a map that reaches it counts as unsolvable.
    """

    representation: str = "narrow"
    rows: int = 10
    columns: int = 10
    change_share: float = 0.3
    step_share: float = 3.0
    takes_back: bool = False
    thing_share: float = 0.01
    wall_spread: float = 0.05
    reward: RewardSettings = field(default_factory=RewardSettings)
    spare_crates: int = 0
    max_states: int = 5_000

    def __post_init__(self) -> None:
        if self.representation not in REPRESENTATIONS:
            raise ValueError(f"representation {self.representation!r} is none of {', '.join(REPRESENTATIONS)}")
        if min(self.rows, self.columns) < 1:
            raise ValueError(f"rows and columns must be at least 1, found {self.rows} and {self.columns}")
        if self.cells > MAX_CELLS:
            raise ValueError(f"{self.rows} x {self.columns} cells are too many; at most {MAX_CELLS} are solved")

    @property
    def shape(self) -> Cell:
        """Rows and columns."""
        return self.rows, self.columns

    @property
    def cells(self) -> int:
        """Number of tiles."""
        return self.rows * self.columns

    @property
    def has_position(self) -> bool:
        """Whether the agent edits the map around one cell."""
        return REPRESENTATIONS[self.representation].has_position

    @property
    def sees_solution(self) -> bool:
        """Whether the agent sees where the optimal solution passes."""
        return REPRESENTATIONS[self.representation].sees_solution

    @property
    def n_actions(self) -> int:
        """Actions are 0 to n_actions - 1."""
        return REPRESENTATIONS[self.representation](self.shape, 1).n_actions

    @property
    def max_changes(self) -> int:
        """Tiles that may be changed in an episode."""
        return max(1, round(self.change_share * self.cells))

    @property
    def max_steps(self) -> int:
        """Steps of an episode."""
        return max(1, round(self.step_share * self.cells))


@dataclass(frozen=True)
class Beginning:
    """How n episodes begin.

    Attributes:
        maps: (n, rows, columns) tiles.
        frozen: (n, rows, columns) flags of the cells that cannot be changed.
        controls: (n, len(Control)).
    """

    maps: TileArray
    frozen: TileArray
    controls: FloatArray


@dataclass(frozen=True)
class Transition:
    """What a step did to n episodes.

    Attributes:
        reward: (n,).
        changed: (n,) whether a tile was changed.
        terminated: (n,) whether everything is met.
        truncated: (n,) whether a budget is spent without success.
    """

    reward: FloatArray
    changed: BoolArray
    terminated: BoolArray
    truncated: BoolArray


class Episodes:
    """n episodes that are stepped together; `begin` starts those that are named anew.

    Args:
        settings: Size, budgets, what is wanted.
        n: Number of episodes.
        archive: (m, rows, columns) maps that novelty is measured against; None for none.

    Raises:
        ValueError: the archive's maps have another shape.

    Attributes:
        settings: Size, budgets, what is wanted.
        maps: (n, rows, columns) tiles.
        frozen: (n, rows, columns) flags.
        controls: (n, len(Control)).
        statistics: (n, len(Column)); where the agent sees the solution followed by the marks of each cell.
        distance: (n,) to what is wanted.
        steps: (n,) steps done.
        changes: (n,) changes done.
        budgets: Changes and steps of an episode.
        coordinates: (cells, 2) row and column of each cell.
        judge: Solves maps, with a cache of its verdicts.
        representation: How maps are edited.
    """

    def __init__(self, settings: EpisodeSettings, n: int, archive: TileArray | None = None) -> None:
        shape = settings.shape
        self.settings = settings
        self.budgets = settings.max_changes, settings.max_steps
        self.coordinates = np.indices(shape, dtype=np.int64).reshape(2, -1).T.copy()
        self.maps = np.zeros((n, *shape), dtype=np.uint8)
        self.frozen = np.zeros((n, *shape), dtype=np.uint8)
        self.controls = np.zeros((n, len(Control)))
        self.distance = np.zeros(n)
        self.steps = np.zeros(n, dtype=np.int64)
        self.changes = np.zeros(n, dtype=np.int64)
        archive = np.zeros((0, *shape), dtype=np.uint8) if archive is None else archive
        if archive.shape[1:] != shape:
            raise ValueError(f"the archive needs maps of {shape[0]} x {shape[1]} cells, found shape {archive.shape}")
        max_crates = settings.reward.crates + settings.spare_crates
        self._wanted = settings.reward.wanted()
        marks = settings.sees_solution
        self.statistics = np.zeros((n, len(Column) + marks * settings.cells), dtype=np.int32)
        self.judge = make_judge(archive, max_crates, settings.max_states, 13 if marks else 16, marks=marks)
        self.representation: Representation = REPRESENTATIONS[settings.representation](shape, n)

    def begin(self, rng: np.random.Generator, episodes: IntArray, beginning: Beginning) -> None:
        """Starts the episodes with these numbers anew."""
        self.maps[episodes] = beginning.maps
        self.frozen[episodes] = beginning.frozen
        self.controls[episodes] = beginning.controls
        self.steps[episodes] = 0
        self.changes[episodes] = 0
        self.representation.begin(rng, episodes)
        measure(self.maps, episodes, self.statistics, self.judge)
        distances(self.statistics, self.controls, episodes, self._wanted, self.distance)

    def is_valid(self) -> BoolArray:
        """(n,) whether each map is a solvable level with the wanted numbers of crates and targets."""
        s, wanted = self.statistics, self.settings.reward
        counted = (s[:, Column.CRATES] == wanted.crates) & (s[:, Column.TARGETS] == wanted.targets)
        return np.asarray(counted & (s[:, Column.SOLVABLE] == 1), dtype=np.bool_)

    def step(self, actions: IntArray) -> Transition:
        """Carries out one action in each episode.

        Raises:
            ValueError: there are more or fewer actions, or one is none of the representation's.
        """
        n_actions = self.representation.n_actions
        # Compiled code does not look where it reads and writes.
        if actions.shape != self.steps.shape:
            raise ValueError(f"{len(self.steps)} actions are needed, found shape {actions.shape}")
        if actions.min() < 0 or actions.max() >= n_actions:
            raise ValueError(f"actions must be 0 to {n_actions - 1}, found {actions.min()} to {actions.max()}")
        before = self.distance.copy()
        cells, tiles = self.representation.step(actions, self.maps)
        kept = self._state_at(cells) if self.settings.takes_back else None
        changed = advance(
            self.maps,
            self.frozen,
            cells,
            tiles,
            self.statistics,
            self.controls,
            self.distance,
            self.judge,
            self._wanted,
        )
        if kept is not None:
            worse = self.distance > before
            self._take_back(worse, cells, kept)
            changed &= ~worse
        self.steps += 1
        self.changes += changed
        terminated = self.distance == 0
        max_changes, max_steps = self.budgets
        spent = (self.steps >= max_steps) | (self.changes >= max_changes)
        gained = reward(before, self.distance, self.settings.reward)
        return Transition(gained, changed, terminated, spent & ~terminated)

    def _state_at(self, cells: IntArray) -> tuple[TileArray, Int32Array, FloatArray]:
        """What an edit of one cell (n,) in each map may change: its tile, the statistics, the distance."""
        return (
            self.maps.reshape(len(cells), -1)[np.arange(len(cells)), cells],
            self.statistics.copy(),
            self.distance.copy(),
        )

    def _take_back(self, worse: BoolArray, cells: IntArray, kept: tuple[TileArray, Int32Array, FloatArray]) -> None:
        tiles, statistics, distance = kept
        self.maps.reshape(len(cells), -1)[worse, cells[worse]] = tiles[worse]
        self.statistics[worse], self.distance[worse] = statistics[worse], distance[worse]
