"""Order of expansion, budget of expansions, and rejection of equal configurations."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.frontier import Frontier, Node, Rejection
from planner.pick_place import PickPlace
from planner.problem import Configuration, Problem
from planner.settings import Settings
from tests.planner.scenes import body, room, vectors, wall

PRIORITISED, OLDEST_FIRST = Settings(method="Rnd+FP"), Settings(method="Rnd+R")
scores = st.lists(st.sampled_from([0.0, 2.0, 5.0, 10.0, 15.0, 20.0]), min_size=1, max_size=12)


def configuration(*objects: tuple[float, float]) -> Configuration:
    """Objects at these places."""
    return Configuration(np.zeros(2), vectors(*objects))


def node(score: float = 0.0) -> Node:
    """A node with this score."""
    return Node(configuration((0, 0)), score=score)


def frontier_of(nodes: list[Node], settings: Settings) -> Frontier:
    """A frontier that the nodes entered in order."""
    frontier = Frontier(settings)
    for one in nodes:
        frontier.add(one)
    return frontier


@given(scores)
def test_the_best_goes_first_and_of_equals_the_oldest(values: list[float]):
    """With prioritised selection nodes come by falling score, those of equal score in order of age."""
    nodes = [node(value) for value in values]
    frontier = frontier_of(nodes, PRIORITISED)
    assert len(frontier) == len(nodes)
    expected = sorted(nodes, key=lambda one: -one.score)
    assert [frontier.select_node() for _ in nodes] == expected
    assert not frontier


def test_of_equals_the_least_crowded_goes_first():
    """Among equal scores nodes from other surroundings go before those near an expanded one, however old they are."""
    near, also_near, elsewhere = (
        Node(Configuration(np.array([0.05, x]), vectors([0.0, 0.0])), score=5.0) for x in (0.05, 0.1, 0.9)
    )
    frontier = frontier_of([near, also_near, elsewhere], PRIORITISED)
    assert [frontier.select_node() for _ in range(3)] == [near, elsewhere, also_near]


@given(scores)
def test_without_priority_the_oldest_goes_first(values: list[float]):
    """Without P scores do not count: first in, first out."""
    nodes = [node(value) for value in values]
    frontier = frontier_of(nodes, OLDEST_FIRST)
    assert [frontier.select_node() for _ in nodes] == nodes


@given(scores, st.sampled_from([PRIORITISED, OLDEST_FIRST]))
def test_second_expansions_come_after_all_first_ones(values: list[float], settings: Settings):
    """A node is expanded twice at most, the second time when no other waits for its first."""
    nodes = [node(value) for value in values]
    frontier = frontier_of(nodes, settings)
    order = []
    while frontier:
        selected = frontier.select_node()
        order.append(selected)
        frontier.add(selected)
    assert order[: len(nodes)] == order[len(nodes) :]
    assert [one.expansions for one in nodes] == [2] * len(nodes)
    frontier.add(nodes[0])
    assert not frontier


def test_a_new_node_goes_before_second_expansions():
    """A poor new node is preferred to a good one that has been expanded."""
    good, poor = node(20.0), node(0.0)
    frontier = frontier_of([good], PRIORITISED)
    frontier.add(frontier.select_node())
    frontier.add(poor)
    assert [frontier.select_node(), frontier.select_node()] == [poor, good]


def test_the_budget_of_expansions_is_a_setting():
    """With a budget of one no node comes back."""
    frontier = frontier_of([node()], Settings(expansions=1))
    frontier.add(frontier.select_node())
    assert not frontier


def test_steps_lead_from_the_start():
    """A node's steps are those of its ancestors and its own, in order."""
    first, second = (PickPlace(i, vectors([0, 0]), vectors([0, 0]), np.zeros(2)) for i in range(2))
    start = node()
    child = Node(configuration((0, 0)), start, first)
    grandchild = Node(configuration((0, 0)), child, second)
    assert start.steps() == []
    assert grandchild.steps() == [first, second]


def rejection(**changes: Any) -> Rejection:
    """Rejection in an empty room by object positions alone, unless changed."""
    objects = body("obj", 1, 1), body("other", -1, -1)
    settings = {"method": "Rnd+R", "rejection_by_access": False, "equal_configurations": 2, **changes}
    return Rejection(Problem(room(objects=objects)), Settings(**settings))


def test_two_equal_configurations_pass():
    """The third configuration with equal object positions is refused, wherever the agent is; others pass."""
    rej = rejection()
    equal = [Configuration(np.array([x, 0.0]), vectors([0.51, 0.12], [1, 1])) for x in (0.0, 1.0, 2.0)]
    assert [rej.accepts(one) for one in equal] == [True, True, False]
    assert rej.accepts(configuration((0.51, 0.12), (1, 1.2)))


@pytest.mark.parametrize(
    ("other", "equal"),
    [((0.59, 0.11), True), ((0.61, 0.11), False), ((0.51, 0.09), False), ((0.51, -0.11), False)],
)
def test_equal_means_in_the_same_cells(other: tuple[float, float], *, equal: bool):
    """Positions are compared by cells of 0.1 m, on both sides of zero."""
    rej = rejection(equal_configurations=1)
    assert rej.accepts(configuration((0.51, 0.11), (1, 1)))
    assert rej.accepts(configuration(other, (1, 1))) == (not equal)


def test_swapped_objects_are_another_configuration():
    """Which object stands where counts."""
    rej = rejection(equal_configurations=1)
    assert rej.accepts(configuration((0.5, 0), (1, 0)))
    assert rej.accepts(configuration((1, 0), (0.5, 0)))


def test_without_the_letter_nothing_is_refused():
    """Rejection is off in methods without R."""
    rej = rejection(method="Rnd+FP")
    assert all(rej.accepts(configuration((0.5, 0.1), (1, 1))) for _ in range(5))


def test_agents_on_either_side_of_an_object_are_told_apart():
    """By access, configurations are equal only if the agent can drive from one to the other."""
    corridor = [wall(x, sign * 1.2, 1, 2) for sign in (1, -1) for x in (-1.5, -0.5, 0.5, 1.5)]
    problem = Problem(room(*corridor, objects=(body("obj", 0, 0),), agent=(-1.5, 0)))
    rej = Rejection(problem, Settings(method="Rnd+R", equal_configurations=2))
    left, right = (
        [Configuration(np.array([x, 0.0]), vectors([0, 0])) for x in side] for side in ([-1, -1.5, -0.5], [1, 0.5, 1.5])
    )
    assert [rej.accepts(one) for one in left] == [True, True, False]
    assert [rej.accepts(one) for one in right] == [True, True, False]
    assert [rej.accepts(one) for one in (left[0], right[0])] == [False, False]
