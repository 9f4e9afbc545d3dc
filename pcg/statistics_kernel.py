"""The statistics of many maps in one compiled call, with a transposition cache of solver verdicts.

A map is a (rows, columns) array of the first five `Tile` values; unlike a level it may hold any number of players, crates
and targets. A map is *furnished* if it has one player, a target, at least as many crates as targets (and no more than
asked for) and one region of cells without wall; only furnished maps are solved.

The cache's key is the canonical map: which of its cells the player stands on does not change the verdict, only which
region of free cells it is in. A key is a 128-bit hash of the map with that region marked; two maps with one hash are
not told apart (among a thousand million maps the odds are 1 in 10^20). A full slot is overwritten.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numba import njit

from pcg.arrays import ByteArray, Int32Array, IntArray, WordArray
from pcg.dependency_kernel import depends
from pcg.level import Tile, TileArray
from pcg.push_search import fewest_pushes
from pcg.region_kernel import Scratch, count_regions, fill, make_scratch, parts_around, visit
from pcg.solver_kernel import SOLVED, make_board, start_of

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


CRATE_PASSES, PUSHED_FROM = 1, 2
"""Marks of a cell in the optimal solution, added up; see `make_judge`."""

N_COLUMNS = len(Column)


_PLAYERS, _CRATES, _TARGETS, _WALLS, _REGIONS = (int(column) for column in list(Column)[:5])
_SOLVABLE, _PUSHES, _GOAL, _OCCLUDED, _DEPENDENCY, _CLEARANCE, _NOVELTY = (int(column) for column in list(Column)[5:])
_LOOKUPS, _HITS = 0, 1
_MARKS = 4
"""Where a verdict's marks begin."""


class Judge(NamedTuple):
    """What decides about furnished maps, as the compiled functions take it.

    Attributes:
        keys: (size, 2) hashes of canonical maps, size a power of two.
        verdicts: (size, 4 or 4 + cells) solvable, pushes, goal crate, dependency of the maps with these keys, then marks.
        counters: Look-ups and hits so far.
        archive: (m, rows, columns) maps that novelty is measured against, m may be 0.
        max_crates: Maps with more crates are not solved.
        max_states: Limit of the solver; a map that reaches it counts as unsolvable.
    """

    keys: WordArray
    verdicts: Int32Array
    counters: IntArray
    archive: TileArray
    max_crates: int
    max_states: int

    @property
    def hit_rate(self) -> float:
        """Hits by look-ups, 0 without any."""
        return float(self.counters[_HITS] / max(1, self.counters[_LOOKUPS]))


def make_judge(archive: TileArray, max_crates: int, max_states: int, bits: int = 16, *, marks: bool = False) -> Judge:
    """A judge with an empty cache of 2 ** `bits` verdicts, 32 bytes each.

    With `marks` it also says where the optimal solution passes: statistics then have a column more for each cell.
    """
    cells = archive.shape[1] * archive.shape[2] if marks else 0
    keys, verdicts = np.zeros((1 << bits, 2), dtype=np.uint64), np.zeros((1 << bits, 4 + cells), dtype=np.int32)
    return Judge(keys, verdicts, np.zeros(2, dtype=np.int64), archive, max_crates, max_states)


@njit(cache=True)
def measure(maps: TileArray, chosen: IntArray, statistics: Int32Array, judge: Judge) -> None:
    """Writes the statistics of the chosen maps.

    Args:
        maps: (n, rows, columns) tiles.
        chosen: Numbers of the maps to measure.
        statistics: (n, len(Column)), written to.
        judge: Decides about furnished maps.
    """
    scratch = make_scratch(maps.shape[1], maps.shape[2])
    for index in chosen:
        row = statistics[index]
        row[:] = 0
        for tile in maps[index].flat:
            if tile != FLOOR:
                row[_column_of(tile)] += 1
        fill(scratch, maps[index])
        row[_REGIONS] = count_regions(scratch)
        _judge(maps[index], row, judge, scratch)


@njit(cache=True)
def edit(
    maps: TileArray, chosen: IntArray, cells: IntArray, tiles: IntArray, statistics: Int32Array, judge: Judge
) -> None:
    """Writes one tile into each of the chosen maps and brings their statistics up to date.

    Args:
        maps: (n, rows, columns) tiles, written to.
        chosen: (k,) numbers of the maps, each at most once.
        cells: (k,) cells to write to, `row * columns + column`.
        tiles: (k,) tiles to write, each different from the one that is there.
        statistics: (n, len(Column)), true before, and after.
        judge: Decides about furnished maps.
    """
    scratch = make_scratch(maps.shape[1], maps.shape[2])
    for k in range(chosen.size):
        tiles_of_map, row = maps[chosen[k]], statistics[chosen[k]]
        i, j = cells[k] // maps.shape[2], cells[k] % maps.shape[2]
        before, after = tiles_of_map[i, j], tiles[k]
        tiles_of_map[i, j] = after
        if before != FLOOR:
            row[_column_of(before)] -= 1
        if after != FLOOR:
            row[_column_of(after)] += 1
        if before == WALL or after == WALL:  # noqa: PLR1714  # a tuple of two types of integers is not compiled
            row[_REGIONS] = _regions_after(tiles_of_map, i, j, row[_REGIONS], scratch)
        _judge(tiles_of_map, row, judge, scratch)


@njit(cache=True)
def _column_of(tile: int) -> int:
    """The column that counts a tile that is not floor."""
    return (_WALLS, _PLAYERS, _CRATES, _TARGETS)[tile - 1]


@njit(cache=True)
def _judge(tiles: TileArray, row: Int32Array, judge: Judge, scratch: Scratch) -> None:
    """Writes the columns from SOLVABLE on; the counts are up to date."""
    row[_SOLVABLE:] = 0
    row[_GOAL] = -1
    row[_NOVELTY] = _novelty(tiles, judge.archive)
    if row[_PLAYERS] != 1 or row[_REGIONS] != 1 or not 1 <= row[_TARGETS] <= row[_CRATES] <= judge.max_crates:
        return
    fill(scratch, tiles)
    _look_up(row, judge, scratch)
    if row[_SOLVABLE]:
        row[_OCCLUDED] = _is_occluded(tiles, row[_GOAL])
        row[_CLEARANCE] = _clearance(scratch)


@njit(cache=True)
def _regions_after(tiles: TileArray, i: int, j: int, before: int, scratch: Scratch) -> int:
    """The number of regions after a wall came to or went from cell (i, j)."""
    parts = parts_around(tiles, i, j)
    if parts == 1:
        return before
    if parts == 0:
        return before + (-1 if tiles[i, j] == WALL else 1)
    fill(scratch, tiles)
    return count_regions(scratch)


@njit(cache=True)
def _look_up(row: Int32Array, judge: Judge, scratch: Scratch) -> None:
    """Writes solvability, pushes, goal crate and dependency of a furnished map, from the cache if it is there."""
    low, high = _key(scratch)
    slot = np.int64(low & np.uint64(judge.keys.shape[0] - 1))
    judge.counters[_LOOKUPS] += 1
    if judge.keys[slot, 0] == low and judge.keys[slot, 1] == high:
        judge.counters[_HITS] += 1
    else:
        judge.keys[slot, 0], judge.keys[slot, 1] = low, high
        _decide(scratch.board, scratch.width, judge.max_states, judge.verdicts[slot])
    row[_SOLVABLE] = judge.verdicts[slot, 0]
    row[_PUSHES] = judge.verdicts[slot, 1]
    row[_GOAL] = judge.verdicts[slot, 2]
    row[_DEPENDENCY] = judge.verdicts[slot, 3]
    row[N_COLUMNS:] = judge.verdicts[slot, 4:]


@njit(cache=True)
def _mixed(value: np.uint64) -> np.uint64:
    """The finaliser of SplitMix64 (Steele et al. 2014): every bit of the argument flips half of the result's."""
    value = (value ^ (value >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    value = (value ^ (value >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return value ^ (value >> np.uint64(31))


@njit(cache=True)
def _key(scratch: Scratch) -> tuple[np.uint64, np.uint64]:
    """Two hashes of the board with the player's region marked instead of the player."""
    board, unvisited, player = scratch.board, scratch.unvisited, 0
    for cell in range(board.size):
        unvisited[cell] = board[cell] not in (WALL, CRATE)
        if board[cell] == PLAYER:
            player = cell
    first_of_region = board.size
    for k in range(visit(player, scratch.width, unvisited, scratch.queue)):
        first_of_region = min(first_of_region, scratch.queue[k])
    low, high = _mixed(np.uint64(first_of_region + board.size * scratch.width)), np.uint64(0)
    for cell in range(board.size):
        if board[cell] not in (FLOOR, PLAYER):
            code = _mixed(np.uint64(cell * 8 + board[cell] + 1))
            low ^= code
            high += _mixed(code)
    # No key is zero: that is what an empty slot holds.
    return low | np.uint64(1) << np.uint64(63), high + _mixed(np.uint64(first_of_region))


@njit(cache=True)
def _decide(board: ByteArray, width: int, max_states: int, verdict: Int32Array) -> None:
    """Writes solvable, pushes, goal crate (inner cell number), dependency, and the marks if there is room."""
    verdict[:] = 0
    verdict[2] = -1
    wall = (board == WALL).astype(np.uint8)
    player = np.flatnonzero(board == PLAYER)[0]
    crates = np.flatnonzero(board == CRATE).astype(np.int16)
    targets = np.flatnonzero(board == TARGET).astype(np.int32)
    status, _, path = fewest_pushes(make_board(wall, width, targets), player, crates, 0, max_states)
    if status != SOLVED:
        return
    if verdict.size > _MARKS:
        _mark(path, width, verdict[_MARKS:])
    goal, _ = start_of(path, targets[0])
    verdict[0], verdict[1], verdict[2] = 1, len(path), _inner(goal, width)
    verdict[3] = depends(wall, width, player, crates, targets[0], path, max_states)


@njit(cache=True)
def _inner(cell: int, width: int) -> int:
    """The number of a cell of the board without its border."""
    return (cell // width - 1) * (width - 2) + cell % width - 1


@njit(cache=True)
def _mark(path: Int32Array, width: int, marks: Int32Array) -> None:
    """Writes where the pushes of `path` (cell of the crate, step) move crates, and where the player stands for them."""
    for k in range(len(path)):
        cell, step = path[k, 0], path[k, 1]
        marks[_inner(cell, width)] |= CRATE_PASSES
        marks[_inner(cell + step, width)] |= CRATE_PASSES
        marks[_inner(cell - step, width)] |= PUSHED_FROM


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
def _clearance(scratch: Scratch) -> int:
    board, width = scratch.board, scratch.width
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
