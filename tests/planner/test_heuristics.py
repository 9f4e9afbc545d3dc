"""The score of a configuration: 10 v_o + 5 v_g + v_dist."""

import numpy as np
import pytest

from planner.heuristics import checked, score, scores_if
from planner.problem import Configuration, Problem
from tests.planner.scenes import body, room, vectors, wall

BETWEEN = wall(0, 0, 0.2, 0.8)
"""Hides the goal at (1, 0) from much of the left half of the room."""


def problem_with_wall() -> Problem:
    """The goal at (1, 0), the wall to the left of it, two objects."""
    objects = (body("obj", -1, 0), body("other", -1.5, -1.5))
    return Problem(room(BETWEEN, objects=objects, agent=(0, -1), goal=(1.0, 0.0)))


@pytest.mark.parametrize(
    ("obj", "agent", "expected"),
    [
        ((-1, 0), (1, 0.1), 0),  # behind the wall from both
        ((-1, 0), (-1, -1), 5),  # sees the agent
        ((1, -0.6), (-1, 0.6), 10),  # sees the goal; the line to the agent leads through the wall
        ((1, -0.6), (0, -1), 15),
        ((1, -0.4), (0, -1), 15),  # 0.4 m is not closer than 0.4 m
        ((1, 0.39), (1, -1), 17),
        ((1, 0.2), (1, -1), 17),  # 0.2 m is not closer than 0.2 m
        ((1.1, -0.1), (1, -1), 20),
        ((1, 0), (-1, 0), 15),  # in the goal, hidden from the agent
    ],
)
def test_terms_add_up(obj: tuple[float, float], agent: tuple[float, float], expected: float):
    """Sight to the goal 10, sight to the agent 5, closer than 0.4 m 2 and closer than 0.2 m 5."""
    problem = problem_with_wall()
    configuration = Configuration(np.array(agent), vectors(obj, (-1.5, -1.5)))
    assert score(problem, configuration) == expected


@pytest.mark.parametrize("index", [0, 1])
def test_hypothetical_scores_are_scores_of_the_hypothetical_configuration(index: int):
    """With the object at a candidate and the agent where it is, both functions agree."""
    problem = problem_with_wall()
    rng = np.random.default_rng(0)
    seen = set()
    for _ in range(20):
        configuration = Configuration(rng.uniform(-2, 2, 2), rng.uniform(-2, 2, (2, 2)))
        candidates = np.vstack([rng.uniform(-2, 2, (5, 2)), np.array([1.0, 0.0]) + rng.uniform(-0.3, 0.3, (5, 2))])
        found = scores_if(problem, configuration, index, candidates)
        expected = [score(problem, configuration.with_object(index, one)) for one in candidates]
        np.testing.assert_array_equal(found, expected)
        seen.update(expected)
    assert {0, 5, 10, 15} <= seen


def test_no_candidates_have_no_scores():
    """An empty array gives an empty array, for either kind of object."""
    problem = problem_with_wall()
    for index in (0, 1):
        assert scores_if(problem, problem.initial, index, np.empty((0, 2))).shape == (0,)


@pytest.mark.parametrize("value", [None, "high", float("nan"), np.zeros(1), 1j])
def test_heuristics_from_outside_give_numbers(value: object):
    """What has no order cannot select a configuration."""
    problem = problem_with_wall()
    with pytest.raises(TypeError, match=r"the heuristic returned .*, allowed are numbers"):
        checked(lambda *_: value)(problem, problem.initial)  # type: ignore[arg-type,return-value]  # what anybody may do
    assert checked(lambda *_: np.float32(2))(problem, problem.initial) == 2.0
