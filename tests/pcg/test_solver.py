from collections import deque
from dataclasses import replace
from heapq import heappop, heappush

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pcg.grid import DIRECTIONS, Cell, cells_of, shortest_walk
from pcg.level import Level
from pcg.sokoban import apply_moves, is_solved
from pcg.solver import MAX_CELLS, Objective, Solution, SolverStatus, default_max_states, goal_crate_of, solve
from pcg.symmetry import symmetries
from pcg.xsb import parse_levels
from tests.pcg import plain_solver


def fewest_pushes(level: Level) -> int | None:
    """The least number of pushes, by visiting every position of player and crates; None if no solution exists."""
    floor, targets, first = set(cells_of(~level.is_wall)), set(level.targets), level.targets[0]
    start = (level.player, level.goal_crate, frozenset(level.crates))
    least = {start: 0}
    queue = deque([start])
    while queue:
        position = queue.popleft()
        player, goal, crates = position
        if targets <= crates and (goal is None or goal == first):
            return least[position]
        for down, right in DIRECTIONS.values():
            ahead, beyond = (player[0] + down, player[1] + right), (player[0] + 2 * down, player[1] + 2 * right)
            push = ahead in crates
            if ahead not in floor or (push and (beyond not in floor or beyond in crates)):
                continue
            after = (ahead, beyond if push and ahead == goal else goal, crates - {ahead} | {beyond} if push else crates)
            cost = least[position] + push
            if cost < least.get(after, cost + 1):
                least[after] = cost
                # Walking is free, so its positions come before those that wait for a push.
                (queue.append if push else queue.appendleft)(after)
    return None


@st.composite
def playable_levels(draw: st.DrawFn) -> Level:
    """Small levels with walls, surplus crates, covered targets and named goal crates."""
    rows, columns = draw(st.integers(1, 4)), draw(st.integers(3, 5))
    cells = draw(st.permutations(list(np.ndindex(rows, columns))))
    crates = draw(st.integers(1, 3 if rows > 1 else 2))
    targets = draw(st.integers(1, min(2, crates)))
    walls = draw(st.integers(0, max(0, len(cells) - 2 - crates - targets) // 2))
    is_wall = np.zeros((rows, columns), dtype=bool)
    for cell in cells[:walls]:
        is_wall[cell] = True
    player, *placed = cells[walls : walls + 1 + crates]
    target_cells = draw(st.permutations(cells[walls:]))[:targets]
    goal = draw(st.sampled_from([None, *placed]))
    return Level.of(is_wall, players=[player], crates=placed, targets=target_cells, goal_crate=goal)


def check(level: Level, solution: Solution) -> None:
    """A solution replays, is as long as it says, and its goal crate ends on the first target."""
    assert solution.lurd is not None
    assert solution.pushes == sum(letter.isupper() for letter in solution.lurd)
    assert solution.moves == len(solution.lurd)
    assert is_solved(apply_moves(level, solution.lurd))
    assert is_solved(apply_moves(replace(level, goal_crate=solution.goal_crate), solution.lurd))


@settings(max_examples=400, deadline=None)
@given(playable_levels())
def test_agrees_with_a_search_over_raw_moves(level: Level):
    """Solvability and the number of pushes are those of a search without regions or pruning."""
    solution = solve(level)
    expected = fewest_pushes(level)
    assert solution.pushes == expected
    assert solution.status is (SolverStatus.UNSOLVABLE if expected is None else SolverStatus.SOLVED)
    if solution.solved:
        check(level, solution)


@pytest.mark.parametrize(
    ("shape", "crates", "targets"), [((6, 6), 2, 1), ((6, 6), 1, 1), ((4, 5), 3, 2), ((4, 5), 2, 2)]
)
@pytest.mark.parametrize("named", ["any crate", "first crate"])
def test_agrees_with_a_search_over_raw_moves_in_wider_rooms(shape: Cell, crates: int, targets: int, named: str):
    """The same in wider rooms, where solutions are longer."""
    rng = np.random.default_rng(1)
    solved = 0
    for _ in range(20):
        is_wall = rng.random(shape) < 0.15
        player, *free = map(tuple, rng.permutation(np.argwhere(~is_wall)).tolist())
        level = Level.of(
            is_wall,
            players=[player],
            crates=free[:crates],
            targets=free[crates : crates + targets],
            goal_crate=free[0] if named == "first crate" else None,
        )
        solution = solve(level)
        assert solution.pushes == fewest_pushes(level)
        if solution.solved:
            solved += 1
            check(level, solution)
    assert solved >= 2


@settings(max_examples=50, deadline=None)
@given(playable_levels())
def test_symmetric_levels_need_as_many_pushes(level: Level):
    """Turning or mirroring a level with its goal crate named changes nothing."""
    goal = level.goal_crate or level.crates[0]
    # With one target its place in reading order cannot change.
    level = Level.of(
        level.is_wall, players=level.players, crates=level.crates, targets=level.targets[:1], goal_crate=goal
    )
    assert len({solve(image).pushes for image in symmetries(level)}) == 1


def fewest_moves(level: Level) -> tuple[int, int] | None:
    """The least number of moves and, with so many moves, of pushes, by Dijkstra's algorithm over single steps."""
    floor, targets, first = set(cells_of(~level.is_wall)), set(level.targets), level.targets[0]
    start = (level.player, level.goal_crate or (-1, -1), tuple(level.crates))
    least = {start: (0, 0)}
    heap = [((0, 0), start)]
    while heap:
        cost, position = heappop(heap)
        player, goal, crates = position
        if targets <= set(crates) and goal in {(-1, -1), first}:
            return cost
        for down, right in DIRECTIONS.values():
            ahead, beyond = (player[0] + down, player[1] + right), (player[0] + 2 * down, player[1] + 2 * right)
            push = ahead in crates
            if ahead not in floor or (push and (beyond not in floor or beyond in crates)):
                continue
            moved = tuple(sorted({*crates} - {ahead} | {beyond})) if push else crates
            after = (ahead, beyond if push and ahead == goal else goal, moved)
            reached = cost[0] + 1, cost[1] + push
            if reached < least.get(after, (1 << 60, 0)):
                least[after] = reached
                heappush(heap, (reached, after))
    return None


@settings(max_examples=200, deadline=None)
@given(playable_levels())
def test_fewest_moves_agree_with_a_search_over_raw_moves(level: Level):
    """With moves as objective a solution has the fewest moves and, of such solutions, the fewest pushes."""
    solution = solve(level, objective=Objective.MOVES)
    expected = fewest_moves(level)
    assert (None if solution.moves is None else (solution.moves, solution.pushes)) == expected
    assert solution.status is (SolverStatus.UNSOLVABLE if expected is None else SolverStatus.SOLVED)
    if solution.solved:
        check(level, solution)


@pytest.mark.parametrize(
    ("text", "moves", "pushes"),
    [
        ("######\n#   @#\n# $ ##\n#  $ #\n#.   #\n######", 7, 3),
        ("#######\n# #   #\n## $$@#\n#     #\n#.    #\n#######", 9, 4),
        ("######\n#   @#\n#  $ #\n# . $#\n#    #\n######", 5, 2),
    ],
)
def test_fewest_moves_before_fewest_pushes(text: str, moves: int, pushes: int):
    """In these levels there are solutions with as few moves and one push more."""
    solution = solve(parse_levels(text, "test.xsb")[0], objective=Objective.MOVES)
    assert (solution.moves, solution.pushes) == (moves, pushes)


@pytest.mark.parametrize(
    ("text", "moves", "pushes"),
    [
        ("########\n#$   # #\n#  #   #\n# #  $ #\n# @.   #\n########", 10, 3),
        ("########\n##@ .  #\n##$    #\n#     ##\n#      #\n# #    #\n########", 11, 7),
        ("########\n#   $# #\n###    #\n##   $ #\n# . @  #\n#      #\n########", 9, 4),
    ],
)
def test_a_state_that_is_reached_again_by_fewer_moves(text: str, moves: int, pushes: int):
    """The search finds a state on the solution by a longer way first."""
    solution = solve(parse_levels(text, "test.xsb")[0], objective=Objective.MOVES)
    assert (solution.moves, solution.pushes) == (moves, pushes)


@pytest.mark.parametrize(
    ("text", "pushes"),
    [
        ("#######\n#.    #\n#  ## #\n#  $ ##\n# $@  #\n# #   #\n#######", 6),
        ("########\n#     ##\n# ..# ##\n##$$@$ #\n# .    #\n########", 6),
        ("########\n# $.   #\n#..$#  #\n# @  $ #\n#      #\n########", 9),
    ],
)
def test_a_state_that_is_reached_again_by_fewer_pushes(text: str, pushes: int):
    """The search finds a state on the solution by more pushes first, which the bound makes look as short."""
    (level,) = parse_levels(text, "test.xsb")
    assert solve(level).pushes == plain_solver.fewest_pushes(level) == pushes


def test_each_objective_has_its_own_solution():
    """Here two pushes take ten moves and three take eight."""
    (level,) = parse_levels("######\n# @. #\n# $  #\n# $  #\n######", "test.xsb")
    by_pushes, by_moves = (solve(level, objective=objective) for objective in (Objective.PUSHES, Objective.MOVES))
    assert (by_pushes.pushes, by_pushes.moves) == (2, 10)
    assert (by_moves.pushes, by_moves.moves) == (3, 8)


@pytest.mark.parametrize("named", ["any crate", "first crate"])
def test_no_level_is_missed(named: str):
    """On 1,000 random 10 x 10 levels both objectives find a solution where the plain twin finds one, and no others."""
    rng = np.random.default_rng(7)
    solved = 0
    for index in range(500):
        is_wall = rng.random((10, 10)) < (0.1, 0.2, 0.3, 0.4)[index % 4]
        player, first, second, target = map(tuple, rng.permutation(np.argwhere(~is_wall))[:4].tolist())
        goal = first if named == "first crate" else None
        level = Level.of(is_wall, players=[player], crates=[first, second], targets=[target], goal_crate=goal)
        solution, by_moves = solve(level), solve(level, objective=Objective.MOVES)
        assert solution.pushes == plain_solver.fewest_pushes(level)
        assert by_moves.status == solution.status
        if solution.solved:
            solved += 1
            check(level, solution)
            check(level, by_moves)
            assert by_moves.moves <= solution.moves
            assert by_moves.pushes >= solution.pushes
    assert solved > 100


@pytest.mark.parametrize(("crates", "targets"), [(3, 3), (4, 2)])
def test_more_crates_and_targets(crates: int, targets: int):
    """Levels of other sizes with more crates and targets are those of the plain twin too."""
    rng = np.random.default_rng(3)
    solved = 0
    for _ in range(60):
        is_wall = rng.random((6, 7)) < 0.1
        player, *free = map(tuple, rng.permutation(np.argwhere(~is_wall)).tolist())
        level = Level.of(is_wall, players=[player], crates=free[:crates], targets=free[crates : crates + targets])
        solution = solve(level)
        assert solution.pushes == plain_solver.fewest_pushes(level)
        if solution.solved:
            solved += 1
            check(level, solution)
    assert solved >= 3


@pytest.mark.parametrize("objective", Objective)
@pytest.mark.parametrize(
    ("shape", "crates", "targets"), [((6, 7), 2, 1), ((6, 7), 3, 2), ((7, 7), 2, 2), ((5, 6), 2, 1)]
)
def test_every_state_is_visited_once(shape: Cell, crates: int, targets: int, objective: Objective):
    """An unsolvable level takes as many states as the plain twin meets: none is left out, none visited again."""
    rng = np.random.default_rng(0)
    most = 0
    for _ in range(120):
        is_wall = rng.random(shape) < 0.2
        player, *free = map(tuple, rng.permutation(np.argwhere(~is_wall)).tolist())
        level = Level.of(
            is_wall,
            players=[player],
            crates=free[:crates],
            targets=free[crates : crates + targets],
            goal_crate=free[0],
        )
        solution = solve(level, objective=objective)
        if not solution.solved:
            most = max(most, solution.states)
            assert solution.states == plain_solver.search(level, by_region=objective is Objective.PUSHES).states
    assert most > 20


@pytest.mark.parametrize("objective", Objective)
@pytest.mark.parametrize(("rows", "columns", "crates"), [(4, 5, 2), (5, 5, 2), (4, 4, 3)])
def test_every_state_of_an_open_room_is_visited_once(rows: int, columns: int, crates: int, objective: Objective):
    """The table of states grows; the target lies round a corner that no crate can be pushed round.

    #########
    #@    # #
    # $     #
    #   $ #.#
    #     ###
    #########
    """
    is_wall = np.ones((rows, columns + 2), dtype=bool)
    is_wall[:, :columns] = is_wall[1, columns] = is_wall[:3, columns + 1] = False
    placed = [(1, 1), (rows - 2, columns - 2), (1, columns - 2)][:crates]
    level = Level.of(is_wall, players=[(0, 0)], crates=placed, targets=[(2, columns + 1)], goal_crate=placed[0])
    solution = solve(level, objective=objective)
    assert solution.status is SolverStatus.UNSOLVABLE
    assert solution.states == plain_solver.search(level, by_region=objective is Objective.PUSHES).states


def test_a_surplus_crate_may_stand_on_a_dead_cell():
    """A crate in a corner is lost, but the other one can still cover the only target."""
    (level,) = parse_levels(
        """
        #######
        #$ @$.#
        #######
        """,
        "test.xsb",
    )
    solution = solve(level)
    assert (solution.pushes, solution.lurd, solution.goal_crate) == (1, "R", (0, 3))
    assert solve(level, goal_crate=(0, 0)).status is SolverStatus.UNSOLVABLE


def test_a_surplus_crate_may_be_pushed_into_a_corner():
    """The way is cleared by pushing a crate where it is lost for good."""
    (level,) = parse_levels(
        """
        #######
        #@$  ##
        ### ###
        ###$###
        ###.###
        #######
        """,
        "test.xsb",
    )
    assert solve(level).lurd == "RRdD"


def test_the_goal_crate_has_to_be_on_the_first_target():
    """Of two targets, the upper one is the goal crate's, even where exchanging the crates is far."""
    (level,) = parse_levels(
        """
        #######
        #  .  #
        #  $  #
        # @   #
        #  $  #
        #  .  #
        #######
        """,
        "test.xsb",
    )
    upper, lower = level.crates
    assert solve(level).pushes == solve(level, goal_crate=upper).pushes == 2
    exchanged = solve(level, goal_crate=lower)
    assert exchanged.pushes == fewest_pushes(replace(level, goal_crate=lower))
    assert exchanged.pushes > 2
    assert exchanged.goal_crate == lower


@pytest.mark.parametrize(
    ("text", "goal"),
    [
        ("######\n#$   #\n# @. #\n#    #\n######", None),
        ("########\n#.@#.  #\n##  $$ #\n#      #\n########", (1, 4)),
    ],
    ids=["no pull from the target leads into a corner", "the goal crate cannot get to the first target"],
)
def test_dead_cells_are_seen_before_any_push(text: str, goal: Cell | None):
    """A level without enough live crates is decided without a search."""
    solution = solve(parse_levels(text, "test.xsb")[0], goal_crate=goal)
    assert (solution.status, solution.states) == (SolverStatus.UNSOLVABLE, 1)


def test_the_argument_overrides_the_levels_goal_crate():
    """The goal crate of the level holds unless another one is given."""
    (level,) = parse_levels("#######\n#.$@$ #\n#######", "test.xsb")
    named = replace(level, goal_crate=(0, 3))
    assert solve(named).status is SolverStatus.UNSOLVABLE
    assert solve(named, goal_crate=(0, 1)).pushes == 1


def test_a_solved_level_needs_no_push():
    """Nothing has to be done where every target is covered."""
    solution = solve(parse_levels("####\n#@*#\n####", "test.xsb")[0])
    assert (solution.status, solution.pushes, solution.moves, solution.lurd) == (SolverStatus.SOLVED, 0, 0, "")
    assert solution.goal_crate == (0, 1)


def test_fewer_crates_than_targets_are_unsolvable():
    """Two targets cannot be covered by one crate."""
    assert solve(Level(np.array([[2, 3, 4, 4]]))).solvable is False


def test_the_limit_is_never_taken_for_unsolvable():
    """A search that is cut short says so; with enough states the same level is decided."""
    (level,) = parse_levels("########\n#@     #\n# $  $ #\n#     .#\n########", "test.xsb")
    needed = solve(level).states
    assert solve(level, max_states=needed).solved
    cut = solve(level, max_states=2)
    assert cut.status is SolverStatus.LIMIT
    assert cut.solvable is None
    assert cut.pushes is None


@pytest.mark.parametrize("objective", Objective)
def test_the_limit_is_kept_exactly(objective: Objective):
    """A search that is cut short has visited as many states as allowed; the number it needs is enough."""
    (level,) = parse_levels("########\n#@     #\n# $  $ #\n#     .#\n########", "test.xsb")
    needed = solve(level, objective=objective).states
    for limit in range(1, needed):
        cut = solve(level, max_states=limit, objective=objective)
        assert (cut.status, cut.states) == (SolverStatus.LIMIT, limit)
    assert solve(level, max_states=needed, objective=objective).solved


@pytest.mark.parametrize("objective", Objective)
@pytest.mark.parametrize("length", [60, 70, 300])
def test_far_more_pushes_than_the_bound_says(length: int, objective: Objective):
    """A crate in a corridor has to be pushed all along it, before one at its end goes home with a single push.

    The bound is 1 where the search begins; queue, states and table outgrow their first sizes.
    """
    is_wall = np.zeros((2, length + 4), dtype=bool)
    is_wall[1, :length] = True
    level = Level.of(is_wall, players=[(0, 0)], crates=[(0, 1), (1, length + 1)], targets=[(1, length + 2)])
    solution = solve(level, objective=objective)
    assert solution.lurd == "R" * length + "dR"
    assert (solution.pushes, solution.goal_crate) == (length + 1, (1, length + 1))


def test_the_bound_leads_straight_to_the_target():
    """In an open room a crate that needs 8 pushes in a line takes few states, and so do two of them side by side."""
    lone = Level.of(np.zeros((11, 11), dtype=bool), players=[(5, 0)], crates=[(5, 1)], targets=[(5, 9)])
    assert solve(lone).pushes == 8
    assert solve(lone).states <= 1 + 8 * 4
    two = Level.of(np.zeros((11, 11), dtype=bool), players=[(5, 0)], crates=[(4, 1), (6, 1)], targets=[(4, 9), (6, 9)])
    assert solve(two).pushes == 16
    assert solve(two).states <= 1 + 9 * 9 * 4


def test_huge_levels_are_left_undecided():
    """A board beyond the largest is not searched."""
    tiles = np.zeros((1, MAX_CELLS + 1), dtype=np.uint8)
    tiles[0, :4] = [2, 3, 0, 4]
    assert solve(Level(tiles)).status is SolverStatus.LIMIT


def test_the_largest_level_is_searched():
    """A board of as many cells as allowed is decided."""
    tiles = np.zeros((1, MAX_CELLS), dtype=np.uint8)
    tiles[0, :4] = [2, 3, 0, 4]
    assert solve(Level(tiles)).pushes == 2


@pytest.mark.parametrize(("shape", "states"), [((10, 10), 250_000), ((10, 20), 250_000), ((50, 50), 20_000)])
def test_large_boards_get_fewer_states(shape: Cell, states: int):
    """Beyond 200 cells the number of states falls with the size, so that the memory stays the same."""
    assert default_max_states(Level(np.zeros(shape, dtype=np.uint8))) == states


def test_walks_between_pushes_are_shortest():
    """No walk between two pushes is longer than it must be."""
    (level,) = parse_levels("#######\n#     #\n# #$# #\n#  @  #\n# #.# #\n#######", "test.xsb")
    solution = solve(level)
    assert solution.pushes == 2
    walk = solution.lurd[: solution.lurd.index("D")]
    assert len(walk) == len(shortest_walk(~(level.is_wall | level.is_crate), level.player, (0, 2)))


@pytest.mark.parametrize(
    ("tiles", "goal", "problem"),
    [([[3, 4]], None, "0 players"), ([[2, 3]], None, "no target"), ([[2, 3, 4]], (0, 2), "not a crate")],
)
def test_unusable_arguments_are_refused(tiles: list[list[int]], goal: Cell | None, problem: str):
    """A level needs one player and a target, and the goal crate must be a crate."""
    with pytest.raises(ValueError, match=problem):
        solve(Level(np.array(tiles)), goal_crate=goal)


@pytest.mark.parametrize(
    ("row", "goal", "expected"),
    [("$@$.", None, (0, 2)), ("$@$.", (0, 0), (0, 0)), ("$ $@ .", None, (0, 0))],
)
def test_choice_of_the_goal_crate(row: str, goal: Cell | None, expected: Cell):
    """The named crate, else the one that the solution brings to the target, else the first in reading order."""
    wall = "#" * (len(row) + 2)
    level = replace(parse_levels(f"{wall}\n#{row}#\n{wall}", "test.xsb")[0], goal_crate=goal)
    assert goal_crate_of(level, solve(level)) == expected


def test_no_goal_crate_without_crates():
    """A level without crates has no goal crate."""
    with pytest.raises(ValueError, match="no crate"):
        goal_crate_of(Level(np.array([[2, 4]])), Solution(SolverStatus.UNSOLVABLE))
