"""The statistics of many maps in one compiled call, with a transposition cache of solver verdicts.

A map is a (rows, columns) array of the first five `Tile` values; unlike a level it may hold any number of players, crates
and targets. A map is *furnished* if it has one player, a target, at least as many crates as targets (and no more than
asked for) and one region of cells without wall; only furnished maps are solved.

The cache's key is the canonical map: which of its cells the player stands on does not change the verdict, only which
region of free cells it is in. A key is a 128-bit hash of the map with that region marked; two maps with one hash are
not told apart (among a thousand million maps the odds are 1 in 10^20). A full slot is overwritten.
"""

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
import numpy.typing as npt
from numba import njit

from pcg.level import Tile, TileArray
from pcg.solver_kernel import SOLVED, ByteArray, Int32Array, WordArray, fewest_pushes, make_board

IntArray = npt.NDArray[np.int64]

FLOOR, WALL, PLAYER, CRATE, TARGET = (int(tile) for tile in list(Tile)[:5])


class Column(IntEnum):
    """The columns of a statistics array; SOLVABLE to CLEARANCE are 0 (GOAL: -1) unless the map is solved."""

    PLAYERS = 0
    CRATES = 1
    TARGETS = 2
    WALLS = 3
    REGIONS = 4
    """Four-connected regions of cells without wall."""
    SOLVABLE = 5
    PUSHES = 6
    """Least number of pushes."""
    GOAL = 7
    """The goal crate, `row * columns + column`: the one that the optimal solution brings to the first target."""
    OCCLUDED = 8
    """Whether a wall or another crate hides the goal crate from the player, as in `metrics.occluded`."""
    DEPENDENCY = 9
    """Whether the goal crate could not reach its target if the other crates were walls."""
    CLEARANCE = 10
    """Fewest cells without wall and crate among the eight around a crate."""
    NOVELTY = 11
    """Cells in which the map differs from the most similar one of the archive; all of them without an archive."""


_PLAYERS, _CRATES, _TARGETS, _WALLS, _REGIONS = (int(column) for column in list(Column)[:5])
_SOLVABLE, _PUSHES, _GOAL, _OCCLUDED, _DEPENDENCY, _CLEARANCE, _NOVELTY = (int(column) for column in list(Column)[5:])
_LOOKUPS, _HITS = 0, 1


@dataclass(frozen=True)
class VerdictCache:
    """Verdicts of the solver by canonical map.

    Attributes:
        keys: (size, 2) hashes, size a power of two.
        verdicts: (size, 4) solvable, pushes, goal crate, dependency.
        counters: Look-ups and hits so far.
    """

    keys: WordArray
    verdicts: Int32Array
    counters: IntArray = field(default_factory=lambda: np.zeros(2, dtype=np.int64))

    @classmethod
    def empty(cls, bits: int = 16) -> "VerdictCache":
        """A cache of 2 ** `bits` verdicts, 32 bytes each."""
        return cls(np.zeros((1 << bits, 2), dtype=np.uint64), np.zeros((1 << bits, 4), dtype=np.int32))

    @property
    def hit_rate(self) -> float:
        """Hits by look-ups, 0 without any."""
        return float(self.counters[_HITS] / max(1, self.counters[_LOOKUPS]))


def measure(
    maps: TileArray,
    chosen: IntArray,
    statistics: Int32Array,
    cache: VerdictCache,
    archive: TileArray,
    *,
    max_crates: int,
    max_states: int,
) -> None:
    """Writes the statistics of the chosen maps.

    Args:
        maps: (n, rows, columns) tiles.
        chosen: Indices of the maps to measure.
        statistics: (n, len(Column)), written to.
        cache: Looked up and filled.
        archive: (m, rows, columns) maps that novelty is measured against, m may be 0.
        max_crates: Maps with more crates are not solved.
        max_states: Limit of the solver; a map that reaches it counts as unsolvable.
    """
    _measure(maps, chosen, statistics, cache.keys, cache.verdicts, cache.counters, archive, max_crates, max_states)


@njit(cache=True)
def _measure(
    maps: TileArray,
    chosen: IntArray,
    statistics: Int32Array,
    keys: WordArray,
    verdicts: Int32Array,
    counters: IntArray,
    archive: TileArray,
    max_crates: int,
    max_states: int,
) -> None:
    rows, columns = maps.shape[1], maps.shape[2]
    width = columns + 2
    board = np.full((rows + 2) * width, WALL, dtype=np.uint8)
    unvisited = np.zeros(board.size, dtype=np.uint8)
    queue = np.empty(board.size, dtype=np.int32)
    for index in chosen:
        row = statistics[index]
        row[:] = 0
        row[_GOAL] = -1
        for i in range(rows):
            for j in range(columns):
                tile = maps[index, i, j]
                board[(i + 1) * width + j + 1] = tile
                if tile == WALL:
                    row[_WALLS] += 1
                elif tile == PLAYER:
                    row[_PLAYERS] += 1
                elif tile == CRATE:
                    row[_CRATES] += 1
                elif tile == TARGET:
                    row[_TARGETS] += 1
        row[_REGIONS] = _count_regions(board, width, unvisited, queue)
        row[_NOVELTY] = _novelty(maps[index], archive)
        furnished = row[_PLAYERS] == 1 and 1 <= row[_TARGETS] <= row[_CRATES] <= max_crates and row[_REGIONS] == 1
        if not furnished:
            continue
        _look_up(board, width, row, keys, verdicts, counters, max_states, unvisited, queue)
        if row[_SOLVABLE]:
            row[_OCCLUDED] = _is_occluded(maps[index], row[_GOAL])
            row[_CLEARANCE] = _clearance(board, width)


@njit(cache=True)
def _visit(cell: int, width: int, unvisited: ByteArray, queue: Int32Array) -> int:
    """Clears the flags of all cells connected to `cell`, lists them in `queue` and returns their number."""
    unvisited[cell] = 0
    queue[0] = cell
    begin, end = 0, 1
    while begin < end:
        cell = queue[begin]
        begin += 1
        for step in (-1, -width, 1, width):
            if unvisited[cell + step]:
                unvisited[cell + step] = 0
                queue[end] = cell + step
                end += 1
    return end


@njit(cache=True)
def _count_regions(board: ByteArray, width: int, unvisited: ByteArray, queue: Int32Array) -> int:
    for cell in range(board.size):
        unvisited[cell] = board[cell] != WALL
    regions = 0
    for cell in range(board.size):
        if unvisited[cell]:
            regions += 1
            _visit(cell, width, unvisited, queue)
    return regions


@njit(cache=True)
def _look_up(
    board: ByteArray,
    width: int,
    row: Int32Array,
    keys: WordArray,
    verdicts: Int32Array,
    counters: IntArray,
    max_states: int,
    unvisited: ByteArray,
    queue: Int32Array,
) -> None:
    """Writes solvability, pushes, goal crate and dependency of a furnished map, from the cache if it is there."""
    low, high = _key(board, width, unvisited, queue)
    slot = np.int64(low & np.uint64(keys.shape[0] - 1))
    counters[_LOOKUPS] += 1
    if keys[slot, 0] == low and keys[slot, 1] == high:
        counters[_HITS] += 1
    else:
        keys[slot, 0], keys[slot, 1] = low, high
        verdicts[slot] = _verdict(board, width, max_states)
    row[_SOLVABLE], row[_PUSHES], row[_GOAL], row[_DEPENDENCY] = (
        verdicts[slot, 0],
        verdicts[slot, 1],
        verdicts[slot, 2],
        verdicts[slot, 3],
    )


@njit(cache=True)
def _mixed(value: np.uint64) -> np.uint64:
    """The finaliser of SplitMix64 (Steele et al. 2014): every bit of the argument flips half of the result's."""
    value = (value ^ (value >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    value = (value ^ (value >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return value ^ (value >> np.uint64(31))


@njit(cache=True)
def _key(board: ByteArray, width: int, unvisited: ByteArray, queue: Int32Array) -> tuple[np.uint64, np.uint64]:
    """Two hashes of the board with the player's region marked instead of the player."""
    player = 0
    for cell in range(board.size):
        unvisited[cell] = board[cell] not in (WALL, CRATE)
        if board[cell] == PLAYER:
            player = cell
    first_of_region = board.size
    for k in range(_visit(player, width, unvisited, queue)):
        first_of_region = min(first_of_region, queue[k])
    low, high = _mixed(np.uint64(first_of_region + board.size * width)), np.uint64(0)
    for cell in range(board.size):
        if board[cell] not in (FLOOR, PLAYER):
            code = _mixed(np.uint64(cell * 8 + board[cell] + 1))
            low ^= code
            high += _mixed(code)
    # No key is zero: that is what an empty slot holds.
    return low | np.uint64(1) << np.uint64(63), high + _mixed(np.uint64(first_of_region))


@njit(cache=True)
def _verdict(board: ByteArray, width: int, max_states: int) -> tuple[int, int, int, int]:
    """Solvable, pushes, goal crate (inner cell number), dependency."""
    wall = (board == WALL).astype(np.uint8)
    player = np.flatnonzero(board == PLAYER)[0]
    crates = np.flatnonzero(board == CRATE).astype(np.int16)
    targets = np.flatnonzero(board == TARGET).astype(np.int32)
    status, _, path = fewest_pushes(make_board(wall, width, targets), player, crates, 0, max_states)
    if status != SOLVED:
        return 0, 0, -1, 0
    goal, own_pushes = targets[0], 0
    for k in range(len(path) - 1, -1, -1):
        if path[k, 0] + path[k, 1] == goal:
            goal = path[k, 0]
            own_pushes += 1
    number = (goal // width - 1) * (width - 2) + goal % width - 1
    if own_pushes == len(path):
        # No other crate moves, so they might as well be walls.
        return 1, len(path), number, 0
    for crate in crates:
        wall[crate] = crate != goal
    alone = np.empty(1, dtype=np.int16)
    alone[0] = goal
    status, _, _ = fewest_pushes(make_board(wall, width, targets[:1]), player, alone, 0, max_states)
    return 1, len(path), number, int(status != SOLVED)


@njit(cache=True)
def _is_occluded(tiles: TileArray, goal: int) -> bool:
    """Whether the ray between the cell centres of player and goal crate is blocked; see `metrics.occluded`.

    Lengths are in quarters of a cell. A segment and an open square are apart if and only if one of three axes separates
    them: the two of the grid and the normal of the segment.
    """
    rows, columns = tiles.shape
    goal_row, goal_column = goal // columns, goal % columns
    player_row, player_column = 0, 0
    for i in range(rows):
        for j in range(columns):
            if tiles[i, j] == PLAYER:
                player_row, player_column = i, j
    d_row, d_column = 4 * (goal_row - player_row), 4 * (goal_column - player_column)
    for i in range(min(goal_row, player_row), max(goal_row, player_row) + 1):
        for j in range(min(goal_column, player_column), max(goal_column, player_column) + 1):
            if i == goal_row and j == goal_column:
                continue
            if tiles[i, j] == WALL:
                half_width = 2
            elif tiles[i, j] == CRATE:
                half_width = 1
            else:
                continue
            offset = 4 * (i - player_row) * d_column - 4 * (j - player_column) * d_row
            if abs(offset) < half_width * (abs(d_row) + abs(d_column)):
                return True
    return False


@njit(cache=True)
def _clearance(board: ByteArray, width: int) -> int:
    clearance = 8
    for cell in range(board.size):
        if board[cell] == CRATE:
            free = 0
            for step in (-width - 1, -width, -width + 1, -1, 1, width - 1, width, width + 1):
                free += board[cell + step] not in (WALL, CRATE)
            clearance = min(clearance, free)
    return clearance


@njit(cache=True)
def _novelty(tiles: TileArray, archive: TileArray) -> int:
    least = tiles.size
    for known in archive:
        differing = 0
        for i in range(tiles.shape[0]):
            for j in range(tiles.shape[1]):
                differing += tiles[i, j] != known[i, j]
        least = min(least, differing)
    return least
