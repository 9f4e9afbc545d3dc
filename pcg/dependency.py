"""Whether the goal crate depends on the others: one of them has to move before it can reach its target.

A solvable level has a dependency if it becomes unsolvable when the other crates are walls. With the others taken away
it is always solvable, by the same moves; so among solvable levels these are just the *movable-critical* ones: solvable
when the other objects are ignored, unsolvable when they are walls.
"""

from pcg.level import Level
from pcg.solver import solve


def has_dependency(level: Level, max_states: int | None = None) -> bool | None:
    """Whether another crate has to move in a solvable level; None if the solver gave up.

    Args:
        level: Solvable, with a goal crate; only its first target counts.
        max_states: Limit of the solver, None for its default.

    Raises:
        ValueError: the level names no goal crate.
    """
    solvable = _solvable_alone(level, others_are_walls=True, max_states=max_states)
    return None if solvable is None else not solvable


def movable_critical(level: Level, max_states: int | None = None) -> bool | None:
    """Whether a level, solvable or not, is movable-critical; None if the solver gave up.

    Arguments and errors are those of `has_dependency`.
    """
    ignored = _solvable_alone(level, others_are_walls=False, max_states=max_states)
    fixed = _solvable_alone(level, others_are_walls=True, max_states=max_states)
    return None if ignored is None or fixed is None else ignored and not fixed


def _solvable_alone(level: Level, *, others_are_walls: bool, max_states: int | None) -> bool | None:
    if level.goal_crate is None:
        raise ValueError("the level names no goal crate")
    target, others = level.targets[0], level.is_crate.copy()
    others[level.goal_crate] = False
    if others_are_walls and others[target]:
        return False
    alone = Level.of(
        level.is_wall | (others & others_are_walls),
        players=[level.player],
        crates=[level.goal_crate],
        targets=[target],
        goal_crate=level.goal_crate,
    )
    return solve(alone, max_states=max_states).solvable
