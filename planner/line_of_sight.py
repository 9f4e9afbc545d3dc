"""Lines of sight, as the heuristics of [L] use them.

Two points see each other if the open segment between them meets no wall and no object other than the ones it starts
from and ends at. Touching does not block.
"""

import numpy as np

from converter.shape import FloatArray
from planner.configuration_space import ObstacleSet
from planner.kernel import BoolArray, segments_free
from planner.problem import Configuration, Problem


def goal_object_sees(problem: Problem, configuration: Configuration, target: FloatArray) -> bool:
    """Whether the centre of the goal-object sees `target` (2,) [m], world."""
    blockers = problem.sight_blockers(configuration, problem.goal_index)
    return bool(_clear(configuration.objects[problem.goal_index], target[None], blockers)[0])


def goal_object_sees_if(
    problem: Problem, configuration: Configuration, index: int, candidates: FloatArray, target: FloatArray
) -> BoolArray:
    """For each of `candidates` (n, 2) [m] whether the goal-object would see `target` (2,) with object `index` there."""
    goal_index = problem.goal_index
    if index == goal_index:
        return _clear(target, candidates, problem.sight_blockers(configuration, goal_index))
    source = configuration.objects[goal_index]
    others_clear = _clear(source, target[None], problem.sight_blockers(configuration, goal_index, index))
    # The blocker at z meets the segment as the blocker at the origin meets the segment moved by -z.
    blocker = problem.sight_objects[index]
    moved_clear = segments_free(source - candidates, target - candidates, *blocker.arrays)
    return np.asarray(others_clear & moved_clear)


def _clear(source: FloatArray, targets: FloatArray, blockers: ObstacleSet) -> BoolArray:
    sources = np.ascontiguousarray(np.broadcast_to(source, targets.shape))
    return np.asarray(segments_free(sources, np.ascontiguousarray(targets), *blockers.arrays))
