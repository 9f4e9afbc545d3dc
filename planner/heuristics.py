"""How promising a configuration is: 10 v_o + 5 v_g + v_dist ([L], section IV).

v_o is 1 if the goal-object sees the goal, v_g is 1 if the goal-object sees the agent, and v_dist is 5 if the
goal-object's centre is closer than 0.2 m to the goal's, 2 if closer than 0.4 m, else 0.
"""

from collections.abc import Callable

import numpy as np

from converter.shape import FloatArray
from pcg.printable import one_line
from planner.line_of_sight import goal_object_sees, goal_object_sees_if
from planner.problem import Configuration, Problem

GOAL_WEIGHT, AGENT_WEIGHT = 10.0, 5.0
NEAR, NEAR_BONUS = 0.2, 5.0
FAR, FAR_BONUS = 0.4, 2.0


Heuristic = Callable[[Problem, Configuration], float]
"""How promising a configuration is; higher is more promising."""


def score(problem: Problem, configuration: Configuration) -> float:
    """The score of a configuration; higher is more promising."""
    v_o = goal_object_sees(problem, configuration, problem.scene.goal.position)
    v_g = goal_object_sees(problem, configuration, configuration.agent)
    v_dist = _distance_bonus(problem, configuration.objects[problem.goal_index][None])[0]
    return float(GOAL_WEIGHT * v_o + AGENT_WEIGHT * v_g + v_dist)


def scores_if(problem: Problem, configuration: Configuration, index: int, candidates: FloatArray) -> FloatArray:
    """The scores (n,) that the configuration would have with object `index` at each of `candidates` (n, 2) [m].

    The agent is taken to stay where it is.
    """
    goal = problem.scene.goal.position
    v_o = goal_object_sees_if(problem, configuration, index, candidates, goal)
    v_g = goal_object_sees_if(problem, configuration, index, candidates, configuration.agent)
    where = candidates if index == problem.goal_index else configuration.objects[problem.goal_index][None]
    return np.asarray(GOAL_WEIGHT * v_o + AGENT_WEIGHT * v_g + _distance_bonus(problem, where))


def checked(heuristic: Heuristic) -> Heuristic:
    """A heuristic from outside, which must give numbers that have an order; others raise a TypeError."""

    def score(problem: Problem, configuration: Configuration) -> float:
        value = heuristic(problem, configuration)
        if not isinstance(value, (int, float, np.integer, np.floating)) or np.isnan(value):
            raise TypeError(f"the heuristic returned {one_line(repr(value), 100)}, allowed are numbers")
        return float(value)

    return score


def scores_by(heuristic: Heuristic) -> Callable[[Problem, Configuration, int, FloatArray], FloatArray]:
    """The counterpart of `scores_if` for another heuristic, which is asked once per candidate."""

    def scores(problem: Problem, configuration: Configuration, index: int, candidates: FloatArray) -> FloatArray:
        return np.array([heuristic(problem, configuration.with_object(index, z)) for z in candidates], dtype=np.float64)

    return scores


def _distance_bonus(problem: Problem, positions: FloatArray) -> FloatArray:
    distance = np.hypot(*(positions - problem.scene.goal.position).T)
    return np.select([distance < NEAR, distance < FAR], [NEAR_BONUS, FAR_BONUS], 0.0)
