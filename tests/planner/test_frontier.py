"""Order and budget of expansions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.frontier import Frontier, Node
from planner.pick_place import PickPlace
from planner.problem import Configuration
from planner.settings import Settings
from tests.planner.scenes import vectors

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


def test_length_adds_up_from_the_start():
    """That of all approaches and carries on the way, a regrasp being an approach only."""
    start = node()
    there = PickPlace(0, vectors([0, 0], [3, 4]), vectors([3, 4], [3, 5]), np.zeros(2))
    regrasp = PickPlace(0, vectors([3, 5], [5, 5]), vectors([5, 5]), np.zeros(2))
    assert start.length == 0.0
    assert start.followed_by([there, regrasp]).length == pytest.approx(5 + 1 + 2)
