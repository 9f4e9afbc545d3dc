"""What a policy is asked for in training: controls, frozen parts and start maps, drawn anew for each episode."""

from dataclasses import dataclass

import numpy as np

from pcg.arrays import FloatArray
from pcg.episodes import Beginning, EpisodeSettings
from pcg.level import TileArray
from pcg.request import MAX_PUSHES
from pcg.reward import Control
from pcg.start_maps import start_maps
from pcg.statistics_kernel import FLOOR, WALL


@dataclass(frozen=True)
class TaskDistribution:
    """The ranges that tasks are drawn from.

    Attributes:
        wall_density: Lower end of the wall band, by cells.
        wall_width: Width of the wall band, by cells.
        pushes: Lower end of the push band, inclusive.
        push_width: Width of the push band.
        open_share: Share of tasks whose push band has no upper end.
        occluded_share: Share of tasks that ask for a hidden goal crate; as many ask for a visible one.
        dependency_share: Share of tasks that ask for a dependency.
        frozen_share: Share of tasks with frozen parts.
    """

    wall_density: tuple[float, float] = (0.05, 0.27)
    wall_width: tuple[float, float] = (0.03, 0.1)
    pushes: tuple[int, int] = (3, 18)
    push_width: tuple[int, int] = (2, 6)
    open_share: float = 0.5
    occluded_share: float = 0.15
    dependency_share: float = 0.1
    frozen_share: float = 0.25

    def controls(self, rng: np.random.Generator, n: int, cells: int) -> FloatArray:
        """(n, len(Control)) controls."""
        controls = np.zeros((n, len(Control)))
        low = rng.uniform(*self.wall_density, n)
        controls[:, Control.WALLS_LOW] = np.floor(low * cells)
        controls[:, Control.WALLS_HIGH] = np.ceil((low + rng.uniform(*self.wall_width, n)) * cells)
        fewest = rng.integers(*self.pushes, n, endpoint=True)
        most = fewest + rng.integers(*self.push_width, n, endpoint=True)
        controls[:, Control.PUSHES_LOW] = fewest
        controls[:, Control.PUSHES_HIGH] = np.where(rng.random(n) < self.open_share, MAX_PUSHES, most)
        sight = rng.random(n)
        hidden, seen = sight < self.occluded_share, sight > 1 - self.occluded_share
        controls[:, Control.OCCLUDED] = hidden.astype(int) - seen.astype(int)
        controls[:, Control.DEPENDENCY] = rng.random(n) < self.dependency_share
        return controls

    def beginning(self, rng: np.random.Generator, n: int, settings: EpisodeSettings) -> Beginning:
        """Draws n tasks with random start maps."""
        controls = self.controls(rng, n, settings.cells)
        maps = start_maps(rng, controls, settings)
        return Beginning(maps, self._frozen(rng, maps), controls)

    def _frozen(self, rng: np.random.Generator, maps: TileArray) -> TileArray:
        """Flags of a rectangle of the start map in some tasks; walls and floor only, things stay free to move."""
        n, rows, columns = maps.shape
        down, right = np.arange(rows)[:, None], np.arange(columns)
        one_each = (n, 1, 1)
        top, left = rng.integers(rows, size=one_each), rng.integers(columns, size=one_each)
        high = rng.integers(1, max(2, rows // 2), size=one_each)
        wide = rng.integers(1, max(2, columns // 2), size=one_each)
        inside = (down >= top) & (down < top + high) & (right >= left) & (right < left + wide)
        inside &= rng.random(one_each) < self.frozen_share
        return np.asarray(inside & ((maps == FLOOR) | (maps == WALL)), dtype=np.uint8)


LONG_SOLUTIONS = TaskDistribution(
    wall_density=(0.05, 0.2),
    wall_width=(0.03, 0.2),
    pushes=(8, 28),
    open_share=1.0,
    occluded_share=0.0,
    dependency_share=0.25,
)
"""At least so many pushes, in any band of walls, some with a dependency."""
