import numpy as np

from pcg.arrays import BoolArray
from pcg.episode_kernel import advance
from pcg.representation import KEEP
from pcg.reward import Control, RewardSettings, distances
from pcg.statistics_kernel import FLOOR, WALL, Column, make_judge, measure

SHAPE = (4, 5)
NO_ARCHIVE = np.zeros((0, *SHAPE), dtype=np.uint8)


class _State:
    """Random maps with what is known about them."""

    def __init__(self, n: int) -> None:
        self.rng = np.random.default_rng(0)
        self.maps = self.rng.choice(5, p=[0.6, 0.2, 0.05, 0.1, 0.05], size=(n, *SHAPE)).astype(np.uint8)
        self.frozen = (self.rng.random(self.maps.shape) < 0.2).astype(np.uint8)
        self.controls = np.zeros((n, len(Control)))
        self.controls[:, Control.WALLS_HIGH], self.controls[:, Control.PUSHES_HIGH] = 5, 9
        self.wanted = RewardSettings().wanted()
        self.judge = make_judge(NO_ARCHIVE, 2, 5000, bits=8)
        self.statistics, self.distance = self.anew()

    def anew(self) -> tuple[np.ndarray, np.ndarray]:
        """Statistics and distance of the maps, from nothing and without what the cache holds."""
        everyone = np.arange(len(self.maps))
        statistics = np.zeros((len(self.maps), len(Column)), dtype=np.int32)
        distance = np.zeros(len(self.maps))
        measure(self.maps, everyone, statistics, make_judge(NO_ARCHIVE, 2, 5000, bits=8))
        distances(statistics, self.controls, everyone, self.wanted, distance)
        return statistics, distance

    def advance(self, cells: np.ndarray, tiles: np.ndarray) -> BoolArray:
        """One step of all maps."""
        known = self.statistics, self.controls, self.distance
        return advance(self.maps, self.frozen, cells, tiles, *known, self.judge, self.wanted)


def test_what_is_known_stays_true():
    """After any edits statistics and distance are those of the maps, and what changed is what differs."""
    state = _State(200)
    solvable = 0
    for _ in range(60):
        before = state.maps.copy()
        cells, tiles = state.rng.integers(20, size=200), state.rng.integers(KEEP, 5, size=200)
        changed = state.advance(cells, tiles)
        assert (changed == (state.maps != before).any(axis=(1, 2))).all()
        statistics, distance = state.anew()
        assert (state.statistics == statistics).all()
        assert (state.distance == distance).all()
        solvable += int(statistics[:, Column.SOLVABLE].sum())
    assert solvable > 0


def test_only_open_cells_are_written():
    """The tile is written but where the cell is frozen, and `KEEP` writes nothing."""
    state = _State(3)
    state.maps[:], state.frozen[:] = FLOOR, 0
    state.frozen[1, 1, 2] = 1
    state.statistics, state.distance = state.anew()
    changed = state.advance(np.array([7, 7, 7]), np.array([WALL, WALL, KEEP]))
    assert changed.tolist() == [True, False, False]
    assert state.maps[:, 1, 2].tolist() == [WALL, FLOOR, FLOOR]
    assert (state.maps != FLOOR).sum() == 1
