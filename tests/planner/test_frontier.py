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

PRIORITISED = Settings(method="Rnd+FP", explore_share=0.0)
OLDEST_FIRST = Settings(method="Rnd+R")
EXPLORING = Settings(method="Rnd+FP", explore_share=1.0)
scores = st.lists(st.sampled_from([0.0, 2.0, 5.0, 10.0, 15.0, 20.0]), min_size=1, max_size=12)


def configuration(*objects: tuple[float, float]) -> Configuration:
    """Objects at these places."""
    return Configuration(np.zeros(2), vectors(*objects))


def node(score: float = 0.0) -> Node:
    """A node with this score."""
    return Node(configuration((0, 0)), score=score)


def frontier_of(nodes: list[Node], settings: Settings, seed: int = 0) -> Frontier:
    """A frontier that the nodes entered in order."""
    frontier = Frontier(settings, np.random.default_rng(seed), goal_index=0)
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


@given(scores, st.sampled_from([0.2, 1.0]), st.integers(0, 5))
def test_exploration_takes_every_node_as_often(values: list[float], share: float, seed: int):
    """However they are drawn, all nodes are expanded once, and then all once more, best first."""
    nodes = [node(value) for value in values]
    frontier = frontier_of(nodes, Settings(method="Rnd+FP", explore_share=share), seed)
    order = []
    while frontier:
        order.append(frontier.select_node())
        frontier.add(order[-1])
    assert sorted(map(id, order[: len(nodes)])) == sorted(map(id, nodes))
    assert order[len(nodes) :] == sorted(order[: len(nodes)], key=lambda one: -one.score)


def test_exploration_is_even_over_the_places_of_the_goal_object():
    """Twenty good nodes with the goal-object at one place are drawn as often as the one poor node elsewhere."""
    good = [Node(configuration((0, 0), (i, 0)), score=15.0) for i in range(20)]
    poor = Node(configuration((1, 0), (0, 0)), score=0.0)
    firsts = []
    for seed in range(200):
        first = frontier_of([*good, poor], EXPLORING, seed).select_node()
        first.expansions = 0
        firsts.append(first)
    assert 70 <= sum(first is poor for first in firsts) <= 130


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
