"""The symbolic domain: its actions, and the skeletons in order and number."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.logic import Action, Domain, Surface
from tests.planner.skeletons import skeletons

GOAL, FLOOR = Surface.GOAL, Surface.FLOOR
domains = st.integers(1, 3).flatmap(lambda n: st.builds(Domain, st.just(n), st.integers(0, n - 1)))


def test_picks_need_an_empty_hand_and_placements_what_is_held():
    """With an empty hand every object can be picked; then only that object can be placed, on the goal or the floor."""
    domain = Domain(2, 0)
    assert domain.actions(domain.initial) == [Action(0), Action(1)]
    holding = domain.successor(domain.initial, Action(1))
    assert holding.held == 1
    assert holding.surfaces == (FLOOR, None)
    assert domain.actions(holding) == [Action(1, GOAL), Action(1, FLOOR)]
    assert domain.successor(holding, Action(1, GOAL)).surfaces == (FLOOR, GOAL)


@pytest.mark.parametrize("action", [Action(0), Action(0, GOAL), Action(2)])
def test_impossible_actions_are_refused(action: Action):
    """Picking with a full hand, placing what is not held, and objects that do not exist are errors."""
    domain = Domain(2, 0)
    holding = domain.successor(domain.initial, Action(1))
    with pytest.raises(ValueError, match="not possible with 1 held"):
        domain.successor(holding, action)


def test_solved_means_that_the_goal_object_lies_on_the_goal():
    """Neither another object on the goal nor the goal-object in the hand is enough."""
    domain = Domain(2, 1)
    assert not domain.is_solved(domain.initial)
    assert not domain.is_solved(domain.initial.with_object(0, GOAL))
    assert not domain.is_solved(domain.initial.with_object(1, None))
    assert domain.is_solved(domain.initial.with_object(1, GOAL))


def test_skeletons_of_one_object_by_hand():
    """The object is brought to the goal at once, or after it was put down on the way."""
    direct = (Action(0), Action(0, GOAL))
    assert list(skeletons(Domain(1, 0), 1)) == []
    assert list(skeletons(Domain(1, 0), 3)) == [direct]
    assert list(skeletons(Domain(1, 0), 4)) == [direct, (Action(0), Action(0, FLOOR), *direct)]


def test_skeletons_of_two_objects_by_hand():
    """Of four actions there are three: one for each first placement that does not end the search, in their order."""
    direct = (Action(1), Action(1, GOAL))
    longer = [(Action(0), Action(0, GOAL)), (Action(0), Action(0, FLOOR)), (Action(1), Action(1, FLOOR))]
    assert list(skeletons(Domain(2, 1), 4)) == [direct, *((*first, *direct) for first in longer)]


@pytest.mark.parametrize(("n_objects", "count"), [(1, 4), (2, 40), (3, 156)])
def test_numbers_of_skeletons(n_objects: int, count: int):
    """Each pair of actions has 2 n - 1 unsolved outcomes, so there are (2 n - 1)^(k - 1) skeletons of 2 k actions."""
    assert len(list(skeletons(Domain(n_objects, 0), 8))) == count == sum((2 * n_objects - 1) ** k for k in range(4))


@given(domains)
def test_skeletons_are_possible_solutions_shortest_first(domain: Domain):
    """Each skeleton can be executed and is solved by its last action only; lengths never fall, none comes twice."""
    found = list(skeletons(domain, 6))
    assert len(set(found)) == len(found)
    assert [len(s) for s in found] == sorted(len(s) for s in found)
    for skeleton in found:
        state = domain.initial
        for action in skeleton:
            assert not domain.is_solved(state)
            state = domain.successor(state, action)
        assert domain.is_solved(state)
