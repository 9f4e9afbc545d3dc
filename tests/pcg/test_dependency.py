from dataclasses import replace

import pytest

from pcg.dependency import has_dependency, movable_critical
from pcg.generate import random_levels
from pcg.level import Level
from pcg.solver import solve
from pcg.xsb import parse_levels

CORRIDOR = "########\n#  $   #\n#@$   .#\n########\n"


def level_of(text: str, goal_crate: tuple[int, int]) -> Level:
    """The level of an XSB text with a goal crate."""
    return replace(parse_levels(text, "t")[0], goal_crate=goal_crate)


def test_a_free_way_is_no_dependency():
    """The goal crate goes straight to its target, whatever the other one does."""
    level = level_of(CORRIDOR, (1, 1))
    assert solve(level).solved
    assert (has_dependency(level), movable_critical(level)) == (False, False)


def test_a_crate_in_the_way_is_a_dependency():
    """In a corridor of one cell it stands between player and goal crate, and there is no room for it."""
    level = level_of("########\n#@ $ $.#\n########\n", (0, 4))
    assert solve(level).solvable is False
    assert (has_dependency(level), movable_critical(level)) == (True, True)


def test_a_level_that_is_solvable_only_because_the_other_crate_moves():
    """Solved by the rules, yet unsolvable with the other crate as a wall."""
    level = level_of("#######\n#  #  #\n#@$ $.#\n#  #  #\n#######\n", (1, 3))
    solvable, fixed = solve(level).solved, has_dependency(level)
    assert (solvable, fixed) == (True, True)


def test_a_crate_on_the_target_has_to_leave():
    """Nothing else can be on the target while the other crate is a wall there."""
    level = level_of("######\n#@$ *#\n#    #\n######\n", (0, 1))
    assert has_dependency(level) is True


def test_both_notions_agree_on_solvable_levels():
    """A solvable level stays solvable without the other crates, so a dependency is all that movable-critical asks."""
    for generated, _ in zip(random_levels(4), range(60), strict=False):
        assert movable_critical(generated.level) == has_dependency(generated.level)


def test_what_the_solver_leaves_open_is_unknown():
    """With too small a limit there is no answer; without a goal crate there is no question."""
    level = level_of(CORRIDOR, (1, 1))
    assert has_dependency(level, max_states=1) is None
    assert movable_critical(level, max_states=1) is None
    with pytest.raises(ValueError, match="names no goal crate"):
        has_dependency(replace(level, goal_crate=None))
