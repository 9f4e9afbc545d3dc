from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from pcg.dependency import has_dependency
from pcg.grid import DIRECTIONS, Cell
from pcg.level import Level
from pcg.metrics import occluded, statistics
from pcg.solver import solve
from pcg.statistics_kernel import CRATE_PASSES, PUSHED_FROM, Column, Judge, edit, make_judge, measure
from tests.pcg.maps import furnished, scattered

NO_ARCHIVE = np.zeros((0, 10, 10), dtype=np.uint8)


def judge(archive: np.ndarray = NO_ARCHIVE, max_crates: int = 2) -> Judge:
    """A judge with an empty cache."""
    return make_judge(archive, max_crates, max_states=20_000)


def measured(maps: np.ndarray, by: Judge) -> np.ndarray:
    """The statistics of all maps."""
    found = np.full((len(maps), len(Column)), 99, dtype=np.int32)
    measure(maps, np.arange(len(maps)), found, by)
    return found


def tiles_of(text: str) -> np.ndarray:
    """(1, rows, columns) tiles; rows are divided by slashes, and a map need not be playable."""
    return np.array([[[" #@$.".index(letter) for letter in row] for row in text.split("/")]], dtype=np.uint8)


def one(text: str, max_crates: int = 2) -> dict[Column, int]:
    """The statistics of a map."""
    tiles = tiles_of(text)
    found = measured(tiles, judge(np.zeros((0, *tiles.shape[1:]), dtype=np.uint8), max_crates))
    return dict(zip(Column, found[0].tolist(), strict=True))


@pytest.mark.parametrize("shape", [(10, 10), (3, 7), (1, 5)])
def test_counts_are_those_of_the_metrics(shape: tuple[int, int]):
    """Players, crates, targets, walls and regions agree with the plain counts."""
    maps = scattered(np.random.default_rng(0), 200, shape)
    counted = measured(maps, judge(np.zeros((0, *shape), dtype=np.uint8)))[:, : Column.REGIONS + 1]
    for tiles, row in zip(maps, counted.tolist(), strict=True):
        s = statistics(Level(tiles))
        assert row == [s.players, s.crates, s.targets, s.walls, s.regions]


@pytest.mark.slow
def test_verdicts_are_those_of_the_solver_and_the_metrics():
    """Solvability, pushes, goal crate, occlusion and dependency agree with the functions on levels."""
    maps = np.concatenate([furnished(np.random.default_rng(1), 200, crates) for crates in (2, 3)])
    solved = dependent = 0
    for tiles, row in zip(maps, measured(maps, judge(max_crates=3)), strict=True):
        if row[Column.REGIONS] != 1:
            assert row[Column.SOLVABLE] == 0
            continue
        level = Level(tiles)
        solution = solve(level)
        assert solution.solved == row[Column.SOLVABLE]
        if not solution.solved:
            assert row[Column.PUSHES : Column.CLEARANCE + 1].tolist() == [0, -1, 0, 0, 0]
            continue
        solved += 1
        goal = divmod(int(row[Column.GOAL]), 10)
        assert (solution.pushes, solution.goal_crate) == (row[Column.PUSHES], goal)
        assert occluded(level, goal) == row[Column.OCCLUDED]
        dependency = has_dependency(replace(level, goal_crate=goal))
        assert dependency == row[Column.DEPENDENCY]
        dependent += bool(dependency)
    assert solved > 100
    assert dependent > 0


@pytest.mark.parametrize("shape", [(10, 10), (4, 3), (2, 6), (1, 5)])
@pytest.mark.parametrize("walls_share", [0.3, 0.9], ids=["all tiles", "mostly walls"])
def test_edits_keep_the_statistics_true(shape: tuple[int, int], walls_share: float):
    """After any edit the statistics are those of a fresh measurement, above all the number of regions."""
    rng = np.random.default_rng(2)
    maps = scattered(rng, 32, shape)
    by = judge(maps[:2].copy(), max_crates=3)
    found = measured(maps, by)
    for _ in range(100):
        cells = rng.integers(shape[0] * shape[1], size=len(maps))
        tiles = np.where(rng.random(len(maps)) < walls_share, rng.integers(2, size=32), rng.integers(5, size=32))
        chosen = np.flatnonzero(maps.reshape(32, -1)[np.arange(32), cells] != tiles)
        edit(maps, chosen, cells[chosen], tiles[chosen], found, by)
        assert (found == measured(maps, by)).all()


def test_the_cache_changes_nothing():
    """Verdicts from the cache are those of the solver, also when slots are overwritten all the time."""
    maps = furnished(np.random.default_rng(3), 150)
    tiny = make_judge(NO_ARCHIVE, 2, 20_000, bits=3)
    fresh = measured(maps, judge())
    assert (measured(maps, tiny) == fresh).all()
    by = judge()
    measured(maps, by)
    assert (measured(maps, by) == fresh).all()
    assert by.counters[1] >= by.counters[0] // 2 > 0


def test_a_player_who_walks_needs_no_new_verdict():
    """Maps whose players stand in one region of free cells share an entry of the cache; other regions do not."""
    by = judge(np.zeros((0, 1, 7), dtype=np.uint8))
    found = [measured(tiles_of(text), by)[0, Column.SOLVABLE] for text in ("@  $ . ", "  @$ . ", "   $ .@")]
    assert found == [1, 1, 0]
    assert by.counters.tolist() == [3, 1]
    assert by.hit_rate == pytest.approx(1 / 3)


def test_marks_are_those_of_the_solution():
    """Cells that crates pass and cells that they are pushed from, of the solution that the solver names; else none."""
    maps = furnished(np.random.default_rng(4), 100)
    marked = np.full((len(maps), len(Column) + 100), 99, dtype=np.int32)
    measure(maps, np.arange(len(maps)), marked, make_judge(NO_ARCHIVE, 2, 20_000, marks=True))
    assert (marked[:, : len(Column)] == measured(maps, judge())).all()
    for tiles, row in zip(maps, marked, strict=True):
        expected = np.zeros((10, 10), dtype=np.int32)
        if row[Column.SOLVABLE]:
            level = Level(tiles)
            for cell, (down, right) in pushes_of(level, solve(level).lurd):
                expected[cell] |= CRATE_PASSES
                expected[cell[0] + down, cell[1] + right] |= CRATE_PASSES
                expected[cell[0] - down, cell[1] - right] |= PUSHED_FROM
        assert (row[len(Column) :].reshape(10, 10) == expected).all()
    assert marked[:, len(Column) :].any()


def pushes_of(level: Level, lurd: str) -> Iterator[tuple[Cell, Cell]]:
    """Cell of the crate and direction of every push."""
    row, column = level.player
    for letter in lurd:
        down, right = DIRECTIONS[letter.lower()]
        row, column = row + down, column + right
        if letter.isupper():
            yield (row, column), (down, right)


def test_only_furnished_maps_are_solved():
    """One player, a target, as many crates, not too many of them, and one region are needed."""
    assert one("@ $ .")[Column.SOLVABLE] == 1
    assert one("@ $@.")[Column.SOLVABLE] == 0
    assert one("@ $..")[Column.SOLVABLE] == 0
    assert one("@ $  ")[Column.SOLVABLE] == 0
    assert one("  $ .")[Column.SOLVABLE] == 0
    assert one("@ $ ./#####/     ")[Column.SOLVABLE] == 0
    assert one("@$ .$", max_crates=1)[Column.SOLVABLE] == 0
    assert one("@$ .$", max_crates=2)[Column.SOLVABLE] == 1


def test_a_dependency_needs_another_crate_in_the_way():
    """A crate in a corridor has to be pushed on before the player can pass; with a way around there is none."""
    corridor, room = "@$   /## ##/##$##/##.##", "@$   /   ##/##$##/##.##"
    for text, depends in ((corridor, 1), (room, 0)):
        found = one(text)
        assert (found[Column.SOLVABLE], found[Column.GOAL], found[Column.DEPENDENCY]) == (1, 12, depends)


def test_clearance_counts_free_cells_around_the_most_enclosed_crate():
    """Players and targets leave room for a grasp, walls and crates do not."""
    assert one("@ ./ $ /   ")[Column.CLEARANCE] == 8
    assert one("@$./   ")[Column.CLEARANCE] == 5


@pytest.mark.parametrize(
    ("text", "hidden"),
    [
        ("####/@ $./####", 0),
        ("@  /#$ / . ", 0),  # the ray touches the corner of a wall
        ("@   /#   / $. /    ", 1),  # it passes through one
        ("@    /  $  /    $/    .", 1),  # through the middle of another crate
        (" .  / $  /  # /   @", 1),
        (" .  / $  /   #/   @", 0),
        ("  @  /     / $   / $   / .   ", 0),  # touches the other crate's square, which is half as wide as a wall's
        ("  @  /     / #   / $.  /     ", 1),
    ],
)
def test_the_goal_crate_is_hidden_where_the_ray_is_blocked(text: str, hidden: int):
    """A ray between cell centres that passes through a wall or another crate's square; to touch a corner is none."""
    found = one(text)
    assert (found[Column.SOLVABLE], found[Column.OCCLUDED]) == (1, hidden)


def test_no_look_up_is_no_hit():
    """The hit rate of an empty cache is 0."""
    assert judge().hit_rate == 0.0


def test_novelty_is_the_distance_to_the_nearest_of_the_archive():
    """It counts differing cells; without an archive all cells count."""
    maps = scattered(np.random.default_rng(4), 3, (10, 10))
    changed = maps[:1].copy()
    changed[0, 0, :3] = (changed[0, 0, :3] + 1) % 5
    assert measured(changed, judge(maps))[0, Column.NOVELTY] == 3
    assert measured(maps, judge(maps))[:, Column.NOVELTY].tolist() == [0, 0, 0]
    assert measured(changed, judge())[0, Column.NOVELTY] == 100
